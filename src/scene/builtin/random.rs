//! A seeded generator whose numbers are the same on every machine.

/// SplitMix64 (Steele, Lea & Flood 2014): small, and good enough to place polygons.
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn seeded(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// From 0 to 1, without 1.
    pub(super) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
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
