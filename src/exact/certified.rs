//! The certified decision on one triangle: f64 where a forward error bound allows, expansions elsewhere.
//!
//! With the corners `a`, `b`, `c` taken relative to the origin of the ray, and the direction `d`:
//!
//! * the edges `d·(a×b)`, `d·(b×c)`, `d·(c×a)` say on which side of each edge the line of the ray passes.
//!   The line meets the closed triangle iff no two of them have opposite signs and not all are zero;
//! * their sum is the slope `d·n` with the normal `n = (b−a)×(c−a)`, so the sign they agree on is that of the slope;
//! * the line meets the plane at `t = (a·n)/(d·n)`. Hence `t > 0` iff the start `a·n` has the sign of the slope,
//!   and `t < end` iff the stop `end·(d·n) − a·n` has.
//!
//! So five signs decide. All zero edges mean no slope: a triangle without area, a direction of zero, or a ray
//! in the plane, none of which is blocked.
//!
//! **The bound.** Let u = 2⁻⁵³ and γₙ = nu/(1−nu). Each sum of products goes with its *permanent*: the same
//! expression with every term replaced by its magnitude. A term of an edge meets seven roundings (two
//! differences of f32, two products, three sums), one of the start eight (three differences), one of the stop
//! nine (three differences or one more product, one more sum). So the error is at most γ₉ times the permanent of the
//! rounded inputs, itself computed with nine roundings at most; and γ₉/(1−u)⁹ < 10u(1−u), so comparing with
//! `ERROR_BOUND` = 10u times the computed permanent is sound. Nothing can underflow (the smallest product of four f32
//! is 2⁻⁵⁹⁶) or overflow, and fusing multiplications with additions could only remove roundings.
//!
//! Source of the method: Shewchuk (see `expansion`); the permanents are those of his `orient3d` filter.

use glam::{DVec3, Vec3Swizzles};

use super::expansion::{Expansion, difference};
use super::oracle::Verdict;
use crate::geometry::{Ray, Triangle, is_finite};

/// Which arithmetic settled a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// f64 with an error bound.
    Double,
    /// Exact expansions.
    Expansion,
}

/// Relative to the permanent, no f64 evaluation below errs by more: 10u with u = 2⁻⁵³.
const ERROR_BOUND: f64 = 5.0 * f64::EPSILON;

/// Whether the triangle blocks the ray: the oracle's answer, at speed.
#[must_use]
pub fn blocks(ray: &Ray, triangle: &Triangle) -> bool {
    decide(ray, triangle).0 == Verdict::Blocked
}

/// The oracle's verdict, at speed.
#[must_use]
pub fn verdict(ray: &Ray, triangle: &Triangle) -> Verdict {
    decide(ray, triangle).0
}

/// The verdict, and the arithmetic that was needed for it.
#[must_use]
pub fn decide(ray: &Ray, triangle: &Triangle) -> (Verdict, Stage) {
    let doubles = Doubles::new(ray, triangle);
    // Most of what is asked here is the triangle that a ray starts on: its plane is behind, which needs no edges.
    let (start, slope) = doubles.start_and_slope();
    if start.sign().sign * slope.sign().sign < 0 {
        return (Verdict::Clear, Stage::Double);
    }
    let edges = doubles.edges();
    let signs = edges.map(|edge| edge.sign);
    if is_mixed(signs) {
        return (Verdict::Clear, Stage::Double);
    }
    if edges[0].is_certain & edges[1].is_certain & edges[2].is_certain & (ray.end > 0.0) {
        let interval = doubles.interval(start, slope);
        if interval[0].is_certain & interval[1].is_certain {
            return (settle(signs, || interval.map(|end| end.sign)), Stage::Double);
        }
    }
    (complete(ray, triangle, &doubles), Stage::Expansion)
}

