//! OBJ with MTL. They have no place for lights and camera.

use std::{collections::HashMap, io::Write, path::Path};

use glam::Vec3;

use super::{material_names, runs, unwritable};
use crate::scene::{Material, Scene, SceneError};
use crate::whole_file::WholeFile;

/// `path` and, beside it, the same name with `.mtl`.
///
/// # Errors
/// [`SceneError::Unwritable`].
pub(super) fn files(scene: &Scene, path: &Path) -> Result<Vec<WholeFile>, SceneError> {
    let mtl = path.with_extension("mtl");
    let no_name = || unwritable(path)(std::io::Error::other("this is no name for a file"));
    let mtl_name = mtl.file_name().and_then(|name| name.to_str()).ok_or_else(no_name)?;
    let names = material_names(scene);
    let materials = WholeFile::with(&mtl, |file| {
        writeln!(file, "# Materials of {}, written by umbra", scene.name)?;
        scene.materials.iter().zip(&names).try_for_each(|(m, name)| write_material(file, m, name))
    })?;
    let geometry = WholeFile::with(path, |file| {
        writeln!(file, "# {}, written by umbra", scene.name)?;
        writeln!(file, "mtllib {mtl_name}")?;
        write_geometry(file, scene, &names)
    })?;
    Ok(vec![materials, geometry])
}

fn write_geometry(file: &mut impl Write, scene: &Scene, names: &[String]) -> std::io::Result<()> {
    let (mut positions, mut normals) = (HashMap::new(), HashMap::new());
    for run in runs(scene) {
        writeln!(file, "usemtl {}", names[run.material as usize])?;
        for id in run.triangles {
            let mut face = String::from("f");
            for (corner, position) in scene.triangles.get(id).into_iter().enumerate() {
                let next = positions.len() + 1;
                let index = *positions.entry(position.to_array().map(f32::to_bits)).or_insert(next);
                if index == next {
                    let [x, y, z] = [0, 1, 2].map(|i| decimal(position[i], scene.origin[i]));
                    writeln!(file, "v {x} {y} {z}")?;
                }
                face += &format!(" {index}");
                if run.smooth {
                    let normal = scene.normals[id as usize][corner];
                    let next = normals.len() + 1;
                    let index = *normals.entry(normal.to_array().map(f32::to_bits)).or_insert(next);
                    if index == next {
                        let [x, y, z] = normal.to_array().map(|n| decimal(n, 0.0));
                        writeln!(file, "vn {x} {y} {z}")?;
                    }
                    face += &format!("//{index}");
                }
            }
            writeln!(file, "{face}")?;
        }
    }
    Ok(())
}

/// The coordinate in the world, short where the reader gets the same bits from it.
fn decimal(local: f32, origin: f64) -> String {
    let short = local.to_string();
    let same = short.parse::<f64>().is_ok_and(|read| (read as f32).to_bits() == local.to_bits());
    if origin == 0.0 && same { short } else { (f64::from(local) + origin).to_string() }
}

fn write_material(file: &mut impl Write, material: &Material, name: &str) -> std::io::Result<()> {
    let opacity = 1.0 - material.transmission.element_sum() / 3.0;
    let mirrors = material.reflection != Vec3::ZERO;
    let refracts = material.refraction_index != 1.0 && opacity < 1.0;
    let (model, specular) = match (refracts, mirrors) {
        (true, _) => (7, material.reflection),
        (false, true) => (3, material.reflection),
        (false, false) => (2, material.highlight),
    };
    let diffuse = if opacity > 0.0 { material.diffuse / opacity } else { material.diffuse };
    writeln!(file, "\nnewmtl {name}\nillum {model}")?;
    for (keyword, colour) in [("Kd", diffuse), ("Ks", specular), ("Ke", material.emission)] {
        writeln!(file, "{keyword} {} {} {}", colour.x, colour.y, colour.z)?;
    }
    writeln!(file, "Ns {}\nNi {}\nd {opacity}", material.shininess, material.refraction_index)
}
