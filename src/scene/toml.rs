#![doc = include_str!("description.md")]

mod light_fields;
mod soundness;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use light_fields::LightFields;
use serde::Deserialize;
use soundness::Step;

use super::{
    Camera, Draft, DraftTriangle, Light, Material, SceneError, builtin,
    load::{empty_draft, is_mesh, malformed, read_file, read_mesh},
    memory,
    placement::Placement,
    polygon::triangulate,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    up: Option<[f64; 3]>,
    ambient: Option<[f32; 3]>,
    background: Option<[f32; 3]>,
    exposure: Option<f32>,
    camera: Option<CameraEntry>,
    #[serde(default)]
    materials: BTreeMap<String, Material>,
    #[serde(default)]
    mesh: Vec<MeshEntry>,
    #[serde(default)]
    light: Vec<LightEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraEntry {
    position: [f64; 3],
    target: [f64; 3],
    #[serde(default = "forty_degrees")]
    field_of_view: f64,
}

fn forty_degrees() -> f64 {
    40.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshEntry {
    file: Option<PathBuf>,
    builtin: Option<String>,
    quads: Option<Vec<[[f64; 3]; 4]>>,
    triangles: Option<Vec<[[f64; 3]; 3]>>,
    material: Option<String>,
    #[serde(default = "unscaled")]
    scale: [f64; 3],
    #[serde(default)]
    rotate: [f64; 3],
    #[serde(default)]
    translate: [f64; 3],
}

impl MeshEntry {
    /// Its triangles, unless they are in a file that has yet to be read.
    fn known_triangles(&self) -> u64 {
        let quads = self.quads.as_ref().map_or(0, Vec::len);
        let triangles = self.triangles.as_ref().map_or(0, Vec::len);
        let builtin = self.builtin.as_ref().and_then(|name| builtin::triangle_count(name, 1.0));
        builtin.unwrap_or(0) + (2 * quads + triangles) as u64
    }
}

fn unscaled() -> [f64; 3] {
    [1.0; 3]
}

/// One of three kinds. Those are told apart after their fields are read: of fields that it puts aside until it knows the kind,
/// serde forgets the lines.
#[derive(Deserialize)]
#[serde(try_from = "LightFields")]
enum LightEntry {
    Point { position: [f64; 3], intensity: [f32; 3] },
    Spot { position: [f64; 3], target: [f64; 3], intensity: [f32; 3], inner: f64, outer: f64 },
    Directional { from: [f64; 3], irradiance: [f32; 3] },
}

/// Reads a scene description and the meshes it names.
pub(super) fn read(path: &Path) -> Result<Draft, SceneError> {
    let bytes = read_file(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let description: Description = ::toml::from_str(&text).map_err(|error| {
        let before = error.span().map_or(0, |span| text[..span.start].matches('\n').count());
        let message = error.message().replace('\n', " ");
        // Of a value, serde does not say whose it is.
        let field = text.lines().nth(before).filter(|_| message.starts_with("invalid "));
        let field = field.map_or(String::new(), |line| format!(" in `{}`", line.trim()));
        malformed(path, format!("line {}: {message}{field}", before + 1))
    })?;
    soundness::check(&text, &description).map_err(|problem| malformed(path, problem))?;
    let up = DVec3::from(description.up.unwrap_or([0.0, 1.0, 0.0]));
    let mut draft = empty_draft(path);
    draft.up = Some(up);
    draft.camera = description.camera.map(|camera| {
        let field_of_view = camera.field_of_view.to_radians();
        Camera::look_at(camera.position.into(), camera.target.into(), up, field_of_view)
    });
    draft.lights = description.light.iter().map(light).collect();
    draft.choose_ambient = description.ambient.is_none();
    draft.choose_background = description.background.is_none();
    draft.ambient = description.ambient.unwrap_or_default().into();
    draft.background = description.background.unwrap_or_default().into();
    draft.exposure = description.exposure;
    for (name, material) in description.materials {
        draft.materials.push(Material { name, ..material });
    }
    let own_materials = draft.materials.len();
    let known = description.mesh.iter().map(MeshEntry::known_triangles).sum();
    memory::check(known).map_err(|problem| malformed(path, problem))?;
    for (index, entry) in description.mesh.iter().enumerate() {
        add_mesh(path, &mut draft, own_materials, entry).map_err(|problem| {
            let line = soundness::line(&text, &[Step::Key("mesh"), Step::Element(index)]);
            malformed(path, format!("line {line}: mesh {}: {problem}", index + 1))
        })?;
    }
    Ok(draft)
}

fn light(entry: &LightEntry) -> Light {
    match *entry {
        LightEntry::Point { position, intensity } => {
            Light::Point { position: position.into(), intensity: intensity.into() }
        }
        LightEntry::Spot { position, target, intensity, inner, outer } => Light::Spot {
            position: position.into(),
            axis: (DVec3::from(target) - DVec3::from(position)).normalize_or(DVec3::NEG_Y),
            intensity: intensity.into(),
            inner: inner.to_radians(),
            outer: outer.to_radians(),
        },
        LightEntry::Directional { from, irradiance } => Light::Directional {
            direction: DVec3::from(from).normalize_or(DVec3::Y),
            irradiance: irradiance.into(),
        },
    }
}

/// Adds a mesh, or says what is wrong with it. The description's own materials are the first of the draft:
/// it names no others.
fn add_mesh(
    path: &Path,
    draft: &mut Draft,
    own_materials: usize,
    entry: &MeshEntry,
) -> Result<(), String> {
    let own = match &entry.material {
        None => None,
        Some(name) => {
            let mut own = draft.materials[..own_materials].iter();
            let place = own.position(|material| material.name == *name);
            Some(place.ok_or_else(|| format!("there is no [materials.{name}]"))? as u32)
        }
    };
    let mesh = match (&entry.file, &entry.builtin, &entry.quads, &entry.triangles) {
        (Some(file), None, None, None) => {
            let file = path.parent().unwrap_or(Path::new("")).join(file);
            if !is_mesh(&file) {
                let text = "is no mesh; name an .obj, .glb or .gltf file";
                return Err(format!("'{}' {text}", file.display()));
            }
            read_mesh(&file).map_err(|error| error.to_string())?
        }
        (None, Some(name), None, None) => {
            builtin::draft_at(name, 1.0).map_err(|error| error.to_string())?
        }
        (None, None, Some(quads), None) => {
            let halves = |corners: &[[f64; 3]; 4]| {
                let corners = corners.map(DVec3::from);
                triangulate(&corners).into_iter().map(move |half| half.map(|at| corners[at]))
            };
            inline("quads", quads.iter().flat_map(halves))
        }
        (None, None, None, Some(triangles)) => {
            inline("triangles", triangles.iter().map(|corners| corners.map(DVec3::from)))
        }
        _ => return Err("give one of file, builtin, quads and triangles".to_owned()),
    };
    if mesh.triangles.is_empty() {
        // By itself it is no scene either: the same words say why.
        return mesh.finish().map(drop).map_err(|error| error.to_string());
    }
    memory::check((draft.triangles.len() + mesh.triangles.len()) as u64)?;
    if !mesh.lights.is_empty() || mesh.camera.is_some() {
        draft.note(format!("{}: its lights and camera are left out", mesh.name));
    }
    let first = draft.materials.len() as u32;
    let [x, y, z] = entry.rotate.map(f64::to_radians);
    let placement = Placement::new(DAffine3::from_scale_rotation_translation(
        entry.scale.into(),
        DQuat::from_euler(EulerRot::XYZEx, x, y, z),
        entry.translate.into(),
    ));
    draft.triangles.extend(mesh.triangles.iter().map(|triangle| DraftTriangle {
        material: own.unwrap_or(first + triangle.material),
        ..placement.place(triangle)
    }));
    if own.is_none() {
        draft.materials.extend(mesh.materials);
    }
    for note in &mesh.notes {
        draft.note(format!("{}: {note}", mesh.name));
    }
    draft.files.extend(mesh.files);
    draft.dropped.out_of_range += mesh.dropped.out_of_range;
    draft.dropped.not_finite += mesh.dropped.not_finite;
    draft.dropped.zero_area += mesh.dropped.zero_area;
    Ok(())
}

/// A mesh that is written in the description itself.
fn inline(name: &str, triangles: impl Iterator<Item = [DVec3; 3]>) -> Draft {
    let triangles = triangles
        .map(|corners| DraftTriangle { corners, normals: [Vec3::ZERO; 3], material: 0 })
        .collect();
    let name = name.to_owned();
    Draft { name, triangles, materials: vec![Material::default()], ..Draft::default() }
}
