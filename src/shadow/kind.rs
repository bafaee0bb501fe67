//! From names to verdicts.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

use super::{Budget, Verdict};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

/// The verdicts, in the order in which they are asked: cheap ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictKind {}

impl VerdictKind {
    /// How many there are.
    pub const COUNT: usize = 0;

    /// All of them.
    pub const ALL: [Self; Self::COUNT] = [];

    /// Its place in [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        match self {}
    }

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {}
    }

    /// Makes it ready for a scene before a backend, within the memory that is left.
    pub(super) fn prepare<'a>(
        self,
        _scene: &Scene,
        _backend: &'a dyn Occlusion,
        _budget: &Arc<Budget>,
    ) -> Box<dyn Verdict + 'a> {
        match self {}
    }
}

impl fmt::Display for VerdictKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
