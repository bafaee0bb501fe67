//! What commands write.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::failure::Failure;
use crate::whole_file::{WholeFile, finish_all, folder_of, place_of};

/// What messages call standard output.
pub(super) const STANDARD_OUTPUT: &str = "standard output";

/// Statistics, and by which umbra.
#[derive(Serialize)]
struct Versioned<'a, T> {
    version: &'static str,
    #[serde(flatten)]
    value: &'a T,
}

/// The files of a command in the making: all of them appear, or none.
#[derive(Default)]
pub(super) struct Outputs(Vec<WholeFile>);

impl Outputs {
    /// Takes a file that is not in its place yet.
    pub fn push(&mut self, file: WholeFile) {
        self.0.push(file);
    }

    /// Writes a file that is not in its place yet.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        self.push(WholeFile::with(path, |file| file.write_all(bytes))?);
        Ok(())
    }

    /// Writes statistics as JSON, not in their place yet.
    pub fn add_json(&mut self, path: &Path, value: &impl Serialize) -> Result<(), Failure> {
        let versioned = Versioned { version: env!("CARGO_PKG_VERSION"), value };
        let mut text = serde_json::to_string_pretty(&versioned).expect("statistics are plain data");
        text.push('\n');
        self.add(path, text.as_bytes())
    }

    /// Puts all files in their places.
    pub fn finish(self) -> Result<(), Failure> {
        Ok(finish_all(self.0)?)
    }
}

/// Writes statistics as JSON, where they are all that is written.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    outputs.add_json(path, value)?;
    outputs.finish()
}

/// Writes to standard output.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    output
        .write_all(text.as_bytes())
        .and_then(|()| output.flush())
        .map_err(|reason| unprinted(&reason))
}

/// The same; where nobody reads on, a command that writes files too goes on for those.
pub(super) fn print_beside_files(text: &str, writes_files: bool) -> Result<(), Failure> {
    match print(text) {
        Err(Failure::NoReader) if writes_files => Ok(()),
        printed => printed,
    }
}

/// Standard output does not take what is said.
pub(super) fn unprinted(reason: &io::Error) -> Failure {
    match reason.kind() {
        io::ErrorKind::BrokenPipe => Failure::NoReader,
        _ => Failure::unwritable(Path::new(STANDARD_OUTPUT), reason),
    }
}

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
        let Some(place) = replaced(output) else { continue };
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
    let place = place_of(path);
    let folder = folder_of(&place);
    let refuse =
        |reason: String| Failure::Input(format!("cannot write {}: {reason}", path.display()));
    if path == Path::new("-") {
        let stands = "only rays and answers of `umbra query` go to standard streams by that name";
        return Err(refuse(format!("{stands}; give the name of a file")));
    }
    if !folder.is_dir() {
        return Err(refuse(format!("there is no folder {}; make it first", folder.display())));
    }
    let there = match path.metadata() {
        Err(reason) if reason.kind() == io::ErrorKind::InvalidFilename => {
            return Err(Failure::unwritable(path, &reason));
        }
        found => found.ok(),
    };
    if there.as_ref().is_some_and(std::fs::Metadata::is_dir) {
        return Err(refuse("it is a folder; give the name of a file".to_owned()));
    }
    let tried = match there {
        // A device or a pipe: opening it may already do something.
        Some(there) if !there.is_file() => return Ok(()),
        // Renaming over a file does not ask whether it may be written; so ask here.
        Some(_) => OpenOptions::new().append(true).open(path).map(drop),
        None => Ok(()),
    };
    tried
        .and_then(|()| tempfile::tempfile_in(folder).map(drop))
        .map_err(|reason| Failure::unwritable(path, &reason))
}

/// Where a file is or will be; none for devices and pipes, which nothing replaces.
fn replaced(path: &Path) -> Option<PathBuf> {
    let place = place_of(path);
    (place.is_file() || !place.exists()).then_some(place)
}
