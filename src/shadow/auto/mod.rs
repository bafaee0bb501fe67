//! `auto`: asks for each batch of queries whichever method is cheapest at its light and place, from what was seen
//! while rendering.
//!
//! The candidates are tracing, shafts, a memory, and, if more memory is allowed than usual, light buffers alone and with shafts. A time stamp before and after
//! a batch of some hundred queries says what a query costs; `policy` decides from that whom to ask next, when to try another,
//! and when a structure is worth building, with a bound on what it may lose against the best single
//! candidate in hindsight. A structure that grows while it answers spoils the measure: when a batch made it grow,
//! the batch is answered once more, aside, and the second time counts.
//!
//! Exact because each candidate is: the answers do not depend on who gives them. What does depend on the clock is who
//! does, and so the counts of how queries were answered; they differ from run to run.

mod candidate;
mod estimate;
mod policy;
mod statistics;
mod worker;

use std::sync::atomic::{
    AtomicBool, AtomicUsize,
    Ordering::{Acquire, Relaxed, Release},
};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Instant;

use candidate::Candidate;
use policy::{Choice, Observation, Policy};
use statistics::Uses;
pub use statistics::{CandidateShare, LightChoices};
use worker::Worker;

use super::plan::prepare_from;
use super::stock::Stock;
use super::{
    Glass, MethodError, Plan, Prepared, SelfShadow, ShadowQuery, Shadows, VerdictReport, VerdictSet,
};
use crate::geometry::Bounds;
use crate::occlusion::{Occlusion, Test};
use crate::scene::Scene;

/// Places along each side of the scene's box.
const PLACES: u32 = 4;

/// Nanoseconds since some moment.
type Clock<'a> = Box<dyn Fn() -> u64 + Send + Sync + 'a>;

/// Several methods, of which the cheapest is asked.
pub struct Auto<'a> {
    backend: &'a dyn Occlusion,
    plan: Plan,
    stock: Stock<'a>,
    bounds: Bounds,
    candidates: Vec<Candidate<'a>>,
    policy: Mutex<Policy>,
    uses: Uses,
    /// Of each light, who was chosen last: for whoever finds the policy busy.
    latest: Vec<AtomicUsize>,
    /// Whether a candidate is being prepared; meanwhile the others go on.
    preparing: AtomicBool,
    clock: Clock<'a>,
}

impl<'a> Auto<'a> {
    /// Before a backend with this test, with the options of a plan; its own verdicts and memory do not matter.
    ///
    /// # Errors
    /// If the options make no sense.
    pub fn new(
        plan: impl Into<Plan>,
        test: Test,
        scene: &'a Scene,
        backend: &'a dyn Occlusion,
    ) -> Result<Self, MethodError> {
        let start = Instant::now();
        let clock = move || start.elapsed().as_nanos() as u64;
        Self::with_clock(plan, test, scene, backend, clock)
    }

    /// The same by another clock, which gives nanoseconds; whatever it gives, the answers are the same.
    ///
    /// # Errors
    /// If the options make no sense.
    pub fn with_clock(
        plan: impl Into<Plan>,
        test: Test,
        scene: &'a Scene,
        backend: &'a dyn Occlusion,
        clock: impl Fn() -> u64 + Send + Sync + 'a,
    ) -> Result<Self, MethodError> {
        let plan = Plan { verdicts: VerdictSet::NONE, ..plan.into() };
        plan.check()?;
        let lights = scene.lights.len();
        let candidates: Vec<Candidate<'a>> =
            candidate::candidates(test, plan.self_shadow, plan.budget.is_some())
                .into_iter()
                .map(|combination| Candidate { combination, prepared: OnceLock::new() })
                .collect();
        let triangles = scene.triangles.len();
        let prices =
            candidates.iter().map(|candidate| candidate.prices(triangles, backend)).collect();
        let auto = Self {
            backend,
            plan,
            stock: plan.stock(scene, backend),
            bounds: scene.bounds(),
            policy: Mutex::new(Policy::new(prices, lights)),
            uses: Uses::new(lights, candidates.len()),
            candidates,
            latest: (0..lights).map(|_| AtomicUsize::new(0)).collect(),
            preparing: AtomicBool::new(false),
            clock: Box::new(clock),
        };
        auto.prepared(0);
        Ok(auto)
    }

    /// The same, told that about so many queries are to come ([`crate::render::forecast`] says): what they are worth is
    /// prepared at once.
    #[must_use]
    pub fn expecting(self, queries: u64) -> Self {
        self.policy.lock().unwrap_or_else(PoisonError::into_inner).expect(queries as f64);
        self
    }

