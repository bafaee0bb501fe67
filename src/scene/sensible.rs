//! A camera, lights and surroundings for files that have none. The scene's notes say what was chosen.

mod emitters;
mod room;

use glam::{DVec3, Vec3};

use super::{Camera, Light, Scene};
use crate::geometry::Bounds;
use room::Walls;

/// Vertical field of view of a chosen camera, in degrees.
const FIELD_OF_VIEW: f64 = 40.0;
/// Width over height of the pictures a chosen camera is made for.
const ASPECT: f64 = 1.25;
/// Share of the picture that the scene fills.
const FILLED: f64 = 0.94;
/// A scene is flat in an axis where it is smaller than this share of its other extents.
const FLAT: f64 = 0.25;
/// Emissive surfaces of a smaller share of the whole area are not what lights the scene.
const LEAST_SHARE: f64 = 1.0 / 300.0;
/// Irradiance of the sun.
const SUN: f32 = 3.0;

/// Looks at the scene from the front, right and above, so that all of it is seen; into a room with
/// one open side, from there; at a closed room, from within.
pub(super) fn add_camera(scene: &mut Scene, up: Option<DVec3>) {
    let bounds = scene.bounds();
    let chosen = if is_flat(&bounds, DVec3::Z) { DVec3::Z } else { DVec3::Y };
    let up = up.and_then(DVec3::try_normalize).unwrap_or(chosen);
    let walls = Walls::of(scene);
    let (camera, what) = if walls.close_a_room() {
        (walls.corner_view(scene, up), "looks about the closed room from a corner")
    } else if let Some(side) = walls.open_side() {
        (fitted(scene, side, up), "looks into the open side")
    } else {
        let front = if up.z.abs() > up.y.abs() { DVec3::NEG_Y } else { DVec3::Z };
        let height = if is_flat(&bounds, up) { 0.65 } else { 0.35 };
        let from = 0.45 * up.cross(front) + height * up + 0.82 * front;
        (fitted(scene, from, up), "sees the whole scene")
    };
    scene.camera = camera;
    let axis = if up == DVec3::Z { ", with Z up," } else { "" };
    scene
        .notes
        .push(format!("no usable camera{}: one{axis} that {what} was added", of_file(scene)));
}

/// Whether the extent along an axis is much smaller than both others.
fn is_flat(bounds: &Bounds, axis: DVec3) -> bool {
    let extent = bounds.extent().as_dvec3();
    let across = if axis.abs().max_element() == axis.x.abs() {
        extent.y.min(extent.z)
    } else if axis.abs().max_element() == axis.y.abs() {
        extent.x.min(extent.z)
    } else {
        extent.x.min(extent.y)
    };
    extent.dot(axis.abs()) < FLAT * across
}

/// The camera nearest to the scene that sees all of it from that direction.
///
/// The four planes of its view touch the scene: left with right, and top with bottom, give a distance
/// each, of which the greater holds.
fn fitted(scene: &Scene, from: DVec3, up: DVec3) -> Camera {
    let centre = scene.bounds().centre();
    let mut camera = Camera::facing(centre, -from, up, FIELD_OF_VIEW.to_radians());
    let high = (0.5 * camera.field_of_view).tan() * FILLED;
    let wide = high * ASPECT;
    let [mut right, mut left, mut top, mut bottom] = [f64::NEG_INFINITY; 4];
    for corner in scene.triangles.corners().iter().flatten() {
        let seen = corner.as_dvec3() - centre;
        let (x, y) = (seen.dot(camera.right), seen.dot(camera.up));
        let depth = seen.dot(camera.forward);
        (right, left) = (right.max(x - wide * depth), left.max(-x - wide * depth));
        (top, bottom) = (top.max(y - high * depth), bottom.max(-y - high * depth));
    }
    let distance = ((right + left) / (2.0 * wide)).max((top + bottom) / (2.0 * high));
    camera.position = centre - distance * camera.forward
        + 0.5 * (right - left) * camera.right
        + 0.5 * (top - bottom) * camera.up;
    camera
}

/// Lights in place of emissive surfaces, and a sun at the side of the camera where there are none or
/// they are but sparks in a large scene; in a room, into which hardly any sun comes, a lamp under the ceiling.
pub(super) fn add_lights(scene: &mut Scene) {
    let found = emitters::lights(scene);
    let mut added = Vec::new();
    if !found.lights.is_empty() {
        let chosen = match (found.lights.len(), found.surfaces) {
            (_, 1) => "its emissive surface".to_owned(),
            (lights, all) if lights == all => format!("each of its {all} emissive surfaces"),
            (lights, all) => format!("the {lights} brightest of its {all} emissive surfaces"),
        };
        added.push(format!("a point light before {chosen}"));
    }
    if found.beyond_f32 {
        scene.notes.push(
            "the emissive surfaces are too large or too small for lights in their place".to_owned(),
        );
    }
    if found.share < LEAST_SHARE || found.beyond_f32 {
        let lamp = Walls::of(scene).lamp_for(&scene.camera, Vec3::splat(SUN));
        let (what, light) = match lamp {
            Some(lamp) if emitters::is_held(scene.bounds().diagonal().powi(2)) => {
                ("a point light under the ceiling", lamp)
            }
            _ => ("a directional light", sun_beside(&scene.camera)),
        };
        added.push(what.to_owned());
        scene.lights.push(light);
    }
    scene.lights.extend(found.lights);
    scene.notes.push(format!("no usable light{}: added {}", of_file(scene), added.join(" and ")));
}

/// Where it was looked for; not every scene comes from a file.
fn of_file(scene: &Scene) -> &'static str {
    if scene.files.is_empty() { "" } else { " in the file" }
}

/// A sun low enough for shadows to be seen.
fn sun_beside(camera: &Camera) -> Light {
    let direction = 0.55 * camera.up - 0.15 * camera.forward - 0.8 * camera.right;
    Light::Directional { direction: direction.normalize(), irradiance: Vec3::splat(SUN) }
}

/// A little ambient light, so that shadows are not black.
pub(super) fn choose_ambient(scene: &mut Scene) {
    scene.ambient = 0.05 * total(scene);
}

/// A sky where a sun shines.
pub(super) fn choose_background(scene: &mut Scene) {
    let sunny = scene.lights.iter().any(|light| matches!(light, Light::Directional { .. }));
    scene.background = if sunny {
        total(scene).element_sum() / 3.0 * Vec3::new(0.10, 0.15, 0.22)
    } else {
        Vec3::ZERO
    };
}

/// What all lights give to a surface that faces them half a radius of the scene away.
fn total(scene: &Scene) -> Vec3 {
    let reach = (0.25 * scene.bounds().diagonal()).powi(2) as f32;
    let given = |light: &Light| match *light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity / reach,
        Light::Directional { irradiance, .. } => irradiance,
    };
    scene.lights.iter().map(given).sum()
}
