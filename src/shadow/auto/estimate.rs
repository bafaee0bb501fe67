//! What a query costs each candidate, as far as it has been seen: in the whole scene, towards one light, and
//! from one place to that light.
//!
//! Few queries say little. So an estimate leans on that of the level above, as if it had already been confirmed by
//! [`PRIOR`] queries here; and a place that is twice as hard for whoever was asked there counts as twice as
//! hard for the others too, until they have been asked themselves. Old observations fade, so that estimates follow
//! costs that change.

/// Queries here that weigh as much as the level above.
const PRIOR: f64 = 4096.0;

/// Queries after which what was seen counts half.
const HORIZON: f64 = 262_144.0;

/// Time and queries.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    nanoseconds: f64,
    queries: f64,
}

/// What was seen at one level.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// By candidate.
    sums: Vec<Sum>,
    /// All that was seen here, and what the level above would have expected of it.
    seen: f64,
    expected: f64,
    queries: f64,
}

impl Level {
    pub fn new(candidates: usize) -> Self {
        Self { sums: vec![Sum::default(); candidates], seen: 0.0, expected: 0.0, queries: 0.0 }
    }

    /// How much harder it is here than the level above says.
    fn difficulty(&self) -> f64 {
        if self.queries == 0.0 || self.expected == 0.0 {
            return 1.0;
        }
        let prior = PRIOR * self.expected / self.queries;
        (self.seen + prior) / (self.expected + prior)
    }

    /// Nanoseconds that a query costs a candidate here, with the estimate of the level above; `None` if neither
    /// has seen any.
    pub fn estimate(&self, candidate: usize, above: Option<f64>) -> Option<f64> {
        let Sum { nanoseconds, queries } = self.sums[candidate];
        match above {
            Some(above) => {
                Some((nanoseconds + PRIOR * self.difficulty() * above) / (queries + PRIOR))
            }
            None => (queries > 0.0).then(|| nanoseconds / queries),
        }
    }

    /// Takes note of what queries cost.
    pub fn observe(
        &mut self,
        candidate: usize,
        queries: f64,
        nanoseconds: f64,
        above: Option<f64>,
    ) {
        let sum = &mut self.sums[candidate];
        sum.nanoseconds += nanoseconds;
        sum.queries += queries;
        if sum.queries > HORIZON {
            sum.nanoseconds *= 0.5;
            sum.queries *= 0.5;
        }
        if let Some(above) = above {
            self.seen += nanoseconds;
            self.expected += above * queries;
            self.queries += queries;
            if self.queries > HORIZON {
                self.seen *= 0.5;
                self.expected *= 0.5;
                self.queries *= 0.5;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_queries_lean_on_the_level_above_and_many_do_not() {
        let mut level = Level::new(1);
        level.observe(0, 64.0, 64.0 * 200.0, Some(100.0));
        let few = level.estimate(0, Some(100.0)).unwrap();
        level.observe(0, 1e5, 1e5 * 200.0, Some(100.0));
        let many = level.estimate(0, Some(100.0)).unwrap();
        assert!((100.0..110.0).contains(&few) && (190.0..210.0).contains(&many), "{few} {many}");
    }

    #[test]
    fn a_hard_place_is_presumed_to_be_hard_for_all() {
        let mut level = Level::new(2);
        level.observe(0, 1e5, 1e5 * 300.0, Some(100.0));
        let other = level.estimate(1, Some(50.0)).unwrap();
        assert!((130.0..160.0).contains(&other), "{other}");
    }

    #[test]
    fn estimates_follow_costs_that_change() {
        let mut level = Level::new(1);
        for _ in 0..10_000 {
            level.observe(0, 256.0, 256.0 * 100.0, None);
        }
        for _ in 0..2_000 {
            level.observe(0, 256.0, 256.0 * 40.0, None);
        }
        let after = level.estimate(0, None).unwrap();
        assert!(after < 60.0, "{after}");
    }
}
