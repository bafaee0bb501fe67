//! What settles a query before anything is traversed.

use super::ShadowQuery;
use crate::occlusion::Tally;

/// Settles some queries outright, from what was prepared for their light; shared by all workers.
///
/// A verdict must be that of the backend behind it, bit for bit: it may only say what it can prove.
pub trait Verdict: Send + Sync {
    /// Whether the query is blocked; `None` where that is not proven. What it costs goes to `tally`.
    fn settle(&self, light: usize, query: &ShadowQuery, tally: &mut Tally) -> Option<bool>;

    /// Bytes of what was prepared.
    fn memory(&self) -> usize {
        0
    }
}

/// Settles nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Undecided;

impl Verdict for Undecided {
    #[inline(always)]
    fn settle(&self, _: usize, _: &ShadowQuery, _: &mut Tally) -> Option<bool> {
        None
    }
}
