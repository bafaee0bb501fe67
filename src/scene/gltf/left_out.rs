//! What is refused, and what is said of what is not read.

use ::gltf::json::{
    Root,
    material::Material,
    mesh::{Primitive, Semantic},
    validation::Checked,
};

use super::{Problem, has_triangles, material, mode};
use crate::words::counted;

/// The extensions that are read.
const READ: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    QUANTIZED,
];

/// By this extension vectors are made of short integers.
pub(super) const QUANTIZED: &str = "KHR_mesh_quantization";

/// Extensions of how surfaces look: those that are not read leave plain colours.
const LOOKS: [&str; 4] =
    ["KHR_lights_", "KHR_materials_", "KHR_technique_webgl", "KHR_techniques_webgl"];

/// Extensions of textures, which are left out anyway.
const TEXTURES: [&str; 3] = ["KHR_texture_", "EXT_texture_", "MSFT_texture_"];

fn begins_with(name: &str, beginnings: &[&str]) -> bool {
    beginnings.iter().any(|beginning| name.starts_with(beginning))
}

/// Refuses what changes the shape of things in a way we do not know.
pub(super) fn check_extensions(root: &Root) -> Result<(), Problem> {
    let harmless =
        |name: &str| begins_with(name, &TEXTURES) || begins_with(name, &LOOKS) || name == QUANTIZED;
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        Some(name) => Err(format!(
            "the file needs the glTF extension {name}, which umbra does not read; export it without"
        )),
        None => Ok(()),
    }
}

/// What is left out of the file, or only in part as it says.
pub(super) fn notes(root: &Root) -> Vec<String> {
    let mut notes = Vec::new();
    let unread = root.extensions_used.iter().map(String::as_str);
    let unread: Vec<&str> =
        unread.filter(|name| !READ.contains(name) && !begins_with(name, &TEXTURES)).collect();
    if unread.contains(&"EXT_mesh_gpu_instancing") {
        notes.push(
            "EXT_mesh_gpu_instancing is not read: of all instances of a mesh there is one"
                .to_owned(),
        );
    }
    let others: Vec<&str> =
        unread.into_iter().filter(|name| *name != "EXT_mesh_gpu_instancing").collect();
    if !others.is_empty() {
        notes.push(format!(
            "glTF extensions that umbra does not read are left out: {}",
            others.join(", ")
        ));
    }
    if !root.textures.is_empty() {
        notes.push("textures are left out: plain colours instead".to_owned());
    }
    if !root.animations.is_empty() {
        notes.push("animations are left out: everything stands where its node does".to_owned());
    }
    let mut note_materials = |is_one: fn(&Material) -> bool, verbs: [&str; 2], what: &str| {
        let count = root.materials.iter().filter(|material| is_one(material)).count();
        if count > 0 {
            let materials = counted(count as u64, "material");
            notes.push(format!("{materials} {} {what}", verbs[usize::from(count > 1)]));
        }
    };
    note_materials(
        material::is_masked,
        ["with a cut-out mask is", "with a cut-out mask are"],
        "solid here",
    );
    note_materials(
        material::glows_by_texture,
        ["glows", "glow"],
        "by a texture, which is left out: no light comes from there",
    );
    note_materials(
        material::absorbs_within,
        ["absorbs", "absorb"],
        "light on the way through, which is left out",
    );
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let is_coloured = |primitive: &Primitive| {
        let mut attributes = primitive.attributes.keys();
        attributes.any(|attribute| matches!(attribute, Checked::Valid(Semantic::Colors(_))))
    };
    if primitives().any(is_coloured) {
        notes.push("the colours of vertices are left out: those of materials instead".to_owned());
    }
    if primitives().filter_map(|p| mode(p).ok()).any(|mode| !has_triangles(mode)) {
        notes.push("points and lines are left out".to_owned());
    }
    notes
}
