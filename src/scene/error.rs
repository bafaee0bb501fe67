//! What can be wrong with a scene.

use std::{io, path::PathBuf};

use crate::whole_file::Unwritable;

/// Why there is no scene. Each message says what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be opened or read.
    #[error("cannot read {path}: {reason}{}", advice(reason), path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        reason: io::Error,
    },
    /// The file could not be written.
    #[error("cannot write {path}: {reason}", path = path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        reason: io::Error,
    },
    /// Scenes are not written to files of such a name.
    #[error("{path}: scenes are written as .obj or .glb; give a name that ends so", path = path.display())]
    UnknownKind {
        /// The file.
        path: PathBuf,
    },
    /// The file was read but is not what its name says.
    #[error("{path}: {problem}", path = path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong, where, and what to do.
        problem: String,
    },
    /// The name is neither a file nor a built-in scene.
    #[error("no file and no built-in scene is called '{name}'; built-in scenes: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The built-in names.
        known: String,
    },
    /// Nothing is left to render.
    #[error("{name}: no triangles{dropped}; give at least one face that has an area")]
    Empty {
        /// The scene.
        name: String,
        /// What was dropped, as text, or empty.
        dropped: String,
    },
    /// A part of it makes no sense, and nothing else can stand in its place.
    #[error("{name}: {problem}")]
    Unsound {
        /// The scene.
        name: String,
        /// What is wrong, where, and what to do.
        problem: String,
    },
    /// More triangles than a 32-bit index holds, or than memory holds.
    #[error("{name}: {problem}")]
    TooLarge {
        /// The scene.
        name: String,
        /// The estimate and the limit.
        problem: String,
    },
}

/// What to do about a file that cannot be read, after a semicolon.
pub(crate) fn advice(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::NotFound => "; check its name and its folder",
        io::ErrorKind::PermissionDenied => "; give yourself the right to read it",
        _ => "",
    }
}

impl From<Unwritable> for SceneError {
    fn from(Unwritable { path, reason }: Unwritable) -> Self {
        Self::Unwritable { path, reason }
    }
}
