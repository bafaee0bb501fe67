//! The nearest hit, for rays that see rather than ask.

use crate::geometry::{Ray, Triangle, TriangleId};

/// Where a ray first meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The triangle.
    pub triangle: TriangleId,
    /// Distance in units of the ray's direction.
    pub t: f64,
}

/// Distance along the ray to the triangle's plane, in f64; `None` behind the origin or if parallel.
#[inline]
pub(super) fn distance(ray: &Ray, &[a, b, c]: &Triangle) -> Option<f64> {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a - ray.origin.as_dvec3()) / normal.dot(ray.direction.as_dvec3());
    (t > 0.0 && t.is_finite()).then_some(t)
}
