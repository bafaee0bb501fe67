//! Spanky the snare drum.

use glam::{DAffine3, DVec3, Vec3};

use super::{MaterialId, Model};
use crate::scene::{Camera, Light, Material};

/// Puts the scene together.
pub(super) fn describe(model: &mut Model) {
    let floor = model.material(
        "floor",
        Material { diffuse: Vec3::splat(0.5), reflection: Vec3::splat(0.1), ..Material::default() },
    );
    let shell = model.material(
        "shell",
        Material {
            diffuse: Vec3::new(0.6, 0.1, 0.08),
            reflection: Vec3::splat(0.06),
            highlight: Vec3::splat(0.5),
            shininess: 60.0,
            ..Material::default()
        },
    );
    let head = model
        .material("head", Material { diffuse: Vec3::new(0.85, 0.83, 0.78), ..Material::default() });
    body(model, shell, head);
    let corner = DVec3::new(-2.0, 0.0, 2.0);
    model.panel(corner, DVec3::X * 4.0, DVec3::Z * -4.0, (23, 22), floor);
    for (x, y, z) in [
        (-1.0, 1.5, 1.0),
        (1.0, 1.6, 1.2),
        (0.0, 2.0, 0.5),
        (-1.4, 1.0, -0.6),
        (1.4, 1.2, -0.4),
        (0.3, 1.8, 1.6),
    ] {
        let position = DVec3::new(x, y, z);
        model.draft.lights.push(Light::Point { position, intensity: Vec3::splat(0.9) });
    }
    model.draft.camera =
        Some(Camera::look_at(DVec3::new(0.5, 0.75, 1.1), DVec3::new(0.0, 0.2, 0.0), DVec3::Y, 0.5));
    model.draft.ambient = Vec3::splat(0.05);
    model.draft.exposure = Some(1.0);
}

fn body(model: &mut Model, shell: MaterialId, head: MaterialId) {
    let (radius, low, high) = (0.18, 0.14, 0.28);
    model.lathe(&[(&[(radius, low), (radius, high)], 60)], 240, shell, DAffine3::IDENTITY);
    model.lathe(&[(&[(0.0, low), (radius, low)], 30)], 240, head, DAffine3::IDENTITY);
    model.lathe(&[(&[(radius, high), (0.0, high)], 33)], 240, head, DAffine3::IDENTITY);
}