    /// Whom it may ask.
    pub(super) fn candidates(&self) -> impl Iterator<Item = String> {
        self.candidates.iter().map(|candidate| candidate.combination.to_string())
    }

    /// Whether something that is not prepared yet may be worth it soon.
    fn waits(&self) -> bool {
        self.candidates.iter().any(|candidate| candidate.prepared.get().is_none())
    }

    /// A candidate, made ready if it is not yet.
    fn prepared(&self, candidate: usize) -> &dyn Prepared {
        let Candidate { combination, prepared } = &self.candidates[candidate];
        &**prepared.get_or_init(|| {
            let plan =
                Plan { verdicts: combination.verdicts, method: combination.method, ..self.plan };
            prepare_from(&plan, &self.stock.for_verdicts(plan.verdicts), self.backend)
        })
    }

    /// Whom to ask queries at a place.
    fn choose(&self, light: usize, place: u32, queries: usize) -> Choice {
        if self.worth_preparing().is_some() {
            self.prepare_what_is_worth_it();
        }
        let Ok(policy) = self.policy.try_lock() else {
            return Choice::again(self.latest[light].load(Relaxed));
        };
        let choice = policy.choose(light, place, queries as f64);
        self.latest[light].store(choice.candidate, Relaxed);
        choice
    }

    fn worth_preparing(&self) -> Option<usize> {
        self.policy.try_lock().ok()?.worth_preparing()
    }

    /// Nobody waits: preparing may use all threads, and one that waited could be needed for it.
    fn prepare_what_is_worth_it(&self) {
        if self.preparing.swap(true, Acquire) {
            return;
        }
        let _turn = Turn(&self.preparing);
        // Only now: whoever had the turn before may have prepared what was worth it until then, and what it took must stand.
        let Some(candidate) = self.worth_preparing() else { return };
        let start = (self.clock)();
        self.prepared(candidate);
        let nanoseconds = (self.clock)().saturating_sub(start);
        let share = |other: &usize| {
            self.candidates[*other].needs_clusters() && self.candidates[candidate].needs_clusters()
        };
        let others: Vec<usize> = (0..self.candidates.len()).filter(share).collect();
        let mut policy = self.policy.lock().unwrap_or_else(PoisonError::into_inner);
        policy.prepare(candidate, nanoseconds as f64, &others);
    }

    /// Takes note of what a batch cost, unless the policy is busy.
    fn observe(&self, seen: &Observation) {
        if let Ok(mut policy) = self.policy.try_lock() {
            policy.observe(seen);
        }
    }

    /// The part of the scene that a query comes from, and whether the eye sees it or a mirror does.
    fn place(&self, query: &ShadowQuery) -> u32 {
        let Bounds { min, max } = self.bounds;
        let share = (query.ray.origin - min) / (max - min);
        let along = |share: f32| ((share * PLACES as f32) as u32).min(PLACES - 1);
        let [x, y, z] = share.to_array().map(along);
        ((z * PLACES + y) * PLACES + x) << 1 | u32::from(query.path.level() > 0)
    }
}

/// The turn to prepare, which ends in a panic too.
struct Turn<'a>(&'a AtomicBool);

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.0.store(false, Release);
    }
}

impl Prepared for Auto<'_> {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        Box::new(Worker::new(self))
    }

    fn memory(&self) -> usize {
        self.verdicts().iter().map(|report| report.bytes).sum()
    }

    /// Of a structure that several candidates have, the largest report: only the first counts what they share.
    fn verdicts(&self) -> Vec<VerdictReport> {
        let prepared = self.candidates.iter().filter_map(|candidate| candidate.prepared.get());
        let mut reports: Vec<VerdictReport> = Vec::new();
        for report in prepared.flat_map(|prepared| prepared.verdicts()) {
            match reports.iter_mut().find(|known| known.verdict == report.verdict) {
                Some(known) => {
                    known.build_seconds = known.build_seconds.max(report.build_seconds);
                    known.bytes = known.bytes.max(report.bytes);
                    known.notes = report.notes;
                }
                None => reports.push(report),
            }
        }
        reports
    }

    fn glass(&self) -> Option<&dyn Glass> {
        let prepared = self.candidates.iter().filter_map(|candidate| candidate.prepared.get());
        prepared.filter_map(|prepared| prepared.glass()).next()
    }

    fn choices(&self) -> Vec<LightChoices> {
        let policy = self.policy.lock().unwrap_or_else(PoisonError::into_inner);
        self.uses.report(&self.candidates, &policy)
    }

    fn leaves_out_spawner(&self) -> bool {
        self.plan.self_shadow == SelfShadow::Exclude
    }
}

#[cfg(test)]
mod tests;
