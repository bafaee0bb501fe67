//! A seeded generator whose numbers are the same on every machine.

use crate::geometry::random::SplitMix64;

/// Random numbers to place polygons by.
#[derive(Clone, Debug)]
pub(super) struct Random(SplitMix64);

impl Random {
    pub(super) fn seeded(seed: u64) -> Self {
        Self(SplitMix64::seeded(seed))
    }

    /// From 0 to 1, without 1.
    pub(super) fn uniform(&mut self) -> f64 {
        self.0.unit()
    }

    /// Gaussian of the given standard deviation, drawn again until it lies within ±1.
    ///
    /// The sum of twelve uniform numbers less six: its deviation is 1, and sums are the same on
    /// every machine, which logarithms are not.
    pub(super) fn truncated_gaussian(&mut self, deviation: f64) -> f64 {
        loop {
            let sum: f64 = (0..12).map(|_| self.uniform()).sum();
            let value = (sum - 6.0) * deviation;
            if value.abs() <= 1.0 {
                return value;
            }
        }
    }
}
