//! The f32 filter: many triangles at a time, each surely blocking, surely not, or left to `certified`.
//!
//! It is the test of Möller and Trumbore with a bound for its rounding errors, so that it claims nothing it
//! cannot know. Edges come from the corners as given, not from corners moved to the origin of the ray: then
//! the errors shrink with the triangle, and small far triangles are as easy as large near ones.
//! With c = v0 − o, e₁ = v0 − v1, e₂ = v2 − v0, r = c×d and n = e₂×e₁, the slope is n·d, and with s its sign,
//!
//! > U = s r·e₂,  V = s r·e₁,  W = |n·d| − U − V,  T = s n·c
//!
//! say that the line of the ray meets the triangle iff U, V, W ≥ 0, at t = T / |n·d|.
//!
//! **Rounding.** Let u = 2⁻²⁴ and γₖ = ku/(1−ku). E is the largest coordinate of e₁ and e₂ in magnitude,
//! |x| a vector of magnitudes, |x|₁ their sum, and wᵢ = 2(|dⱼ| + |dₖ|). Every term of U, V and n·d meets seven
//! roundings (two of the differences that enter it, two products, a difference, two sums), so their errors are
//! below γ₇ times their permanents, which are at most
//!
//! > E (w·|c|)/2 for U and V,  2E² |d|₁ for n·d,  2E² |c|₁ for T (with γ₈, for one more difference).
//!
//! W subtracts twice more: its error, *plus that of n·d*, is below γ₉ (E (w·|c|) + 4E² |d|₁). That is the bound
//! that U, V and W are all compared with, with 10u in place of γ₉ because the bound is itself rounded, twelve
//! times at most, as those of start and end are: 10u (1−u)¹² > γ₉.
//! * All three above the bound: all have sign s, and s is the sign of the slope. The line meets the interior.
//! * One of them, X, below minus the bound: X < 0, and the other two add up to s(n·d) − X, which is above zero even if
//!   rounding got s wrong, as the bound has room for the error of n·d too. So one of those is positive, the signs
//!   are mixed, and the line misses. Only the least of the three has to be looked at.
//!
//! The interval 0 < T < end·|n·d| is compared without division. A finite end is the ratio end/1, an infinite
//! one 1/0; for p/q the second comparison is p|n·d| − qT > 0, whose terms meet nine roundings: its error is
//! below γ₉ 2E² (p|d|₁ + q|c|₁); for both comparisons the code has 5u times 4E² in place of
//! 10u times 2E². Beyond the ends a lane is only let go if the sign of the slope is certain.
//!
//! **Underflow.** Sums and differences never lose anything to underflow. A product does, at most η = 2⁻¹⁵⁰.
//! Carried through, that adds at most (12E + 4|d|₁ + 12)η to the error of W plus that of n·d, (2|c|₁ + 3)η to
//! that of T, and (2p|d|₁ + 3p + 2q|c|₁ + 3q + 1)η to that of the end. Adding `UNDERFLOW` to each factor and
//! sum in the bounds pays for these and for what underflows in the bounds themselves:
//! 10u times `UNDERFLOW` is 20η.
//!
//! **Overflow.** Each bound is made of magnitudes at least twice those of the terms it bounds, every
//! intermediate of the test has a counterpart there that is no smaller, and nothing is subtracted. So if the bound is
//! finite, nothing overflowed; if it is infinite or NaN, no comparison with it holds and the lane stays open.
//!
//! Fused multiplications and additions round less and keep every bound: the claims may differ between instruction
//! sets, the answers cannot. Denormals must not be flushed to zero, as everywhere in Rust.

use super::certified;
use crate::geometry::intersect::{Claims, RayLanes, TriangleTest};
use crate::geometry::lanes::{Lanes, Vector, all, cross, dot, largest, magnitudes, sub};
use crate::geometry::{Ray, Triangle};

/// The certified test: the filter, and [`certified::blocks`] for what it leaves open.
#[derive(Clone, Copy, Debug, Default)]
pub struct Exact;

/// 10u, with u = 2⁻²⁴: above γ₉ by enough for the rounding of the bound itself.
const ROUNDING: f32 = 5.0 * f32::EPSILON;

/// 2⁻¹²⁵, see "Underflow" above.
const UNDERFLOW: f32 = 2.0 * f32::MIN_POSITIVE;

