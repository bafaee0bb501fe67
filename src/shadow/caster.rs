//! Verdicts, then memory, then backend: how a query with any of them before the backend is answered.

use super::{
    Answer, Direct, Glass, Inquiry, Memory, Plan, Prepared, Retest, SelfShadow, ShadowQuery,
    ShadowTally, Shadows, Shelf, Sparing, VerdictReport, Verdicts,
};
use crate::occlusion::Occlusion;

/// Verdicts, and memories of one kind on a shelf of one kind, before a backend.
pub struct Cached<'a, M: Memory, K> {
    backend: &'a dyn Occlusion,
    opaque: u32,
    verdicts: Verdicts<'a>,
    /// What a worker starts with.
    shelf: K,
    shared: M::Shared,
    plan: Plan,
}

impl<'a, M: Memory, K: Shelf<M>> Cached<'a, M, K> {
    /// Every worker starts with copies of `shelf` and `shared`.
    #[must_use]
    pub fn new(
        backend: &'a dyn Occlusion,
        opaque: u32,
        verdicts: Verdicts<'a>,
        shelf: K,
        shared: M::Shared,
        plan: Plan,
    ) -> Self {
        if M::NEEDS_CELLS {
            // Embree's are made when they are first asked for: now, not by a worker.
            let _ = backend.order();
        }
        Self { backend, opaque, verdicts, shelf, shared, plan }
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    fn caster<I: Inquiry>(&self, inquiry: I) -> Caster<'_, M, K, I> {
        let mut caster = Caster::new(inquiry, self.shelf.clone(), self.shared.clone());
        caster.verdicts = (!self.verdicts.is_empty()).then_some(&self.verdicts);
        caster.forgets = self.plan.reset_scanlines;
        caster
    }
}

impl<M: Memory, K: Shelf<M>> Prepared for Cached<'_, M, K> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        let ask = if M::NEEDS_CELLS { Direct::new } else { Direct::without_cells };
        let direct = ask(self.backend, self.opaque);
        let spawner = self.leaves_out_spawner();
        if spawner || self.plan.retest != Retest::Again {
            Box::new(self.caster(Sparing::new(direct, spawner, self.plan.retest)))
        } else {
            Box::new(self.caster(direct))
        }
    }

    fn memory(&self) -> usize {
        self.verdicts.memory()
    }

    fn glass(&self) -> Option<&dyn Glass> {
        self.verdicts.glass()
    }

    fn verdicts(&self) -> Vec<VerdictReport> {
        self.verdicts.reports()
    }

    fn leaves_out_spawner(&self) -> bool {
        self.plan.self_shadow == SelfShadow::Exclude
    }
}

/// Answers the queries of one worker.
pub struct Caster<'a, M: Memory, K, I> {
    /// None if there are none to ask.
    verdicts: Option<&'a Verdicts<'a>>,
    /// What they say of the present queries.
    settled: Vec<Option<bool>>,
    inquiry: I,
    shelf: K,
    shared: M::Shared,
    /// Whether memories last for a scanline only.
    forgets: bool,
    tally: ShadowTally,
}

impl<M: Memory, K: Shelf<M>, I: Inquiry> Caster<'_, M, K, I> {
    /// A caster with memories as they are on the shelf, behind no verdict.
    #[must_use]
    pub fn new(inquiry: I, shelf: K, shared: M::Shared) -> Self {
        Self {
            verdicts: None,
            settled: Vec::new(),
            inquiry,
            shelf,
            shared,
            forgets: false,
            tally: ShadowTally::default(),
        }
    }

    /// The memories.
    pub fn shelf_mut(&mut self) -> &mut K {
        &mut self.shelf
    }

    /// Answers one query that no verdict settles.
    #[inline(always)]
    fn cast(&mut self, light: usize, query: &ShadowQuery) -> Answer {
        let Self { inquiry, shelf, shared, tally, .. } = self;
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
        Answer::traversed(found.is_some())
    }
}

impl<M: Memory, K: Shelf<M>, I: Inquiry> Shadows for Caster<'_, M, K, I> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        if let Some(verdicts) = self.verdicts {
            verdicts.settle(light, queries, &mut self.settled, &mut self.tally);
        }
        for (place, (query, answer)) in queries.iter().zip(answers).enumerate() {
            let settled = self.verdicts.and_then(|_| self.settled[place]);
            *answer = settled.map_or_else(|| self.cast(light, query), Answer::settled);
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
