//! Verdict, then memory, then backend: how a query with any of them before the backend is answered.

use super::{
    Answer, Direct, Inquiry, Memory, Outcome, Plan, Prepared, Retest, SelfShadow, ShadowQuery,
    ShadowTally, Shadows, Shelf, Sparing, Verdict,
};
use crate::occlusion::Occlusion;

/// A verdict, and memories of one kind on a shelf of one kind, before a backend.
pub struct Cached<'a, V, M: Memory, K> {
    backend: &'a dyn Occlusion,
    opaque: u32,
    verdict: V,
    /// What a worker starts with.
    shelf: K,
    shared: M::Shared,
    plan: Plan,
}

impl<'a, V: Verdict, M: Memory, K: Shelf<M>> Cached<'a, V, M, K> {
    /// Every worker starts with copies of `shelf` and `shared`.
    #[must_use]
    pub fn new(
        backend: &'a dyn Occlusion,
        opaque: u32,
        verdict: V,
        shelf: K,
        shared: M::Shared,
        plan: Plan,
    ) -> Self {
        // Embree's companion grid is built when it is first asked for: now, not by a worker.
        let _ = backend.order();
        Self { backend, opaque, verdict, shelf, shared, plan }
    }

    fn caster<I: Inquiry>(&self, inquiry: I) -> Caster<'_, V, M, K, I> {
        Caster {
            verdict: &self.verdict,
            inquiry,
            shelf: self.shelf.clone(),
            shared: self.shared.clone(),
            forgets: self.plan.reset_scanlines,
            tally: ShadowTally::default(),
        }
    }
}

impl<V: Verdict, M: Memory, K: Shelf<M>> Prepared for Cached<'_, V, M, K> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        let direct = Direct::new(self.backend, self.opaque);
        let spawner = self.leaves_out_spawner();
        if spawner || self.plan.retest != Retest::Again {
            Box::new(self.caster(Sparing::new(direct, spawner, self.plan.retest)))
        } else {
            Box::new(self.caster(direct))
        }
    }

    fn memory(&self) -> usize {
        self.verdict.memory()
    }

    fn leaves_out_spawner(&self) -> bool {
        self.plan.self_shadow == SelfShadow::Exclude
    }
}

/// Answers the queries of one worker.
pub struct Caster<'a, V, M: Memory, K, I> {
    verdict: &'a V,
    inquiry: I,
    shelf: K,
    shared: M::Shared,
    /// Whether memories last for a scanline only.
    forgets: bool,
    tally: ShadowTally,
}

impl<'a, V: Verdict, M: Memory, K: Shelf<M>, I: Inquiry> Caster<'a, V, M, K, I> {
    /// A caster with memories as they are on the shelf.
    #[must_use]
    pub fn new(verdict: &'a V, inquiry: I, shelf: K, shared: M::Shared) -> Self {
        Self { verdict, inquiry, shelf, shared, forgets: false, tally: ShadowTally::default() }
    }

    /// The memories.
    pub fn shelf_mut(&mut self) -> &mut K {
        &mut self.shelf
    }

    /// Answers one query.
    #[inline(always)]
    fn cast(&mut self, light: usize, query: &ShadowQuery) -> Answer {
        let Self { verdict, inquiry, shelf, shared, tally, .. } = self;
        if let Some(blocked) = verdict.settle(light, query, &mut tally.backend) {
            let outcome = if blocked { Outcome::VerdictBlocked } else { Outcome::VerdictLit };
            return Answer { blocked, outcome };
        }
        inquiry.begin(query);
        let memory = shelf.at(light, query.path);
        let invalid_rays = tally.backend.invalid_rays;
        if let Some(outcome) = memory.recall(query, shared, inquiry, tally) {
            return Answer { blocked: true, outcome };
        }
        // A ray that is not valid is counted by the traversal, not once more by each test before.
        tally.backend.invalid_rays = invalid_rays;
        let found = inquiry.anywhere(query, &mut tally.backend);
        memory.record(query, shared, found);
        match found {
            Some(_) => Answer { blocked: true, outcome: Outcome::TraversalBlocked },
            None => Answer { blocked: false, outcome: Outcome::TraversalLit },
        }
    }
}

impl<V: Verdict, M: Memory, K: Shelf<M>, I: Inquiry> Shadows for Caster<'_, V, M, K, I> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        for (query, answer) in queries.iter().zip(answers) {
            *answer = self.cast(light, query);
            self.tally.count(answer.blocked, answer.outcome);
        }
    }

    fn begin_scanline(&mut self) {
        if self.forgets {
            self.shelf.clear();
        }
    }

    fn tally(&self) -> ShadowTally {
        ShadowTally { memories: self.shelf.count() as u64, ..self.tally }
    }
}
