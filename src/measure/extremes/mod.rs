//! Where answers go wrong: queries at the extremes of scale, place, shape and aim, put to every engine.
//!
//! A *case* is a mesh and rays that stress one thing ([`cases`]). The exact verdict on each ray is found apart from
//! all engines, by going through the triangles one by one ([`truth`]), and each engine's answers are held
//! against it: *false blocked* where it is clear, *false clear* where it is blocked. Ties are counted apart.
//! Our own engines must also answer as brute force does with the same test, ray for ray.

pub mod cases;
mod mesh;
mod shot;
mod table;
mod truth;

use std::sync::Arc;

use rayon::prelude::*;
use serde::Serialize;

use crate::exact::Verdict;
use crate::exact::random::Random;
use crate::geometry::{Ray, Triangles};
use crate::occlusion::{Backend, BackendError, BuildOptions, Occlusion, Tally, Test, build};
use cases::{Case, Situation};

pub use table::head;
pub use truth::truth;

/// Rays that one job answers.
const RAYS_A_JOB: usize = 256;

/// Who is asked, and how much.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Rays of each case; cases with very many triangles shoot fewer.
    pub queries: usize,
    /// The engines.
    pub backends: Vec<Backend>,
    /// Their tests, where they have them.
    pub tests: Vec<Test>,
}

impl Conditions {
    /// Whether there is nobody to ask: no engine has any of the tests.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let asked = |&test: &Test| self.backends.iter().any(|backend| backend.has(test));
        !self.tests.iter().any(asked)
    }
}

/// What one engine answered in one case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Answers {
    /// The engine.
    pub backend: &'static str,
    /// Its test.
    pub test: &'static str,
    /// Rays it called blocked that are clear.
    pub false_blocked: u64,
    /// Rays it called clear that are blocked.
    pub false_clear: u64,
    /// Ties that it called blocked.
    pub blocked_ties: u64,
    /// For our own engines: answers that are not those of brute force with the same test.
    pub unlike_brute: Option<u64>,
}

impl Answers {
    /// Whether this is a defect of ours: a wrong answer of the exact test, or a difference from brute force.
    #[must_use]
    pub fn is_defect(&self) -> bool {
        let wrong = self.false_blocked + self.false_clear + self.blocked_ties;
        self.unlike_brute.is_some_and(|count| count > 0)
            || (self.test == Test::Exact.name() && wrong > 0)
    }
}

/// What came of one case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Name of the case.
    pub case: String,
    /// What it stresses.
    pub what: String,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Rays asked.
    pub rays: u64,
    /// Rays that are blocked.
    pub blocked: u64,
    /// Rays that touch something at an end of theirs and are not blocked.
    pub ties: u64,
    /// Rays whose verdict was found by the oracle as well.
    pub by_oracle: u64,
    /// Those of them on which it disagrees: a defect.
    pub oracle_disagrees: u64,
    /// An entry an engine and test.
    pub answers: Vec<Answers>,
}

impl Report {
    /// Whether anything of ours is wrong.
    #[must_use]
    pub fn is_defect(&self) -> bool {
        self.oracle_disagrees > 0 || self.answers.iter().any(Answers::is_defect)
    }
}

/// Puts the rays of a case to every engine, on all threads of the current pool.
///
/// # Errors
/// If Embree is asked for and cannot be used.
pub fn examine(case: &Case, conditions: &Conditions) -> Result<Report, BackendError> {
    let Situation { triangles, rays } =
        (case.make)(&mut Random::new(case.seed(), 0), conditions.queries);
    let mesh = Arc::new(triangles.into_iter().collect::<Triangles>());
    let verdicts: Vec<_> = rays.par_iter().map(|ray| truth(ray, &mesh)).collect();
    let (by_oracle, oracle_disagrees) = truth::sample(&rays, &verdicts, &mesh);
    let mut report = Report {
        case: case.name.clone(),
        what: case.what.clone(),
        triangles: mesh.len(),
        rays: rays.len() as u64,
        blocked: count(&verdicts, |verdict| *verdict == Verdict::Blocked),
        ties: count(&verdicts, |verdict| *verdict == Verdict::Tie),
        by_oracle,
        oracle_disagrees,
        answers: Vec::new(),
    };
    for &test in &conditions.tests {
        let brute = answers(Backend::Brute, test, &mesh, &rays)?;
        for &backend in &conditions.backends {
            if !backend.has(test) {
                continue;
            }
            let is_peer = backend == Backend::Embree;
            let answers = answers(backend, test, &mesh, &rays)?;
            let both = || answers.iter().zip(&verdicts);
            let wrong = |said: bool, truth: Verdict| {
                both().filter(|&(&answer, &verdict)| answer == said && verdict == truth).count()
                    as u64
            };
            let unlike =
                answers.iter().zip(&brute).filter(|(answer, brute)| answer != brute).count();
            report.answers.push(Answers {
                backend: backend.name(),
                test: test.name(),
                false_blocked: wrong(true, Verdict::Clear),
                false_clear: wrong(false, Verdict::Blocked),
                blocked_ties: wrong(true, Verdict::Tie),
                unlike_brute: (!is_peer).then_some(unlike as u64),
            });
        }
    }
    Ok(report)
}

fn answers(
    backend: Backend,
    test: Test,
    mesh: &Arc<Triangles>,
    rays: &[Ray],
) -> Result<Vec<bool>, BackendError> {
    let engine: Box<dyn Occlusion> = build(backend, test, mesh, &BuildOptions::default())?;
    let mut answers = vec![false; rays.len()];
    rays.par_chunks(RAYS_A_JOB)
        .zip(answers.par_chunks_mut(RAYS_A_JOB))
        .for_each(|(rays, answers)| engine.occluded_many(rays, answers, &mut Tally::default()));
    Ok(answers)
}

fn count<T>(values: &[T], wanted: impl Fn(&T) -> bool) -> u64 {
    values.iter().filter(|value| wanted(value)).count() as u64
}
