//! Who answered the queries to each light, and why.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use serde::Serialize;

use super::candidate::Candidate;
use super::policy::{Choice, Hindrance, Policy, Reason};

/// Who answered the queries to one light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightChoices {
    /// Its number.
    pub light: usize,
    /// Queries asked.
    pub queries: u64,
    /// All candidates, those that answered most first.
    pub candidates: Vec<CandidateShare>,
}

/// What one candidate had of the queries to a light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CandidateShare {
    /// Its name.
    pub method: String,
    /// Queries that it answered, trials included.
    pub queries: u64,
    /// Those of them that it answered to see what it costs.
    pub trials: u64,
    /// Nanoseconds that a query is expected to cost it at this light; none if that was never seen.
    pub nanoseconds_a_query: Option<f64>,
    /// Why it was asked, or not, in words.
    pub reason: String,
}

impl fmt::Display for LightChoices {
    /// One line, with those who answered.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "light {}:", self.light)?;
        let asked = self.candidates.iter().filter(|candidate| candidate.queries > 0);
        for (place, CandidateShare { method, queries, reason, .. }) in asked.enumerate() {
            let share = 100.0 * *queries as f64 / self.queries as f64;
            let comma = if place > 0 { "," } else { "" };
            write!(f, "{comma} {method} {share:.1} % ({reason})")?;
        }
        Ok(())
    }
}

/// Queries by light and candidate: all of them, and those in trials.
pub(super) struct Uses {
    candidates: usize,
    counts: Vec<[AtomicU64; 2]>,
}

impl Uses {
    pub fn new(lights: usize, candidates: usize) -> Self {
        let counts = (0..lights * candidates).map(|_| Default::default()).collect();
        Self { candidates, counts }
    }

    pub fn count(&self, light: usize, choice: Choice, queries: usize) {
        let [all, trials] = &self.counts[light * self.candidates + choice.candidate];
        all.fetch_add(queries as u64, Relaxed);
        if choice.reason == Reason::Trial {
            trials.fetch_add(queries as u64, Relaxed);
        }
    }

    /// Lights that were asked.
    pub fn report(&self, candidates: &[Candidate<'_>], policy: &Policy) -> Vec<LightChoices> {
        let lights = self.counts.chunks(self.candidates).enumerate();
        lights
            .map(|(light, counts)| {
                let cheapest = cheapest(policy, light, counts);
                let mut shares: Vec<CandidateShare> = (0..candidates.len())
                    .map(|candidate| {
                        let [queries, trials] =
                            [0, 1].map(|which| counts[candidate][which].load(Relaxed));
                        let cost = policy.at_light(candidate, light);
                        CandidateShare {
                            method: candidates[candidate].combination.to_string(),
                            queries,
                            trials,
                            nanoseconds_a_query: cost,
                            reason: Why {
                                steps_aside: candidates[candidate].steps_aside(),
                                led: queries - trials.min(queries),
                                trials,
                                cost,
                                cheapest: cheapest == Some(candidate),
                                hindrance: policy.hindrance(candidate, light),
                            }
                            .to_string(),
                        }
                    })
                    .collect();
                shares.sort_by_key(|share| std::cmp::Reverse(share.queries));
                let queries = shares.iter().map(|share| share.queries).sum();
                LightChoices { light, queries, candidates: shares }
            })
            .filter(|light| light.queries > 0)
            .collect()
    }
}

/// Whoever is cheapest at a light, of those it asked.
fn cheapest(policy: &Policy, light: usize, counts: &[[AtomicU64; 2]]) -> Option<usize> {
    let asked = (0..counts.len()).filter(|&candidate| counts[candidate][0].load(Relaxed) > 0);
    let costs = asked.filter_map(|candidate| Some((policy.at_light(candidate, light)?, candidate)));
    costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, candidate)| candidate)
}

/// Why a candidate was asked, or not.
struct Why {
    /// Whether it has no memory for what it would prepare, so that the engine answers in its place.
    steps_aside: bool,
    /// Queries that it answered because it led, and in trials.
    led: u64,
    trials: u64,
    cost: Option<f64>,
    cheapest: bool,
    hindrance: Option<Hindrance>,
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { led, trials, cheapest, hindrance, .. } = *self;
        let milliseconds = |nanoseconds: f64| nanoseconds / 1e6;
        match (self.cost, hindrance) {
            (Some(cost), _) if self.steps_aside => {
                write!(f, "steps aside, so the engine answers: {cost:.0} ns a query")
            }
            (Some(cost), _) if led > 0 && cheapest => write!(f, "cheapest: {cost:.0} ns a query"),
            (Some(cost), _) if led > 0 => {
                write!(f, "cheapest at first, or in places: {cost:.0} ns a query")
            }
            (_, Some(Hindrance::NotPrepared { price, spent })) => write!(
                f,
                "not prepared: that takes about {:.1} ms, and all queries took {:.1} ms",
                milliseconds(price),
                milliseconds(spent)
            ),
            (Some(cost), _) if trials > 0 => write!(f, "only in trials: {cost:.0} ns a query"),
            (_, Some(Hindrance::NotBuilt { price, saving })) => write!(
                f,
                "not built for this light: that takes {:.1} ms or more, and would have saved {:.1} ms",
                milliseconds(price),
                milliseconds(saving)
            ),
            (Some(cost), _) => write!(f, "dearer at other lights: {cost:.0} ns a query"),
            (None, _) => f.write_str("not tried: trials may not take more time yet"),
        }
    }
}
