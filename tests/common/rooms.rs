//! Small scenes with mirrors and glass, and backends over them.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use glam::{DVec3, Vec3};
use umbra::geometry::Triangle;
use umbra::occlusion::{Backend, Occlusion, Test};
use umbra::scene::{Camera, Draft, DraftTriangle, Light, Material, Scene, builtin};

use super::common::{BACKENDS, engine, soup, sphere};

/// Every backend over a scene.
pub fn backends(scene: &Scene) -> Vec<(Backend, Box<dyn Occlusion>)> {
    BACKENDS.iter().map(|&name| (name, engine(name, Test::Pluecker, &scene.triangles))).collect()
}

/// A box full of small triangles, a mirrored ball and a glass ball: every kind of ray occurs, and
/// rays to lights pass glass, once, twice, and before and behind opaque triangles.
pub fn glass_room() -> Scene {
    let plain = Material::default();
    let mirror = Material { reflection: Vec3::splat(0.6), ..Material::default() };
    let glass = Material {
        diffuse: Vec3::splat(0.1),
        transmission: Vec3::new(0.9, 0.7, 0.5),
        refraction_index: 1.3,
        ..Material::default()
    };
    let sheet = Material { refraction_index: 1.0, ..glass.clone() };
    let mut draft = Draft {
        name: "glass room".to_owned(),
        materials: vec![plain, mirror, glass, sheet],
        ambient: Vec3::splat(0.05),
        ..Draft::default()
    };
    let wall = |a: Vec3, b: Vec3, c: Vec3| [[a, b, c], [a + c - b, c, a]];
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * 1.5;
    add(&mut draft, 0, &wall(corner(-1., -1., 1.), corner(-1., -1., -1.), corner(1., -1., -1.)));
    add(&mut draft, 1, &wall(corner(-1., -1., -1.), corner(-1., 1., -1.), corner(1., 1., -1.)));
    add(&mut draft, 0, &soup(500, 0.12, 31));
    add(&mut draft, 3, &soup(60, 0.25, 32));
    add(&mut draft, 1, &sphere(Vec3::new(-0.5, -0.7, 0.3), 0.4, 10));
    add(&mut draft, 2, &sphere(Vec3::new(0.5, -0.6, 0.5), 0.45, 10));
    for position in [DVec3::new(1.2, 1.4, 0.9), DVec3::new(-1.0, 1.3, 1.2)] {
        draft.lights.push(Light::Point { position, intensity: Vec3::splat(3.0) });
    }
    draft.lights.push(Light::Directional {
        direction: DVec3::new(0.2, 0.9, 0.4).normalize(),
        irradiance: Vec3::splat(0.8),
    });
    draft.camera = Some(Camera::look_at(DVec3::new(0.2, 0.4, 4.0), DVec3::ZERO, DVec3::Y, 0.8));
    draft.finish().unwrap()
}

/// The paper's chair room with few triangles.
pub fn small_chair_room() -> Scene {
    builtin::draft_at("chair-room", 0.03).unwrap().finish().unwrap()
}

fn add(draft: &mut Draft, material: u32, triangles: &[Triangle]) {
    draft.triangles.extend(triangles.iter().map(|triangle| DraftTriangle {
        corners: triangle.map(|corner| corner.as_dvec3()),
        normals: [Vec3::ZERO; 3],
        material,
    }));
}
