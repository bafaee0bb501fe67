//! `trace`: no method at all; the backend answers every query. The measure of the others' answers.

use super::{Answer, Outcome, Prepared, ShadowQuery, ShadowTally, Shadows};
use crate::geometry::Ray;
use crate::occlusion::Occlusion;

/// Asks the backend, in batches.
pub struct Trace<'a> {
    backend: &'a dyn Occlusion,
}

impl<'a> Trace<'a> {
    /// Nothing to prepare.
    #[must_use]
    pub fn new(backend: &'a dyn Occlusion) -> Self {
        Self { backend }
    }
}

impl Prepared for Trace<'_> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        Box::new(Worker {
            backend: self.backend,
            rays: Vec::new(),
            blocked: Vec::new(),
            tally: ShadowTally::default(),
        })
    }
}

struct Worker<'a> {
    backend: &'a dyn Occlusion,
    rays: Vec<Ray>,
    blocked: Vec<bool>,
    tally: ShadowTally,
}

impl Shadows for Worker<'_> {
    fn answer(&mut self, _: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        let Self { backend, rays, blocked, tally } = self;
        rays.clear();
        rays.extend(queries.iter().map(|query| query.ray));
        blocked.clear();
        blocked.resize(queries.len(), false);
        backend.occluded_many(rays, blocked, &mut tally.backend);
        for (&blocked, answer) in blocked.iter().zip(answers) {
            let outcome = if blocked { Outcome::TraversalBlocked } else { Outcome::TraversalLit };
            *answer = Answer { blocked, outcome };
            tally.count(blocked, outcome);
        }
    }

    fn tally(&self) -> ShadowTally {
        self.tally
    }
}
