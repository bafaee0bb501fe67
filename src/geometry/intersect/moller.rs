//! Möller and Trumbore 1997, in the arithmetic of Embree's default mode.
//!
//! The fastest test, and the least careful: edges decided from a shared determinant, so that a ray
//! through the common edge of two triangles may miss both. Bit for bit the decision of Embree's
//! `TriangleMIntersector1Moeller` (`rtcOccluded1`, default scene flags): `0 < t` strict, `t <= end`.
//!
//! Möller, Trumbore: Fast, Minimum Storage Ray/Triangle Intersection. Journal of Graphics Tools 2(1), 1997.

use super::{Claims, RayLanes, TriangleTest, vicinity};
use crate::geometry::lanes::{Lanes, Vector, cross, dot, sub};
use crate::geometry::{Ray, Triangle};

/// The test of Embree's default mode.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moller;

impl TriangleTest for Moller {
    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, &[v0, v1, v2]: &[Vector<L>; 3]) -> Claims {
        let zero = L::splat(0.0);
        let (e1, e2) = (sub(v0, v1), sub(v2, v0));
        let normal = cross(e2, e1);
        let c = sub(v0, ray.origin);
        let r = cross(c, ray.direction);
        let den = dot(normal, ray.direction);
        let abs_den = den.abs();
        let u = dot(r, e2).flip_sign(den);
        let v = dot(r, e1).flip_sign(den);
        let inside = L::and(
            L::and(den.not_equal(zero), zero.less_equal(u)),
            L::and(zero.less_equal(v), u.add(v).less_equal(abs_den)),
        );
        if L::bits(inside) == 0 {
            return Claims::default();
        }
        let t = dot(normal, c).flip_sign(den);
        let within = L::and(abs_den.mul(zero).less(t), t.less_equal(abs_den.mul(ray.end)));
        Claims { certain: 0, open: L::bits(L::and(inside, within)) }
    }

    fn settle(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
        vicinity::meets(ray, triangle, slack)
    }
}
