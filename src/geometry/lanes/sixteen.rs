//! Sixteen values at once: a packet of rays, whatever the instruction set.

use super::Lanes;

/// Sixteen f32 that are computed with together. The rounding is that of the lanes behind it.
pub trait Sixteen: Copy {
    /// The same value sixteen times.
    fn splat(value: f32) -> Self;
    /// Sixteen values.
    fn load(values: &[f32; 16]) -> Self;
    /// Writes sixteen values.
    fn store(self, values: &mut [f32; 16]);
    /// Sum, rounded.
    fn add(self, other: Self) -> Self;
    /// Difference, rounded.
    fn sub(self, other: Self) -> Self;
    /// Product, rounded.
    fn mul(self, other: Self) -> Self;
    /// Quotient, rounded.
    fn div(self, other: Self) -> Self;
    /// `self·b + c`: rounded once where the arithmetic is fused, twice elsewhere.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Sign bit cleared.
    fn abs(self) -> Self;
    /// The smaller; `other` where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where one is NaN.
    fn max(self, other: Self) -> Self;
    /// `self < other`, a bit each; false with NaN.
    fn less(self, other: Self) -> u16;
    /// `self <= other`, a bit each; false with NaN.
    fn less_equal(self, other: Self) -> u16;
    /// The least of the sixteen; anything if one is NaN.
    fn least(self) -> f32;
    /// The greatest.
    fn greatest(self) -> f32;
}

/// Sixteen values in `N` narrower vectors.
#[derive(Clone, Copy, Debug)]
pub struct Several<L, const N: usize>([L; N]);

impl<L: Lanes, const N: usize> Several<L, N> {
    #[inline(always)]
    fn values(self) -> [f32; 16] {
        const { assert!(N * L::COUNT == 16) };
        let mut values = [0.0; 16];
        for (part, lanes) in self.0.into_iter().enumerate() {
            lanes.store_to(&mut values, part * L::COUNT);
        }
        values
    }
}

impl<L: Lanes, const N: usize> Sixteen for Several<L, N> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([L::splat(value); N])
    }
    #[inline(always)]
    fn load(values: &[f32; 16]) -> Self {
        let mut parts = [L::splat(0.0); N];
        for (part, lanes) in parts.iter_mut().enumerate() {
            *lanes = L::load_from(values, part * L::COUNT);
        }
        Self(parts)
    }
    #[inline(always)]
    fn store(self, values: &mut [f32; 16]) {
        for (part, lanes) in self.0.into_iter().enumerate() {
            lanes.store_to(values, part * L::COUNT);
        }
    }
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.add(b);
        }
        self
    }
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.sub(b);
        }
        self
    }
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.mul(b);
        }
        self
    }
    #[inline(always)]
    fn div(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.div(b);
        }
        self
    }
    #[inline(always)]
    fn mul_add(mut self, b: Self, c: Self) -> Self {
        for (part, a) in self.0.iter_mut().enumerate() {
            *a = a.mul_add(b.0[part], c.0[part]);
        }
        self
    }
    #[inline(always)]
    fn abs(mut self) -> Self {
        for a in &mut self.0 {
            *a = a.abs();
        }
        self
    }
    #[inline(always)]
    fn min(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.min(b);
        }
        self
    }
    #[inline(always)]
    fn max(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.max(b);
        }
        self
    }
    #[inline(always)]
    fn less(self, other: Self) -> u16 {
        let mut bits = 0;
        for (part, a) in self.0.into_iter().enumerate() {
            bits |= L::bits(a.less(other.0[part])) << (part * L::COUNT);
        }
        bits as u16
    }
    #[inline(always)]
    fn less_equal(self, other: Self) -> u16 {
        let mut bits = 0;
        for (part, a) in self.0.into_iter().enumerate() {
            bits |= L::bits(a.less_equal(other.0[part])) << (part * L::COUNT);
        }
        bits as u16
    }
    #[inline(always)]
    fn least(self) -> f32 {
        let mut values = self.values();
        let mut half = 8;
        while half > 0 {
            for lane in 0..half {
                let (a, b) = (values[lane], values[lane + half]);
                values[lane] = if a < b { a } else { b };
            }
            half /= 2;
        }
        values[0]
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        let mut values = self.values();
        let mut half = 8;
        while half > 0 {
            for lane in 0..half {
                let (a, b) = (values[lane], values[lane + half]);
                values[lane] = if a > b { a } else { b };
            }
            half /= 2;
        }
        values[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::lanes::{Available, LanesJob};

    struct Sums([f32; 16], [f32; 16]);

    impl LanesJob for Sums {
        type Answer = ([u16; 2], [f32; 2]);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Answer {
            let (a, b) = (L::Sixteen::load(&self.0), L::Sixteen::load(&self.1));
            let sum = a.mul_add(L::Sixteen::splat(2.0), b.sub(a.mul(a))).add(b.abs()).min(a).max(b);
            let mut stored = [0.0; 16];
            sum.store(&mut stored);
            let sum = L::Sixteen::load(&stored);
            ([a.less(b), sum.less_equal(b)], [sum.least(), sum.greatest()])
        }
    }

    #[test]
    fn sixteen_values_are_sixteen_values_in_every_arithmetic() {
        let a = std::array::from_fn(|lane| ((lane * 7) % 16) as f32 - 4.0);
        let b = std::array::from_fn(|lane| ((lane * 5) % 16) as f32 - 8.0);
        let mut bits = [0u16; 2];
        let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        for lane in 0..16 {
            let (a, b): (f32, f32) = (a[lane], b[lane]);
            let sum = (a * 2.0 + (b - a * a) + b.abs()).min(a).max(b);
            bits[0] |= u16::from(a < b) << lane;
            bits[1] |= u16::from(sum <= b) << lane;
            least = least.min(sum);
            greatest = greatest.max(sum);
        }
        for arithmetic in Available::all() {
            let got = arithmetic.run(Sums(a, b));
            assert_eq!(got, (bits, [least, greatest]), "{arithmetic:?}");
        }
    }
}
