//! `trace`: no memory; the backend answers every query that no verdict settles. The measure of the
//! other methods' answers.

use super::{Answer, Outcome, Prepared, ShadowQuery, ShadowTally, Shadows, Undecided, Verdict};
use crate::geometry::Ray;
use crate::occlusion::Occlusion;

/// Asks the backend, in batches.
pub struct Trace<'a, V = Undecided> {
    backend: &'a dyn Occlusion,
    verdict: V,
}

impl<'a> Trace<'a> {
    /// Nothing to prepare.
    #[must_use]
    pub fn new(backend: &'a dyn Occlusion) -> Self {
        Self::behind(Undecided, backend)
    }
}

impl<'a, V: Verdict> Trace<'a, V> {
    /// Asks the verdict first.
    #[must_use]
    pub fn behind(verdict: V, backend: &'a dyn Occlusion) -> Self {
        Self { backend, verdict }
    }
}

impl<V: Verdict> Prepared for Trace<'_, V> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        Box::new(Worker {
            backend: self.backend,
            verdict: &self.verdict,
            rays: Vec::new(),
            places: Vec::new(),
            blocked: Vec::new(),
            tally: ShadowTally::default(),
        })
    }

    fn memory(&self) -> usize {
        self.verdict.memory()
    }
}

struct Worker<'a, V> {
    backend: &'a dyn Occlusion,
    verdict: &'a V,
    /// Of queries that the verdict did not settle: the rays, and the places of the answers.
    rays: Vec<Ray>,
    places: Vec<u32>,
    blocked: Vec<bool>,
    tally: ShadowTally,
}

impl<V: Verdict> Shadows for Worker<'_, V> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        let Self { backend, verdict, rays, places, blocked, tally } = self;
        rays.clear();
        places.clear();
        for (place, query) in queries.iter().enumerate() {
            match verdict.settle(light, query, &mut tally.backend) {
                Some(blocked) => {
                    let outcome =
                        if blocked { Outcome::VerdictBlocked } else { Outcome::VerdictLit };
                    answers[place] = Answer { blocked, outcome };
                    tally.count(blocked, outcome);
                }
                None => {
                    rays.push(query.ray);
                    places.push(place as u32);
                }
            }
        }
        blocked.clear();
        blocked.resize(rays.len(), false);
        backend.occluded_many(rays, blocked, &mut tally.backend);
        for (&blocked, &place) in blocked.iter().zip(&*places) {
            let outcome = if blocked { Outcome::TraversalBlocked } else { Outcome::TraversalLit };
            answers[place as usize] = Answer { blocked, outcome };
            tally.count(blocked, outcome);
        }
    }

    fn tally(&self) -> ShadowTally {
        self.tally
    }
}
