//! What is written reads back the same.

mod common;

use std::fs;

use common::real_scenes;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use tempfile::TempDir;
use umbra::scene::{Camera, Draft, DraftTriangle, Light, Material, Scene, load, write};

/// Writes and loads a scene.
fn there_and_back(scene: &Scene, name: &str) -> Scene {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join(name);
    write(scene, &path).expect("it can be written");
    load(path.to_str().expect("a path in UTF-8")).expect("it can be read back")
}

fn bits(scene: &Scene) -> Vec<[u32; 3]> {
    let corners = scene.triangles.corners().iter().flatten();
    corners.map(|corner| corner.to_array().map(f32::to_bits)).collect()
}

fn assert_same_geometry(a: &Scene, b: &Scene) {
    assert_eq!(a.origin, b.origin);
    assert_eq!(a.triangles.opaque_count(), b.triangles.opaque_count());
    assert!(bits(a) == bits(b), "corners differ");
    assert!(a.normals == b.normals, "normals differ");
}

/// Two materials, smooth and flat triangles, a far origin, all three kinds of light.
fn varied() -> Scene {
    let far = DVec3::new(90_000.0, 0.0, -450_000.0);
    let corner = |x: f64, y: f64| far + DVec3::new(x / 3.0, y / 7.0, x * y / 11.0);
    let triangle = |i: u32| {
        let x = f64::from(i);
        let normal = Vec3::new(0.1 * i as f32, 1.0, 0.3).normalize();
        DraftTriangle {
            corners: [corner(x, 0.1), corner(x + 1.0, 0.2), corner(x, 1.3)],
            normals: [if i.is_multiple_of(3) { normal } else { Vec3::ZERO }; 3],
            material: i % 4 / 2,
        }
    };
    let glass = Material {
        name: "green glass".to_owned(),
        diffuse: Vec3::ZERO,
        reflection: Vec3::splat(0.04),
        transmission: Vec3::new(0.3, 0.9, 0.1),
        refraction_index: 1.52,
        highlight: Vec3::ONE,
        shininess: 77.0,
        emission: Vec3::new(0.0, 3.0, 0.1),
    };
    Draft {
        name: "varied".to_owned(),
        triangles: (0..20).map(triangle).collect(),
        materials: vec![glass, Material::default()],
        lights: vec![
            Light::Point { position: far + DVec3::Y, intensity: Vec3::new(5.0, 4.0, 3.0) },
            Light::Spot {
                position: far + DVec3::splat(3.0),
                axis: DVec3::new(1.0, -2.0, 0.5).normalize(),
                intensity: Vec3::new(0.5, 0.25, 0.0),
                inner: 0.25,
                outer: 0.5,
            },
            Light::Directional {
                direction: DVec3::new(-1.0, 1.0, 0.25).normalize(),
                irradiance: Vec3::ONE,
            },
        ],
        camera: Some(Camera::look_at(far + DVec3::Z * 9.0, far, DVec3::Y, 0.7)),
        ambient: Vec3::new(0.1, 0.2, 0.3),
        background: Vec3::new(0.4, 0.5, 0.6),
        exposure: Some(1.25),
        ..Draft::default()
    }
    .finish()
    .expect("a scene")
}

#[test]
fn glb_brings_everything_back() {
    let scene = varied();
    let back = there_and_back(&scene, "varied.glb");
    assert_same_geometry(&scene, &back);
    for id in 0..scene.triangles.len() as u32 {
        let name = scene.material(id).name.replace(' ', "_");
        assert_eq!(Material { name, ..scene.material(id).clone() }, *back.material(id));
    }
    assert_eq!((scene.ambient, scene.background), (back.ambient, back.background));
    assert_eq!(scene.exposure, back.exposure);
    let near = |a: DVec3, b: DVec3| assert!(a.abs_diff_eq(b, 1e-9), "{a} is not {b}");
    near(scene.camera.position, back.camera.position);
    near(scene.camera.forward, back.camera.forward);
    near(scene.camera.up, back.camera.up);
    assert!((scene.camera.field_of_view - back.camera.field_of_view).abs() < 1e-6);
    assert_eq!(scene.lights.len(), back.lights.len());
    for (light, back) in scene.lights.iter().zip(&back.lights) {
        for point in [DVec3::ZERO, DVec3::new(2.0, 1.0, 0.5), DVec3::new(5.0, -3.0, 4.0)] {
            match (light.illuminate(point), back.illuminate(point)) {
                (Some(a), Some(b)) => {
                    assert!(a.direction.abs_diff_eq(b.direction, 1e-6));
                    assert!(a.irradiance.abs_diff_eq(b.irradiance, 1e-5));
                }
                (a, b) => assert_eq!(a, b),
            }
        }
    }
}

