//! What contenders cost, and how often they are wrong, on the same recorded queries.
//!
//! In its turn a contender is built from nothing, answers all queries cold, answers them again warm, and is
//! dropped. So what it builds lazily counts, only one is in memory at a time, and none profits from what another
//! left behind. Of the warm passes of a turn the fastest counts: what disturbs a pass disturbs it upwards. All
//! have their turn within every repetition.

use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::Conditions;
use super::timing::{Timing, turns};
use crate::exact::Verdict;
use crate::measure::MeasureError;
use crate::measure::contender::Contender;
use crate::measure::recording::Recording;
use crate::measure::truth::Truths;
use crate::measure::wilson::PerMillion;
use crate::occlusion::{Backend, Test};
use crate::render::Progress;
use crate::scene::Scene;
use crate::shadow::Combination;

/// One contender as a point of the plane of speed and accuracy.
#[derive(Clone, Debug, Serialize)]
pub struct EnginePoint {
    /// Its name.
    pub name: String,
    /// The engine.
    pub backend: Backend,
    /// The triangle test.
    pub test: Test,
    /// What stands before the engine.
    pub method: Combination,
    /// Million queries a second, when everything is built.
    pub mrays_per_second: Timing,
    /// The same with everything that was built for them, the queries of one picture together.
    pub mrays_per_second_with_build: Timing,
    /// Building the engine and preparing the method.
    pub build_seconds: Timing,
    /// The first pass over the queries, in which lazy parts are built.
    pub cold_seconds: Timing,
    /// The fastest of the later passes.
    pub warm_seconds: Timing,
    /// Answers that are not the exact ones, ties apart.
    pub wrong_per_million: PerMillion,
    /// Answers "blocked" that are wrong.
    pub false_blocked: u64,
    /// Answers "not blocked" that are wrong.
    pub false_clear: u64,
    /// Answers "blocked" about rays that only touch a triangle at their end: no error.
    pub ties: u64,
    /// Bytes held by engine and method after the last pass, the triangles apart.
    pub memory_bytes: usize,
    /// Whether every pass gave the same answers.
    pub steady: bool,
    /// Queries that were answered otherwise than exactly, by their number.
    #[serde(skip)]
    pub differing: Vec<u32>,
}

impl EnginePoint {
    /// Wrong answers of both kinds.
    #[must_use]
    pub fn wrong(&self) -> u64 {
        self.false_blocked + self.false_clear
    }

    /// Whether it breaks what the exact test promises.
    #[must_use]
    pub fn breaks_its_promise(&self) -> bool {
        !self.steady || (self.test == Test::Exact && !self.differing.is_empty())
    }
}

/// How often queries are answered warm in a turn.
const WARM_PASSES: usize = 2;

/// What one contender took and said in one turn.
struct Turn {
    build: f64,
    cold: f64,
    warm: f64,
    bytes: usize,
}

/// All contenders, and the truth about what they were asked, by query.
pub(super) struct Measured {
    pub points: Vec<EnginePoint>,
    pub truth: Vec<Verdict>,
}

