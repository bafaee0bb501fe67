//! The space in which obvhs culls.
//!
//! obvhs works in f32 with constants that have a unit (`EPSILON` of 1e-4 in the node test of its
//! CWBVH, 1.2e-7 in its inverse), and does not widen its boxes for rounding. So umbra gives it
//! neither the scene's coordinates nor the query's ray: triangles' boxes are mapped in f64 so that
//! the scene fills a unit cube, and padded; the ray is clipped and mapped in f64, normalised, and
//! starts a little before the scene. There the unit is known. The padding is 64 roundings of the largest coordinate (`clip`), of which a
//! ray may be 48 beside a triangle that it meets. The other 16 are 2⁻¹⁹ of that coordinate, and as no side is longer
//! than two of it, almost 16u of the cube's side, with u = 2⁻²⁴. They cover every rounding:
//!
//! | error, in units of the cube's side | bound |
//! | --- | --- |
//! | box rounded to f32 | 1u |
//! | ray origin rounded (coordinates below 2) | 1u |
//! | BVH2: plane distance, product with the inverse, inverse itself: 3 roundings of t ≤ 2 | 6u |
//! | CWBVH: plane in the node 2u, the node's corner 3u, each of at most 1.1; their sum, of t ≤ 2: 2u | 8u |
//! | direction rounded, over t ≤ 2 | 2u |
//!
//! Together 10u in a BVH2, and 13u in a CWBVH, which quantises boxes outwards from the padded ones, with one more rounding.

use std::collections::HashSet;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::ray::Ray as CullingRay;
use rayon::prelude::*;

use super::Visit;
use super::brute::visit_all;
use super::clip::{Clip, clip, padding};
use crate::geometry::random::scattered;
use crate::geometry::{Bounds, Ray, TriangleId, Triangles, is_finite};

/// The culling ray starts and ends this far outside the clipped segment: beyond the 1e-4 within
/// which obvhs' CWBVH does not see.
const MARGIN: f64 = 1.0 / 64.0;

/// Direction components are kept above this, so that no product with an inverse overflows or is NaN.
const SMALLEST_COMPONENT: DVec3 = DVec3::splat(1e-30);

/// Triangles that a visitor is shown at once where nothing is culled: as many as its tests are wide.
const SHOWN_AT_ONCE: u32 = 8;

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

impl CullingSpace {
    /// The space of some triangles; of none, that of a point.
    pub(super) fn new(triangles: &Triangles) -> Self {
        let bounds = &triangles.bounds().unwrap_or_default();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let side = (max - min).max_element();
        let pad = padding(bounds, 0.0);
        Self { min: min - pad, max: max + pad, scale: (side + 2.0 * pad).recip(), pad }
    }

    /// The padded boxes of all triangles in culling space.
    pub(super) fn boxes(&self, triangles: &Triangles) -> Vec<Aabb> {
        // What is not finite blocks nothing; any box does.
        let nowhere = Aabb { min: Vec3A::ZERO, max: Vec3A::ZERO };
        let place = |id| {
            let triangle = triangles.get(id);
            if is_finite(&triangle) { self.map(&Bounds::of(triangle)) } else { nowhere }
        };
        let mut boxes: Vec<_> = (0..triangles.len() as u32).map(place).collect();
        spread_copies(&mut boxes);
        boxes
    }

    /// The padded box in culling space.
    fn map(&self, bounds: &Bounds) -> Aabb {
        let place = |corner: DVec3| Vec3A::from(((corner - self.min) * self.scale).as_vec3());
        Aabb {
            min: place(bounds.min.as_dvec3() - self.pad),
            max: place(bounds.max.as_dvec3() + self.pad),
        }
    }

    /// The ray in this space, to walk a tree over triangles in this order. None where nothing is left to walk: the ray passes beside
    /// all of them, or comes from so far away that the visitor was shown all of them.
    #[inline(always)]
    pub(super) fn enter<V: Visit + ?Sized>(
        &self,
        ray: &Ray,
        order: &[TriangleId],
        visitor: &mut V,
    ) -> Option<Culled> {
        match clip(ray, self.min, self.max) {
            Clip::Outside => None,
            Clip::Everything => {
                visit_all(order, SHOWN_AT_ONCE, visitor);
                None
            }
            Clip::Inside(enter, leave) => Some(self.culled(ray, enter, leave)),
        }
    }

    /// The ray between two places of it.
    #[inline]
    fn culled(&self, ray: &Ray, enter: f64, leave: f64) -> Culled {
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
        Culled { ray, start: enter, length }
    }
}

impl Culled {
    /// Where a walk may end once nothing beyond `end` is of interest.
    #[inline]
    pub(super) fn limit(&self, end: f32) -> f32 {
        ((f64::from(end) - self.start) * self.length + 2.0 * MARGIN) as f32
    }
}

/// Widens boxes that are alike, each to another side, where there are very many: obvhs makes a chain of them, as deep as
/// there are copies, in a time that grows with their square.
fn spread_copies(boxes: &mut [Aabb]) {
    /// So many copies are no trouble.
    const FEW: usize = 64;
    /// How much wider, in sides of the cube: enough that thousands of copies differ after rounding.
    const SPREAD: f32 = 1.0 / 1024.0;

    let mut keys: Vec<u64> = boxes.iter().map(key).collect();
    keys.par_sort_unstable();
    let many: HashSet<u64> =
        keys.chunk_by(|a, b| a == b).filter(|run| run.len() > FEW).map(|run| run[0]).collect();
    if many.is_empty() {
        return;
    }
    for (id, bounds) in boxes.iter_mut().enumerate() {
        if many.contains(&key(bounds)) {
            let bits = scattered(id as u64);
            let part = |shift: u32| ((bits >> shift) & 0xffff) as f32 / 65536.0;
            let low = Vec3A::new(part(0), part(16), part(32));
            bounds.min -= SPREAD * low;
            bounds.max += SPREAD * (Vec3A::ONE - low);
        }
    }
}

/// A number that boxes which are alike share.
fn key(bounds: &Aabb) -> u64 {
    let corners = [bounds.min.to_array(), bounds.max.to_array()];
    corners.as_flattened().iter().fold(0, |key, value| scattered(key ^ u64::from(value.to_bits())))
}
