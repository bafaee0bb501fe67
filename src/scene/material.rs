//! How a surface answers light.

use glam::Vec3;

/// A Whitted material: diffuse, mirror-like, transparent; each as a colour from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file.
    pub name: String,
    /// Diffuse albedo.
    pub diffuse: Vec3,
    /// Mirror reflectance at normal incidence; rises to 1 at grazing incidence (Schlick 1994).
    pub reflection: Vec3,
    /// Share of light that passes the surface; anything above zero makes it a transparent occluder,
    /// which attenuates shadow rays by this colour.
    pub transmission: Vec3,
    /// Index of refraction inside; 1 for a thin sheet, which does not bend rays.
    pub refraction_index: f32,
    /// Colour of the Phong highlight of lights.
    pub highlight: Vec3,
    /// Exponent of that highlight.
    pub shininess: f32,
    /// Light the surface sends out by itself; it is seen, but lights nothing.
    pub emission: Vec3,
}

impl Default for Material {
    /// Plain grey.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            diffuse: Vec3::splat(0.7),
            reflection: Vec3::ZERO,
            transmission: Vec3::ZERO,
            refraction_index: 1.0,
            highlight: Vec3::ZERO,
            shininess: 1.0,
            emission: Vec3::ZERO,
        }
    }
}

impl Material {
    /// Whether light passes.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        self.transmission != Vec3::ZERO
    }

    /// Whether rays are reflected or refracted, so that rendering recurses.
    #[must_use]
    pub fn is_specular(&self) -> bool {
        self.reflection != Vec3::ZERO || self.is_transparent()
    }
}
