//! How sure a share is: Wilson's interval.
//!
//! Wrong answers are rare, and the textbook interval says of none in a million that there can be none. Wilson's
//! does not: none of n leaves up to 3.8/n possible.
//!
//! Wilson: Probable Inference, the Law of Succession, and Statistical Inference. JASA 22(158), 1927.

use serde::Serialize;

/// The 97.5 % point of the normal distribution: two-sided 95 %.
const Z: f64 = 1.959_963_984_540_054;

/// A count out of a number, per million, with its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PerMillion {
    /// What was found.
    pub share: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl PerMillion {
    /// The share of `count` in `of`; of nothing, anything is possible.
    #[must_use]
    pub fn new(count: u64, of: u64) -> Self {
        let [low, high] = wilson(count, of);
        let share = if of == 0 { 0.0 } else { count as f64 / of as f64 };
        Self { share: 1e6 * share, low: 1e6 * low, high: 1e6 * high }
    }
}

/// The two-sided 95 % interval of a share of which `count` in `of` were seen.
///
/// # Panics
/// If the count is larger than the whole.
#[must_use]
pub fn wilson(count: u64, of: u64) -> [f64; 2] {
    assert!(count <= of, "{count} of {of}");
    if of == 0 {
        return [0.0, 1.0];
    }
    let (n, share) = (of as f64, count as f64 / of as f64);
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 / (1.0 + Z * Z / n);
    // Exactly so, which rounding would miss.
    let low = if count == 0 { 0.0 } else { scale * (middle - half) };
    let high = if count == of { 1.0 } else { scale * (middle + half) };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(interval: [f64; 2], expected: [f64; 2]) -> bool {
        interval.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-5)
    }

    #[test]
    fn intervals_are_those_of_the_books() {
        // Newcombe, Two-sided confidence intervals for the single proportion, 1998, Table I, method 3.
        assert!(is_near(wilson(81, 263), [0.2553, 0.3662]));
        assert!(is_near(wilson(15, 148), [0.0624, 0.1605]));
        assert!(is_near(wilson(0, 20), [0.0, 0.1611]));
        assert!(is_near(wilson(1, 29), [0.0061, 0.1718]));
    }

    #[test]
    fn none_in_a_million_leaves_four_possible() {
        let none = PerMillion::new(0, 1_000_000);
        assert!(none.low == 0.0 && none.share == 0.0 && (3.8..3.9).contains(&none.high));
    }

    #[test]
    fn all_and_none_are_mirrored_and_nothing_says_nothing() {
        let ([low, high], [of_all_low, of_all_high]) = (wilson(0, 50), wilson(50, 50));
        assert!((1.0 - high - of_all_low).abs() < 1e-12 && low == 0.0 && of_all_high == 1.0);
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
    }
}
