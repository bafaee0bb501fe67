//! Scenes the program makes itself.

use super::Draft;

/// The names of the built-in scenes.
pub const NAMES: &[&str] = &[];

/// Makes the built-in scene of that name.
#[must_use]
pub fn draft(_name: &str) -> Option<Draft> {
    None
}
