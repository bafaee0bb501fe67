//! `woo`: Woo's variant of the shadow voxel cache (§14). Each light remembers a voxel only; the
//! triangle that blocks is moved to the front of the voxel's list, and so is tested first by every
//! light that remembers the voxel.
//!
//! Wins over `voxel-cache` where several lights are blocked in the same voxel. Moving triangles in a
//! list that all threads read would be a race, so each worker has a table of its own that says which
//! triangle of a voxel comes first; the lists stay as they are, and a traversal does not see the
//! table. Testing the front alone is counted as a test of an object, testing all as one of the voxel.
//!
//! Exact because every triangle is tested anew; a slot of the table that another voxel took over
//! loses a hint.
//!
//! Woo's suggestion in Pearce, Jevans: Exploiting Shadow Coherence in Ray Tracing. Graphics Interface 1991.

use super::{Inquiry, Memory, Outcome, ShadowQuery, ShadowTally};
use crate::geometry::{NOBODY, TriangleId};
use crate::occlusion::{Cell, Occluder};

/// Voxels with a front, at most: 2 KiB a worker.
const SLOTS: usize = 256;

/// Which triangle of a voxel is tested first, for one worker.
#[derive(Clone, Debug, Default)]
pub struct Fronts {
    /// By a hash of where the cell starts: that start, and the triangle. Empty until first used.
    slots: Vec<(u32, TriangleId)>,
}

impl Fronts {
    fn slot(cell: Cell) -> usize {
        // Fibonacci hashing: neighbouring cells go to distant slots.
        (cell.start.wrapping_mul(0x9e37_79b9) >> (32 - SLOTS.trailing_zeros())) as usize
    }

    /// The triangle at the front of a cell; [`TriangleId::MAX`] if it is not known.
    #[must_use]
    #[inline(always)]
    pub fn of(&self, cell: Cell) -> TriangleId {
        match self.slots.get(Self::slot(cell)) {
            Some(&(start, triangle)) if start == cell.start => triangle,
            _ => NOBODY,
        }
    }

    /// Moves a triangle to the front of a cell.
    #[inline(always)]
    pub fn move_to_front(&mut self, triangle: TriangleId, cell: Cell) {
        if self.slots.is_empty() {
            self.slots = vec![(0, NOBODY); SLOTS];
        }
        self.slots[Self::slot(cell)] = (cell.start, triangle);
    }
}

/// The cell in which a ray was blocked last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LastCell {
    /// Any run; an empty one for none.
    pub cell: Cell,
}

impl Memory for LastCell {
    type Shared = Fronts;

    const NEEDS_CELLS: bool = true;

    #[inline(always)]
    fn recall<I: Inquiry>(
        &mut self,
        query: &ShadowQuery,
        fronts: &mut Fronts,
        inquiry: &mut I,
        tally: &mut ShadowTally,
    ) -> Option<Outcome> {
        if !inquiry.is_cell(self.cell) {
            return None;
        }
        let front = fronts.of(self.cell);
        if inquiry.is_occluder(front) {
            tally.object_tested += 1;
            if inquiry.meets(front, query, &mut tally.backend) {
                return Some(Outcome::Object);
            }
        }
        tally.voxel_tested += 1;
        let found = inquiry.in_cell(self.cell, query, &mut tally.backend)?;
        fronts.move_to_front(found.triangle, self.cell);
        Some(Outcome::Voxel)
    }

    #[inline(always)]
    fn record(&mut self, _: &ShadowQuery, fronts: &mut Fronts, found: Option<Occluder>) {
        let cell = found.map_or_else(Cell::default, |found| found.cell);
        if let Some(found) = found {
            fronts.move_to_front(found.triangle, cell);
        }
        if self.cell != cell {
            self.cell = cell;
        }
    }
}
