//! Answers the queries of one worker, and takes the time.

use super::Auto;
use super::policy::{Choice, Observation, Reason};
use crate::shadow::{Answer, ShadowQuery, ShadowTally, Shadows};

/// Queries for which a choice stands: the time stamps and the choosing cost some hundred nanoseconds.
const LEASE: usize = 256;

/// Most queries of a call that go to one that is tried.
const TRIED: usize = 512;

/// A call with fewer queries than this may go untimed.
const SHORT: usize = 64;

/// Of short calls, one in so many is timed.
const SAMPLED: usize = 16;

/// A choice, and what came of it so far.
struct Lease {
    choice: Choice,
    place: u32,
    calls: usize,
    asked: usize,
    /// Of those, the timed ones.
    timed: usize,
    nanoseconds: u64,
    building: u64,
}

/// All candidates that this worker has asked, with memories of its own.
pub(super) struct Worker<'w, 'a> {
    auto: &'w Auto<'a>,
    shadows: Vec<Option<Box<dyn Shadows + 'w>>>,
    /// By light.
    leases: Vec<Option<Lease>>,
}

impl<'w, 'a> Worker<'w, 'a> {
    pub fn new(auto: &'w Auto<'a>) -> Self {
        Self {
            auto,
            shadows: auto.candidates.iter().map(|_| None).collect(),
            leases: auto.latest.iter().map(|_| None).collect(),
        }
    }

    /// Tells what a lease cost.
    fn end(auto: &Auto<'_>, light: usize, lease: &Lease) {
        let &Lease { choice, place, asked, timed, nanoseconds, building, .. } = lease;
        auto.uses.count(light, choice, asked);
        if timed > 0 {
            let scale = asked as f64 / timed as f64;
            auto.observe(&Observation {
                light,
                place,
                choice,
                queries: asked as f64,
                nanoseconds: nanoseconds as f64 * scale,
                building: building as f64 * scale,
            });
        }
    }
}

impl Worker<'_, '_> {
    /// Answers with one candidate: all queries if it leads, some of them if it is tried or others wait to be
    /// prepared. Says how many.
    fn answer_some(
        &mut self,
        light: usize,
        queries: &[ShadowQuery],
        answers: &mut [Answer],
    ) -> usize {
        let auto = self.auto;
        let lease = self.leases[light].get_or_insert_with(|| {
            let place = auto.place(&queries[queries.len().min(TRIED) / 2]);
            Lease {
                choice: auto.choose(light, place, queries.len().clamp(LEASE, TRIED)),
                place,
                calls: 0,
                asked: 0,
                timed: 0,
                nanoseconds: 0,
                building: 0,
            }
        });
        let candidate = lease.choice.candidate;
        let tried = lease.choice.reason == Reason::Trial || (candidate == 0 && auto.waits());
        let count = if tried { queries.len().min(TRIED) } else { queries.len() };
        let (queries, answers) = (&queries[..count], &mut answers[..count]);
        let prepared = auto.prepared(candidate);
        let shadows = self.shadows[candidate].get_or_insert_with(|| prepared.worker());
        if count >= SHORT || lease.calls.is_multiple_of(SAMPLED) {
            let (nanoseconds, building) = timed(
                auto,
                candidate,
                || {
                    shadows.answer(light, queries, answers);
                },
                || {
                    let mut aside = vec![Answer::default(); queries.len()];
                    prepared.worker().answer(light, queries, &mut aside);
                },
            );
            lease.timed += count;
            // A clock may leap.
            lease.nanoseconds = lease.nanoseconds.saturating_add(nanoseconds);
            lease.building = lease.building.saturating_add(building);
        } else {
            shadows.answer(light, queries, answers);
        }
        lease.calls += 1;
        lease.asked += count;
        if lease.asked >= LEASE {
            Self::end(auto, light, lease);
            self.leases[light] = None;
        }
        count
    }
}

impl Shadows for Worker<'_, '_> {
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]) {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        let mut first = 0;
        while first < queries.len() {
            first += self.answer_some(light, &queries[first..], &mut answers[first..]);
        }
    }

    fn begin_scanline(&mut self) {
        self.shadows.iter_mut().flatten().for_each(|shadows| shadows.begin_scanline());
    }

    fn tally(&self) -> ShadowTally {
        let mut sum = ShadowTally::default();
        for shadows in self.shadows.iter().flatten() {
            sum += shadows.tally();
        }
        sum
    }
}

impl Drop for Worker<'_, '_> {
    fn drop(&mut self) {
        for (light, lease) in self.leases.iter().enumerate() {
            if let Some(lease) = lease {
                Self::end(self.auto, light, lease);
            }
        }
    }
}

/// Nanoseconds of answering, and of building. If answering made the candidate's structures grow, the second answering
/// is the one that counts, and the first was building.
fn timed(
    auto: &Auto<'_>,
    candidate: usize,
    answer: impl FnOnce(),
    answer_again: impl FnOnce(),
) -> (u64, u64) {
    let prepared = auto.prepared(candidate);
    let grows = auto.candidates[candidate].builds_for_lights();
    let bytes = if grows { prepared.memory() } else { 0 };
    let start = (auto.clock)();
    answer();
    let first = (auto.clock)().saturating_sub(start);
    if !grows || prepared.memory() == bytes {
        return (first, 0);
    }
    let start = (auto.clock)();
    answer_again();
    ((auto.clock)().saturating_sub(start), first)
}
