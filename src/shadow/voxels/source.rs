//! A light as proofs need it: where the rays towards it end, rounding included.
//!
//! A shadow ray is given by its origin P and the rounded direction fl(L − P): it ends at P + fl(L − P), not
//! at L. The two differ by half a unit in the last place of each difference at most, and what is proven
//! must hold for every such end. So a point light is a small box. The rays towards a directional light
//! all have the same direction, bit for bit.

use glam::{DVec3, Vec3};

use super::Span;
use crate::geometry::{Bounds, Ray};
use crate::scene::Light;

/// Half a unit in the last place of a difference is at most this share of it; doubled, for the
/// rounding of what is computed from it.
const ENDS: f64 = f32::EPSILON as f64;

/// What f64 may lose of coordinates, many times over.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;

/// Origins may be this share of the scene's diagonal outside its box: those offset from its surface are.
const MARGIN: f64 = 1.0 / 16.0;

/// The place or direction of a light, and the origins that it is prepared for.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// As it is in rays.
    place: Vec3,
    is_point: bool,
    /// How far from `place` a ray may end, along each axis; nothing for a direction.
    slack: DVec3,
    /// Origins that it is prepared for.
    origins: Span,
    /// A vector towards a directional light that leaves the scene from wherever in `origins`.
    beyond: DVec3,
}

impl Source {
    /// `None` for a light that no valid ray goes to.
    pub fn new(light: &Light, scene: &Bounds) -> Option<Self> {
        let (place, is_point) = match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                (position.as_vec3(), true)
            }
            Light::Directional { direction, .. } => (direction.as_vec3(), false),
        };
        let diagonal = scene.diagonal();
        let margin = diagonal * MARGIN;
        let origins =
            Span { low: scene.min.as_dvec3() - margin, high: scene.max.as_dvec3() + margin };
        let wide = place.as_dvec3();
        if !wide.is_finite() || diagonal <= 0.0 || (!is_point && place == Vec3::ZERO) {
            return None;
        }
        let (slack, beyond) = if is_point {
            let farthest = (wide - origins.low).abs().max((wide - origins.high).abs());
            let largest = origins.low.abs().max(origins.high.abs()).max(wide.abs());
            (farthest * ENDS + largest.max_element() * ROUNDING, DVec3::ZERO)
        } else {
            (DVec3::ZERO, wide * (4.0 * (diagonal + margin) / wide.length()))
        };
        Some(Self { place, is_point, slack, origins, beyond })
    }

    /// Whether this is a ray towards the light that what is prepared for it holds for.
    #[inline]
    pub fn is_aimed_at(&self, ray: &Ray) -> bool {
        let aimed = if self.is_point {
            ray.end == 1.0 && ray.direction == self.place - ray.origin
        } else {
            ray.end == f32::INFINITY && ray.direction == self.place
        };
        aimed && self.origins.contains(ray.origin.as_dvec3())
    }

    /// The way from a point to it, and how far along each axis rays may end off it.
    #[inline]
    pub fn towards(&self, point: DVec3) -> (DVec3, DVec3) {
        match self.is_point {
            true => (self.place.as_dvec3() - point, self.slack),
            false => (self.place.as_dvec3(), DVec3::ZERO),
        }
    }

    /// A ray towards it.
    pub fn ray_from(&self, origin: Vec3) -> Ray {
        match self.is_point {
            true => Ray::between(origin, self.place),
            false => Ray::towards(origin, self.place),
        }
    }

    /// Where rays from `near` end, or have left the scene.
    pub fn ends_from(&self, near: &Span) -> Span {
        match self.is_point {
            true => Span {
                low: self.place.as_dvec3() - self.slack,
                high: self.place.as_dvec3() + self.slack,
            },
            false => Span { low: near.low + self.beyond, high: near.high + self.beyond },
        }
    }
}
