//! `voxel-cache`: the shadow voxel cache of Pearce and Jevans (§6). Each light remembers the triangle
//! that blocked it last and the voxel it was met in; when the triangle does not block, all triangles
//! of the voxel are tested before anything is traversed.
//!
//! Wins over the object cache where triangles are small beside the distance of neighbouring queries:
//! tessellated surfaces. Loses the tests of a voxel wherever queries jump. "The voxel" is the
//! backend's cell: the voxel of the grid, the leaf of a BVH2, what was met of a node of the CWBVH; for
//! Embree, which shows none, the voxel at the hit point of a grid beside it.
//!
//! Exact because every triangle is tested anew. Figure 1 is read as follows. A hit that lies outside
//! the voxel counts, since any hit before the light proves shadow; Figure 1 forgets the voxel then, we
//! keep it: the next query is as near to it as this one. A voxel that holds the remembered triangle
//! alone counts as tested, as the paper's rates have it, but nothing is tested twice for it.
//!
//! Pearce, Jevans: Exploiting Shadow Coherence in Ray Tracing. Graphics Interface 1991.

use super::{Inquiry, Memory, Outcome, ShadowQuery, ShadowTally};
use crate::geometry::{NOBODY, TriangleId};
use crate::occlusion::{Cell, Occluder};

/// The triangle that blocked last, and its cell: the paper's `last_object` and `last_voxel`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastVoxel {
    /// Any number; [`TriangleId::MAX`] for none.
    pub triangle: TriangleId,
    /// Any run; an empty one for none.
    pub cell: Cell,
}

impl Default for LastVoxel {
    fn default() -> Self {
        Self { triangle: NOBODY, cell: Cell::default() }
    }
}

impl Memory for LastVoxel {
    type Shared = ();

    const NEEDS_CELLS: bool = true;

    #[inline(always)]
    fn recall<I: Inquiry>(
        &mut self,
        query: &ShadowQuery,
        (): &mut (),
        inquiry: &mut I,
        tally: &mut ShadowTally,
    ) -> Option<Outcome> {
        let object = inquiry.is_occluder(self.triangle);
        if object {
            tally.object_tested += 1;
            if inquiry.meets(self.triangle, query, &mut tally.backend) {
                return Some(Outcome::Object);
            }
        }
        if !inquiry.is_cell(self.cell) {
            return None;
        }
        tally.voxel_tested += 1;
        if object && self.cell.end - self.cell.start == 1 {
            return None;
        }
        let found = inquiry.in_cell(self.cell, query, &mut tally.backend)?;
        self.triangle = found.triangle;
        Some(Outcome::Voxel)
    }

    #[inline(always)]
    fn record(&mut self, _: &ShadowQuery, (): &mut (), found: Option<Occluder>) {
        let now = found.map_or_else(Self::default, |found| {
            let Occluder { triangle, cell } = found;
            Self { triangle, cell }
        });
        if *self != now {
            *self = now;
        }
    }
}
