//! The same shadow queries through several contenders, and the truth about each.
//!
//! **Truth** is the exact verdict on the query's bits: blocked, clear, or a *tie*, where a triangle is touched at an
//! end of the interval only. A tie blocks nothing; but Embree promises nothing about ends, so what f32 tests say of
//! ties is counted apart and is no error.
//!
//! **A wrong answer is explained** if it is what the contender claims to compute ([`Claim`]), so that the error is
//! in the arithmetic that was chosen, and not in the engine:
//!
//! | contender | a wrong answer is explained if |
//! | --- | --- |
//! | an engine of ours, `exact` | never |
//! | an engine of ours, another test | that test says the same when asked of every triangle, with no engine |
//! | `rtcOccluded1` | it lies between L and U, which are computed bit for bit; this is asked of right answers too |
//! | the same, default mode, high quality | above, L is proven by rounding alone: spatial splits clip the boxes |
//! | the same, with verdicts before it | as above; a right answer needs no bound, for verdicts give the truth |
//! | `rtcOccluded4`, `8`, `16` | a forward error bound allows it: "clear" if no triangle and its box are met by more than rounding, "blocked" if some triangle is not missed by more than rounding |
//!
//! The bound of packets is as wide as f32 is rough: it decides all but a few ordinary rays in a thousand, but of
//! slivers 10⁷ times as long as wide, of denormals and of what overflows it allows any answer.
//!
//! **The truth itself is checked.** It comes from f64 with a bound and expansions, over the candidates of one culler.
//! The oracle's big integers give the verdict on every query that any contender got wrong, and on a
//! sample of the others; brute force checks the culler on as many queries as its time allows.
//!
//! A comparison fails if an `exact` answer was wrong, a wrong answer is not explained, or the truth was contradicted.

mod bounds;
mod listing;
mod picture;
mod report;
mod rounding;
mod table;

use std::collections::BTreeMap;
use std::fmt;
use std::mem::replace;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

pub use bounds::Claim;
use bounds::{Judge, brute};
pub use report::{Checks, Disagreement, Kind, Report, Row};

use super::contender::Contender;
use super::recording::{NoQueries, Recording};
use super::truth::{Truth, Truths};
use crate::exact::Verdict;
use crate::geometry::Ray;
use crate::geometry::lanes::Arithmetic;
use crate::occlusion::{BackendError, Tally, Test};
use crate::scene::Scene;
use crate::shadow::MethodError;

/// Queries that go to the oracle besides those that are disputed; each takes it some 100 µs.
const ORACLE_SAMPLE: usize = 1000;

/// Triangles that brute force may test to check the culler: about a second.
const BRUTE_TESTS: usize = 1 << 30;

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// One is always right.
    #[error(
        "a comparison needs at least two contenders, and these are {0}; name more backends, tests, methods or Embree variants"
    )]
    Few(usize),
    /// Nothing to answer.
    #[error(transparent)]
    NoQueries(#[from] NoQueries),
    /// The queries are not this scene's.
    #[error(
        "{scene}: a query asks about light {light}, and there are {lights}, counted from 0; give a recording of this scene"
    )]
    NoLight {
        /// The scene.
        scene: String,
        /// The light that is asked about.
        light: usize,
        /// How many there are.
        lights: usize,
    },
    /// An engine cannot be used.
    #[error("{contender}: {error}")]
    Backend {
        /// Whose.
        contender: String,
        /// Why.
        #[source]
        error: BackendError,
    },
    /// A method cannot be used.
    #[error("{contender}: {error}")]
    Method {
        /// Whose.
        contender: String,
        /// Why.
        #[source]
        error: MethodError,
    },
}

