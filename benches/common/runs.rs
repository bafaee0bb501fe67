//! The shadow queries of a picture as the renderer asks them: light by light, and whoever answers them.

use umbra::geometry::Ray;
use umbra::occlusion::{Occlusion, Tally};
use umbra::render::RecordedQuery;
use umbra::shadow::{Answer, ShadowQuery, Shadows};

/// Queries about one light that the renderer asks at once.
pub struct Run {
    pub light: usize,
    pub queries: Vec<ShadowQuery>,
    /// Their rays, for engines that ask for no more.
    pub rays: Vec<Ray>,
}

impl Run {
    /// What was recorded of a unit, cut where light or generation change.
    pub fn all(recorded: &[RecordedQuery]) -> Vec<Self> {
        let runs = recorded.chunk_by(RecordedQuery::is_asked_with).map(|run| {
            let queries: Vec<ShadowQuery> = run.iter().map(|recorded| recorded.query).collect();
            let rays = queries.iter().map(|query| query.ray).collect();
            Self { light: run[0].light as usize, queries, rays }
        });
        runs.collect()
    }
}

/// How many queries an engine calls blocked.
pub fn blocked_by_engine(engine: &dyn Occlusion, runs: &[Run]) -> usize {
    let (mut answers, mut blocked) = (Vec::new(), 0);
    for run in runs {
        answers.clear();
        answers.resize(run.rays.len(), false);
        engine.occluded_many(&run.rays, &mut answers, &mut Tally::default());
        blocked += answers.iter().filter(|blocked| **blocked).count();
    }
    blocked
}

/// How many queries a worker of a shadow method calls blocked.
pub fn blocked_by_worker(worker: &mut dyn Shadows, runs: &[Run]) -> usize {
    let (mut answers, mut blocked) = (Vec::new(), 0);
    for run in runs {
        answers.clear();
        answers.resize(run.queries.len(), Answer::default());
        worker.answer(run.light, &run.queries, &mut answers);
        blocked += answers.iter().filter(|answer| answer.blocked).count();
    }
    blocked
}
