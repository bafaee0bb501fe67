//! Four lanes: SSE2, which every x86_64 has.
//!
//! Every `unsafe` here has one reason. SAFETY: SSE2 is part of x86_64.

use std::arch::x86_64::*;

use glam::Vec3A;

use super::{Kernel, Lanes, Several};
use crate::geometry::{Ray, TriangleId};

/// Four f32, multiply-add rounded twice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sse(__m128);

impl Lanes for Sse {
    const COUNT: usize = 4;
    type Mask = __m128;
    type Sixteen = Several<Self, 4>;

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
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_set1_ps(value) })
    }
    #[inline(always)]
    fn gather(corners: &[[Vec3A; 3]], ids: &[TriangleId]) -> [[Self; 3]; 3] {
        let last = ids.len() - 1;
        let triangle = |lane: usize| &corners[ids[lane.min(last)] as usize];
        let rows: [&[Vec3A; 3]; 4] = std::array::from_fn(triangle);
        [transpose(rows, 0), transpose(rows, 1), transpose(rows, 2)]
    }
    #[inline(always)]
    fn load(values: &[f32; 8], first: usize) -> Self {
        let [a, b, c, d] = [0, 1, 2, 3].map(|lane| values[first + lane]);
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_setr_ps(a, b, c, d) })
    }
    #[inline(always)]
    fn load_from(values: &[f32], first: usize) -> Self {
        let values: &[f32; 4] = values[first..first + 4].try_into().expect("four of them");
        // SAFETY: see the head of this file; the array holds the four values that are read.
        Self(unsafe { _mm_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn rays(rays: &[&Ray; 8], first: usize) -> [Self; 7] {
        let mut values = [[0.0; 4]; 7];
        for lane in 0..4 {
            let Ray { origin, direction, end } = rays[first + lane];
            for axis in 0..3 {
                values[axis][lane] = origin[axis];
                values[3 + axis][lane] = direction[axis];
            }
            values[6][lane] = *end;
        }
        values.map(|values| Self::load_from(&values, 0))
    }
    #[inline(always)]
    fn store_to(self, values: &mut [f32], first: usize) {
        let values: &mut [f32; 4] = (&mut values[first..first + 4]).try_into().expect("four");
        // SAFETY: see the head of this file; the array holds the four values that are written.
        unsafe { _mm_storeu_ps(values.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul(b).sub(c)
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        // SAFETY: see the head of this file.
        let estimate = Self(unsafe { _mm_rcp_ps(self.0) });
        estimate.add(estimate.mul(Self::splat(1.0).sub(self.mul(estimate))))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_xor_ps(self.0, _mm_and_ps(sign.0, _mm_set1_ps(-0.0))) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_cmplt_ps(self.0, other.0) }
    }
    #[inline(always)]
    fn less_equal(self, other: Self) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_cmple_ps(self.0, other.0) }
    }
    #[inline(always)]
    fn not_less(self, other: Self) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_cmpnlt_ps(self.0, other.0) }
    }
    #[inline(always)]
    fn not_equal(self, other: Self) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_cmpneq_ps(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m128, yes: Self, no: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm_or_ps(_mm_and_ps(mask, yes.0), _mm_andnot_ps(mask, no.0)) })
    }
    #[inline(always)]
    fn and(a: __m128, b: __m128) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_and_ps(a, b) }
    }
    #[inline(always)]
    fn or(a: __m128, b: __m128) -> __m128 {
        // SAFETY: see the head of this file.
        unsafe { _mm_or_ps(a, b) }
    }
    #[inline(always)]
    fn bits(mask: __m128) -> u32 {
        // SAFETY: see the head of this file.
        unsafe { _mm_movemask_ps(mask) as u32 }
    }
}

/// 4 rows of (x, y, z, _) as x, y and z.
#[inline(always)]
fn transpose(rows: [&[Vec3A; 3]; 4], corner: usize) -> [Sse; 3] {
    // SAFETY: see the head of this file.
    unsafe {
        let (r0, r1) = (rows[0][corner].into(), rows[1][corner].into());
        let (r2, r3) = (rows[2][corner].into(), rows[3][corner].into());
        let (xy01, z01) = (_mm_unpacklo_ps(r0, r1), _mm_unpackhi_ps(r0, r1));
        let (xy23, z23) = (_mm_unpacklo_ps(r2, r3), _mm_unpackhi_ps(r2, r3));
        [
            Sse(_mm_shuffle_ps::<0x44>(xy01, xy23)),
            Sse(_mm_shuffle_ps::<0xEE>(xy01, xy23)),
            Sse(_mm_shuffle_ps::<0x44>(z01, z23)),
        ]
    }
}
