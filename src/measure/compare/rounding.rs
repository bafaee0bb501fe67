//! What rounding can do to a triangle's answer, where the order of the roundings is not known.
//!
//! Embree's packets are not modelled bit for bit: lanes part company, boxes are tested as a frustum, and which
//! kernel answers a lane depends on the others. But all of them evaluate the same polynomials in f32, so
//! each result lies within a forward error bound of the exact value. Three fates follow: a triangle surely reported, if
//! it and its box are met by more than the bounds; surely not, if it is missed by more; or either.
//!
//! The quantities are those of Embree's two tests, here in f64, whose own rounding is nothing beside the bounds.
//! With u = 2⁻²⁴, |d|₁ the sum of the direction's magnitudes, c the corners relative to the origin, C their largest
//! coordinate in magnitude, E that of the edges:
//!
//! * default mode (Möller & Trumbore): the bounds of `exact::filter`, derived there;
//! * robust mode (Plücker): the corners are moved to the origin first, so the errors grow with C² and not with E C. A
//!   volume U = d·(e×(v+v')) has terms of nine roundings (two moves, an edge, a sum, two products, a difference,
//!   two sums) and the permanent 8 C² |d|₁. An edge is off by 4uC at most, so the normal by 24uEC, the slope
//!   by 36uEC|d|₁, and the height c·n by 132uEC².
//!
//! Coherent packets are tested against boxes as one frustum, whose error is that of the lane with the largest
//! coordinates and the steepest reciprocals. The lanes are taken to be alike in these, as coherent rays are.
//!
//! All bounds are taken [`CAUTION`] times: once for this evaluation against Embree's, once where the sign of the
//! slope, to which the others are compared, may be wrong too; and twice that again for good measure.

use std::ops::RangeInclusive;

use glam::{DVec3, Vec3Swizzles};

use crate::geometry::intersect::{EMBREE_LARGEST, EMBREE_SMALLEST};
use crate::geometry::{Bounds, Ray, Triangle};

/// How many error bounds away from zero a sign is taken to be the same in any f32 evaluation.
const CAUTION: f64 = 4.0;

/// 10u with u = 2⁻²⁴, as in `exact::filter`.
const ROUNDING: f64 = 5.0 * f32::EPSILON as f64;

/// 2⁻¹²⁵: what underflow may add to a permanent, as in `exact::filter`.
const UNDERFLOW: f64 = 2.0 * f32::MIN_POSITIVE as f64;

/// The error of a quantity whose terms may overflow: its permanent, in f32 and with room for twice the edges.
const OVERFLOW: f64 = ROUNDING * f32::MAX as f64 / 16.0;

/// Slopes whose doubles have reciprocals that are no denormals, and are none themselves: 2⁻¹²⁴ to 2¹²⁴.
const INVERTIBLE: RangeInclusive<f64> =
    4.0 * f32::MIN_POSITIVE as f64..=0.25 / f32::MIN_POSITIVE as f64;

/// Direction components below this are replaced by it.
const SMALLEST_COMPONENT: f64 = EMBREE_SMALLEST as f64;

/// What an engine may say of a triangle, however it rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It reports the triangle.
    Met,
    /// It may report it or not.
    Either,
    /// It does not report it.
    Missed,
}

/// The fate of a triangle in robust scenes of Embree, or in default ones.
pub(super) fn fate(ray: &Ray, triangle: &Triangle, robust: bool) -> Fate {
    let sides = if robust { pluecker(ray, triangle) } else { moller(ray, triangle) };
    match sides.fate() {
        Fate::Met if !box_is_met(ray, &Bounds::of(*triangle)) => Fate::Either,
        fate => fate,
    }
}

/// The quantities that decide, signed so that all are above zero if the triangle is met, and how far off each
/// may be.
struct Sides {
    edges: [f64; 3],
    edge_error: f64,
    slope: f64,
    slope_error: f64,
    /// Whether the test can divide by the slope, if it does.
    has_quotient: bool,
    start: f64,
    start_error: f64,
    stop: f64,
    stop_error: f64,
}

impl Sides {
    fn fate(&self) -> Fate {
        let errors = [self.edge_error, self.start_error, self.stop_error];
        // Not a number, or too large for f32.
        if !errors.iter().all(|error| *error < OVERFLOW) {
            return Fate::Either;
        }
        let [edge_error, start_error, stop_error] = errors.map(|error| CAUTION * error);
        let least = self.edges.into_iter().fold(f64::INFINITY, f64::min);
        let slope_is_sure = self.has_quotient && self.slope > CAUTION * self.slope_error;
        let is_outside = self.start < -start_error || self.stop < -stop_error;
        if least < -edge_error || (slope_is_sure && is_outside) {
            Fate::Missed
        } else if slope_is_sure
            && least > edge_error
            && self.start > start_error
            && self.stop > stop_error
        {
            Fate::Met
        } else {
            Fate::Either
        }
    }
}

/// The corners relative to the origin, and the direction.
fn relative(ray: &Ray, triangle: &Triangle) -> ([DVec3; 3], DVec3) {
    let origin = ray.origin.as_dvec3();
    (triangle.map(|corner| corner.as_dvec3() - origin), ray.direction.as_dvec3())
}

fn sum_of_magnitudes(vector: DVec3) -> f64 {
    vector.abs().element_sum()
}

