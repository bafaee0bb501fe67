//! A hit counts only where the ray comes near the triangle's own box.
//!
//! f32 tests report hits that are nowhere near the triangle: almost parallel to a sliver, every
//! quantity is rounding noise, and noise has the right signs now and then. An engine that looks at
//! every triangle would see such a hit, one that culls by boxes or voxels would not, and the answer
//! would depend on the engine. So a hit must also pass this test, which is a little wider than any
//! box test of Embree's (its answer lies between "test and own box" and "test alone") and narrower
//! than the culling of every backend here.
//!
//! It runs on hits only, in f64, some 10 ns.

use crate::geometry::{Bounds, Ray, Triangle, is_finite};

/// How far outside the box a ray may pass, in units of the coordinates' rounding: Embree's box tests
/// err by up to 3 ulp in each plane distance, twice, and by another in the reciprocal.
const TOLERANCE: f64 = 16.0 * f32::EPSILON as f64;

/// Whether the segment comes near the box of the triangle, which has none if it is not finite.
pub(super) fn meets(ray: &Ray, triangle: &Triangle) -> bool {
    if !is_finite(triangle) {
        return false;
    }
    let bounds = Bounds::of(*triangle);
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let pad = TOLERANCE * (origin.abs().max_element() + min.abs().max(max.abs()).max_element());
    let (mut enter, mut leave) = (0.0, f64::from(ray.end));
    for axis in 0..3 {
        let (low, high) = (min[axis] - pad - origin[axis], max[axis] + pad - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        enter = a.min(b).max(enter);
        leave = a.max(b).min(leave);
    }
    enter <= leave
}
