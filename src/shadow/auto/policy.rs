//! Whom to ask next, from what was seen so far: logic alone, which reads no clock.
//!
//! Three rules:
//!
//! 1. **Follow the leader.** Whoever is estimated to be cheapest at this light and place is asked.
//! 2. **Try the others, rarely.** After `b` batches of 256 queries, trials may have cost more than the leader would have by 1/√b of
//!    all time spent so far, no more. The candidate on which least was spent comes first: those nearly as good are
//!    tried often, those far worse hardly ever. What a first trial costs nobody foresees: it counts neither as trial nor as time spent, so that it neither keeps
//!    the others from theirs nor buys them more.
//! 3. **Rent before you buy** (the ski-rental rule; Karlin, Manasse, Rudolph, Sleator 1988). What has to be built
//!    is built when the time that its lack has cost so far is the price of building: for the scene, as soon as all
//!    time spent is the price; for a light, as soon as its queries would have been cheaper by it. A
//!    candidate that was never seen is taken to be cheap there, so that it gets a chance.
//!
//!    Told how many queries will come, it builds for the scene as soon as 0.62 of what those still to come would cost without
//!    is the price, and else not before a quarter more have come than were said to, for who said it looked at few pixels; then as many are
//!    taken to come as have come. That share is the golden one: building in vain
//!    and failing to build then cost the same, 1.62 times the best. While few batches have been seen, it must be clearer: by
//!    nine times after the first two, of which the caches knew nothing yet; they also come from one corner of the picture. What has cost the price by
//!    now is doubted no longer.
//!
//!    What was bought is asked next, for [`FIRST_CALLS`]: so it is known at once what it is worth. The first one does not count, for
//!    no cache knows anything of what was built.
//!
//! **Bound.** With costs that stay the same, the time of all queries is at most (2 + 1/√b) times that of the best single
//! candidate in hindsight, building included, and (1 + 1/√b) / (1 − 1/√b) times where nothing has to be built, or twice 1 + 1/√b while
//! that is less; and besides, one batch of each candidate, and the first calls of what was bought. Rule 3 gives the 2: when a structure is bought for B, B was lost by not having it, and
//! the best in hindsight has paid B or that; on a true word it is 1.62 + 8/√b. Rule 2 gives
//! the rest. Costs that change are followed, as the estimates
//! fade (`estimate`), without a bound.
//!
//! Karlin, Manasse, Rudolph, Sleator: Competitive Snoopy Caching. Algorithmica 3, 1988.

use std::collections::HashMap;

use super::estimate::Level;

/// Queries of a batch, in which time is counted.
const BATCH: f64 = 256.0;

/// The share of what queries to come would cost without it for which something is built: the golden one.
const WORTH: f64 = 0.618;

/// Batches after which half of what they say of those to come is believed.
const DOUBT: f64 = 16.0;

/// How much more than it said a forecast may turn out to be, and yet be believed: it looks at a thousandth of the pixels, 80 in small
/// pictures. One that is short by less would have something bought at the very end, for nobody.
const SHORT_BY: f64 = 0.25;

/// A batch counts for at most so many times what was expected: what takes longer was interrupted, by another
/// program or by the system.
const MOST_SURPRISE: f64 = 8.0;

/// Calls, whole, that go to what was bought. By one alone, whatever disturbed it would decide for long.
const FIRST_CALLS: u32 = 4;

/// What a light's structure that was never seen is taken to cost a query, as a share of what others need: so little that it gets a
/// chance, and no less, as it would be built then where few queries come.
const UNSEEN: f64 = 0.5;

/// What is known of a candidate beforehand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Prices {
    /// Nanoseconds that preparing it for the scene is expected to take.
    pub scene: f64,
    /// Nanoseconds that it is expected to take before it answers a light's first batch; `None` if nothing is built
    /// for lights.
    pub light: Option<f64>,
}

/// Why a candidate was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    /// It leads.
    Leads,
    /// To see what it costs.
    Trial,
}

/// Who is asked, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choice {
    pub candidate: usize,
    pub reason: Reason,
}

impl Choice {
    /// Whoever led before leads still.
    pub fn again(candidate: usize) -> Self {
        Self { candidate, reason: Reason::Leads }
    }
}

/// What a batch cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observation {
    pub light: usize,
    pub place: u32,
    pub choice: Choice,
    pub queries: f64,
    /// Nanoseconds of answering, those of building apart.
    pub nanoseconds: f64,
    /// Nanoseconds of building.
    pub building: f64,
}

