//! GLB with materials, lights (KHR_lights_punctual) and camera. What glTF has no field for stands
//! under `extras.umbra`, so that nothing is lost on the way back.

use std::{collections::HashMap, io, io::Write, path::Path};

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::{Run, material_names, runs, unwritable};
use crate::scene::{
    Camera, Light, Material, Scene, SceneError,
    light::{is_colour, is_exposure},
    material::{Extras, Surroundings},
};
use crate::whole_file::WholeFile;

/// glTF numbers for types and targets.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A GLB.
///
/// # Errors
/// [`SceneError::Unwritable`], also beyond the 4 GiB that a GLB holds; [`SceneError::Unsound`].
pub(super) fn file(scene: &Scene, path: &Path) -> Result<WholeFile, SceneError> {
    check(scene)?;
    let mut blob = Blob::default();
    let primitives: Vec<Value> = runs(scene).iter().map(|run| blob.primitive(scene, run)).collect();
    let mut nodes = vec![
        json!({ "name": scene.name, "mesh": 0, "translation": scene.origin.to_array() }),
        camera_node(&scene.camera, scene.origin),
    ];
    let placed = scene.lights.iter().enumerate();
    nodes.extend(placed.map(|(index, light)| light_node(index, light, scene.origin)));
    let names = material_names(scene);
    let materials = scene.materials.iter().zip(names).map(|(m, name)| material(m, &name));
    let surroundings = Surroundings {
        ambient: scene.ambient.into(),
        background: scene.background.into(),
        exposure: scene.exposure,
    };
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "umbra" },
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{
            "nodes": (0..nodes.len()).collect::<Vec<_>>(),
            "extras": Extras { umbra: surroundings },
        }],
        "nodes": nodes,
        "meshes": [{ "primitives": primitives }],
        "materials": materials.collect::<Vec<_>>(),
        "cameras": [{
            "type": "perspective",
            "perspective": { "yfov": scene.camera.field_of_view, "znear": 1e-3 },
        }],
        "buffers": [{ "byteLength": blob.bytes.len() }],
        "bufferViews": blob.views,
        "accessors": blob.accessors,
    });
    if !scene.lights.is_empty() {
        let lights: Vec<Value> = scene.lights.iter().map(light).collect();
        document["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
        document["extensionsUsed"] =
            json!(["KHR_materials_emissive_strength", "KHR_lights_punctual"]);
    }
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunks = [(b"JSON", &json), (b"BIN\0", &blob.bytes)];
    let length = chunks.iter().fold(12, |length, (_, bytes)| length + 8 + bytes.len());
    // No chunk is longer than the whole.
    let length = u32::try_from(length)
        .map_err(|_| unwritable(path)(io::Error::other("a GLB holds no more than 4 GiB")))?;
    let file = WholeFile::with(path, |file| {
        file.write_all(b"glTF")?;
        file.write_all(&2u32.to_le_bytes())?;
        file.write_all(&length.to_le_bytes())?;
        for (kind, bytes) in chunks {
            file.write_all(&(bytes.len() as u32).to_le_bytes())?;
            file.write_all(kind)?;
            file.write_all(bytes)?;
        }
        Ok(())
    })?;
    Ok(file)
}

/// Refuses numbers that cannot be read back: JSON has no infinity and no NaN.
fn check(scene: &Scene) -> Result<(), SceneError> {
    let unsound = |what: &str, advice: &str| SceneError::Unsound {
        name: scene.name.clone(),
        problem: format!("the numbers of {what} make no sense; {advice}"),
    };
    let advice = "give others, or take it out";
    if let Some(index) = scene.lights.iter().position(|light| !light.is_sound()) {
        return Err(unsound(&format!("light {index}"), advice));
    }
    // Not whether it is sound: of a scene near the end of f32, the camera that was chosen may lie beyond it.
    let Camera { position, right, up, forward, field_of_view } = scene.camera;
    if ![position, right, up, forward].iter().all(|v| v.is_finite()) || !field_of_view.is_finite() {
        return Err(unsound("the camera", "give it finite ones"));
    }
    if !is_colour(&scene.ambient) || !is_colour(&scene.background) {
        return Err(unsound("the ambient light or the background", "give numbers from 0 up"));
    }
    if scene.exposure.is_some_and(|factor| !is_exposure(factor)) {
        return Err(unsound("the exposure", "give a number above 0, or none"));
    }
    match scene.materials.iter().position(|material| *material != material.clamped()) {
        None => Ok(()),
        Some(index) => Err(unsound(&format!("material {index}"), "give others")),
    }
}

