//! Eight lanes: AVX2 with FMA, and AVX-512 VL, which differs from it in the reciprocal, and has
//! sixteen at once as well.
//!
//! Every `unsafe` here has one reason. SAFETY: code that has lanes of this kind is reached only through
//! `Available`, which has found the instruction set on this CPU.

use std::arch::x86_64::*;

use glam::Vec3A;

use super::{Kernel, Lanes, Several, Sixteen};
use crate::geometry::{Ray, TriangleId};

/// Eight f32. `RCP14`: the reciprocal of AVX-512, else that of AVX.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx<const RCP14: bool>(__m256);

/// The widest vectors beside eight lanes.
pub(crate) trait Widest {
    type Sixteen: Sixteen;
}

impl Widest for Avx<false> {
    type Sixteen = Several<Self, 2>;
}

impl Widest for Avx<true> {
    type Sixteen = Zmm;
}

impl<const RCP14: bool> Lanes for Avx<RCP14>
where
    Self: Widest,
{
    const COUNT: usize = 8;
    type Mask = __m256;
    type Sixteen = <Self as Widest>::Sixteen;

    #[inline(always)]
    fn run<K: Kernel>(kernel: K) -> K::Answer {
        // SAFETY: see the head of this file.
        unsafe { if RCP14 { run_avx512(kernel) } else { run_avx2(kernel) } }
    }
    #[inline(always)]
    fn run_apart<K: Kernel>(kernel: K) -> K::Answer {
        // SAFETY: see the head of this file.
        unsafe { if RCP14 { apart_avx512(kernel) } else { apart_avx2(kernel) } }
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_set1_ps(value) })
    }
    #[inline(always)]
    fn gather(corners: &[[Vec3A; 3]], ids: &[TriangleId]) -> [[Self; 3]; 3] {
        let last = ids.len() - 1;
        let triangle = |lane: usize| &corners[ids[lane.min(last)] as usize];
        let rows: [&[Vec3A; 3]; 8] = std::array::from_fn(triangle);
        [transpose(rows, 0), transpose(rows, 1), transpose(rows, 2)]
    }
    #[inline(always)]
    fn load(values: &[f32; 8], _: usize) -> Self {
        // SAFETY: see the head of this file; the array holds the eight values that are read.
        Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn load_from(values: &[f32], first: usize) -> Self {
        let values: &[f32; 8] = values[first..first + 8].try_into().expect("eight of them");
        Self::load(values, 0)
    }
    #[inline(always)]
    fn rays(rays: &[&Ray; 8], _: usize) -> [Self; 7] {
        let [ox, oy, oz, _] = columns::<RCP14, 0>(rays);
        let [dx, dy, dz, end] = columns::<RCP14, 3>(rays);
        [ox, oy, oz, dx, dy, dz, end]
    }
    #[inline(always)]
    fn store_to(self, values: &mut [f32], first: usize) {
        let values: &mut [f32; 8] = (&mut values[first..first + 8]).try_into().expect("eight");
        // SAFETY: see the head of this file; the array holds the eight values that are written.
        unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_fmsub_ps(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        // SAFETY: see the head of this file.
        unsafe {
            let estimate = if RCP14 { _mm256_rcp14_ps(self.0) } else { _mm256_rcp_ps(self.0) };
            let error = _mm256_fnmadd_ps(self.0, estimate, _mm256_set1_ps(1.0));
            Self(_mm256_fmadd_ps(estimate, error, estimate))
        }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(sign.0, _mm256_set1_ps(-0.0))) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn less_equal(self, other: Self) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn not_less(self, other: Self) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_NLT_UQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn not_equal(self, other: Self) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_cmp_ps::<_CMP_NEQ_UQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256, yes: Self, no: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn and(a: __m256, b: __m256) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    fn or(a: __m256, b: __m256) -> __m256 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_or_ps(a, b) }
    }
    #[inline(always)]
    fn bits(mask: __m256) -> u32 {
        // SAFETY: see the head of this file.
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }
}

/// Sixteen f32 of AVX-512.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Zmm(__m512);