/// What is known of one candidate at one light.
#[derive(Clone, Debug, Default)]
struct Account {
    /// What its trials cost more than the leader would have.
    trials: f64,
    /// Spent on building; and on the last batch alone.
    built: f64,
    last_built: f64,
    /// What others needed for the queries that they answered.
    without: f64,
    queries_without: f64,
}

struct AtLight {
    level: Level,
    places: HashMap<u32, Level>,
    accounts: Vec<Account>,
}

/// What was seen so far, in the whole scene.
pub(super) struct Policy {
    prices: Vec<Prices>,
    /// Nanoseconds that preparing took; none if it has not been prepared.
    prepared: Vec<Option<f64>>,
    /// The one that was last prepared for a price, and how many of its first calls are still to come.
    bought: Option<(usize, u32)>,
    scene: Level,
    lights: Vec<AtLight>,
    batches: f64,
    /// Queries so far, and in all, if somebody said so.
    queries: f64,
    expected: f64,
    spent: f64,
    /// What trials cost more than the leader would have: the first of each candidate, and all others.
    first_trials: f64,
    trials: f64,
}

impl Policy {
    /// Nothing has been seen. The first candidate needs no preparation.
    pub fn new(prices: Vec<Prices>, lights: usize) -> Self {
        let count = prices.len();
        let mut prepared = vec![None; count];
        prepared[0] = Some(0.0);
        let at_light = || AtLight {
            level: Level::new(count),
            places: HashMap::new(),
            accounts: vec![Account::default(); count],
        };
        Self {
            prices,
            prepared,
            bought: None,
            scene: Level::new(count),
            lights: (0..lights).map(|_| at_light()).collect(),
            batches: 0.0,
            queries: 0.0,
            expected: 0.0,
            spent: 0.0,
            first_trials: 0.0,
            trials: 0.0,
        }
    }

    /// So many queries are to come in all.
    pub fn expect(&mut self, queries: f64) {
        self.expected = queries;
    }

    /// The candidate that is worth preparing by now, if there is one.
    pub fn worth_preparing(&self) -> Option<usize> {
        let paid: f64 = self.prepared.iter().flatten().sum();
        let waiting = (0..self.prices.len()).filter(|&c| self.prepared[c].is_none());
        waiting.min_by(|&a, &b| self.prices[a].scene.total_cmp(&self.prices[b].scene)).filter(
            |&c| {
                let price = self.prices[c].scene;
                self.batches > 0.0 && (price == 0.0 || self.worth(price) >= paid + price)
            },
        )
    }

    /// What may be paid by now for something of this price.
    fn worth(&self, price: f64) -> f64 {
        if self.expected == 0.0 {
            return self.spent;
        }
        if self.queries > (1.0 + SHORT_BY) * self.expected {
            // As many again as have come.
            return WORTH * self.spent;
        }
        let believed = (self.batches / (self.batches + DOUBT)).max((self.spent / price).min(1.0));
        let to_come = (self.expected - self.queries).max(0.0);
        WORTH * believed * self.spent / self.queries.max(1.0) * to_come
    }

    /// A candidate has been prepared; those that share what it needed will cost less.
    pub fn prepare(&mut self, candidate: usize, nanoseconds: f64, others: &[usize]) {
        self.prepared[candidate] = Some(nanoseconds);
        if self.prices[candidate].scene > 0.0 {
            self.bought = Some((candidate, FIRST_CALLS));
        }
        for &other in others {
            self.prices[other].scene = 0.0;
        }
    }

    /// Whom to ask so many queries.
    pub fn choose(&self, light: usize, place: u32, queries: f64) -> Choice {
        let estimates: Vec<Option<f64>> =
            (0..self.prices.len()).map(|c| self.estimate(c, light, place)).collect();
        let ready = |&c: &usize| self.prepared[c].is_some() && self.affordable(c, light);
        if let Some((candidate, calls)) = self.bought
            && calls > 0
            && ready(&candidate)
        {
            return Choice { candidate, reason: Reason::Leads };
        }
        let cost = |c: usize| estimates[c].unwrap_or(f64::INFINITY);
        let leader = (0..estimates.len())
            .filter(ready)
            .min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
            .unwrap_or_default();
        let leads = Choice { candidate: leader, reason: Reason::Leads };
        let Some(least) = estimates[leader] else { return leads };
        let accounts = &self.lights[light].accounts;
        let Some(other) = (0..estimates.len())
            .filter(|&c| c != leader)
            .filter(ready)
            .min_by(|&a, &b| accounts[a].trials.total_cmp(&accounts[b].trials))
        else {
            return leads;
        };
        let trials = match estimates[other] {
            Some(cost) => self.trials + (cost - least) * queries,
            // What was never seen is expected to take twice as long.
            None => least * queries,
        };
        if trials <= (self.spent - self.first_trials) / self.batches.sqrt() {
            Choice { candidate: other, reason: Reason::Trial }
        } else {
            leads
        }
    }

