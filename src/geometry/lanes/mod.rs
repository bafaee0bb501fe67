//! Vectors of f32, one lane a triangle, with the arithmetic of each instruction set.
//!
//! A triangle test is written once, over [`Lanes`], and runs 8 wide with AVX2, 4 wide with SSE2, or
//! one triangle at a time in [`Scalar`], the portable twin: each of its operations gives the bits of
//! one lane of the wide ones, so the answers are the same by construction.
//!
//! What does differ between instruction sets is arithmetic itself: whether `a·b + c` is rounded once
//! or twice, and which table approximates `1/x`. Embree's kernels differ in just that way, and the
//! tests that reproduce Embree bit for bit must choose: [`Arithmetic`] names the three variants.
//! Tests that are certified (`exact`) may round otherwise, but answer alike.
//!
//! **Closures and the instruction set.** A closure is compiled on its own, without the instruction set
//! of the function that it stands in, and then each operation in it is a call (20 times slower,
//! measured). So code over [`Lanes`] is written without closures, `map` and `from_fn` over lanes included;
//! and where a kernel is reached through somebody else's closure, it goes through [`Lanes::run`].

mod available;
#[cfg(target_arch = "x86_64")]
mod avx;
mod scalar;
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod sse;

use std::marker::PhantomData;

use glam::{Vec3, Vec3A};

pub(crate) use available::Available;
pub use scalar::Scalar;
pub use sixteen::{Several, Sixteen};

use super::{Ray, TriangleId};

/// Something to be compiled for the instruction set of some lanes.
pub trait Kernel {
    /// What it gives.
    type Answer;
    /// Does it; to be marked `#[inline(always)]`.
    fn run(self) -> Self::Answer;
}

/// Something to do in lanes of whatever kind: those of an [`Arithmetic`] that this CPU has.
pub trait LanesJob {
    /// What it gives.
    type Answer;
    /// Does it; to be marked `#[inline(always)]`.
    fn run<L: Lanes>(self) -> Self::Answer;
}

/// A job in lanes of one kind.
struct InLanes<J, L>(J, PhantomData<L>);

impl<J: LanesJob, L: Lanes> Kernel for InLanes<J, L> {
    type Answer = J::Answer;

    #[inline(always)]
    fn run(self) -> J::Answer {
        self.0.run::<L>()
    }
}

/// Does a job as a function of its own, called by code that is compiled for the same lanes.
///
/// Loops in one function compete for registers, and which of them loses is chance: shafts, walked and tested in one
/// piece, took up to 16 % more time for changes elsewhere in it.
#[inline(always)]
pub(crate) fn apart<L: Lanes, J: LanesJob>(job: J) -> J::Answer {
    L::run_apart(InLanes::<J, L>(job, PhantomData))
}

/// Values of f32 that are computed with together.
pub trait Lanes: Copy {
    /// How many.
    const COUNT: usize;
    /// The result of a comparison, a truth value a lane.
    type Mask: Copy;
    /// Sixteen values in the widest vectors there are.
    type Sixteen: Sixteen;

