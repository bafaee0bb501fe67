//! The space in which obvhs culls.
//!
//! obvhs works in f32 with constants that have a unit (`EPSILON` of 1e-4 in the node test of its
//! CWBVH, 1.2e-7 in its inverse), and does not widen its boxes for rounding. So umbra gives it
//! neither the scene's coordinates nor the query's ray: triangles' boxes are mapped in f64 so that
//! the scene fills a unit cube, and padded; the ray is clipped and mapped in f64, normalised, and
//! starts a little before the scene. There the unit is known, and the padding covers every rounding:
//!
//! | error, in units of the cube's side | bound |
//! | --- | --- |
//! | box rounded to f32 | 2⁻²⁴ |
//! | ray origin rounded (coordinates below 2) | 2⁻²⁴ |
//! | plane distance, product with the inverse, inverse itself: 3 roundings of t ≤ 2 | 6 · 2⁻²⁴ |
//! | direction rounded, over t ≤ 2 | 2 · 2⁻²⁴ |
//!
//! Together 10 · 2⁻²⁴ < 2⁻²⁰ = [`PADDING`]. (CWBVH quantises boxes outwards from the padded ones.)

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::ray::Ray as CullingRay;

use super::clip::{Clip, clip, padding};
use crate::geometry::{Bounds, Ray, Triangles, is_finite};

/// See the table above.
const PADDING: f64 = 1.0 / (1 << 20) as f64;

/// The culling ray starts and ends this far outside the clipped segment: beyond the 1e-4 within
/// which obvhs' CWBVH does not see.
const MARGIN: f64 = 1.0 / 64.0;

/// Direction components are kept above this, so that no product with an inverse overflows or is NaN.
const SMALLEST_COMPONENT: DVec3 = DVec3::splat(1e-30);

/// Maps scene coordinates to the unit cube.
pub(super) struct CullingSpace {
    min: DVec3,
    max: DVec3,
    scale: f64,
    pad: f64,
}

/// A ray in culling space, and how to take `t` there.
pub(super) struct Culled {
    pub ray: CullingRay,
    start: f64,
    length: f64,
}

pub(super) enum Passage {
    Outside,
    Through(Culled),
    Everything,
}

impl CullingSpace {
    /// The space of some triangles; of none, that of a point.
    pub(super) fn new(triangles: &Triangles) -> Self {
        let bounds = &triangles.bounds().unwrap_or_default();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let side = (max - min).max_element();
        let pad = padding(bounds, PADDING * side);
        Self { min: min - pad, max: max + pad, scale: (side + 2.0 * pad).recip(), pad }
    }

    /// The padded boxes of all triangles in culling space.
    pub(super) fn boxes(&self, triangles: &Triangles) -> Vec<Aabb> {
        // What is not finite blocks nothing; any box does.
        let nowhere = Bounds { min: self.min.as_vec3(), max: self.min.as_vec3() };
        let bounds = |id| {
            let triangle = triangles.get(id);
            if is_finite(&triangle) { Bounds::of(triangle) } else { nowhere }
        };
        (0..triangles.len() as u32).map(|id| self.map(&bounds(id))).collect()
    }

    /// The padded box in culling space.
    fn map(&self, bounds: &Bounds) -> Aabb {
        let place = |corner: DVec3| Vec3A::from(((corner - self.min) * self.scale).as_vec3());
        Aabb {
            min: place(bounds.min.as_dvec3() - self.pad),
            max: place(bounds.max.as_dvec3() + self.pad),
        }
    }

    #[inline]
    pub(super) fn passage(&self, ray: &Ray) -> Passage {
        let (enter, leave) = match clip(ray, self.min, self.max) {
            Clip::Outside => return Passage::Outside,
            Clip::Everything => return Passage::Everything,
            Clip::Inside(enter, leave) => (enter, leave),
        };
        let direction = ray.direction.as_dvec3() * self.scale;
        // Length in culling space of a unit of t.
        let length = direction.length();
        let unit = direction / length;
        let origin = (ray.at(enter) - self.min) * self.scale - MARGIN * unit;
        // Such a component displaces the ray by nothing. Its sign is set too: obvhs takes the order of
        // children from the signs of the direction, and -0 would contradict its inverse.
        let unit = DVec3::select(unit.abs().cmplt(SMALLEST_COMPONENT), SMALLEST_COMPONENT, unit);
        let ray = CullingRay {
            origin: Vec3A::from(origin.as_vec3()),
            direction: Vec3A::from(unit.as_vec3()),
            inv_direction: Vec3A::from(unit.recip().as_vec3()),
            tmin: 0.0,
            tmax: ((leave - enter) * length + 2.0 * MARGIN) as f32,
        };
        Passage::Through(Culled { ray, start: enter, length })
    }
}

impl Culled {
    /// Where a walk may end once nothing beyond `end` is of interest.
    #[inline]
    pub(super) fn limit(&self, end: f32) -> f32 {
        ((f64::from(end) - self.start) * self.length + 2.0 * MARGIN) as f32
    }
}
