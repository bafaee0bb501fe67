//! Why nothing was measured.

use std::io;

use super::recording::{NoQueries, TooManyQueries};
use crate::occlusion::BackendError;
use crate::render::SettingsError;
use crate::scene::SceneError;
use crate::shadow::MethodError;

/// Why there is no table of the paper, or no trade-off.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// A scene cannot be made.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An engine cannot be used.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// A method cannot be used.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The picture cannot be made.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// There would be too much to ask.
    #[error(transparent)]
    Queries(#[from] TooManyQueries),
    /// Nothing to answer.
    #[error(transparent)]
    NoQueries(#[from] NoQueries),
    /// Nothing would be measured.
    #[error("repetitions 0: give at least 1")]
    Repetitions,
    /// No scanline would be rendered.
    #[error("every {every}: give 1 to {height}, the scanlines of the picture")]
    Every {
        /// What was asked for.
        every: u32,
        /// Scanlines of the picture.
        height: u32,
    },
    /// No tile would be rendered.
    #[error(
        "every {every}: give 1 to {tiles}, the tiles of the picture, as some variants render tiles"
    )]
    EveryTile {
        /// What was asked for.
        every: u32,
        /// Tiles of the picture.
        tiles: u32,
    },
    /// The count of instructions cannot be read.
    #[error("cannot read the count of instructions: {0}")]
    Count(#[from] io::Error),
    /// Callgrind shall count and does not run.
    #[error(
        "Callgrind counts only in programs that Valgrind runs, on x86-64: leave --callgrind-folder out"
    )]
    NoCallgrind,
}