/// Has all contenders answer the queries of a recording; `answered` counts queries, for whoever shows progress.
///
/// ```
/// use std::sync::atomic::AtomicU64;
/// use umbra::measure::{compare::compare, contender::Choice, recording::Recording};
/// use umbra::occlusion::{Backend, Test};
/// use umbra::render::{Progress, Settings};
/// use umbra::scene::builtin;
///
/// let scene = builtin::draft_at("drum", 0.01)?.finish()?;
/// let settings = Settings { width: 8, height: 6, ..Settings::default() };
/// let recording = Recording::of(&scene, &settings, &Progress::default())?;
/// let choice = Choice {
///     backends: vec![Backend::Grid, Backend::Bvh2],
///     tests: vec![Test::Exact],
///     ..Choice::default()
/// };
/// let contenders = choice.select().contenders;
/// let report = compare(&scene, &recording, &contenders, &AtomicU64::new(0))?;
/// assert!(report.disagreements.is_empty() && report.failure().is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Engines are built one after the other and dropped, so memory holds the scene, one engine, one culler, and the
/// queries with their verdicts.
///
/// # Errors
/// If there is nothing to compare, a query asks about a light that the scene does not have, or a contender cannot be built.
pub fn compare(
    scene: &Scene,
    recording: &Recording,
    contenders: &[Contender],
    answered: &AtomicU64,
) -> Result<Report, CompareError> {
    if contenders.len() < 2 {
        return Err(CompareError::Few(contenders.len()));
    }
    recording.check_asked(&scene.name)?;
    let lights = scene.lights.len();
    if let Some((light, _)) = recording.runs().find(|(light, _)| *light >= lights) {
        return Err(CompareError::NoLight { scene: scene.name.clone(), light, lights });
    }
    let mut comparison = Comparison::new(scene, recording);
    let mut last = None;
    for contender in contenders {
        let engine = contender
            .build_after(last.take(), &scene.triangles)
            .map_err(|error| CompareError::Backend { contender: contender.to_string(), error })?;
        let method = contender
            .prepare(scene, &*engine)
            .map_err(|error| CompareError::Method { contender: contender.to_string(), error })?;
        let answers = recording.answers(&*method);
        drop(method);
        comparison.enter(&contender.to_string(), Claim::of(contender), &answers);
        answered.fetch_add(answers.len() as u64, Relaxed);
        last = Some((contender, engine));
    }
    Ok(comparison.finish())
}

/// A comparison under way: the truth, and what each contender that entered made of it.
pub struct Comparison<'a> {
    scene: &'a Scene,
    recording: &'a Recording,
    truths: Truths,
    /// By query.
    truth: Vec<Truth>,
    rows: Vec<Row>,
    disagreements: Vec<Disagreement>,
}

impl fmt::Debug for Comparison<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Comparison")
            .field("scene", &self.scene.name)
            .field("queries", &self.truth.len())
            .field("contenders", &self.rows.len())
            .field("disagreements", &self.disagreements.len())
            .finish_non_exhaustive()
    }
}

impl<'a> Comparison<'a> {
    /// Finds the truth about every query, on all threads of the current pool.
    #[must_use]
    pub fn new(scene: &'a Scene, recording: &'a Recording) -> Self {
        let truths = Truths::new(scene.triangles.clone());
        let queries = recording.queries().par_iter();
        let truth = queries.map(|recorded| truths.certified(&recorded.query.ray)).collect();
        Self { scene, recording, truths, truth, rows: Vec::new(), disagreements: Vec::new() }
    }

    /// Enters the answers of a contender: for each query, whether it is blocked.
    ///
    /// # Panics
    /// If there is not one answer a query.
    pub fn enter(&mut self, name: &str, claim: Claim, answers: &[bool]) {
        assert_eq!(answers.len(), self.truth.len(), "one answer a query");
        let judge = Judge::new(claim, &self.truths);
        let contender = self.rows.len();
        let found: Vec<Disagreement> = answers
            .par_iter()
            .enumerate()
            .filter_map(|(query, &blocked)| self.examine(&judge, contender, query, blocked))
            .collect();
        let ties = self.truth.iter().zip(answers);
        let ties_blocked =
            ties.filter(|(truth, blocked)| truth.verdict == Verdict::Tie && **blocked).count();
        self.rows.push(Row::new(name, claim, &self.totals(), ties_blocked as u64, &found));
        self.disagreements.extend(found);
    }

    /// Looks at one answer; finds nothing if it is right, or about a tie, and not beyond its bounds.
    fn examine(
        &self,
        judge: &Judge,
        contender: usize,
        query: usize,
        blocked: bool,
    ) -> Option<Disagreement> {
        let truth = self.truth[query];
        let is_right = blocked == truth.is_blocked();
        if is_right && !judge.judges_right_ones() {
            return None;
        }
        let ray = self.ray(query);
        let is_tie = truth.verdict == Verdict::Tie;
        if is_tie && !judge.judges_ties() {
            return None;
        }
        let is_free = is_tie && !judge.is_exact();
        let ruling = judge.rule(ray, blocked);
        let kind = match (is_right || is_free, blocked) {
            (true, _) if ruling.within => return None,
            (true, _) => Kind::OutOfBounds,
            (false, true) => Kind::FalseBlocked,
            (false, false) => Kind::FalseClear,
        };
        let recorded = &self.recording.queries()[query];
        Some(Disagreement {
            contender,
            query,
            pixel: recorded.pixel,
            light: recorded.light,
            ray: *ray,
            kind,
            blocked,
            exact: truth.verdict,
            triangle: truth.triangle.or(ruling.witness),
            explained: ruling.within,
        })
    }

