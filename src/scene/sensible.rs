//! A camera and lights for files that have none. The scene's notes say what was chosen.

use glam::{DVec3, Vec3};

use super::{Camera, Light, Scene};

/// Looks at the middle of the scene from the front, right and above, so that all of it is seen.
pub(super) fn add_camera(scene: &mut Scene) {
    let bounds = scene.bounds();
    let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
    let field_of_view = 40f64.to_radians();
    let distance = radius / (0.5 * field_of_view).sin();
    let position = centre + distance * DVec3::new(0.45, 0.35, 0.82).normalize();
    scene.camera = Camera::look_at(position, centre, DVec3::Y, field_of_view);
    scene.notes.push("no camera in the file: one that sees the whole scene was added".to_owned());
}

/// A sun over the shoulder of the camera.
pub(super) fn add_lights(scene: &mut Scene) {
    let camera = &scene.camera;
    let direction = (camera.up - 0.6 * camera.forward - 0.5 * camera.right).normalize();
    scene.lights.push(Light::Directional { direction, irradiance: Vec3::splat(3.0) });
    scene.notes.push("no light in the file: a directional one was added".to_owned());
}