/// Gives every contender its turns, on the threads of the current pool.
///
/// # Errors
/// If a contender cannot be built.
pub(super) fn measure(
    scene: &Scene,
    recording: &Recording,
    conditions: &Conditions,
    progress: &Progress,
) -> Result<Measured, MeasureError> {
    let truths = Truths::new(scene.triangles.clone());
    let queries = recording.queries().par_iter();
    let truth: Vec<Verdict> =
        queries.map(|recorded| truths.certified(&recorded.query.ray).verdict).collect();
    drop(truths);
    let contenders = &conditions.contenders;
    let mut taken: Vec<Vec<Turn>> = contenders.iter().map(|_| Vec::new()).collect();
    let mut said: Vec<Option<Vec<u32>>> = vec![None; contenders.len()];
    let mut steady = vec![true; contenders.len()];
    for which in turns(contenders.len(), conditions.repetitions) {
        let (turn, answers) = take_turn(&contenders[which], scene, recording)?;
        taken[which].push(turn);
        for answers in answers {
            let differing = differing(&truth, &answers);
            let first = said[which].get_or_insert_with(|| differing.clone());
            steady[which] &= *first == differing;
        }
        let passes = 1 + WARM_PASSES as u64;
        progress.rays.fetch_add(passes * recording.queries().len() as u64, Relaxed);
        progress.pixels.fetch_add(1, Relaxed);
    }
    let said: Vec<Vec<u32>> = said.into_iter().map(Option::unwrap_or_default).collect();
    let measured = said.into_iter().zip(steady).zip(&taken).zip(contenders);
    let points = measured
        .map(|(((differing, steady), turns), contender)| {
            let tried = EnginePoint::timed(contender, recording.queries().len(), turns);
            EnginePoint { steady, ..tried.judged(differing, &truth) }
        })
        .collect();
    Ok(Measured { points, truth })
}

fn take_turn(
    contender: &Contender,
    scene: &Scene,
    recording: &Recording,
) -> Result<(Turn, Vec<Vec<bool>>), MeasureError> {
    let start = Instant::now();
    let engine = contender.build(&scene.triangles)?;
    let method = contender.prepare(scene, &*engine)?;
    let build = start.elapsed().as_secs_f64();
    let pass = || {
        let start = Instant::now();
        let answers = recording.answers(&*method);
        (start.elapsed().as_secs_f64(), answers)
    };
    let (cold, first) = pass();
    let warm: [_; WARM_PASSES] = std::array::from_fn(|_| pass());
    let least = warm.iter().map(|(seconds, _)| *seconds).fold(f64::INFINITY, f64::min);
    let bytes = engine.memory() + method.memory();
    let answers = std::iter::once(first).chain(warm.into_iter().map(|(_, answers)| answers));
    Ok((Turn { build, cold, warm: least, bytes }, answers.collect()))
}

/// The queries whose answers are not the truth, ties included.
fn differing(truth: &[Verdict], answers: &[bool]) -> Vec<u32> {
    let queries = truth.iter().zip(answers).enumerate();
    queries
        .filter(|(_, (verdict, blocked))| (**verdict == Verdict::Blocked) != **blocked)
        .map(|(number, _)| number as u32)
        .collect()
}

impl EnginePoint {
    fn timed(contender: &Contender, queries: usize, turns: &[Turn]) -> Self {
        let rays = queries as f64;
        let timing = |of: &dyn Fn(&Turn) -> f64| Timing::of(turns.iter().map(of));
        Self {
            name: contender.to_string(),
            backend: contender.backend,
            test: contender.test,
            method: contender.method,
            mrays_per_second: timing(&|turn| 1e-6 * rays / turn.warm),
            mrays_per_second_with_build: timing(&|turn| 1e-6 * rays / (turn.build + turn.cold)),
            build_seconds: timing(&|turn| turn.build),
            cold_seconds: timing(&|turn| turn.cold),
            warm_seconds: timing(&|turn| turn.warm),
            wrong_per_million: PerMillion::default(),
            false_blocked: 0,
            false_clear: 0,
            ties: 0,
            memory_bytes: turns.iter().map(|turn| turn.bytes).max().unwrap_or(0),
            steady: true,
            differing: Vec::new(),
        }
    }

    fn judged(self, differing: Vec<u32>, truth: &[Verdict]) -> Self {
        let mut judged = Self { differing, ..self };
        for number in &judged.differing {
            match truth[*number as usize] {
                Verdict::Blocked => judged.false_clear += 1,
                Verdict::Clear => judged.false_blocked += 1,
                Verdict::Tie => judged.ties += 1,
            }
        }
        let decided = truth.iter().filter(|verdict| **verdict != Verdict::Tie).count() as u64;
        judged.wrong_per_million = PerMillion::new(judged.wrong(), decided);
        judged
    }
}
