//! Plücker coordinates (edge volumes), in the arithmetic of Embree's robust mode.
//!
//! Each edge is decided by a volume that neighbours compute alike, so that a ray seldom slips through
//! a common edge; an epsilon makes the edges a little fat. Bit for bit the decision of Embree's
//! `PlueckerIntersector1` (`rtcOccluded1`, `RTC_SCENE_FLAG_ROBUST`): `0 <= t <= end`, both closed.
//!
//! Davidovič, Engelhardt, Georgiev, Slusallek, Dachsbacher: 3D Rasterization: A Bridge between
//! Rasterization and Ray Casting. Graphics Interface 2012 (edge volumes); the arithmetic was read in
//! Embree's source.

use super::{Claims, RayLanes, TriangleTest, vicinity};
use crate::geometry::lanes::{Lanes, Vector, add, cross, dot, sub};
use crate::geometry::{Ray, Triangle};

/// The test of Embree's robust mode.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pluecker;

/// Embree's `ulp`: how fat the edges are, relative to the triangle's volume.
const EDGE_EPSILON: f32 = f32::EPSILON;

impl TriangleTest for Pluecker {
    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, &[v0, v1, v2]: &[Vector<L>; 3]) -> Claims {
        let direction = ray.direction;
        let (v0, v1, v2) = (sub(v0, ray.origin), sub(v1, ray.origin), sub(v2, ray.origin));
        let (e0, e1, e2) = (sub(v2, v0), sub(v0, v1), sub(v1, v2));
        let u = dot(cross(e0, add(v2, v0)), direction);
        let v = dot(cross(e1, add(v0, v1)), direction);
        let w = dot(cross(e2, add(v1, v2)), direction);
        let epsilon = L::splat(EDGE_EPSILON).mul(u.add(v).add(w).abs());
        let minus_epsilon = epsilon.flip_sign(L::splat(-1.0));
        // Embree's `>=` is true of NaN, which volumes are that overflow; its `<=` is not.
        let inside =
            L::or(u.min(v).min(w).not_less(minus_epsilon), u.max(v).max(w).less_equal(epsilon));
        if L::bits(inside) == 0 {
            return Claims::default();
        }
        let zero = L::splat(0.0);
        let normal = stable_normal(e0, e1, e2);
        let den = twice(dot(normal, direction));
        let t = den.reciprocal().mul(twice(dot(v0, normal)));
        let within = L::and(zero.less_equal(t), t.less_equal(ray.end));
        let open = L::and(L::and(inside, within), den.not_equal(zero));
        Claims { certain: 0, open: L::bits(open) }
    }

    fn settle(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
        vicinity::meets(ray, triangle, slack)
    }
}

/// A normal whose coordinates each come from the pair of edges with the smaller products.
#[inline(always)]
fn stable_normal<L: Lanes>(a: Vector<L>, b: Vector<L>, c: Vector<L>) -> Vector<L> {
    [coordinate(a, b, c, 1, 2), coordinate(a, b, c, 2, 0), coordinate(a, b, c, 0, 1)]
}

#[inline(always)]
fn coordinate<L: Lanes>(a: Vector<L>, b: Vector<L>, c: Vector<L>, i: usize, j: usize) -> L {
    let (ab, bc) = (a[j].mul(b[i]), b[j].mul(c[i]));
    let cross_ab = a[i].mul_sub(b[j], ab);
    let cross_bc = b[i].mul_sub(c[j], bc);
    L::select(ab.abs().less(bc.abs()), cross_ab, cross_bc)
}

#[inline(always)]
fn twice<L: Lanes>(value: L) -> L {
    value.add(value)
}
