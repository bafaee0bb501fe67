//! A shadow query and its answer.

use std::fmt;

use crate::geometry::{Ray, TriangleId};

/// Where in the tree of reflected and refracted rays a query was spawned: the bit table of the
/// paper's Figure 2. Bit `i` is set if the ray of level `i + 1` was refracted, clear if reflected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Path {
    bits: u32,
    level: u8,
}

impl Path {
    /// Levels that the bit table holds.
    pub const MAX_LEVEL: u8 = 31;

    /// The eye ray.
    pub const EYE: Self = Self { bits: 0, level: 0 };

    /// Number of reflections and refractions so far.
    #[must_use]
    pub fn level(self) -> u8 {
        self.level
    }

    /// The bit table.
    #[must_use]
    pub fn bits(self) -> u32 {
        self.bits
    }

    /// The path of the ray reflected here.
    ///
    /// # Panics
    /// Beyond [`Self::MAX_LEVEL`].
    #[must_use]
    pub fn reflected(self) -> Self {
        self.child(0)
    }

    /// The path of the ray refracted here.
    ///
    /// # Panics
    /// Beyond [`Self::MAX_LEVEL`].
    #[must_use]
    pub fn refracted(self) -> Self {
        self.child(1)
    }

    fn child(self, bit: u32) -> Self {
        assert!(self.level < Self::MAX_LEVEL, "a path has at most {} levels", Self::MAX_LEVEL);
        Self { bits: self.bits | bit << self.level, level: self.level + 1 }
    }
}

/// Does light reach the origin of this ray?
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowQuery {
    /// The ray to the light.
    pub ray: Ray,
    /// Where in the ray tree it was spawned.
    pub path: Path,
    /// The triangle it was spawned on.
    pub spawner: TriangleId,
}

/// How a query was answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// A remembered triangle blocks.
    Object,
    /// A triangle of a remembered cell blocks.
    Voxel,
    /// The backend found an occluder.
    TraversalBlocked,
    /// The backend found nothing.
    #[default]
    TraversalLit,
    /// A prepared structure proved it blocked.
    VerdictBlocked,
    /// A prepared structure proved it lit.
    VerdictLit,
}

impl Outcome {
    /// All of them, in the order of their discriminants.
    pub const ALL: [Self; 6] = [
        Self::Object,
        Self::Voxel,
        Self::TraversalBlocked,
        Self::TraversalLit,
        Self::VerdictBlocked,
        Self::VerdictLit,
    ];

    /// The name in pictures and statistics.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Voxel => "voxel",
            Self::TraversalBlocked => "traversal-blocked",
            Self::TraversalLit => "traversal-lit",
            Self::VerdictBlocked => "verdict-blocked",
            Self::VerdictLit => "verdict-lit",
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// Whether an opaque triangle blocks the light.
    pub blocked: bool,
    /// How that was found.
    pub outcome: Outcome,
}

impl Answer {
    /// The answer of a verdict.
    #[must_use]
    pub fn settled(blocked: bool) -> Self {
        let outcome = if blocked { Outcome::VerdictBlocked } else { Outcome::VerdictLit };
        Self { blocked, outcome }
    }

    /// The answer of the backend.
    #[must_use]
    pub fn traversed(blocked: bool) -> Self {
        let outcome = if blocked { Outcome::TraversalBlocked } else { Outcome::TraversalLit };
        Self { blocked, outcome }
    }
}
