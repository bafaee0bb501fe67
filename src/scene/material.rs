//! How a surface answers light.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A Whitted material: diffuse, mirror-like, transparent; each as a colour from 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Material {
    /// Name in the file.
    #[serde(skip)]
    pub name: String,
    /// Diffuse albedo.
    #[serde(with = "colour")]
    pub diffuse: Vec3,
    /// Mirror reflectance at normal incidence; rises to 1 at grazing incidence (Schlick 1994).
    #[serde(with = "colour")]
    pub reflection: Vec3,
    /// Share of light that passes the surface; anything above zero makes it a transparent occluder,
    /// which attenuates shadow rays by this colour.
    #[serde(with = "colour")]
    pub transmission: Vec3,
    /// Index of refraction inside; 1 for a thin sheet, which does not bend rays.
    pub refraction_index: f32,
    /// Colour of the Phong highlight of lights.
    #[serde(with = "colour")]
    pub highlight: Vec3,
    /// Exponent of that highlight.
    pub shininess: f32,
    /// Light the surface sends out by itself; it is seen, but lights nothing.
    #[serde(with = "colour")]
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

    /// The same material with every number as a description may give it: shares from 0 to 1, an index of refraction
    /// from 1 up, the others neither negative nor infinite.
    #[must_use]
    pub(super) fn clamped(&self) -> Self {
        let share = |colour: Vec3| colour.max(Vec3::ZERO).min(Vec3::ONE);
        let brightness = |colour: Vec3| colour.max(Vec3::ZERO).min(Vec3::splat(f32::MAX));
        let at_least = |least: f32, number: f32| number.max(least).min(f32::MAX);
        Self {
            name: self.name.clone(),
            diffuse: brightness(self.diffuse),
            reflection: share(self.reflection),
            transmission: share(self.transmission),
            refraction_index: at_least(1.0, self.refraction_index),
            highlight: brightness(self.highlight),
            shininess: at_least(0.0, self.shininess),
            emission: brightness(self.emission),
        }
    }

    /// Whether rays are reflected or refracted, so that rendering recurses.
    #[must_use]
    pub fn is_specular(&self) -> bool {
        self.reflection != Vec3::ZERO || self.is_transparent()
    }
}

/// Materials by name, for notes: the first few, and how many there are besides.
pub(super) fn listed(names: &[String]) -> String {
    const FEW: usize = 4;
    let quoted: Vec<String> = names.iter().take(FEW).map(|name| format!("'{name}'")).collect();
    let plural = if names.len() == 1 { "" } else { "s" };
    let more = match names.len().saturating_sub(FEW) {
        0 => String::new(),
        count => format!(" and {count} more"),
    };
    format!("material{plural} {}{more}", quoted.join(", "))
}

/// Colours in files: three numbers.
mod colour {
    use super::{Deserialize, Serialize, Vec3};

    pub(super) fn serialize<S: serde::Serializer>(colour: &Vec3, to: S) -> Result<S::Ok, S::Error> {
        colour.to_array().serialize(to)
    }

    pub(super) fn deserialize<'a, D: serde::Deserializer<'a>>(from: D) -> Result<Vec3, D::Error> {
        <[f32; 3]>::deserialize(from).map(Vec3::from)
    }
}

/// What the files that umbra writes say beyond the standard: exact values, under `extras.umbra`.
#[derive(Serialize, Deserialize)]
pub(super) struct Extras<T> {
    pub(super) umbra: T,
}

/// Reads `extras.umbra`, if that is what it is.
pub(super) fn from_extras<T: for<'a> Deserialize<'a>>(extras: &gltf::json::Extras) -> Option<T> {
    let extras: Extras<T> = serde_json::from_str(extras.as_ref()?.get()).ok()?;
    Some(extras.umbra)
}

/// The fields of a scene that glTF has no place for.
#[derive(Serialize, Deserialize)]
pub(super) struct Surroundings {
    pub(super) ambient: [f32; 3],
    pub(super) background: [f32; 3],
    pub(super) exposure: Option<f32>,
}
