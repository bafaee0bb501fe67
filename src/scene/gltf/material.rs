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
/// The index of refraction of a volume that gives none.
const INDEX: f32 = 1.5;

pub(super) fn is_masked(json: &Json) -> bool {
    json.alpha_mode == Checked::Valid(AlphaMode::Mask)
}

/// Whether a texture that is not read says how much of the surface glows.
pub(super) fn glows_by_texture(json: &Json) -> bool {
    let json::material::EmissiveFactor(emission) = json.emissive_factor;
    json.emissive_texture.is_some() && emission != [0.0; 3] && !is_ours(json)
}

/// Whether light loses colour on its way through the volume behind the surface.
pub(super) fn absorbs_within(json: &Json) -> bool {
    let volume = json.extensions.as_ref().and_then(|extensions| extensions.volume.as_ref());
    volume.is_some_and(|v| v.thickness_factor.0 > 0.0 && v.attenuation_color.0 != [1.0; 3])
        && !is_ours(json)
}

/// Whether umbra itself wrote it.
fn is_ours(json: &Json) -> bool {
    from_extras::<Material>(&json.extras).is_some()
}

/// Base colour with alpha, how metallic it is, and its roughness. In the older words of
/// KHR_materials_pbrSpecularGlossiness a metal is what mirrors more than it scatters.
fn surface(json: &Json) -> ([f32; 4], f32, f32) {
    let extensions = json.extensions.as_ref();
    let Some(older) = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref()) else {
        let pbr = &json.pbr_metallic_roughness;
        return (pbr.base_color_factor.0, pbr.metallic_factor.0, pbr.roughness_factor.0);
    };
    let [red, green, blue, alpha] = older.diffuse_factor.0;
    let (diffuse, specular) = (Vec3::new(red, green, blue), Vec3::from(older.specular_factor.0));
    let is_metal = specular.max_element() > diffuse.max_element();
    let colour = if is_metal { specular } else { diffuse };
    (
        colour.extend(alpha).to_array(),
        f32::from(u8::from(is_metal)),
        1.0 - older.glossiness_factor.0,
    )
}

/// A smooth metal is a mirror, a rough one a diffuse surface of its colour; what blends or transmits
/// is transparent. What umbra itself wrote is taken as it is.
pub(super) fn material(json: &Json) -> Material {
    let name = json.name.clone().unwrap_or_default();
    if let Some(material) = from_extras(&json.extras) {
        return Material { name, ..material };
    }
    let ([red, green, blue, alpha], metallic, roughness) = surface(json);
    let colour = Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE);
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
    // Without a volume behind it a surface is a thin sheet, which bends no light.
    let has_volume = extensions
        .and_then(|e| e.volume.as_ref())
        .is_some_and(|volume| volume.thickness_factor.0 > 0.0);
    let index = extensions.and_then(|e| e.ior.as_ref()).map_or(INDEX, |ior| ior.ior.0.max(1.0));
    let strength = extensions.and_then(|e| e.emissive_strength.as_ref());
    let json::material::EmissiveFactor(emission) = json.emissive_factor;
    Material {
        name,
        diffuse: opacity * (1.0 - transmitted) * diffuse,
        reflection,
        transmission: Vec3::splat(1.0 - opacity) + opacity * transmitted * colour,
        refraction_index: if transmitted > 0.0 && has_volume { index } else { 1.0 },
        // Where the texture is dark, nothing glows: nobody knows how much is left.
        emission: match json.emissive_texture {
            Some(_) => Vec3::ZERO,
            None => Vec3::from(emission) * strength.map_or(1.0, |s| s.emissive_strength.0),
        },
        ..Material::default()
    }
}
