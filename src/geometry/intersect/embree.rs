//! The bounds between which Embree's answer lies.
//!
//! Embree culls by boxes before it tests triangles, and which boxes depends on build quality and
//! instruction set. What is defined is: its answer is "blocked" at most where some triangle passes the
//! scalar test (upper bound), and at least where some triangle passes it and that triangle's own box
//! passes Embree's box test (lower bound): box tests are monotone, so every box around that one is met too.
//! Here the lower bound leaves out hits that are noise, where the ray does not come near the triangle
//! (`vicinity`): our own engines do not count those, and cullers need not see them.
//!
//! [`AtLeast`] is the lower bound, as a test; a triangle that passes it proves that Embree says
//! "blocked", which is what memories in front of Embree need. [`AtMost`] is the upper bound.
//!
//! They hold for numbers of 1e-18 to 1e12 in magnitude, and zero: of 17 million rays among those none lay outside. Where coordinates or directions come near
//! to denormal numbers, which Embree may take for zero, 153 did. Our `exact` test has no such range.

use std::marker::PhantomData;

use super::{Claims, RayLanes, TriangleTest, vicinity};
use crate::geometry::lanes::{Lanes, Scalar, Vector};
use crate::geometry::{Bounds, Ray, Triangle};

/// Embree ignores triangles with coordinates as large as this (`FLT_LARGE`).
pub(crate) const EMBREE_LARGEST: f32 = 1.844e18;

/// Direction components below this are replaced by it, sign lost, before Embree inverts them.
pub(crate) const EMBREE_SMALLEST: f32 = 1e-18;

/// Passes where `T` passes: Embree's answer is "not blocked" where no triangle passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct AtMost<T>(PhantomData<T>);

impl<T: TriangleTest> TriangleTest for AtMost<T> {
    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, corners: &[Vector<L>; 3]) -> Claims {
        T::claims(ray, corners)
    }

    fn settle(_: &Ray, _: &Triangle, _: f64) -> bool {
        true
    }
}

/// Passes where `T` and the own box pass and the ray comes near the triangle: Embree's answer is "blocked" where any triangle passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct AtLeast<T, B>(PhantomData<(T, B)>);

/// A box test of Embree's.
pub trait BoxTest: Copy + Default + Send + Sync + 'static {
    /// Whether the ray passes.
    fn passes(ray: &Ray, bounds: &Bounds) -> bool;
}

impl<T: TriangleTest, B: BoxTest> TriangleTest for AtLeast<T, B> {
    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, corners: &[Vector<L>; 3]) -> Claims {
        T::claims(ray, corners)
    }

    fn settle(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
        let bounds = Bounds::of(*triangle);
        bounds.largest_coordinate() < EMBREE_LARGEST
            && B::passes(ray, &bounds)
            && vicinity::meets(ray, triangle, slack)
    }
}

fn fix_zero(component: f32) -> f32 {
    if component.abs() < EMBREE_SMALLEST { EMBREE_SMALLEST } else { component }
}

/// Near and far planes in one axis, for a ray that runs up or down it.
fn planes(bounds: &Bounds, axis: usize, inverse: f32) -> (f32, f32) {
    let (low, high) = (bounds.min[axis], bounds.max[axis]);
    if inverse >= 0.0 { (low, high) } else { (high, low) }
}

/// The box test of robust scenes: exact inverses, rounded down for entry and up for exit.
#[derive(Clone, Copy, Debug, Default)]
pub struct RobustBox;

impl BoxTest for RobustBox {
    fn passes(ray: &Ray, bounds: &Bounds) -> bool {
        const ROUND_DOWN: f32 = 1.0 - 3.0 * f32::EPSILON;
        const ROUND_UP: f32 = 1.0 + 3.0 * f32::EPSILON;
        let (mut enter, mut leave) = (0f32, ray.end);
        for axis in 0..3 {
            let inverse = 1.0 / fix_zero(ray.direction[axis]);
            let (near, far) = planes(bounds, axis, ROUND_DOWN * inverse);
            enter = enter.max((near - ray.origin[axis]) * (ROUND_DOWN * inverse));
            leave = leave.min((far - ray.origin[axis]) * (ROUND_UP * inverse));
        }
        enter <= leave
    }
}

/// The box test of default scenes: approximate inverses; fused where the arithmetic is. The inverses of AVX-512 (`RCP14`) panic on
/// processors of x86 that lack it.
#[derive(Clone, Copy, Debug, Default)]
pub struct FastBox<const FUSED: bool, const RCP14: bool>;

impl<const FUSED: bool, const RCP14: bool> BoxTest for FastBox<FUSED, RCP14> {
    fn passes(ray: &Ray, bounds: &Bounds) -> bool {
        let (mut enter, mut leave) = (0f32, ray.end);
        for axis in 0..3 {
            let lane = Scalar::<FUSED, RCP14>(fix_zero(ray.direction[axis]));
            let inverse = lane.reciprocal().0;
            let (near, far) = planes(bounds, axis, inverse);
            let origin = ray.origin[axis];
            let t = |plane: f32| {
                if FUSED {
                    plane.mul_add(inverse, -(origin * inverse))
                } else {
                    (plane - origin) * inverse
                }
            };
            // `max` and `min` of numbers; a NaN fails as it does in Embree's comparison of bits.
            let (t_near, t_far) = (t(near), t(far));
            if t_near.is_nan() || t_far.is_nan() {
                return false;
            }
            enter = enter.max(t_near);
            leave = leave.min(t_far);
        }
        // Some kernels compare the bits as integers, where −0 is below 0; then that is no hit.
        enter <= leave && !leave.is_sign_negative()
    }
}