impl TriangleTest for Exact {
    const IS_EXACT: bool = true;

    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, &[v0, v1, v2]: &[Vector<L>; 3]) -> Claims {
        let underflow = L::splat(UNDERFLOW);
        let weights = Weights::of(ray.direction);

        let (e1, e2) = (sub(v0, v1), sub(v2, v0));
        let c = sub(v0, ray.origin);
        let r = cross(c, ray.direction);
        let normal = cross(e2, e1);
        let signed_slope = dot(normal, ray.direction);
        let u = dot(r, e2).flip_sign(signed_slope);
        let v = dot(r, e1).flip_sign(signed_slope);
        let slope = signed_slope.abs();
        let w = slope.sub(u).sub(v);

        let size = largest(e1).max(largest(e2));
        let twice = size.add(size);
        let area = twice.mul_add(twice, underflow);
        let [x, y, z] = magnitudes(c);
        let [weight_x, weight_y, weight_z] = weights.across;
        let moment = weight_x.mul_add(x, weight_y.mul_add(y, weight_z.mul_add(z, underflow)));
        let bound = size.mul_add(moment, area.mul_add(weights.along, weights.underflow));
        let error = L::splat(ROUNDING).mul(bound);

        let least = u.min(v).min(w);
        let misses = L::bits(least.less(negative(error)));
        if misses == all::<L>() {
            return Claims::default();
        }

        let half = L::splat(0.5 * ROUNDING);
        let t = dot(normal, c).flip_sign(signed_slope);
        let distance = x.add(y).add(z);
        let start_error = half.mul(area.mul_add(distance, underflow));

        let finite = ray.end.less(L::splat(f32::INFINITY));
        let p = L::select(finite, ray.end, L::splat(1.0));
        let q = L::select(finite, L::splat(1.0), L::splat(0.0));
        let stop = p.mul_add(slope, negative(q.mul(t)));
        let lever = q.mul_add(distance, p.mul_add(weights.along, underflow));
        let stop_error = half.mul(area.mul_add(lever, p.mul_add(underflow, underflow)));

        let within = L::and(start_error.less(t), stop_error.less(stop));
        let outside = L::or(t.less(negative(start_error)), stop.less(negative(stop_error)));
        let certain = L::bits(L::and(error.less(least), within));
        let misses = misses | L::bits(L::and(error.less(slope), outside));
        Claims { certain, open: all::<L>() & !(certain | misses) }
    }

    fn settle(ray: &Ray, triangle: &Triangle, _: f64) -> bool {
        certified::blocks(ray, triangle)
    }
}

/// What the bounds need of the direction: the same for all triangles.
struct Weights<L> {
    /// w: twice the sum of the other two magnitudes.
    across: Vector<L>,
    /// |d|₁.
    along: L,
    /// What underflow may add whatever the triangle.
    underflow: L,
}

impl<L: Lanes> Weights<L> {
    #[inline(always)]
    fn of(direction: Vector<L>) -> Self {
        let [x, y, z] = magnitudes(direction);
        let (yz, zx, xy) = (y.add(z), z.add(x), x.add(y));
        let along = xy.add(z);
        let underflow = L::splat(UNDERFLOW);
        Self {
            across: [yz.add(yz), zx.add(zx), xy.add(xy)],
            along,
            underflow: underflow.mul_add(along, underflow),
        }
    }
}

#[inline(always)]
fn negative<L: Lanes>(value: L) -> L {
    value.flip_sign(L::splat(-1.0))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::lanes::Scalar;

    fn claims(ray: &Ray, triangle: &Triangle) -> (u32, u32) {
        let corners = triangle.map(|corner| corner.to_array().map(Scalar::<false, false>));
        let claims = Exact::claims(&RayLanes::new(ray), &corners);
        (claims.certain, claims.open)
    }

    const BLOCKS: (u32, u32) = (1, 0);
    const OPEN: (u32, u32) = (0, 1);
    const MISSES: (u32, u32) = (0, 0);

    /// A triangle of this size at a distance of one, and a ray towards its plane.
    fn small_far(size: f32, x: f32, end: f32) -> (Ray, Triangle) {
        let origin = Vec3::new(0.3, 0.2, 0.1);
        let corner = origin + Vec3::new(0.5, 0.25, 1.0);
        let triangle = [corner, corner + size * Vec3::X, corner + size * Vec3::Y];
        let target = corner + size * Vec3::new(x, 0.25, 0.0);
        (Ray { origin, direction: target - origin, end }, triangle)
    }

    #[test]
    fn small_far_triangles_are_easy() {
        for size in [1.0, 1e-1, 1e-2, 1e-3, 1e-4] {
            for (x, end, expected) in [
                (0.25, 2.0, BLOCKS),
                (0.25, f32::INFINITY, BLOCKS),
                (0.25, 0.5, MISSES),
                (-0.25, 2.0, MISSES),
                (1.25, 2.0, MISSES),
                (0.0, 2.0, OPEN),
                (0.25, 1.0, OPEN),
            ] {
                let (ray, triangle) = small_far(size, x, end);
                assert_eq!(claims(&ray, &triangle), expected, "{size} {x} {end}");
            }
        }
    }

    #[test]
    fn over_and_underflow_leave_a_lane_open() {
        let (ray, triangle) = small_far(1.0, 0.25, 2.0);
        for (scale, expected) in [
            (1e-30, OPEN),
            (1e-15, OPEN),
            (1e-11, BLOCKS),
            (1e11, BLOCKS),
            (1e15, OPEN),
            (1e38, OPEN),
        ] {
            let scaled =
                Ray { origin: scale * ray.origin, direction: scale * ray.direction, ..ray };
            assert_eq!(
                claims(&scaled, &triangle.map(|corner| scale * corner)),
                expected,
                "{scale}"
            );
        }
    }

    #[test]
    fn what_is_not_finite_never_blocks() {
        let (ray, triangle) = small_far(1.0, 0.25, 2.0);
        for corner in 0..3 {
            for axis in 0..3 {
                for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    let mut broken = triangle;
                    broken[corner][axis] = value;
                    assert_eq!(claims(&ray, &broken).0, 0, "{broken:?}");
                }
            }
        }
    }
}
