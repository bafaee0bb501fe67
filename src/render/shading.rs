//! Where a ray met a surface, and what the surface does with light.

use glam::{DVec3, Vec3};

use crate::geometry::{Ray, Triangle};
use crate::occlusion::Nearest;
use crate::scene::{Illumination, Material, Scene};

/// The origin of a secondary ray is this far off its surface, in units of the scene's largest
/// coordinate: 2⁻¹⁸, some 32 roundings of a position, so that the rounded origin lies strictly on the
/// side it was moved to, and far below what can be seen.
const OFFSET: f64 = 1.0 / (1 << 18) as f64;

/// A point of a surface, seen along a ray.
pub(super) struct Surface {
    pub point: DVec3,
    /// Unit normal of the triangle, towards the side the ray came from.
    pub normal: DVec3,
    /// Unit normal for shading, on the same side.
    pub shading_normal: Vec3,
    /// Unit direction of the ray that sees it.
    pub incoming: Vec3,
    /// Whether the ray came from the side that the corners wind counter-clockwise on.
    pub front: bool,
    /// Length of the offset.
    offset: f64,
}

/// How far origins are moved off surfaces, for a scene.
pub(super) fn offset_of(scene: &Scene) -> f64 {
    let bounds = scene.bounds();
    OFFSET * f64::from(bounds.min.abs().max(bounds.max.abs()).max_element())
}

impl Surface {
    pub(super) fn new(scene: &Scene, ray: &Ray, hit: &Nearest, offset: f64) -> Self {
        let triangle = scene.triangles.get(hit.triangle);
        let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
        let incoming = ray.direction.as_dvec3().normalize();
        let outward = (b - a).cross(c - a).normalize();
        let front = outward.dot(incoming) <= 0.0;
        let normal = if front { outward } else { -outward };
        let point = ray.at(hit.t);
        let flat = normal.as_vec3();
        let smooth =
            scene.normals.get(hit.triangle as usize).filter(|normals| normals[0] != Vec3::ZERO);
        let shading_normal = smooth.map_or(flat, |normals| {
            let smooth = interpolate(&triangle, normals, point);
            let smooth = if smooth.dot(flat) < 0.0 { -smooth } else { smooth };
            // A shading normal that faces away from the eye would reflect into the surface.
            if smooth.dot(incoming.as_vec3()) < 0.0 { smooth } else { flat }
        });
        Self { point, normal, shading_normal, incoming: incoming.as_vec3(), front, offset }
    }

    /// An origin on the side the surface is seen from.
    pub(super) fn origin_above(&self) -> Vec3 {
        (self.point + self.offset * self.normal).as_vec3()
    }

    /// An origin on the far side.
    pub(super) fn origin_below(&self) -> Vec3 {
        (self.point - self.offset * self.normal).as_vec3()
    }

    /// Whether light from this direction falls on the side that is seen.
    pub(super) fn faces(&self, light: &Illumination) -> bool {
        self.normal.dot(light.direction.as_dvec3()) > 0.0
            && self.shading_normal.dot(light.direction) > 0.0
    }

    /// Radiance towards the eye from one light, shadows apart.
    pub(super) fn shade(&self, material: &Material, light: &Illumination) -> Vec3 {
        let cosine = self.shading_normal.dot(light.direction);
        let diffuse = material.diffuse * (cosine * std::f32::consts::FRAC_1_PI);
        if material.highlight == Vec3::ZERO {
            return light.irradiance * diffuse;
        }
        let mirrored = self.incoming.reflect(self.shading_normal);
        let highlight = mirrored.dot(light.direction).max(0.0).powf(material.shininess);
        light.irradiance * (diffuse + material.highlight * highlight)
    }

    /// Direction of the mirrored ray; on the seen side even where the shading normal would point below.
    pub(super) fn reflected(&self) -> Vec3 {
        let mirrored = self.incoming.reflect(self.shading_normal);
        let flat = self.normal.as_vec3();
        if mirrored.dot(flat) > 0.0 { mirrored } else { self.incoming.reflect(flat) }
    }

    /// Direction of the refracted ray, and the share of light that is reflected instead (Fresnel's
    /// equations, unpolarised); `None` where all of it is.
    pub(super) fn refracted(&self, material: &Material) -> Option<(Vec3, f32)> {
        let index = material.refraction_index;
        if index == 1.0 {
            return Some((self.incoming, 0.0));
        }
        let ratio = if self.front { index.recip() } else { index };
        let cosine = -self.incoming.dot(self.shading_normal);
        let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        if squared <= 0.0 {
            return None;
        }
        let inner = squared.sqrt();
        let direction = ratio * self.incoming + (ratio * cosine - inner) * self.shading_normal;
        let parallel = (cosine - ratio * inner) / (cosine + ratio * inner);
        let perpendicular = (ratio * cosine - inner) / (ratio * cosine + inner);
        let reflected = 0.5 * (parallel * parallel + perpendicular * perpendicular);
        let flat = self.normal.as_vec3();
        let below = if direction.dot(flat) < 0.0 { direction } else { self.incoming };
        Some((below, reflected))
    }

    /// Mirror reflectance at this angle (Schlick 1994).
    pub(super) fn reflectance(&self, material: &Material) -> Vec3 {
        if material.reflection == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let grazing = (1.0 + self.incoming.dot(self.shading_normal)).clamp(0.0, 1.0).powi(5);
        material.reflection + (Vec3::ONE - material.reflection) * grazing
    }
}

/// The corners' normals, weighted by the barycentric coordinates of a point in the triangle.
fn interpolate(triangle: &Triangle, normals: &[Vec3; 3], point: DVec3) -> Vec3 {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let area = (b - a).cross(c - a);
    let weight = |p: DVec3, q: DVec3| {
        ((p - point).cross(q - point).dot(area) / area.length_squared()) as f32
    };
    let (u, v) = (weight(c, a), weight(a, b));
    ((1.0 - u - v) * normals[0] + u * normals[1] + v * normals[2])
        .normalize_or(area.normalize().as_vec3())
}