    /// Runs a kernel, compiled for the instruction set of these lanes.
    fn run<K: Kernel>(kernel: K) -> K::Answer;
    /// The same as a function of its own, which is not merged with its caller.
    fn run_apart<K: Kernel>(kernel: K) -> K::Answer;
    /// The same value in every lane.
    fn splat(value: f32) -> Self;
    /// The corners of up to `COUNT` triangles, as coordinates of each corner; unused lanes repeat
    /// the last triangle.
    fn gather(corners: &[[Vec3A; 3]], ids: &[TriangleId]) -> [[Self; 3]; 3];
    /// `COUNT` of eight values, from `first` on; `first` is a multiple of `COUNT`.
    fn load(values: &[f32; 8], first: usize) -> Self;
    /// `COUNT` values from `first` on.
    fn load_from(values: &[f32], first: usize) -> Self;
    /// Of `COUNT` of eight rays, from `first` on: origins, directions, ends. `first` is a multiple of `COUNT`.
    fn rays(rays: &[&Ray; 8], first: usize) -> [Self; 7];
    /// Writes `COUNT` values from `first` on.
    fn store_to(self, values: &mut [f32], first: usize);
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
    /// `self·b − c`, likewise.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// The instruction set's approximation of `1/self` with one Newton step, as Embree computes it.
    fn reciprocal(self) -> Self;
    /// The smaller; `other` where one is NaN, as MINPS has it.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where one is NaN, as MAXPS has it.
    fn max(self, other: Self) -> Self;
    /// Sign bit cleared.
    fn abs(self) -> Self;
    /// Sign bit flipped where that of `sign` is set.
    fn flip_sign(self, sign: Self) -> Self;
    /// `self < other`; false with NaN.
    fn less(self, other: Self) -> Self::Mask;
    /// `self <= other`; false with NaN.
    fn less_equal(self, other: Self) -> Self::Mask;
    /// `!(self < other)`: `self >= other`, but true with NaN, as Embree compares.
    fn not_less(self, other: Self) -> Self::Mask;
    /// `self != other`; true with NaN.
    fn not_equal(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Both.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit a lane, lane 0 lowest.
    fn bits(mask: Self::Mask) -> u32;
}

/// Three coordinates, a lane a triangle.
pub type Vector<L> = [L; 3];

/// The same vector in every lane.
#[inline(always)]
pub fn splat<L: Lanes>(vector: Vec3) -> Vector<L> {
    [L::splat(vector.x), L::splat(vector.y), L::splat(vector.z)]
}

/// `a − b`.
#[inline(always)]
pub fn sub<L: Lanes>(a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

/// `a + b`.
#[inline(always)]
pub fn add<L: Lanes>(a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [a[0].add(b[0]), a[1].add(b[1]), a[2].add(b[2])]
}

/// The magnitude of each coordinate.
#[inline(always)]
pub fn magnitudes<L: Lanes>([x, y, z]: Vector<L>) -> Vector<L> {
    [x.abs(), y.abs(), z.abs()]
}

/// The largest magnitude among the coordinates.
#[inline(always)]
pub fn largest<L: Lanes>(vector: Vector<L>) -> L {
    let [x, y, z] = magnitudes(vector);
    x.max(y).max(z)
}

/// The bits of all lanes.
#[inline(always)]
#[must_use]
pub fn all<L: Lanes>() -> u32 {
    u32::MAX >> (32 - L::COUNT)
}

/// `a·b` in Embree's order: x, then y, then z innermost.
#[inline(always)]
pub fn dot<L: Lanes>(a: Vector<L>, b: Vector<L>) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

/// `a×b`, the second product of each coordinate rounded, as Embree has it.
#[inline(always)]
pub fn cross<L: Lanes>(a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [
        a[1].mul_sub(b[2], a[2].mul(b[1])),
        a[2].mul_sub(b[0], a[0].mul(b[2])),
        a[0].mul_sub(b[1], a[1].mul(b[0])),
    ]
}

/// How an instruction set rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Arithmetic {
    /// Products and sums rounded apart, `rcpps`: SSE2 to AVX.
    Sse,
    /// Fused multiply-add, `rcpps`: AVX2 with FMA and the instructions for bits that came with it.
    Avx2,
    /// Fused multiply-add, `vrcp14ps`: AVX-512 F and VL, and all of AVX2's.
    Avx512,
}

impl Arithmetic {
    /// All three, the oldest first.
    pub const ALL: [Self; 3] = [Self::Sse, Self::Avx2, Self::Avx512];

    /// Whether this CPU has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            Self::Sse => true,
            Self::Avx2 => avx::has_avx2(),
            Self::Avx512 => avx::has_avx512(),
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Self::Sse
        }
    }

    /// Those that this CPU has, the oldest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Available::all().map(Available::arithmetic)
    }

    /// The newest that this CPU has: the one Embree chooses by itself.
    #[must_use]
    pub fn of_this_cpu() -> Self {
        Available::newest().arithmetic()
    }

    /// Short name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sse => "sse",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}