/// The verdict, with expansions for just those signs that f64 leaves open.
#[cold]
fn complete(ray: &Ray, triangle: &Triangle, doubles: &Doubles) -> Verdict {
    if !is_valid(ray, triangle) {
        return Verdict::Clear;
    }
    let exact = Expansions::new(ray, triangle);
    let [first, second, third] = doubles.edges();
    let edges =
        [first.or(|| exact.edge(0)), second.or(|| exact.edge(1)), third.or(|| exact.edge(2))];
    settle(edges, || {
        let (start, slope) = doubles.start_and_slope();
        let [start, stop] = doubles.interval(start, slope);
        [start.or(|| exact.start()), stop.or(|| exact.stop())]
    })
}

/// The verdict by exact expansions alone.
#[must_use]
pub fn verdict_by_expansions(ray: &Ray, triangle: &Triangle) -> Verdict {
    if !is_valid(ray, triangle) {
        return Verdict::Clear;
    }
    let exact = Expansions::new(ray, triangle);
    settle([exact.edge(0), exact.edge(1), exact.edge(2)], || [exact.start(), exact.stop()])
}

fn is_valid(ray: &Ray, triangle: &Triangle) -> bool {
    ray.is_valid() && is_finite(triangle)
}

/// The verdict from the signs of the edges, and if needed those of start and stop.
#[inline(always)]
fn settle(edges: [i8; 3], interval: impl FnOnce() -> [i8; 2]) -> Verdict {
    let slope = edges.iter().sum::<i8>().signum();
    if is_mixed(edges) || slope == 0 {
        return Verdict::Clear;
    }
    let [start, stop] = interval();
    match slope * if slope > 0 { start.min(stop) } else { start.max(stop) } {
        1 => Verdict::Blocked,
        0 => Verdict::Tie,
        _ => Verdict::Clear,
    }
}

/// Whether both signs occur.
#[inline(always)]
fn is_mixed([first, second, third]: [i8; 3]) -> bool {
    first.min(second).min(third) < 0 && first.max(second).max(third) > 0
}

/// The quantities in f64.
struct Doubles {
    corners: [DVec3; 3],
    direction: DVec3,
    sides: [DVec3; 2],
    end: f64,
}

impl Doubles {
    #[inline(always)]
    fn new(ray: &Ray, &[a, b, c]: &Triangle) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        Self {
            corners: [a - origin, b - origin, c - origin],
            direction,
            sides: [b - a, c - a],
            end: f64::from(ray.end),
        }
    }

    #[inline(always)]
    fn edges(&self) -> [Sign; 3] {
        let [a, b, c] = self.corners;
        let edge = |from, to| Bounded::cross(self.direction, from).dot(to).sign();
        [edge(a, b), edge(b, c), edge(c, a)]
    }

    /// Where the ray starts above the triangle's plane, and how fast it goes there.
    #[inline(always)]
    fn start_and_slope(&self) -> (Bounded<f64>, Bounded<f64>) {
        let normal = Bounded::cross(self.sides[0], self.sides[1]);
        (normal.dot(self.corners[0]), normal.dot(self.direction))
    }

    /// The signs of start and stop.
    #[inline(always)]
    fn interval(&self, start: Bounded<f64>, slope: Bounded<f64>) -> [Sign; 2] {
        let stop = if self.end < f64::INFINITY {
            Bounded {
                value: self.end * slope.value - start.value,
                permanent: self.end * slope.permanent + start.permanent,
            }
        } else {
            slope
        };
        [start.sign(), stop.sign()]
    }
}

/// A rounded value with its permanent.
#[derive(Clone, Copy)]
struct Bounded<T> {
    value: T,
    permanent: T,
}

impl Bounded<DVec3> {
    #[inline(always)]
    fn cross(a: DVec3, b: DVec3) -> Self {
        let (plus, minus) = (a.yzx() * b.zxy(), a.zxy() * b.yzx());
        Self { value: plus - minus, permanent: plus.abs() + minus.abs() }
    }

    #[inline(always)]
    fn dot(&self, b: DVec3) -> Bounded<f64> {
        Bounded { value: self.value.dot(b), permanent: self.permanent.dot(b.abs()) }
    }
}

