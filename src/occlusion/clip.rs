//! The part of a ray that is near a box, in f64.

use glam::DVec3;

use crate::geometry::{Bounds, Ray};

/// Origins farther from the box than this many diagonals are not clipped but answered by testing
/// everything: f64 places them with a relative error of 2⁻⁵², which is 2⁻³² diagonals at this
/// distance, far below the padding of any culler.
const FARTHEST_ORIGIN: f64 = (1u64 << 20) as f64;

/// A scene that is one point needs some room too: far below the least f32, and its cube is no zero.
pub(super) const LEAST_EXTENT: f64 = 1e-60;

/// How a ray passes a box.
pub(crate) enum Clip {
    /// It does not come near it.
    Outside,
    /// It is near it from the first to the second `t`; both finite.
    Inside(f64, f64),
    /// The origin is too far away to say.
    Everything,
}

/// Clips the segment to the box, which the caller has padded.
#[inline]
pub(super) fn clip(ray: &Ray, min: DVec3, max: DVec3) -> Clip {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    // It is a point. What that lies on has a plane that contains it, and so is not blocked by it.
    if direction == DVec3::ZERO {
        return Clip::Outside;
    }
    let reach = FARTHEST_ORIGIN * (max - min).max_element();
    if (origin - min).abs().max_element() > reach {
        return Clip::Everything;
    }
    let (mut enter, mut leave) = (0.0, f64::from(ray.end));
    for axis in 0..3 {
        let (low, high) = (min[axis] - origin[axis], max[axis] - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return Clip::Outside;
            }
            continue;
        }
        let inverse = direction[axis].recip();
        let (a, b) = (low * inverse, high * inverse);
        enter = a.min(b).max(enter);
        leave = a.max(b).min(leave);
    }
    if enter <= leave { Clip::Inside(enter, leave) } else { Clip::Outside }
}

/// How far a culler must look beyond exact geometry: so much for its own resolution, and at least
/// what f32 tests may err by on coordinates of this size.
pub(super) fn padding(bounds: &Bounds, resolution: f64) -> f64 {
    /// Hits of tests that round count within 48 roundings of a triangle (`Triangles::slack`); a third more.
    const ROUNDINGS: f64 = 64.0 * f32::EPSILON as f64;
    resolution.max(ROUNDINGS * f64::from(bounds.largest_coordinate())).max(LEAST_EXTENT)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_ray_without_direction_is_outside_wherever_it_starts() {
        for origin in [Vec3::ZERO, Vec3::ONE, Vec3::splat(7.0), Vec3::splat(1e30)] {
            for ray in [Ray::between(origin, origin), Ray::towards(origin, -Vec3::ZERO)] {
                assert!(matches!(clip(&ray, DVec3::NEG_ONE, DVec3::ONE), Clip::Outside), "{ray:?}");
            }
        }
    }
}
