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

impl Worker<'_> {
    /// Asks the backend about all queries: before no verdict there is nothing to sort out.
    fn answer_all(&mut self, queries: &[ShadowQuery], answers: &mut [Answer]) {
        let Self { backend, rays, blocked, tally, .. } = self;
        rays.clear();
        rays.extend(queries.iter().map(|query| query.ray));
        blocked.clear();
        blocked.resize(rays.len(), false);
        backend.occluded_many(rays, blocked, &mut tally.backend);
        for (answer, &blocked) in answers.iter_mut().zip(&*blocked) {
            *answer = Answer::traversed(blocked);
            tally.blocked += u64::from(blocked);
        }
        tally.queries += queries.len() as u64;
    }
}

impl Shadows for Worker<'_> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        if self.verdicts.is_empty() {
            return self.answer_all(queries, answers);
        }
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

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::occlusion::{Backend, BuildOptions, Tally, Test, build};
    use crate::scene::builtin;
    use crate::shadow::{Path, Settled, Verdict, VerdictKind};

    /// Settles nothing.
    struct Silent;

    impl Verdict for Silent {
        fn settle_many(&self, _: usize, _: &[ShadowQuery], _: &mut [Option<bool>], _: &mut Tally) {}

        fn memory(&self) -> usize {
            0
        }
    }

    #[test]
    fn without_verdicts_answers_and_counts_are_those_behind_a_verdict_that_settles_nothing() {
        let scene = builtin::draft_at("chair-room", 0.05).unwrap().finish().unwrap();
        let options = BuildOptions::default();
        let grid = build(Backend::Grid, Test::Exact, &scene.triangles, &options).unwrap();
        let (bounds, light) = (scene.bounds(), &scene.lights[0]);
        let query = |number: u16| {
            let steps = Vec3::new(0.618_034, 0.754_877_7, 0.819_172_5);
            let share = (steps * f32::from(number)).fract();
            let ray = light.shadow_ray(bounds.min + share * bounds.extent());
            ShadowQuery { ray, path: Path::EYE, spawner: 0 }
        };
        let mut queries: Vec<ShadowQuery> = (0..1000).map(query).collect();
        queries[500].ray.origin.x = f32::NAN;
        let mut verdicts = Verdicts::default();
        verdicts.push(VerdictKind::Shaft, || Box::new(Silent));
        let [(alone, mut counts), (behind, mut counts_behind)] =
            [Trace::new(&*grid), Trace::behind(verdicts, &*grid)].map(|trace| {
                let mut answers = vec![Answer::default(); queries.len()];
                let mut worker = trace.worker();
                // One batch after the other, of different lengths, none, too.
                for range in [0..700, 700..700, 700..1000] {
                    worker.answer(0, &queries[range.clone()], &mut answers[range]);
                }
                (answers, worker.tally())
            });
        assert_eq!(alone, behind);
        assert!(counts.blocked > 20 && counts.blocked < 980, "{counts:?}");
        // Only that the verdict was asked differs.
        assert_eq!(counts_behind.verdicts[VerdictKind::Shaft.index()].passed_on, 1000);
        counts.verdicts = [Settled::default(); VerdictKind::COUNT];
        counts_behind.verdicts = counts.verdicts;
        assert_eq!(counts, counts_behind);
    }
}
