//! From names to shadow methods.

use std::fmt;

use super::{Prepared, Trace};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

/// The shadow methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Method {
    /// The backend alone.
    #[default]
    Trace,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 1] = [Self::Trace];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trace => "trace",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why a method cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MethodError {}

/// Makes a method ready for a scene and a backend over its triangles.
///
/// # Errors
/// If method and scene or backend do not go together.
pub fn prepare<'a>(
    method: Method,
    scene: &'a Scene,
    backend: &'a dyn Occlusion,
) -> Result<Box<dyn Prepared + 'a>, MethodError> {
    let _ = scene;
    Ok(match method {
        Method::Trace => Box::new(Trace::new(backend)),
    })
}
