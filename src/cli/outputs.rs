//! What commands write.

use std::fs::OpenOptions;
use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::whole_file::{folder_of, write_whole};

/// Fails early where a file could not be written at the end, or would replace another of the command:
/// an output, or an input.
pub(super) fn check_outputs(outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    outputs.iter().try_for_each(|output| check_writable(output))?;
    check_apart(outputs, inputs)
}

/// Fails if an output would replace another, or an input.
pub(super) fn check_apart(outputs: &[&Path], inputs: &[impl AsRef<Path>]) -> Result<(), Failure> {
    let places = inputs.iter().filter_map(|input| input.as_ref().canonicalize().ok());
    let mut taken: Vec<_> = places.collect();
    for output in outputs {
        let Some(place) = place_of(output) else { continue };
        if taken.contains(&place) {
            return Err(Failure::Input(format!(
                "cannot write {}: the command reads or writes it already; give another name",
                output.display()
            )));
        }
        taken.push(place);
    }
    Ok(())
}

/// Fails early where a file could not be written at the end.
fn check_writable(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    let refuse =
        |reason: String| Failure::Input(format!("cannot write {}: {reason}", path.display()));
    if !folder.is_dir() {
        return Err(refuse(format!("there is no folder {}; make it first", folder.display())));
    }
    let place = path.metadata().ok();
    if place.as_ref().is_some_and(std::fs::Metadata::is_dir) {
        return Err(refuse("it is a folder; give the name of a file".to_owned()));
    }
    let tried = match place {
        // A device or a pipe: opening it may already do something.
        Some(place) if !place.is_file() => return Ok(()),
        // Renaming over a file does not ask whether it may be written; so ask here.
        Some(_) => OpenOptions::new().append(true).open(path).map(drop),
        None => Ok(()),
    };
    tried
        .and_then(|()| tempfile::tempfile_in(folder).map(drop))
        .map_err(|reason| Failure::unwritable(path, &reason))
}

/// Where a file is or will be, however it is named; none for devices and pipes, which nothing replaces.
fn place_of(path: &Path) -> Option<PathBuf> {
    match path.canonicalize() {
        Ok(place) => place.is_file().then_some(place),
        Err(_) => Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?)),
    }
}

/// Writes statistics as JSON.
pub(super) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value).expect("statistics are plain data");
    text.push('\n');
    write_whole(path, text.as_bytes()).map_err(|reason| Failure::unwritable(path, &reason))
}

/// Writes to standard output.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    std::io::stdout().write_all(text.as_bytes()).map_err(|_| Failure::NoReader)
}
