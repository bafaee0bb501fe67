//! Methods in a line or two: what they consist of and take, not what they hold.

use std::fmt;

use super::{Auto, Cached, Caster, Memory, Prepared, Shadows, Shelf, Verdict, Verdicts};

impl fmt::Debug for dyn Prepared + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdicts: Vec<_> = self.verdicts().iter().map(|report| report.verdict).collect();
        f.debug_struct("Prepared")
            .field("verdicts", &verdicts)
            .field("bytes", &self.memory())
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for dyn Shadows + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shadows").field("tally", &self.tally()).finish_non_exhaustive()
    }
}

impl fmt::Debug for dyn Verdict + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Verdict").field("bytes", &self.memory()).finish_non_exhaustive()
    }
}

impl fmt::Debug for Verdicts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Verdicts").field(&self.kinds().collect::<Vec<_>>()).finish()
    }
}

impl fmt::Debug for Auto<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Auto")
            .field("candidates", &self.candidates().collect::<Vec<_>>())
            .field("bytes", &self.memory())
            .finish_non_exhaustive()
    }
}

impl<M: Memory, K: Shelf<M>> fmt::Debug for Cached<'_, M, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cached")
            .field("plan", self.plan())
            .field("bytes", &self.memory())
            .finish_non_exhaustive()
    }
}

impl<M: Memory, K: Shelf<M>, I> fmt::Debug for Caster<'_, M, K, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Caster").finish_non_exhaustive()
    }
}
