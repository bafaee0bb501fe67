//! How queries were answered, in counts.

use serde::Serialize;

use super::{Outcome, Settled, VerdictKind};
use crate::occlusion::Tally;

/// Counters of a worker; plain numbers, summed at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ShadowTally {
    /// Queries asked.
    pub queries: u64,
    /// Queries blocked by an opaque triangle.
    pub blocked: u64,
    /// Queries for which a remembered triangle was tested.
    pub object_tested: u64,
    /// Those that it blocked.
    pub object_hits: u64,
    /// Queries for which a remembered cell was tested.
    pub voxel_tested: u64,
    /// Those that it blocked.
    pub voxel_hits: u64,
    /// Memories made, by all workers: lights, or nodes of cache trees.
    pub memories: u64,
    /// Queries that a prepared structure proved lit.
    pub verdict_lit: u64,
    /// Queries that a prepared structure proved blocked.
    pub verdict_blocked: u64,
    /// What each verdict made of the queries it was asked, in the order of [`VerdictKind::ALL`].
    #[serde(skip)]
    pub verdicts: [Settled; VerdictKind::COUNT],
    /// What the backend did, tests of remembered triangles and cells included.
    pub backend: Tally,
}

impl ShadowTally {
    /// Counts answers of verdicts.
    #[inline]
    pub fn count_settled(&mut self, settled: &Settled) {
        self.queries += settled.lit + settled.blocked;
        self.blocked += settled.blocked;
        self.verdict_lit += settled.lit;
        self.verdict_blocked += settled.blocked;
    }

    /// Counts one answer.
    #[inline]
    pub fn count(&mut self, blocked: bool, outcome: Outcome) {
        self.queries += 1;
        self.blocked += u64::from(blocked);
        match outcome {
            Outcome::TraversalLit | Outcome::TraversalBlocked => {}
            Outcome::Object => self.object_hits += 1,
            Outcome::Voxel => self.voxel_hits += 1,
            Outcome::VerdictLit => self.verdict_lit += 1,
            Outcome::VerdictBlocked => self.verdict_blocked += 1,
        }
    }
}

impl std::ops::AddAssign for ShadowTally {
    fn add_assign(&mut self, other: Self) {
        self.queries += other.queries;
        self.blocked += other.blocked;
        self.object_tested += other.object_tested;
        self.object_hits += other.object_hits;
        self.voxel_tested += other.voxel_tested;
        self.voxel_hits += other.voxel_hits;
        self.memories += other.memories;
        self.verdict_lit += other.verdict_lit;
        self.verdict_blocked += other.verdict_blocked;
        for (verdict, other) in self.verdicts.iter_mut().zip(other.verdicts) {
            *verdict += other;
        }
        self.backend += other.backend;
    }
}