impl Sixteen for Zmm {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_set1_ps(value) })
    }
    #[inline(always)]
    fn load(values: &[f32; 16]) -> Self {
        // SAFETY: see the head of this file; the array holds the sixteen values that are read.
        Self(unsafe { _mm512_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, values: &mut [f32; 16]) {
        // SAFETY: see the head of this file; the array holds the sixteen values that are written.
        unsafe { _mm512_storeu_ps(values.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_fmadd_ps(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of this file.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> u16 {
        // SAFETY: see the head of this file.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn less_equal(self, other: Self) -> u16 {
        // SAFETY: see the head of this file.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn least(self) -> f32 {
        // SAFETY: see the head of this file.
        unsafe { _mm512_reduce_min_ps(self.0) }
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        // SAFETY: see the head of this file.
        unsafe { _mm512_reduce_max_ps(self.0) }
    }
}

/// What runs a kernel with these features, merged with its caller or apart, and whether this CPU has them: of one list, so that
/// what is compiled for is looked for.
macro_rules! with_features {
    ($run:ident, $apart:ident, $is_available:ident: $($feature:tt),+) => {
        $(#[target_feature(enable = $feature)])+
        fn $run<K: Kernel>(kernel: K) -> K::Answer {
            kernel.run()
        }

        $(#[target_feature(enable = $feature)])+
        #[inline(never)]
        fn $apart<K: Kernel>(kernel: K) -> K::Answer {
            kernel.run()
        }

        pub(super) fn $is_available() -> bool {
            $(is_x86_feature_detected!($feature))&&+
        }
    };
}

with_features!(run_avx2, apart_avx2, has_avx2: "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt");
with_features!(
    run_avx512, apart_avx512, has_avx512:
    "avx512f", "avx512vl", "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"
);

/// 8 rows of (x, y, z, _) as x, y and z, by halves of 128 bits.
#[inline(always)]
fn transpose<const RCP14: bool>(rows: [&[Vec3A; 3]; 8], corner: usize) -> [Avx<RCP14>; 3] {
    // SAFETY: see the head of this file.
    unsafe {
        let (r0, r1) = (pair(rows, corner, 0), pair(rows, corner, 1));
        let (r2, r3) = (pair(rows, corner, 2), pair(rows, corner, 3));
        let (xy01, z01) = (_mm256_unpacklo_ps(r0, r1), _mm256_unpackhi_ps(r0, r1));
        let (xy23, z23) = (_mm256_unpacklo_ps(r2, r3), _mm256_unpackhi_ps(r2, r3));
        [
            Avx(_mm256_shuffle_ps::<0x44>(xy01, xy23)),
            Avx(_mm256_shuffle_ps::<0xEE>(xy01, xy23)),
            Avx(_mm256_shuffle_ps::<0x44>(z01, z23)),
        ]
    }
}

/// Rows `i` and `i + 4` in one register.
#[inline(always)]
fn pair(rows: [&[Vec3A; 3]; 8], corner: usize, i: usize) -> __m256 {
    // SAFETY: see the head of this file.
    unsafe {
        let low = _mm256_castps128_ps256(rows[i][corner].into());
        _mm256_insertf128_ps::<1>(low, rows[i + 4][corner].into())
    }
}

/// Four values of each of eight rays, from the `FIRST`, 0 or 3, on.
#[inline(always)]
fn columns<const RCP14: bool, const FIRST: usize>(rays: &[&Ray; 8]) -> [Avx<RCP14>; 4] {
    // SAFETY: see the head of this file.
    unsafe {
        let (r0, r1) = (two_rays::<FIRST>(rays, 0), two_rays::<FIRST>(rays, 1));
        let (r2, r3) = (two_rays::<FIRST>(rays, 2), two_rays::<FIRST>(rays, 3));
        let (low01, high01) = (_mm256_unpacklo_ps(r0, r1), _mm256_unpackhi_ps(r0, r1));
        let (low23, high23) = (_mm256_unpacklo_ps(r2, r3), _mm256_unpackhi_ps(r2, r3));
        [
            Avx(_mm256_shuffle_ps::<0x44>(low01, low23)),
            Avx(_mm256_shuffle_ps::<0xEE>(low01, low23)),
            Avx(_mm256_shuffle_ps::<0x44>(high01, high23)),
            Avx(_mm256_shuffle_ps::<0xEE>(high01, high23)),
        ]
    }
}

/// Of rays `i` and `i + 4`, in one register.
#[inline(always)]
fn two_rays<const FIRST: usize>(rays: &[&Ray; 8], i: usize) -> __m256 {
    const { assert!(FIRST <= 3 && size_of::<Ray>() == 7 * size_of::<f32>()) };
    // SAFETY: see the head of this file; a ray is seven f32 in a row, of which four from `FIRST` on are read.
    unsafe {
        let (a, b) = (std::ptr::from_ref(rays[i]), std::ptr::from_ref(rays[i + 4]));
        let low = _mm256_castps128_ps256(_mm_loadu_ps(a.cast::<f32>().add(FIRST)));
        _mm256_insertf128_ps::<1>(low, _mm_loadu_ps(b.cast::<f32>().add(FIRST)))
    }
}
