//! Lights for scenes that have too few of them, at places that depend on nothing but the scene.

use glam::{DVec3, Vec3};
use umbra::scene::{Light, Scene};

/// How far from the middle of a room lights are added, as a part of the way to its walls.
const WITHIN: f64 = 0.5;

/// How far outdoors, as a part of the way to the sides of the scene's box.
const BEYOND: f64 = 1.0;

/// How high above the scene's box outdoors, as a part of its radius seen from above: low enough for long shadows.
const ABOVE: f64 = 0.25;

/// The angle by which the next light is turned about the vertical: the golden one, which spreads any number evenly.
const GOLDEN: f64 = 2.399_963_229_728_653;

/// Gives a scene so many lights: of its own the first (a loader puts the brightest there), and point lights added.
///
/// Where the scene has a light inside its box, it is a room: lights are added at the height of that light, on an ellipse
/// half-way to the walls. Else the sun shines: lights are added a little above the box, on the ellipse that touches its
/// sides from within. Up is the axis that is most upwards in the picture.
pub fn give(scene: &mut Scene, count: usize) {
    scene.lights.truncate(count);
    let bounds = scene.bounds();
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    let up = axis_of(scene.camera.up);
    let height = |place: DVec3| place.dot(up);
    let across = [up.any_orthonormal_pair().0, up.any_orthonormal_pair().1];
    let indoors = scene.lights.iter().find_map(|light| match light {
        Light::Point { position, .. } | Light::Spot { position, .. } => {
            (position.cmpge(low).all() && position.cmple(high).all()).then_some(*position)
        }
        Light::Directional { .. } => None,
    });
    let radius = across.map(|axis| half.dot(axis.abs()));
    let (level, reach) = match indoors {
        Some(own) => (height(own), WITHIN),
        None => {
            let top = height(centre) + half.dot(up.abs());
            (top + ABOVE * radius[0].hypot(radius[1]), BEYOND)
        }
    };
    for number in scene.lights.len()..count {
        let (sine, cosine) = (number as f64 * GOLDEN).sin_cos();
        let aside = reach * (radius[0] * cosine * across[0] + radius[1] * sine * across[1]);
        let position = centre + aside + (level - height(centre)) * up;
        scene.lights.push(Light::Point { position, intensity: Vec3::ONE });
    }
}

/// The axis, with its sign, that a direction is nearest to.
fn axis_of(direction: DVec3) -> DVec3 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    axes.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction))).unwrap_or(DVec3::Y)
}

/// So many point lights in rows and columns over the rectangle that the point lights given span.
pub fn lattice(own: &[Light], count: usize) -> Vec<Light> {
    let places: Vec<DVec3> = own
        .iter()
        .filter_map(|light| match light {
            Light::Point { position, .. } => Some(*position),
            _ => None,
        })
        .collect();
    let low = places.iter().copied().reduce(DVec3::min).expect("it has point lights");
    let high = places.iter().copied().reduce(DVec3::max).expect("it has point lights");
    let side = (count as f64).sqrt().ceil() as usize;
    (0..count)
        .map(|number| {
            let along = |place: usize| (place as f64 + 0.5) / side as f64;
            let (x, z) = (along(number % side), along(number / side));
            let position = low + (high - low) * DVec3::new(x, 0.5, z);
            Light::Point { position, intensity: Vec3::ONE }
        })
        .collect()
}
