//! What becomes of glTF materials.

use glam::Vec3;
use serde_json::{Value, json};
use umbra::scene::{Light, Material, Scene};

use super::{gltf::loaded, notes_say};

/// A triangle of one material.
fn made_of(json: Value) -> Scene {
    loaded(|document| {
        document["materials"] = json!([json]);
        document["meshes"][0]["primitives"][0]["material"] = json!(0);
    })
}

fn material(json: Value) -> Material {
    made_of(json).material(0).clone()
}

#[test]
fn materials_become_whitted_ones() {
    let pbr = |colour: [f32; 4], metallic: f32, roughness: f32| json!({ "baseColorFactor": colour, "metallicFactor": metallic, "roughnessFactor": roughness });
    let colour = [0.5, 0.25, 1.0, 0.25];
    let rgb = Vec3::new(0.5, 0.25, 1.0);
    let rough_metal = material(json!({ "pbrMetallicRoughness": pbr(colour, 1.0, 1.0) }));
    assert_eq!((rough_metal.diffuse, rough_metal.reflection), (rgb, Vec3::ZERO));
    assert!(!rough_metal.is_transparent(), "alpha counts only with BLEND");
    let mirror = material(json!({ "pbrMetallicRoughness": pbr(colour, 1.0, 0.1) }));
    assert_eq!((mirror.diffuse, mirror.reflection), (Vec3::ZERO, rgb));
    let lacquer = material(json!({ "pbrMetallicRoughness": pbr(colour, 0.0, 0.0) }));
    assert_eq!((lacquer.diffuse, lacquer.reflection), (rgb, Vec3::splat(0.04)));
    let pane =
        material(json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": pbr(colour, 0.0, 1.0) }));
    assert_eq!((pane.transmission, pane.refraction_index), (Vec3::splat(0.75), 1.0));
    assert_eq!(pane.diffuse, 0.25 * rgb);
    let glass = material(json!({
        "pbrMetallicRoughness": pbr(colour, 0.0, 0.0),
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 0.5 },
            "KHR_materials_ior": { "ior": 1.5 },
            "KHR_materials_volume": { "thicknessFactor": 0.1 },
        },
    }));
    assert_eq!((glass.transmission, glass.refraction_index), (0.5 * rgb, 1.5));
    let lamp = material(json!({
        "emissiveFactor": [1, 0.5, 0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
    }));
    assert_eq!(lamp.emission, Vec3::new(8.0, 4.0, 0.0));
}

#[test]
fn numbers_of_materials_that_make_no_sense_are_clamped_with_a_note() {
    let clamped = |material: Value| {
        let scene = loaded(|document| {
            document["materials"] = json!([material]);
            document["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
        let told = "clamped the numbers that make no sense of material 'x'";
        assert!(scene.notes.iter().any(|note| note == told), "{:?}", scene.notes);
        scene.material(0).clone()
    };
    let dark = clamped(json!({ "name": "x", "emissiveFactor": [-1, 0, 0.5] }));
    assert_eq!(dark.emission, Vec3::new(0.0, 0.0, 0.5));
    let bright = clamped(json!({
        "name": "x",
        "emissiveFactor": [1, 0, 0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 1e39 } },
    }));
    assert_eq!(bright.emission, Vec3::new(f32::MAX, 0.0, 0.0));
    let umbra = json!({
        "diffuse": [-1, 2, 0], "reflection": [1.5, 0, 0], "transmission": [-0.5, 0, 0],
        "refraction_index": 0, "shininess": -1, "highlight": [0, 1e39, 0],
    });
    let own = clamped(json!({ "name": "x", "extras": { "umbra": umbra } }));
    assert_eq!((own.diffuse, own.reflection), (Vec3::new(0.0, 2.0, 0.0), Vec3::X));
    assert!(!own.is_transparent());
    assert_eq!((own.refraction_index, own.shininess), (1.0, 0.0));
    assert_eq!(own.highlight, Vec3::new(0.0, f32::MAX, 0.0));
}

/// By KHR_materials_volume, a thickness of 0 means a sheet.
#[test]
fn only_what_has_a_thickness_bends_light() {
    let index = |ior: Value, volume: Value| {
        let mut extensions = json!({ "KHR_materials_transmission": { "transmissionFactor": 1 } });
        for (name, extension) in [("KHR_materials_ior", ior), ("KHR_materials_volume", volume)] {
            if extension.is_object() {
                extensions[name] = extension;
            }
        }
        material(json!({ "extensions": extensions })).refraction_index
    };
    assert_eq!(index(json!({ "ior": 1.3 }), json!(null)), 1.0);
    assert_eq!(index(json!({ "ior": 1.3 }), json!({ "thicknessFactor": 0 })), 1.0);
    assert_eq!(index(json!({ "ior": 1.3 }), json!({ "thicknessFactor": 2 })), 1.3);
    assert_eq!(
        index(json!(null), json!({ "thicknessFactor": 2 })),
        1.5,
        "the default of the index"
    );
}

#[test]
fn what_a_volume_absorbs_is_noted() {
    let scene = made_of(json!({ "extensions": { "KHR_materials_volume": {
        "thicknessFactor": 1, "attenuationColor": [0, 1, 0], "attenuationDistance": 1,
    } } }));
    assert!(notes_say(&scene, "1 material absorbs light on the way through, which is left out"));
}

#[test]
fn older_materials_of_diffuse_and_specular_colour_are_read() {
    let older = |blend: &str, fields: Value| {
        material(json!({
            "alphaMode": blend,
            "extensions": { "KHR_materials_pbrSpecularGlossiness": fields },
        }))
    };
    let dull = json!([0, 0, 0]);
    let pane = older(
        "BLEND",
        json!({ "diffuseFactor": [1, 0, 0, 0.25], "specularFactor": dull, "glossinessFactor": 0 }),
    );
    assert_eq!((pane.transmission, pane.diffuse), (Vec3::splat(0.75), 0.25 * Vec3::X));
    let gold = json!([1, 0.5, 0]);
    let black = json!([0, 0, 0, 1]);
    let mirror = older("OPAQUE", json!({ "diffuseFactor": black, "specularFactor": gold }));
    assert_eq!((mirror.diffuse, mirror.reflection), (Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0)));
    let rough = older(
        "OPAQUE",
        json!({ "diffuseFactor": black, "specularFactor": gold, "glossinessFactor": 0 }),
    );
    assert_eq!((rough.diffuse, rough.reflection), (Vec3::new(1.0, 0.5, 0.0), Vec3::ZERO));
}

#[test]
fn what_glows_by_a_texture_is_no_lamp() {
    let lamp = |texture: bool| {
        let mut json = json!({ "emissiveFactor": [1, 1, 1] });
        if texture {
            json["emissiveTexture"] = json!({ "index": 0 });
        }
        made_of(json)
    };
    let told = "1 material glows by a texture, which is left out: no light comes from there";
    let plain = lamp(false);
    assert!(matches!(plain.lights[..], [Light::Point { .. }]) && !notes_say(&plain, told));
    let textured = lamp(true);
    assert!(matches!(textured.lights[..], [Light::Directional { .. }]));
    assert_eq!(textured.material(0).emission, Vec3::ZERO);
    assert!(notes_say(&textured, told), "{:?}", textured.notes);
}

#[test]
fn cut_out_masks_are_counted() {
    let told = "1 material with a cut-out mask is solid here";
    assert!(notes_say(&made_of(json!({ "alphaMode": "MASK" })), told));
}
