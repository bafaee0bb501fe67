//! One lane: the portable twin of the wide vectors.

use glam::Vec3A;

use super::{Kernel, Lanes, Several};
use crate::geometry::{Ray, TriangleId};

/// One f32 with the arithmetic of a lane: `FUSED` multiply-add or not, and, where `FUSED`, the
/// reciprocal of AVX-512 (`RCP14`) or of AVX2. The first panics on processors of x86 that lack it.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<const FUSED: bool, const RCP14: bool>(pub f32);

impl<const FUSED: bool, const RCP14: bool> Lanes for Scalar<FUSED, RCP14> {
    const COUNT: usize = 1;
    type Mask = bool;
    type Sixteen = Several<Self, 16>;

    #[inline(always)]
    fn run<K: Kernel>(kernel: K) -> K::Answer {
        kernel.run()
    }
    #[inline(never)]
    fn run_apart<K: Kernel>(kernel: K) -> K::Answer {
        kernel.run()
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn gather(corners: &[[Vec3A; 3]], ids: &[TriangleId]) -> [[Self; 3]; 3] {
        corners[ids[0] as usize].map(|corner| corner.to_array().map(Self))
    }
    #[inline(always)]
    fn load(values: &[f32; 8], first: usize) -> Self {
        Self(values[first])
    }
    #[inline(always)]
    fn load_from(values: &[f32], first: usize) -> Self {
        Self(values[first])
    }
    #[inline(always)]
    fn rays(rays: &[&Ray; 8], first: usize) -> [Self; 7] {
        let Ray { origin: o, direction: d, end } = *rays[first];
        [Self(o.x), Self(o.y), Self(o.z), Self(d.x), Self(d.y), Self(d.z), Self(end)]
    }
    #[inline(always)]
    fn store_to(self, values: &mut [f32], first: usize) {
        values[first] = self.0;
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if FUSED { Self(self.0.mul_add(b.0, c.0)) } else { Self(self.0 * b.0 + c.0) }
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        if FUSED { Self(self.0.mul_add(b.0, -c.0)) } else { Self(self.0 * b.0 - c.0) }
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        let estimate = if RCP14 { approximate_14(self.0) } else { approximate(self.0) };
        if FUSED {
            Self(estimate.mul_add((-self.0).mul_add(estimate, 1.0), estimate))
        } else {
            Self(estimate + estimate * (1.0 - self.0 * estimate))
        }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.0 < other.0 { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.0 > other.0 { self } else { other }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        Self(f32::from_bits(self.0.to_bits() ^ (sign.0.to_bits() & 0x8000_0000)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    #[inline(always)]
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
    #[inline(always)]
    fn not_less(self, other: Self) -> bool {
        self.0 >= other.0 || self.0.is_nan() || other.0.is_nan()
    }
    #[inline(always)]
    fn not_equal(self, other: Self) -> bool {
        self.0 != other.0
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a && b
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a || b
    }
    #[inline(always)]
    fn bits(mask: bool) -> u32 {
        u32::from(mask)
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn approximate(value: f32) -> f32 {
    use std::arch::x86_64::{_mm_cvtss_f32, _mm_rcp_ss, _mm_set_ss};
    // SAFETY: SSE is part of x86_64.
    unsafe { _mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(value))) }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn approximate_14(value: f32) -> f32 {
    use std::arch::x86_64::{_mm_cvtss_f32, _mm_rcp14_ss, _mm_set_ss};
    assert!(is_x86_feature_detected!("avx512f"), "this CPU has no reciprocal of AVX-512");
    // SAFETY: the instruction is part of AVX-512 F, which is there.
    unsafe { _mm_cvtss_f32(_mm_rcp14_ss(_mm_set_ss(value), _mm_set_ss(value))) }
}

/// Elsewhere Embree divides (NEON), and so do we.
#[cfg(not(target_arch = "x86_64"))]
fn approximate(value: f32) -> f32 {
    1.0 / value
}

#[cfg(not(target_arch = "x86_64"))]
fn approximate_14(value: f32) -> f32 {
    1.0 / value
}
