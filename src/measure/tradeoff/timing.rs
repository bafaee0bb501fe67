//! Medians of measurements, and how far they spread.

use serde::Serialize;

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

/// Whose turn it is: all of `count` once in each repetition, each time beginning elsewhere, so that nobody is
/// always first, or always after the same neighbour's warm-up.
pub fn turns(count: usize, repetitions: usize) -> impl Iterator<Item = usize> {
    let stride = count.div_ceil(repetitions.max(1)).max(1);
    (0..repetitions).flat_map(move |repetition| {
        (0..count).map(move |turn| (turn + repetition * stride) % count)
    })
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
    fn everyone_has_a_turn_in_every_repetition_and_another_begins() {
        let all: Vec<usize> = turns(5, 3).collect();
        for repetition in all.chunks(5) {
            let mut sorted = repetition.to_vec();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4]);
        }
        assert!(all[0] != all[5] && all[5] != all[10] && all[0] != all[10]);
    }
}