    fn ray(&self, query: usize) -> &'a Ray {
        &self.recording.queries()[query].query.ray
    }

    /// Queries by verdict: blocked, clear, ties.
    fn totals(&self) -> [u64; 3] {
        let count = |verdict| self.truth.iter().filter(|t| t.verdict == verdict).count() as u64;
        [Verdict::Blocked, Verdict::Clear, Verdict::Tie].map(count)
    }

    /// Checks the truth, and gives the report.
    #[must_use]
    pub fn finish(mut self) -> Report {
        let mut disputed: Vec<usize> = self.disagreements.iter().map(|found| found.query).collect();
        disputed.sort_unstable();
        disputed.dedup();
        let (verdicts, checks) = self.check(&disputed);
        for found in &mut self.disagreements {
            found.exact = verdicts[&found.query].verdict;
        }
        let [blocked, clear, ties] = self.totals();
        Report {
            scene: self.scene.name.clone(),
            triangles: self.scene.triangles.len(),
            lights: self.scene.lights.len(),
            width: self.recording.width,
            height: self.recording.height,
            queries: self.truth.len() as u64,
            blocked,
            clear,
            ties,
            contenders: self.rows,
            checks,
            disagreements: self.disagreements,
        }
    }

    /// Puts the disputed queries, and a sample, to the oracle and to brute force.
    fn check(&self, disputed: &[usize]) -> (BTreeMap<usize, Truth>, Checks) {
        let all = self.truth.len();
        let sample = spread(ORACLE_SAMPLE.min(all), all);
        let asked: Vec<usize> = disputed.iter().copied().chain(sample).collect();
        let verdicts: BTreeMap<usize, Truth> = asked
            .into_par_iter()
            .map(|query| (query, self.truths.oracle(self.ray(query))))
            .collect();
        let oracle_contradicts =
            verdicts.iter().filter(|(query, oracle)| oracle.verdict != self.truth[**query].verdict);
        let by_oracle = verdicts.len() as u64;
        let mut contradicted = oracle_contradicts.count() as u64;

        let triangles = &self.scene.triangles;
        // At least one where there are any; there may be neither queries nor triangles.
        let affordable = (BRUTE_TESTS / triangles.len().max(1)).max(1).min(all);
        let engine = brute(Test::Exact, Arithmetic::of_this_cpu(), triangles);
        let asked = chosen(disputed, affordable, all);
        contradicted += asked
            .par_iter()
            .filter(|query| {
                let blocked = engine.occluded(self.ray(**query), &mut Tally::default());
                blocked != self.truth[**query].is_blocked()
            })
            .count() as u64;
        (verdicts, Checks { by_oracle, by_brute_force: asked.len() as u64, contradicted })
    }
}

/// So many of all queries, each once: the disputed ones first, then others, evenly.
fn chosen(disputed: &[usize], few: usize, all: usize) -> Vec<usize> {
    let evenly = spread(few.saturating_sub(disputed.len()), all);
    // Where the even ones meet disputed ones, others take their place.
    let in_turn = disputed.iter().copied().chain(evenly).chain(0..all);
    let mut is_chosen = vec![false; all];
    in_turn.filter(|&query| !replace(&mut is_chosen[query], true)).take(few).collect()
}

/// So many of all places, evenly.
fn spread(few: usize, all: usize) -> impl Iterator<Item = usize> {
    (0..few).map(move |place| place * all / few)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brute_force_checks_each_query_once_and_all_of_them_where_its_time_allows() {
        let disputed = [0, 3, 4, 8, 9];
        for few in 0..=10 {
            let mut asked = chosen(&disputed, few, 10);
            let known = few.min(disputed.len());
            assert_eq!(asked[..known], disputed[..known], "the disputed ones first");
            asked.sort_unstable();
            asked.dedup();
            assert_eq!(asked.len(), few, "{asked:?}");
        }
        assert!(chosen(&[], 0, 0).is_empty());
    }

    #[test]
    fn what_brute_force_checks_besides_disputed_queries_is_spread_over_all() {
        let disputed: Vec<usize> = (0..50).collect();
        let asked = chosen(&disputed, 100, 1000);
        for tenth in 0..10 {
            let range = 100 * tenth..100 * (tenth + 1);
            assert!(asked.iter().any(|query| range.contains(query)), "none of {range:?}");
        }
    }
}