    /// Takes note of what a batch cost.
    pub fn observe(&mut self, seen: &Observation) {
        let &Observation { light, place, choice, queries, nanoseconds, building } = seen;
        let Choice { candidate, reason } = choice;
        let expected = self.estimate(candidate, light, place);
        let nanoseconds =
            expected.map_or(nanoseconds, |e| nanoseconds.min(MOST_SURPRISE * e * queries));
        if reason == Reason::Trial {
            let least = (0..self.prices.len())
                .filter(|&c| c != candidate && self.prepared[c].is_some())
                .filter_map(|c| self.estimate(c, light, place))
                .fold(f64::INFINITY, f64::min);
            let excess = (nanoseconds - least * queries).max(0.0);
            match expected {
                Some(_) => self.trials += excess,
                None => self.first_trials += excess,
            }
            self.lights[light].accounts[candidate].trials += excess;
        }
        self.batches += queries / BATCH;
        self.queries += queries;
        self.spent += nanoseconds + building;
        for c in 0..self.prices.len() {
            if self.prices[c].light.is_none() {
                continue;
            }
            let account = &mut self.lights[light].accounts[c];
            if c == candidate {
                if account.built == 0.0 && building > 0.0 {
                    // What the first batch built here, it will build at other lights.
                    self.prices[c].light = Some(building);
                }
                account.built += building;
                account.last_built = building;
            } else {
                account.without += nanoseconds;
                account.queries_without += queries;
            }
        }
        if let Some((bought, calls)) = &mut self.bought
            && *bought == candidate
            && *calls > 0
        {
            *calls -= 1;
            if *calls + 1 == FIRST_CALLS {
                return;
            }
        }
        let in_scene = self.scene.estimate(candidate, None);
        let AtLight { level, places, .. } = &mut self.lights[light];
        let at_light = level.estimate(candidate, in_scene);
        let at_place = places.entry(place).or_insert_with(|| Level::new(self.prices.len()));
        at_place.observe(candidate, queries, nanoseconds, at_light);
        level.observe(candidate, queries, nanoseconds, in_scene);
        self.scene.observe(candidate, queries, nanoseconds, None);
    }

    /// Nanoseconds that a query is expected to cost a candidate at a light, seen from anywhere.
    pub fn at_light(&self, candidate: usize, light: usize) -> Option<f64> {
        self.lights[light].level.estimate(candidate, self.scene.estimate(candidate, None))
    }

    /// Why a candidate does not answer a light, if it cannot by now.
    pub fn hindrance(&self, candidate: usize, light: usize) -> Option<Hindrance> {
        if self.prepared[candidate].is_none() {
            let spent = self.spent;
            return Some(Hindrance::NotPrepared { price: self.prices[candidate].scene, spent });
        }
        (!self.affordable(candidate, light)).then(|| {
            let account = &self.lights[light].accounts[candidate];
            let price = account.built + self.next(candidate, account);
            Hindrance::NotBuilt { price, saving: self.saving(candidate, light).max(0.0) }
        })
    }

    fn estimate(&self, candidate: usize, light: usize, place: u32) -> Option<f64> {
        let at_light = self.at_light(candidate, light);
        match self.lights[light].places.get(&place) {
            Some(level) => level.estimate(candidate, at_light),
            None => at_light,
        }
    }

    /// Whether what a light's queries would have saved by now pays for what has been and is to be built.
    fn affordable(&self, candidate: usize, light: usize) -> bool {
        if self.prices[candidate].light.is_none() {
            return true;
        }
        let account = &self.lights[light].accounts[candidate];
        account.built + self.next(candidate, account) <= self.saving(candidate, light)
    }

    /// What the next batch is expected to have built.
    fn next(&self, candidate: usize, account: &Account) -> f64 {
        if account.built > 0.0 {
            account.last_built
        } else {
            self.prices[candidate].light.unwrap_or_default()
        }
    }

    /// What the queries of a light that others answered would have cost less.
    fn saving(&self, candidate: usize, light: usize) -> f64 {
        let account = &self.lights[light].accounts[candidate];
        let cost = self.at_light(candidate, light).map(|cost| cost * account.queries_without);
        account.without - cost.unwrap_or(UNSEEN * account.without)
    }
}

/// Why a candidate cannot be asked by now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hindrance {
    /// Less time was spent than preparing it costs.
    NotPrepared { price: f64, spent: f64 },
    /// Less would have been saved at this light than building costs.
    NotBuilt { price: f64, saving: f64 },
}

#[cfg(test)]
mod tests;
