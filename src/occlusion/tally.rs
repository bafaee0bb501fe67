//! What queries cost, in counts.

use serde::Serialize;

/// Counters of a worker; plain numbers, summed at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Queries that a backend traversed its structure for.
    pub traversals: u64,
    /// Rays with NaN or infinite parts: answered "not blocked".
    pub invalid_rays: u64,
    /// Cells visited.
    pub cells: u64,
    /// Triangles tested.
    pub triangle_tests: u64,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.traversals += other.traversals;
        self.invalid_rays += other.invalid_rays;
        self.cells += other.cells;
        self.triangle_tests += other.triangle_tests;
    }
}
