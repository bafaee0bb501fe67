//! A camera, lights and surroundings for files that have none. The scene's notes say what was chosen.

mod emitters;

use glam::{DVec3, Vec3};

use super::{Camera, Light, Scene};
use crate::geometry::Bounds;

/// Vertical field of view of a chosen camera, in degrees.
const FIELD_OF_VIEW: f64 = 40.0;
/// Width over height of the pictures a chosen camera is made for.
const ASPECT: f64 = 1.25;
/// A scene is taken to have Z up if its height in Z is less than this share of its other extents.
const FLAT: f32 = 0.25;

/// Looks at the middle of the scene from the front, right and above, so that all of it is seen; into
/// a room with one open side, from there.
pub(super) fn add_camera(scene: &mut Scene, up: Option<DVec3>) {
    let bounds = scene.bounds();
    let extent = bounds.extent();
    let is_flat = extent.z < FLAT * extent.x.min(extent.y);
    let up = up.unwrap_or(if is_flat { DVec3::Z } else { DVec3::Y });
    let (from, what) = match open_side(scene, &bounds) {
        Some(side) => (side, "that looks into the open side"),
        None => {
            let front = if up.z.abs() > up.y.abs() { DVec3::NEG_Y } else { DVec3::Z };
            let right = up.cross(front);
            ((0.45 * right + 0.35 * up + 0.82 * front), "that sees the whole scene")
        }
    };
    scene.camera = fitted(&bounds, from, up);
    let axis = if up == DVec3::Z { ", with Z up," } else { "" };
    scene.notes.push(format!("no camera in the file: one{axis} {what} was added"));
}

/// The camera that sees all of the box from that side, as near as can be.
fn fitted(bounds: &Bounds, from: DVec3, up: DVec3) -> Camera {
    let centre = bounds.centre();
    let mut camera = Camera::facing(centre, -from, up, FIELD_OF_VIEW.to_radians());
    let vertical = (0.5 * camera.field_of_view).tan();
    let distance = corners(bounds)
        .map(|corner| {
            let (x, y) = ((corner - centre).dot(camera.right), (corner - centre).dot(camera.up));
            let z = (corner - centre).dot(camera.forward);
            (x.abs() / (vertical * ASPECT)).max(y.abs() / vertical) - z
        })
        .fold(0.0, f64::max);
    camera.position = centre - 1.03 * distance * camera.forward;
    camera
}

fn corners(bounds: &Bounds) -> impl Iterator<Item = DVec3> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    (0..8).map(move |i| {
        DVec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    })
}

/// The one side of the box that has no wall while the other five have.
fn open_side(scene: &Scene, bounds: &Bounds) -> Option<DVec3> {
    let walls = walls(scene, bounds);
    let mut open = None;
    for (side, covered) in walls {
        if covered < 0.1 {
            if open.replace(side).is_some() {
                return None;
            }
        } else if covered < 0.8 {
            return None;
        }
    }
    open
}

/// How much of each side of the box is covered by triangles that lie along it, as a share.
fn walls(scene: &Scene, bounds: &Bounds) -> [(DVec3, f64); 6] {
    // A wall lies within a twentieth of the extent, and is turned by less than about ten degrees.
    const NEAR: f64 = 0.05;
    const PARALLEL: f64 = 0.985;
    let extent = bounds.extent().as_dvec3();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut walls =
        [0, 1, 2, 3, 4, 5].map(|i| (if i % 2 == 0 { axes[i / 2] } else { -axes[i / 2] }, 0.0));
    for (id, _) in (0..).zip(scene.triangles.corners()) {
        let corners = scene.triangles.get(id).map(|corner| corner.as_dvec3());
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        for (side, covered) in &mut walls {
            let seen = area.dot(*side).abs();
            let depth = |corner: &DVec3| {
                (0.5 - NEAR) * extent.dot(side.abs()) <= (*corner - bounds.centre()).dot(*side)
            };
            if seen > PARALLEL * area.length() && corners.iter().all(depth) {
                let size = extent.x * extent.y * extent.z / extent.dot(side.abs());
                *covered += seen / size;
            }
        }
    }
    walls
}

/// Lights in place of emissive surfaces, and a sun over the shoulder of the camera where there are
/// none or the scene lies open to the sky.
pub(super) fn add_lights(scene: &mut Scene) {
    let found = emitters::lights(scene);
    if found.lights.is_empty() {
        let camera = &scene.camera;
        let direction = (camera.up - 0.6 * camera.forward - 0.5 * camera.right).normalize();
        scene.lights.push(Light::Directional { direction, irradiance: Vec3::splat(SUN) });
        scene.notes.push("no light in the file: a directional one was added".to_owned());
        return;
    }
    let left_out = match found.surfaces - found.lights.len() {
        0 => String::new(),
        rest => format!(", the brightest; {rest} more are left dark"),
    };
    scene.notes.push(format!(
        "no light in the file: {} point lights were put before its emissive surfaces{left_out}",
        found.lights.len()
    ));
    scene.lights = found.lights;
}

/// Irradiance of the sun.
const SUN: f32 = 3.0;

/// A little ambient light, so that shadows are not black, and a sky where a sun shines.
pub(super) fn choose_surroundings(scene: &mut Scene) {
    // What a light gives to a surface that faces it half a radius of the scene away.
    let reach = (0.25 * scene.bounds().diagonal()).powi(2) as f32;
    let total: Vec3 = scene
        .lights
        .iter()
        .map(|light| match *light {
            Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity / reach,
            Light::Directional { irradiance, .. } => irradiance,
        })
        .sum();
    scene.ambient = 0.05 * total;
    let sunny = scene.lights.iter().any(|light| matches!(light, Light::Directional { .. }));
    scene.background =
        if sunny { total.element_sum() / 3.0 * Vec3::new(0.13, 0.18, 0.25) } else { Vec3::ZERO };
}
