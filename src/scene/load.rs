//! From a name or a path to a scene.

use std::{
    fs,
    io::{self, Read},
    path::Path,
};

use super::{
    Draft, Scene, SceneError, builtin, gltf, obj,
    text::{UTF_16, is_utf_16, without_mark},
    toml,
};

/// Kinds of files that [`load`] reads, for messages.
const READABLE: &str = ".obj, .glb, .gltf and .toml";

/// Loads a scene: the name of a built-in one, or a path that ends in `.obj`, `.glb`, `.gltf` or
/// `.toml` (in any case).
///
/// What the file does not say is chosen, and what makes no sense is left out; [`Scene::notes`] says so in words.
///
/// ```no_run
/// let scene = umbra::scene::load("gallery.toml")?;
/// println!("{} triangles, {} lights", scene.triangles.len(), scene.lights.len());
/// for note in &scene.notes {
///     println!("{note}");
/// }
/// # Ok::<(), umbra::scene::SceneError>(())
/// ```
///
#[doc = include_str!("description.md")]
///
/// # Errors
/// What is wrong with the name or the file, in one line.
pub fn load(name_or_path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    draft(name_or_path)?.finish()
}

/// The scene of that name or path as it is written, before it is moved and rounded.
///
/// # Errors
/// What is wrong with the name or the file, in one line.
pub fn draft(name_or_path: impl AsRef<Path>) -> Result<Draft, SceneError> {
    let path = name_or_path.as_ref();
    if let Some(name) = path.to_str().filter(|name| builtin::NAMES.contains(name)) {
        return builtin::draft_at(name, 1.0);
    }
    match extension(path).as_str() {
        "toml" => toml::read(path),
        _ if is_mesh(path) => read_mesh(path),
        _ => Err(not_a_scene(path)),
    }
}

/// Whether the file has a name that [`read_mesh`] reads.
pub(super) fn is_mesh(path: &Path) -> bool {
    matches!(extension(path).as_str(), "obj" | "glb" | "gltf")
}

/// Reads an OBJ or glTF file.
pub(super) fn read_mesh(path: &Path) -> Result<Draft, SceneError> {
    if extension(path) == "obj" { obj::read(path) } else { gltf::read(path) }
}

/// The bytes of a file that must not be empty, without a byte order mark.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    let unreadable = |reason| SceneError::Unreadable { path: path.into(), reason };
    if path.is_dir() {
        return Err(unreadable(directory()));
    }
    let bytes = fs::read(path).map_err(unreadable)?;
    if bytes.is_empty() {
        return Err(malformed(path, "the file is empty"));
    }
    if is_utf_16(&bytes) {
        return Err(malformed(path, UTF_16));
    }
    Ok(without_mark(bytes))
}

/// At most `most` bytes of a plain file that another file names: a device or a pipe may have no end.
pub(super) fn read_plain(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::other("this is no plain file; name one"));
    }
    let mut bytes = Vec::with_capacity(metadata.len().min(most) as usize);
    fs::File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A [`SceneError::Malformed`].
pub(super) fn malformed(path: &Path, problem: impl Into<String>) -> SceneError {
    SceneError::Malformed { path: path.into(), problem: problem.into() }
}

/// A draft of a file that was read, named after it, with nothing in it.
pub(super) fn empty_draft(path: &Path) -> Draft {
    Draft { name: path.display().to_string(), files: vec![path.into()], ..Draft::default() }
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// What is wrong with a directory.
fn directory() -> io::Error {
    io::Error::other(format!("this is a directory; name a file in it: umbra reads {READABLE}"))
}

/// Why a name without a readable extension is no scene.
fn not_a_scene(path: &Path) -> SceneError {
    if path.is_dir() {
        return SceneError::Unreadable { path: path.into(), reason: directory() };
    }
    if path.exists() {
        return malformed(path, format!("unknown kind of file; umbra reads {READABLE}"));
    }
    SceneError::Unknown { name: path.display().to_string(), known: builtin::NAMES.join(", ") }
}
