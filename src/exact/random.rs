//! Random numbers that are the same on every machine: SplitMix64 (Steele, Lea, Flood, "Fast Splittable
//! Pseudorandom Number Generators", OOPSLA 2014), and shapes made of them without rounding that depends on
//! a library.

use glam::{DVec3, Vec3};

use crate::geometry::{Ray, Triangle};

/// A generator of its own for each index of each stream.
pub(crate) struct Random(u64);

impl Random {
    /// The increment: 2⁶⁴ over the golden ratio, made odd.
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

    pub(crate) fn new(stream: u64, index: u64) -> Self {
        let stream = Self(stream).bits();
        Self(Self(stream ^ index).bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(Self::STEP);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.bits() >> 32) as usize * count) >> 32
    }

    pub(crate) fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * power_of_two(-53)
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