/// The binary chunk and what the JSON says about it.
#[derive(Default)]
struct Blob {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Blob {
    fn primitive(&mut self, scene: &Scene, run: &Run) -> Value {
        let mut places = HashMap::new();
        let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
        for id in run.triangles.clone() {
            for (corner, position) in scene.triangles.get(id).into_iter().enumerate() {
                let normal =
                    if run.smooth { scene.normals[id as usize][corner] } else { Vec3::ZERO };
                let key = [position, normal].map(|v| v.to_array().map(f32::to_bits));
                let next = positions.len() as u32;
                indices.push(*places.entry(key).or_insert_with(|| {
                    positions.push(position);
                    normals.push(normal);
                    next
                }));
            }
        }
        let bounds = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let vectors = |list: &[Vec3]| -> Vec<u8> {
            list.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect()
        };
        let mut attributes = json!({
            "POSITION": self.accessor(
                vectors(&positions),
                ARRAY_BUFFER,
                json!({
                    "componentType": FLOAT, "type": "VEC3", "count": positions.len(),
                    "min": bounds.0.to_array(), "max": bounds.1.to_array(),
                }),
            ),
        });
        if run.smooth {
            attributes["NORMAL"] = json!(self.accessor(
                vectors(&normals),
                ARRAY_BUFFER,
                json!({ "componentType": FLOAT, "type": "VEC3", "count": normals.len() }),
            ));
        }
        let indices_at = self.accessor(
            indices.iter().copied().flat_map(u32::to_le_bytes).collect(),
            ELEMENT_ARRAY_BUFFER,
            json!({ "componentType": UNSIGNED_INT, "type": "SCALAR", "count": indices.len() }),
        );
        json!({ "attributes": attributes, "indices": indices_at, "material": run.material })
    }

    /// Adds a view of its own for the bytes; the number of the accessor.
    fn accessor(&mut self, bytes: Vec<u8>, target: u32, mut accessor: Value) -> usize {
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(), "target": target,
        }));
        self.bytes.extend(bytes);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// A node at `position` whose Z axis is `backwards`.
fn matrix(right: DVec3, up: DVec3, backwards: DVec3, position: DVec3) -> Value {
    let columns = [right.extend(0.0), up.extend(0.0), backwards.extend(0.0), position.extend(1.0)];
    json!(columns.map(|column| column.to_array()).concat())
}

fn camera_node(camera: &Camera, origin: DVec3) -> Value {
    let position = camera.position + origin;
    json!({ "camera": 0, "matrix": matrix(camera.right, camera.up, -camera.forward, position) })
}

fn light_node(index: usize, light: &Light, origin: DVec3) -> Value {
    let (position, backwards) = match *light {
        Light::Point { position, .. } => (position + origin, DVec3::Z),
        Light::Spot { position, axis, .. } => (position + origin, -axis),
        Light::Directional { direction, .. } => (origin, direction),
    };
    let right = backwards.any_orthonormal_vector();
    json!({
        "matrix": matrix(right, backwards.cross(right), backwards, position),
        "extensions": { "KHR_lights_punctual": { "light": index } },
    })
}

fn light(light: &Light) -> Value {
    // glTF viewers expect colours from 0 to 1.
    let parts = |light: Vec3| {
        let strength = light.max_element();
        let colour = if strength > 0.0 { light / strength } else { Vec3::ZERO };
        (colour.to_array(), strength)
    };
    match *light {
        Light::Point { intensity, .. } => {
            let (color, intensity) = parts(intensity);
            json!({ "type": "point", "color": color, "intensity": intensity })
        }
        Light::Spot { intensity, inner, outer, .. } => {
            let (color, intensity) = parts(intensity);
            json!({
                "type": "spot", "color": color, "intensity": intensity,
                "spot": { "innerConeAngle": inner, "outerConeAngle": outer },
            })
        }
        Light::Directional { irradiance, .. } => {
            let (color, intensity) = parts(irradiance);
            json!({ "type": "directional", "color": color, "intensity": intensity })
        }
    }
}

fn material(material: &Material, name: &str) -> Value {
    let mirrors = material.reflection.max_element() > material.diffuse.max_element();
    let opacity = 1.0 - material.transmission.element_sum() / 3.0;
    let base = if mirrors { material.reflection } else { material.diffuse };
    let base = base.clamp(Vec3::ZERO, Vec3::ONE);
    let strength = material.emission.max_element().max(1.0);
    let smooth = material.is_specular();
    json!({
        "name": name,
        "doubleSided": true,
        "alphaMode": if material.is_transparent() { "BLEND" } else { "OPAQUE" },
        "pbrMetallicRoughness": {
            "baseColorFactor": [base.x, base.y, base.z, opacity],
            "metallicFactor": if mirrors { 1.0 } else { 0.0 },
            "roughnessFactor": if smooth { 0.0 } else { 1.0 },
        },
        "emissiveFactor": (material.emission / strength).to_array(),
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } },
        "extras": Extras { umbra: material },
    })
}
