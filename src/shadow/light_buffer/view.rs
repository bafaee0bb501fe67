//! What a light sees: a cube around a point light, a parallel grid for a directional one.
//!
//! A place in the view is a face, `u` and `v` from −1 to 1 on it, and a depth that grows away from the
//! light: on a face of the cube the distance along its axis, in the parallel grid that along the
//! direction. All points of a shadow ray have the face, `u` and `v` of its origin, and lesser depths; but
//! for rounding, and that is what `pad` is for: whatever lies within `pad` of a triangle counts as its.
//!
//! **Rounding.** A ray towards a point light has the direction fl(L − P), each coordinate of which is
//! off by 2⁻²⁴ of itself. So its points stray from the line through P and L by at most 2⁻²⁴ times the
//! reach, whatever their depth. Projecting in f32 errs by another three roundings of the point,
//! and tests in f32 may call a hit what lies 2⁻¹⁹ of the coordinates beside the triangle
//! (`occlusion::clip::padding` has the reasons): `pad` is four times that.

use glam::{DVec3, Vec3};

use crate::geometry::{Bounds, Ray};
use crate::scene::Light;

/// Where a point is in the view of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub face: usize,
    pub u: f32,
    pub v: f32,
    pub depth: f32,
}

/// Most that `u` and `v` of a query err by for reasons that do not shrink with distance: two roundings, and
/// as much for the choice of the face. 2⁻²⁰ pays for 8 of them.
pub(super) const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// Part of the largest coordinate that `pad` is.
const PAD: f64 = 1.0 / (1 << 17) as f64;

/// Nothing nearer to a point light than this many pads is projected: at that depth the padding is a sixteenth.
const NEAR_PADS: f32 = 16.0;

/// The view of one light.
#[derive(Clone, Debug)]
pub(super) enum View {
    Cube { light: Vec3 },
    Parallel { direction: Vec3, centre: Vec3, across: [Vec3; 2], along: Vec3, half: f32 },
}

/// A view, and how careful it has to be.
#[derive(Clone, Debug)]
pub(super) struct LightView {
    pub view: View,
    pub pad: f32,
    /// Of the cube: clusters that come nearer than this are not projected.
    pub near: f32,
    /// Queries from farther away, by any axis, are not answered.
    reach: f32,
}

impl LightView {
    pub fn new(light: &Light, scene: &Bounds) -> Option<Self> {
        let largest = |place: DVec3| {
            let corner = scene.min.abs().max(scene.max.abs()).as_dvec3().max(place.abs());
            corner.max_element()
        };
        let (view, pad, reach) = match *light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                let (low, high) = (scene.min.as_dvec3(), scene.max.as_dvec3());
                let reach = (position - low).abs().max((high - position).abs()).max_element();
                let view = View::Cube { light: position.as_vec3() };
                (view, PAD * largest(position).max(reach), 1.01 * reach)
            }
            Light::Directional { direction, .. } => {
                let rounded = direction.as_vec3();
                let along = rounded.as_dvec3().normalize();
                let across = along.any_orthonormal_pair();
                let half = 0.5 * scene.diagonal();
                let pad = PAD * largest(DVec3::ZERO);
                let view = View::Parallel {
                    direction: rounded,
                    centre: scene.centre().as_vec3(),
                    across: [across.0.as_vec3(), across.1.as_vec3()],
                    along: along.as_vec3(),
                    half: (half + 4.0 * pad) as f32,
                };
                // A query errs by some roundings of its way from the centre, and of that which its ray goes, as what is across is
                // rounded too: within twice the scene, by less than half of what is padded.
                (view, pad, 2.0 * half)
            }
        };
        let (pad, reach) = (pad as f32, reach as f32);
        // Beyond this, squares of coordinates overflow; below, they vanish.
        let sound = (1e-15..1e15).contains(&pad);
        sound.then_some(Self { view, pad, near: NEAR_PADS * pad, reach })
    }

    pub fn faces(&self) -> usize {
        match self.view {
            View::Cube { .. } => 6,
            View::Parallel { .. } => 1,
        }
    }

    /// Where the ray's origin is; `None` if the ray is not one to this light, or comes from too far away.
    #[inline(always)]
    pub fn place(&self, ray: &Ray) -> Option<Place> {
        match &self.view {
            View::Cube { light } => {
                let to_light = *light - ray.origin;
                if to_light != ray.direction || ray.end != 1.0 {
                    return None;
                }
                let from = -to_light;
                let magnitude = from.abs();
                let depth = magnitude.max_element();
                if !(depth <= self.reach && depth > 0.0) {
                    return None;
                }
                let axis = if magnitude.x == depth {
                    0
                } else if magnitude.y == depth {
                    1
                } else {
                    2
                };
                let (u, v) = match axis {
                    0 => (from.y, from.z),
                    1 => (from.z, from.x),
                    _ => (from.x, from.y),
                };
                let inverse = depth.recip();
                let face = 2 * axis + usize::from(from[axis] < 0.0);
                Some(Place { face, u: u * inverse, v: v * inverse, depth })
            }
            View::Parallel { direction, centre, across, along, half } => {
                if ray.direction != *direction || ray.end != f32::INFINITY {
                    return None;
                }
                let from = ray.origin - *centre;
                // Not so if it is no number.
                if !from.abs().cmple(Vec3::splat(self.reach)).all() {
                    return None;
                }
                let inverse = half.recip();
                let (u, v) = (across[0].dot(from) * inverse, across[1].dot(from) * inverse);
                Some(Place { face: 0, u, v, depth: half - along.dot(from) })
            }
        }
    }

    /// A point in the coordinates of a face: two across, then the depth; not divided by it.
    #[inline(always)]
    pub fn across(&self, face: usize, point: Vec3) -> Vec3 {
        match &self.view {
            View::Cube { light } => {
                let from = point - *light;
                let rotated = match face / 2 {
                    0 => Vec3::new(from.y, from.z, from.x),
                    1 => Vec3::new(from.z, from.x, from.y),
                    _ => from,
                };
                if face & 1 == 0 { rotated } else { Vec3::new(rotated.x, rotated.y, -rotated.z) }
            }
            View::Parallel { centre, across, along, half, .. } => {
                let from = point - *centre;
                Vec3::new(across[0].dot(from), across[1].dot(from), *half - along.dot(from))
            }
        }
    }
}