/// A finite end is the ratio end/1, an infinite one 1/0.
fn ratio(end: f32) -> (f64, f64) {
    if end.is_finite() { (f64::from(end), 1.0) } else { (1.0, 0.0) }
}

fn moller(ray: &Ray, triangle: &Triangle) -> Sides {
    let ([c, c1, c2], direction) = relative(ray, triangle);
    let (e1, e2) = (c - c1, c2 - c);
    let normal = e2.cross(e1);
    let r = c.cross(direction);
    let slope = normal.dot(direction);
    let sign = 1f64.copysign(slope);
    let (u, v) = (sign * r.dot(e2), sign * r.dot(e1));
    let w = slope.abs() - u - v;
    let start = sign * normal.dot(c);
    let (p, q) = ratio(ray.end);

    let size = e1.abs().max(e2.abs()).max_element();
    let area = 4.0 * size * size + UNDERFLOW;
    let along = sum_of_magnitudes(direction);
    let distance = sum_of_magnitudes(c);
    let d = direction.abs();
    let across = 2.0 * (d.yzx() + d.zxy());
    let moment = across.dot(c.abs()) + UNDERFLOW;
    let permanent = size * moment + area * along + UNDERFLOW * (along + 1.0);
    let lever = p * along + q * distance + UNDERFLOW;
    Sides {
        edges: [u, v, w],
        edge_error: ROUNDING * permanent,
        slope: slope.abs(),
        slope_error: ROUNDING * permanent,
        has_quotient: true,
        start,
        start_error: ROUNDING * (area * distance + UNDERFLOW),
        stop: p * slope.abs() - q * start,
        stop_error: ROUNDING * (area * lever + UNDERFLOW * (p + 1.0)),
    }
}

fn pluecker(ray: &Ray, triangle: &Triangle) -> Sides {
    /// The error of the normal times |d|₁ is 36uEC|d|₁; with room for the rounding of the bound, in units of 10u.
    const SLOPE: f64 = 4.0;
    /// 132uEC², likewise.
    const HEIGHT: f64 = 15.0;
    let ([v0, v1, v2], direction) = relative(ray, triangle);
    let (e0, e1, e2) = (v2 - v0, v0 - v1, v1 - v2);
    let normal = e0.cross(e1);
    let slope = normal.dot(direction);
    let sign = 1f64.copysign(slope);
    let volume = |edge: DVec3, sum: DVec3| sign * edge.cross(sum).dot(direction);
    let edges = [volume(e0, v2 + v0), volume(e1, v0 + v1), volume(e2, v1 + v2)];
    let start = sign * normal.dot(v0);
    let (p, q) = ratio(ray.end);

    let far = v0.abs().max(v1.abs()).max(v2.abs()).max_element();
    let size = e0.abs().max(e1.abs()).max(e2.abs()).max_element();
    let along = sum_of_magnitudes(direction);
    let volume_error = ROUNDING * (8.0 * far * far * along + UNDERFLOW * (along + 1.0));
    let slope_error = ROUNDING * (SLOPE * size * far * along + UNDERFLOW * (along + 1.0));
    let start_error = ROUNDING * (HEIGHT * size * far * far + UNDERFLOW * (far + 1.0));
    // The quotient is rounded, and its reciprocal approximate.
    let quotient_error = ROUNDING * (p * slope.abs() + q * start.abs());
    Sides {
        edges,
        // The edges are fat by 2⁻²³ of the sum of the volumes, 48u C² |d|₁ at most: less than the bound once more.
        edge_error: 2.0 * volume_error,
        slope: slope.abs(),
        slope_error,
        // The slope is doubled and inverted, and `rcpps` knows no denormals.
        has_quotient: INVERTIBLE.contains(&slope.abs()),
        start,
        start_error,
        stop: p * slope.abs() - q * start,
        stop_error: p * slope_error + q * start_error + quotient_error,
    }
}

/// Whether the ray passes the box by more than the rounding of Embree's box tests, so that this box and
/// all that hold it are entered.
///
/// The ray passes iff it enters each slab before it leaves any other; that it leaves a slab no earlier than it
/// enters the same is certain even for flat boxes, as rounding is monotone.
fn box_is_met(ray: &Ray, bounds: &Bounds) -> bool {
    if bounds.min.abs().max(bounds.max.abs()).max_element() >= EMBREE_LARGEST {
        return false;
    }
    // Entry and exit with their error; the first is the interval itself, which is not rounded.
    let mut slabs = vec![(0.0, f64::from(ray.end), 0.0)];
    for axis in 0..3 {
        let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
        let (origin, direction) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
        // Reciprocal, difference and product, or two products: below 5u, and then CAUTION.
        let error = ROUNDING * (origin.abs() + low.abs().max(high.abs()));
        if direction.abs() < SMALLEST_COMPONENT {
            // Its sign may be lost or not.
            let inside = (origin - low).min(high - origin) / SMALLEST_COMPONENT;
            slabs.push((-inside, inside, error / SMALLEST_COMPONENT));
        } else {
            let (a, b) = ((low - origin) / direction, (high - origin) / direction);
            slabs.push((a.min(b), a.max(b), error / direction.abs()));
        }
    }
    slabs.iter().enumerate().all(|(i, (enter, _, error))| {
        slabs
            .iter()
            .enumerate()
            .all(|(j, (_, leave, other))| i == j || leave - enter > CAUTION * (error + other))
    })
}