#[test]
fn obj_brings_geometry_and_materials_back() {
    let scene = varied();
    let back = there_and_back(&scene, "varied.obj");
    assert_same_geometry(&scene, &back);
    for id in 0..scene.triangles.len() as u32 {
        assert_eq!(scene.material(id).name.replace(' ', "_"), back.material(id).name);
        assert_eq!(scene.material(id).emission, back.material(id).emission);
        assert!(scene.material(id).diffuse.abs_diff_eq(back.material(id).diffuse, 1e-6));
    }
}

#[test]
fn materials_of_one_name_come_back_apart() {
    for names in [["a", "a_2", "a"], ["a_1", "", "_1"], ["a", "a", "a"], ["b c", "b_c", "b_c_2"]] {
        let mut scene = varied();
        let grey = |name: &str, grey: f32| Material {
            name: name.to_owned(),
            diffuse: Vec3::splat(grey),
            ..Material::default()
        };
        let greys = [0.25, 0.5, 0.75];
        scene.materials = names.iter().zip(greys).map(|(name, of)| grey(name, of)).collect();
        scene.material_of = (0..scene.triangles.len() as u32).map(|id| id % 3).collect();
        for file in ["names.obj", "names.glb"] {
            let back = there_and_back(&scene, file);
            for id in 0..scene.triangles.len() as u32 {
                let [there, back] = [&scene, &back].map(|scene| scene.material(id).diffuse);
                assert_eq!(there, back, "{names:?}: triangle {id} of {file}");
            }
        }
    }
}

#[test]
fn real_scenes_come_back_bit_for_bit() {
    let Some(folder) = real_scenes() else { return };
    for name in ["delft.obj", "staircase.glb", "satellite.glb"] {
        let path = folder.join(name);
        let scene = load(path.to_str().expect("a path in UTF-8")).expect("a real scene loads");
        assert_same_geometry(&scene, &there_and_back(&scene, "back.glb"));
        assert_same_geometry(&scene, &there_and_back(&scene, "back.obj"));
    }
}

#[test]
fn built_in_scenes_come_back_bit_for_bit() {
    for name in umbra::scene::builtin::NAMES {
        let scene = load(name).expect("a built-in scene");
        assert_same_geometry(&scene, &there_and_back(&scene, "back.glb"));
        assert_same_geometry(&scene, &there_and_back(&scene, "back.obj"));
    }
}

#[test]
fn nothing_is_left_where_nothing_can_be_written() {
    let folder = TempDir::new().expect("a temporary folder");
    let scene = varied();
    let no_folder = folder.path().join("none").join("a.glb");
    let message = write(&scene, &no_folder).expect_err("there is no folder").to_string();
    assert!(message.starts_with(&format!("cannot write {}: ", no_folder.display())), "{message}");
    let unknown = folder.path().join("a.ply");
    let message = write(&scene, &unknown).expect_err("nobody writes it").to_string();
    assert!(message.contains("scenes are written as .obj or .glb"), "{message}");
    fs::create_dir(folder.path().join("taken.glb")).expect("a folder");
    write(&scene, &folder.path().join("taken.glb")).expect_err("a folder is in the way");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "no files are left over");
}

/// Finite coordinates of any size whose scene is not moved.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![-1e3f32..1e3, proptest::num::f32::NORMAL, proptest::num::f32::SUBNORMAL]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_coordinates_come_back_bit_for_bit(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(coordinate())), 1..20),
    ) {
        let triangles = corners.into_iter().map(|corners| DraftTriangle {
            corners: corners.map(|corner| Vec3::from(corner).as_dvec3()),
            normals: [Vec3::ZERO; 3],
            material: 0,
        });
        let draft = Draft { name: "any".to_owned(), triangles: triangles.collect(), ..Draft::default() };
        let Ok(scene) = draft.finish() else { return Ok(()) };
        if scene.origin == DVec3::ZERO {
            assert_same_geometry(&scene, &there_and_back(&scene, "any.glb"));
            assert_same_geometry(&scene, &there_and_back(&scene, "any.obj"));
        }
    }
}