impl Bounded<f64> {
    /// The sign of the exact value. Without branches: here they are hard to predict.
    #[inline(always)]
    fn sign(self) -> Sign {
        let error = ERROR_BOUND * self.permanent;
        // With infinities and NaN neither holds.
        let sign = i8::from(self.value > error) - i8::from(self.value < -error);
        // A permanent of zero: every term is zero.
        Sign { sign, is_certain: (sign != 0) | (self.permanent == 0.0) }
    }
}

/// −1, 0 or 1; 0 also where unknown.
#[derive(Clone, Copy)]
struct Sign {
    sign: i8,
    is_certain: bool,
}

impl Sign {
    /// The sign, or else the exact one.
    fn or(self, exact: impl FnOnce() -> i8) -> i8 {
        if self.is_certain { self.sign } else { exact() }
    }
}

/// The quantities as expansions.
struct Expansions {
    corners: [[Expansion<2>; 3]; 3],
    direction: [f64; 3],
    sides: [[Expansion<2>; 3]; 2],
    end: f64,
}

impl Expansions {
    fn new(ray: &Ray, triangle: &Triangle) -> Self {
        let minus = |a: glam::Vec3, b: glam::Vec3| [0, 1, 2].map(|i| difference(a[i], b[i]));
        let [a, b, c] = *triangle;
        Self {
            corners: triangle.map(|corner| minus(corner, ray.origin)),
            direction: ray.direction.to_array().map(f64::from),
            sides: [minus(b, a), minus(c, a)],
            end: f64::from(ray.end),
        }
    }

    /// The sign of the edge from this corner to the next.
    fn edge(&self, corner: usize) -> i8 {
        let (from, to) = (&self.corners[corner], &self.corners[(corner + 1) % 3]);
        slope(self.direction, &cross(from, to)).sign()
    }

    fn normal(&self) -> [Expansion<16>; 3] {
        cross(&self.sides[0], &self.sides[1])
    }

    fn height(&self, normal: &[Expansion<16>; 3]) -> Expansion<192> {
        let [x, y, z] =
            [0, 1, 2].map(|i| normal[i].times_difference::<32, 64>(&self.corners[0][i]));
        x.plus::<64, 128>(&y).plus(&z)
    }

    fn start(&self) -> i8 {
        self.height(&self.normal()).sign()
    }

    fn stop(&self) -> i8 {
        let normal = self.normal();
        let slope = slope(self.direction, &normal);
        if self.end.is_infinite() {
            return slope.sign();
        }
        let end = slope.times::<192>(self.end);
        end.plus::<192, 384>(&self.height(&normal).negated()).sign()
    }
}

fn cross(a: &[Expansion<2>; 3], b: &[Expansion<2>; 3]) -> [Expansion<16>; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let plus = a[i].times_difference::<4, 8>(&b[j]);
        let minus = a[j].times_difference::<4, 8>(&b[i]);
        plus.plus(&minus.negated())
    })
}

fn slope(direction: [f64; 3], normal: &[Expansion<16>; 3]) -> Expansion<96> {
    let [x, y, z] = [0, 1, 2].map(|i| normal[i].times::<32>(direction[i]));
    x.plus::<32, 64>(&y).plus(&z)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_plane_behind_the_origin_needs_no_edges() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        // The line passes through a corner, in which two edges are zero: f64 alone cannot say that they are.
        let direction = Vec3::new(0.1, 0.3, 0.7);
        let ray = |origin| Ray::towards(origin, direction);
        assert_eq!(decide(&ray(direction), &triangle), (Verdict::Clear, Stage::Double));
        assert_eq!(decide(&ray(-direction), &triangle), (Verdict::Blocked, Stage::Expansion));
        for corners in [[0, 1, 2], [0, 2, 1]] {
            let triangle = corners.map(|corner| triangle[corner]);
            for direction in [direction, -direction] {
                let ray = Ray { direction, ..ray(Vec3::new(0.2, 0.2, 1e-6)) };
                let expected = verdict_by_expansions(&ray, &triangle);
                assert_eq!(verdict(&ray, &triangle), expected);
                assert_eq!(expected == Verdict::Blocked, direction.z < 0.0);
            }
        }
    }
}
