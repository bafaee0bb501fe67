//! glTF materials as Whitted ones.

use ::gltf::json::{
    self,
    material::{AlphaMode, Material as Json},
    validation::Checked,
};
use glam::Vec3;

use crate::scene::{Material, material::from_extras};

/// A surface smoother than this mirrors if it is a metal.
const SMOOTH_METAL: f32 = 0.3;
/// A surface smoother than this mirrors in any case.
const SMOOTH: f32 = 0.1;
/// What a smooth non-metal mirrors at normal incidence.
const DIELECTRIC: f32 = 0.04;

pub(super) fn is_masked(json: &Json) -> bool {
    json.alpha_mode == Checked::Valid(AlphaMode::Mask)
}

/// A smooth metal is a mirror, a rough one a diffuse surface of its colour; what blends or transmits
/// is transparent. What umbra itself wrote is taken as it is.
pub(super) fn material(json: &Json) -> Material {
    let name = json.name.clone().unwrap_or_default();
    if let Some(material) = from_extras(&json.extras) {
        return Material { name, ..material };
    }
    let pbr = &json.pbr_metallic_roughness;
    let [red, green, blue, alpha] = pbr.base_color_factor.0;
    let colour = Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE);
    let (metallic, roughness) = (pbr.metallic_factor.0, pbr.roughness_factor.0);
    let (diffuse, reflection) = if metallic > 0.5 && roughness < SMOOTH_METAL {
        (colour * (1.0 - metallic).max(0.0), colour)
    } else if roughness < SMOOTH {
        (colour, Vec3::splat(DIELECTRIC))
    } else {
        (colour, Vec3::ZERO)
    };
    let extensions = json.extensions.as_ref();
    let opacity = match json.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => alpha.clamp(0.0, 1.0),
        _ => 1.0,
    };
    let transmitted = extensions
        .and_then(|e| e.transmission.as_ref())
        .map_or(0.0, |transmission| transmission.transmission_factor.0.clamp(0.0, 1.0));
    let index = extensions.and_then(|e| e.ior.as_ref()).map_or(1.0, |ior| ior.ior.0.max(1.0));
    let strength = extensions.and_then(|e| e.emissive_strength.as_ref());
    let json::material::EmissiveFactor(emission) = json.emissive_factor;
    Material {
        name,
        diffuse: opacity * (1.0 - transmitted) * diffuse,
        reflection,
        transmission: Vec3::splat(1.0 - opacity) + opacity * transmitted * colour,
        refraction_index: if transmitted > 0.0 { index } else { 1.0 },
        emission: Vec3::from(emission) * strength.map_or(1.0, |s| s.emissive_strength.0),
        ..Material::default()
    }
}
