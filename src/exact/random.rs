//! Random numbers that are the same on every machine, and shapes made of them without rounding that depends on
//! a library.

use glam::{DVec3, Vec3};

use crate::geometry::random::SplitMix64;
use crate::geometry::{Ray, Triangle};

/// A generator of its own for each index of each stream.
pub(crate) struct Random(SplitMix64);

impl Random {
    pub(crate) fn new(stream: u64, index: u64) -> Self {
        let first = |seed| SplitMix64::seeded(seed).bits();
        Self(SplitMix64::seeded(first(first(stream) ^ index)))
    }

    fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.bits() >> 32) as usize * count) >> 32
    }

    pub(crate) fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    /// Uniform in [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// An integer of at most this magnitude; zero may have either sign.
    pub(crate) fn lattice(&mut self, most: usize) -> f64 {
        let magnitude = self.below(most + 1) as f64;
        if self.one_in(2) { -magnitude } else { magnitude }
    }

    pub(crate) fn lattice_point(&mut self, most: usize) -> DVec3 {
        DVec3::new(self.lattice(most), self.lattice(most), self.lattice(most))
    }

    /// Two to an exponent in this range, ends included.
    pub(crate) fn power_of_two(&mut self, least: i32, greatest: i32) -> f64 {
        power_of_two(least + self.below((greatest - least + 1) as usize) as i32)
    }

    /// A step of about 10⁻⁹ to 10⁻⁴.
    pub(crate) fn nudge(&mut self) -> DVec3 {
        self.power_of_two(-30, -13) * self.point()
    }

    fn any(&mut self) -> f32 {
        f32::from_bits(self.bits() as u32)
    }

    fn any_vector(&mut self) -> Vec3 {
        Vec3::new(self.any(), self.any(), self.any())
    }

    pub(crate) fn any_ray(&mut self) -> Ray {
        Ray { origin: self.any_vector(), direction: self.any_vector(), end: self.any() }
    }

    pub(crate) fn any_triangle(&mut self) -> Triangle {
        [0; 3].map(|_| self.any_vector())
    }
}

/// Two to an exponent in f64's normal range, exactly.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
