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
//! [`ERROR_BOUND`] = 10u times the computed permanent is sound. Nothing can underflow (the smallest product of four f32
//! is 2⁻⁵⁹⁶) or overflow, and fusing multiplications with additions could only remove roundings.
//!
//! Source of the method: Shewchuk (see `expansion`); the permanents are those of his `orient3d` filter.

use super::expansion::{Expansion, difference};
use super::oracle::Verdict;
use crate::geometry::{Ray, Triangle};

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
    let edges = doubles.edges();
    if edges.contains(&Some(-1)) && edges.contains(&Some(1)) {
        return (Verdict::Clear, Stage::Double);
    }
    if let [Some(first), Some(second), Some(third)] = edges
        && ray.end > 0.0
    {
        let settled = settle([first, second, third], || doubles.interval());
        if let Some(verdict) = settled {
            return (verdict, Stage::Double);
        }
    }
    (verdict_by_expansions(ray, triangle), Stage::Expansion)
}

/// The verdict by exact expansions alone.
#[must_use]
pub fn verdict_by_expansions(ray: &Ray, triangle: &Triangle) -> Verdict {
    if !ray.is_valid() || !triangle.iter().all(|corner| corner.is_finite()) {
        return Verdict::Clear;
    }
    let exact = Expansions::new(ray, triangle);
    settle(exact.edges(), || Some(exact.interval())).expect("expansions have a sign")
}

/// The verdict from the signs of the edges, and if needed those of start and stop; `None` without the latter.
fn settle(edges: [i8; 3], interval: impl FnOnce() -> Option<[i8; 2]>) -> Option<Verdict> {
    let (least, greatest) = (edges.into_iter().min()?, edges.into_iter().max()?);
    let slope = least + greatest;
    if least * greatest < 0 || slope == 0 {
        return Some(Verdict::Clear);
    }
    let [start, stop] = interval()?.map(|sign| sign * slope.signum());
    Some(match start.min(stop) {
        1 => Verdict::Blocked,
        0 => Verdict::Tie,
        _ => Verdict::Clear,
    })
}

/// The quantities in f64.
struct Doubles {
    corners: [[f64; 3]; 3],
    direction: [f64; 3],
    sides: [[f64; 3]; 2],
    end: f64,
}

impl Doubles {
    #[inline]
    fn new(ray: &Ray, triangle: &Triangle) -> Self {
        let wide = |v: glam::Vec3| v.to_array().map(f64::from);
        let (origin, [a, b, c]) = (wide(ray.origin), triangle.map(wide));
        Self {
            corners: [a, b, c].map(|corner| minus(corner, origin)),
            direction: wide(ray.direction),
            sides: [minus(b, a), minus(c, a)],
            end: f64::from(ray.end),
        }
    }

    /// The signs of the edges, where certain.
    #[inline]
    fn edges(&self) -> [Option<i8>; 3] {
        let moments = self.corners.map(|corner| Bounded::cross(self.direction, corner));
        [(0, 1), (1, 2), (2, 0)].map(|(from, to)| moments[from].dot(self.corners[to]).sign())
    }

    /// The signs of start and stop, if both are certain.
    #[inline]
    fn interval(&self) -> Option<[i8; 2]> {
        let normal = Bounded::cross(self.sides[0], self.sides[1]);
        let start = normal.dot(self.corners[0]);
        let slope = normal.dot(self.direction);
        let stop = if self.end < f64::INFINITY {
            Bounded {
                value: self.end * slope.value - start.value,
                permanent: self.end * slope.permanent + start.permanent,
            }
        } else {
            slope
        };
        Some([start.sign()?, stop.sign()?])
    }
}

/// A rounded value with its permanent.
#[derive(Clone, Copy)]
struct Bounded<T> {
    value: T,
    permanent: T,
}

impl Bounded<[f64; 3]> {
    #[inline]
    fn cross(a: [f64; 3], b: [f64; 3]) -> Self {
        let products = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (a[i] * b[j], a[j] * b[i]));
        Self {
            value: products.map(|(plus, minus)| plus - minus),
            permanent: products.map(|(plus, minus)| plus.abs() + minus.abs()),
        }
    }

    #[inline]
    fn dot(&self, b: [f64; 3]) -> Bounded<f64> {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        Bounded { value: dot(self.value, b), permanent: dot(self.permanent, b.map(f64::abs)) }
    }
}

impl Bounded<f64> {
    /// The sign of the exact value, if certain. Never so with infinities or NaN.
    #[inline]
    fn sign(self) -> Option<i8> {
        let error = ERROR_BOUND * self.permanent;
        if self.value > error {
            Some(1)
        } else if self.value < -error {
            Some(-1)
        } else {
            // All terms are zero.
            (self.permanent == 0.0).then_some(0)
        }
    }
}

#[inline]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
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

    fn edges(&self) -> [i8; 3] {
        let [a, b, c] = &self.corners;
        [(a, b), (b, c), (c, a)].map(|(from, to)| slope(self.direction, &cross(from, to)).sign())
    }

    fn interval(&self) -> [i8; 2] {
        let normal = cross(&self.sides[0], &self.sides[1]);
        let [x, y, z] =
            [0, 1, 2].map(|i| normal[i].times_difference::<32, 64>(&self.corners[0][i]));
        let start: Expansion<192> = x.plus::<64, 128>(&y).plus(&z);
        let slope = slope(self.direction, &normal);
        let stop = if self.end < f64::INFINITY {
            slope.times::<192>(self.end).plus::<192, 384>(&start.negated()).sign()
        } else {
            slope.sign()
        };
        [start.sign(), stop]
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
