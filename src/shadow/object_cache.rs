//! `object-cache`: the shadow cache of Haines and Greenberg. Each light remembers the triangle that
//! blocked it last, which is tested before anything is traversed; a query that reaches the light
//! forgets it.
//!
//! Wins where one triangle blocks many queries in a row: large triangles, many samples. The mean run
//! is 1 / (1 − success rate). Loses a triangle test wherever queries jump.
//!
//! Exact because the triangle is tested anew, by the backend's own test, on the same open segment, and
//! because only opaque triangles are remembered.
//!
//! Haines, Greenberg: The Light Buffer: A Ray Tracer Shadow Testing Accelerator. IEEE CG&A 6(9), 1986.

use super::{Inquiry, Memory, Outcome, ShadowQuery, ShadowTally};
use crate::geometry::{NOBODY, TriangleId};
use crate::occlusion::Occluder;

/// The triangle that blocked last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastOccluder {
    /// Any number; [`TriangleId::MAX`] for none.
    pub triangle: TriangleId,
}

impl Default for LastOccluder {
    fn default() -> Self {
        Self { triangle: NOBODY }
    }
}

impl Memory for LastOccluder {
    type Shared = ();

    const NEEDS_CELLS: bool = false;

    #[inline(always)]
    fn recall<I: Inquiry>(
        &mut self,
        query: &ShadowQuery,
        (): &mut (),
        inquiry: &mut I,
        tally: &mut ShadowTally,
    ) -> Option<Outcome> {
        if !inquiry.is_occluder(self.triangle) {
            return None;
        }
        tally.object_tested += 1;
        inquiry.meets(self.triangle, query, &mut tally.backend).then_some(Outcome::Object)
    }

    #[inline(always)]
    fn record(&mut self, _: &ShadowQuery, (): &mut (), found: Option<Occluder>) {
        self.triangle = found.map_or(NOBODY, |found| found.triangle);
    }
}
