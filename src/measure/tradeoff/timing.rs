//! Medians of measurements, and how far they spread.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::measure::turns::order_of;

/// Several measurements of one thing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// The middle one; the mean of the two in the middle, if there are two.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Timing {
    /// Of some measurements, in any order.
    ///
    /// # Panics
    /// If there are none.
    #[must_use]
    pub fn of(measured: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = measured.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let (least, greatest) = (sorted[0], sorted[sorted.len() - 1]);
        let (low, high) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
        Self { median: 0.5 * (low + high), least, greatest }
    }

    /// Half the distance from the least to the greatest, as a share of the median.
    #[must_use]
    pub fn spread(&self) -> f64 {
        0.5 * (self.greatest - self.least) / self.median
    }

    /// The same in per cent; a dash where there is but one measurement.
    #[must_use]
    pub fn spread_text(&self) -> String {
        if self.greatest > self.least {
            format!("±{:.0} %", 100.0 * self.spread())
        } else {
            "–".to_owned()
        }
    }
}

/// Orders that are drawn for a repetition. The best is taken: in most of them somebody runs after the same one again.
const DRAWS: usize = 100;

/// Whose turn it is: all of `count` once in each repetition. Whoever ran before leaves caches and a clock rate behind, so
/// nobody runs after themselves, and as few as can be after one whom they ran after before.
pub fn turns(count: usize, repetitions: usize) -> Vec<usize> {
    let mut turns = Vec::new();
    let mut known = BTreeSet::new();
    for repetition in 0..repetitions {
        let last = turns.pop();
        let draws = (0..DRAWS).map(|draw| -> Vec<usize> {
            last.into_iter().chain(order_of(count, (repetition, draw))).collect()
        });
        let repeated = |drawn: &Vec<usize>| {
            let alone = pairs(drawn).filter(|(before, after)| before == after).count();
            (alone, pairs(drawn).filter(|pair| known.contains(pair)).count())
        };
        let best = draws.min_by_key(repeated).unwrap_or_default();
        known.extend(pairs(&best));
        turns.extend(best);
    }
    turns
}

/// Who runs before whom.
fn pairs(turns: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    turns.windows(2).map(|pair| (pair[0], pair[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        let timing = |values: &[f64]| Timing::of(values.iter().copied());
        let odd = timing(&[3.0, 1.0, 9.0]);
        assert_eq!([odd.median, odd.least, odd.greatest], [3.0, 1.0, 9.0]);
        assert_eq!(timing(&[4.0, 1.0, 2.0, 8.0]).median, 3.0);
        assert_eq!(timing(&[5.0]).median, 5.0);
        assert_eq!([odd, timing(&[5.0])].map(|t| t.spread_text()), ["±133 %", "–"]);
    }

    #[test]
    fn everyone_has_a_turn_in_every_repetition() {
        for (count, repetitions) in [(0, 2), (1, 3), (2, 2), (5, 3), (40, 5)] {
            let all = turns(count, repetitions);
            assert_eq!(all.len(), count * repetitions);
            for repetition in all.chunks(count.max(1)) {
                let mut sorted = repetition.to_vec();
                sorted.sort_unstable();
                assert!(sorted.iter().copied().eq(0..count), "{all:?}");
            }
        }
        assert!(turns(3, 0).is_empty());
    }

    #[test]
    fn everyone_runs_after_different_ones_over_the_repetitions() {
        for count in 3..60 {
            for repetitions in 2..8 {
                let all = turns(count, repetitions);
                for which in 0..count {
                    let after = pairs(&all).filter(|(_, after)| *after == which);
                    let before: Vec<usize> = after.map(|(before, _)| before).collect();
                    let different: BTreeSet<usize> = before.iter().copied().collect();
                    let context = format!("{which} of {count}, {repetitions} times: {all:?}");
                    assert!(!different.contains(&which), "after itself: {context}");
                    assert!(different.len() > 1 || before.len() < 2, "the same: {context}");
                }
            }
        }
    }
}
