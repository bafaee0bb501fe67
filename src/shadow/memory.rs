//! What may be remembered from one query to the next.

use super::{Inquiry, Outcome, ShadowQuery, ShadowTally};
use crate::occlusion::Occluder;

/// What one place of a [`Shelf`](super::Shelf) remembers. It may only say "blocked", and only because
/// a triangle that it remembers is tested again and blocks: so no content can change an answer.
pub trait Memory: Clone + Default + Send + Sync {
    /// What all memories of a worker have in common.
    type Shared: Clone + Send + Sync;

    /// Whether it asks for cells: not every backend has them before somebody does.
    const NEEDS_CELLS: bool;

    /// Whether what is remembered blocks the query.
    fn recall<I: Inquiry>(
        &mut self,
        query: &ShadowQuery,
        shared: &mut Self::Shared,
        inquiry: &mut I,
        tally: &mut ShadowTally,
    ) -> Option<Outcome>;

    /// Takes note of what the backend found for a query that could not be answered from memory.
    fn record(&mut self, query: &ShadowQuery, shared: &mut Self::Shared, found: Option<Occluder>);
}

/// Remembers nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forgetful;

impl Memory for Forgetful {
    type Shared = ();

    const NEEDS_CELLS: bool = false;

    #[inline(always)]
    fn recall<I: Inquiry>(
        &mut self,
        _: &ShadowQuery,
        (): &mut (),
        _: &mut I,
        _: &mut ShadowTally,
    ) -> Option<Outcome> {
        None
    }

    #[inline(always)]
    fn record(&mut self, _: &ShadowQuery, (): &mut (), _: Option<Occluder>) {}
}
