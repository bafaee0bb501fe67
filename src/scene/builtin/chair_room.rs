//! The chair room: chairs around a glass table on a polished floor.

use glam::{DVec3, Vec3};

use super::Model;
use crate::scene::{Camera, Light, Material};

/// Puts the scene together.
pub(super) fn describe(model: &mut Model) {
    let floor = model.material(
        "floor",
        Material {
            diffuse: Vec3::new(0.45, 0.40, 0.34),
            reflection: Vec3::splat(0.2),
            ..Material::default()
        },
    );
    let wall = model
        .material("wall", Material { diffuse: Vec3::new(0.75, 0.68, 0.58), ..Material::default() });
    let corner = DVec3::new(-3.0, 0.0, 3.0);
    model.panel(corner, DVec3::X * 6.0, DVec3::Z * -6.0, (120, 120), floor);
    let back = DVec3::new(-3.0, 0.0, -3.0);
    model.panel(back, DVec3::X * 6.0, DVec3::Y * 3.0, (61, 60), wall);
    for (x, z) in [(-1.5, 1.0), (1.5, 1.2), (-1.2, -1.4), (1.4, -1.2)] {
        let position = DVec3::new(x, 2.7, z);
        model.draft.lights.push(Light::Point { position, intensity: Vec3::new(4.0, 3.7, 3.2) });
    }
    model.draft.camera = Some(Camera::look_at(
        DVec3::new(1.9, 1.55, 2.9),
        DVec3::new(0.0, 0.55, -0.2),
        DVec3::Y,
        0.75,
    ));
    model.draft.ambient = Vec3::splat(0.06);
    model.draft.exposure = Some(1.0);
}
