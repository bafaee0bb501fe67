//! Scenes as OBJ or GLB files for other tools. What `load` reads back has the same triangles, bit for
//! bit and in the same order.

mod glb;
mod obj;

use std::{collections::HashSet, io, ops::Range, path::Path};

use glam::Vec3;

use super::{Scene, SceneError};
use crate::whole_file::{WholeFile, finish_all};

/// Writes a scene as the end of the name says: `.obj` (with an `.mtl` beside it) or `.glb`, in world coordinates.
///
/// A GLB keeps everything but notes. OBJ has no place for lights, camera, ambient light, background and exposure:
/// they are not written, and whoever loads the file gets others.
///
/// # Errors
/// [`SceneError::UnknownKind`] for any other name, [`SceneError::Unsound`] if a GLB would hold a light, a camera or
/// surroundings whose numbers make no sense, [`SceneError::Unwritable`]; nothing is written then.
pub fn write(scene: &Scene, path: &Path) -> Result<(), SceneError> {
    Ok(finish_all(files(scene, path)?)?)
}

/// The files of [`write()`], whole but not in their places yet.
///
/// # Errors
/// Those of [`write()`].
pub fn files(scene: &Scene, path: &Path) -> Result<Vec<WholeFile>, SceneError> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("obj") => obj::files(scene, path),
        Some("glb") => Ok(vec![glb::file(scene, path)?]),
        _ => Err(SceneError::UnknownKind { path: path.into() }),
    }
}

fn unwritable(path: &Path) -> impl Fn(io::Error) -> SceneError {
    move |reason| SceneError::Unwritable { path: path.into(), reason }
}

/// Triangles next to each other with one material, all smooth or all flat.
struct Run {
    triangles: Range<u32>,
    material: u32,
    smooth: bool,
}

fn runs(scene: &Scene) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (id, &material) in (0..).zip(&scene.material_of) {
        let smooth =
            scene.normals.get(id as usize).is_some_and(|normals| *normals != [Vec3::ZERO; 3]);
        match runs.last_mut() {
            Some(run) if run.material == material && run.smooth == smooth => run.triangles.end += 1,
            _ => runs.push(Run { triangles: id..id + 1, material, smooth }),
        }
    }
    runs
}

/// A name for each material: its own, made different from those before it.
fn material_names(scene: &Scene) -> Vec<String> {
    let mut taken = HashSet::new();
    let names = scene.materials.iter().enumerate().map(|(index, material)| {
        let name = material.name.split_whitespace().collect::<Vec<_>>().join("_");
        let own = Some(name.clone()).filter(|name| !name.is_empty());
        let numbered = (index..).map(|number| format!("{name}_{number}"));
        let mut names = own.into_iter().chain(numbered);
        names.find(|name| taken.insert(name.clone())).expect("there is always another number")
    });
    names.collect()
}
