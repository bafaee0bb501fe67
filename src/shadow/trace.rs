//! `trace`: no memory; the backend answers every query that no verdict settles. The measure of the
//! other methods' answers.

use super::{Answer, Glass, Prepared, ShadowQuery, ShadowTally, Shadows, VerdictReport, Verdicts};
use crate::geometry::Ray;
use crate::occlusion::Occlusion;

/// Asks the backend, in batches.
#[derive(Debug)]
pub struct Trace<'a> {
    backend: &'a dyn Occlusion,
    verdicts: Verdicts<'a>,
}

impl<'a> Trace<'a> {
    /// Nothing to prepare.
    #[must_use]
    pub fn new(backend: &'a dyn Occlusion) -> Self {
        Self::behind(Verdicts::default(), backend)
    }

    /// Asks verdicts first.
    #[must_use]
    pub fn behind(verdicts: Verdicts<'a>, backend: &'a dyn Occlusion) -> Self {
        Self { backend, verdicts }
    }
}

impl Prepared for Trace<'_> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        Box::new(Worker {
            backend: self.backend,
            verdicts: &self.verdicts,
            settled: Vec::new(),
            rays: Vec::new(),
            blocked: Vec::new(),
            tally: ShadowTally::default(),
        })
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
}

struct Worker<'a> {
    backend: &'a dyn Occlusion,
    verdicts: &'a Verdicts<'a>,
    /// What the verdicts say of the present queries.
    settled: Vec<Option<bool>>,
    /// Rays that they do not settle, and the backend's answers.
    rays: Vec<Ray>,
    blocked: Vec<bool>,
    tally: ShadowTally,
}

impl Shadows for Worker<'_> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        let Self { backend, verdicts, settled, rays, blocked, tally } = self;
        let before = verdicts.settle(light, queries, settled, tally);
        tally.count_settled(&before);
        // Those that are not settled are answered anew below.
        for (answer, settled) in answers.iter_mut().zip(&*settled) {
            *answer = Answer::settled(*settled == Some(true));
        }
        if before.passed_on == 0 {
            return;
        }
        let unsettled = queries.iter().zip(&*settled).filter(|(_, settled)| settled.is_none());
        rays.clear();
        rays.extend(unsettled.map(|(query, _)| query.ray));
        blocked.clear();
        blocked.resize(rays.len(), false);
        backend.occluded_many(rays, blocked, &mut tally.backend);
        let unsettled = answers.iter_mut().zip(&*settled).filter(|(_, settled)| settled.is_none());
        for ((answer, _), blocked) in unsettled.zip(&*blocked) {
            *answer = Answer::traversed(*blocked);
            tally.count(answer.blocked, answer.outcome);
        }
    }

    fn tally(&self) -> ShadowTally {
        self.tally
    }
}
