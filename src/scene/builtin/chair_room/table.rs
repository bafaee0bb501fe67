//! The glass table and what stands on it.

use glam::{DAffine3, DVec3};

use super::Materials;
use crate::scene::builtin::model::{Model, turned};

/// Height of the table's upper side.
const HEIGHT: f64 = 0.73;
/// Thickness of its glass.
const THICKNESS: f64 = 0.014;
/// Its radius.
const RADIUS: f64 = 0.62;

/// A round slab of glass on a chromed trumpet, with its middle at `place`.
pub(super) fn table(model: &mut Model, materials: &Materials, place: DAffine3) {
    let (low, high, half) = (HEIGHT - THICKNESS, HEIGHT, 0.5 * THICKNESS);
    let inner = RADIUS - half;
    let edge = [
        (inner, low),
        (inner + 0.7 * half, low + 0.3 * half),
        (RADIUS, low + half),
        (inner + 0.7 * half, high - 0.3 * half),
        (inner, high),
    ];
    let bottom = [(0.0, low), (inner, low)];
    let top = [(inner, high), (0.0, high)];
    model.lathe(&[(&bottom, 2), (&edge, 6), (&top, 2)], 88, materials.glass, place);
    let trumpet = [
        (0.27, 0.0),
        (0.268, 0.010),
        (0.235, 0.020),
        (0.160, 0.034),
        (0.095, 0.070),
        (0.058, 0.140),
        (0.042, 0.240),
        (0.036, 0.360),
        (0.040, 0.480),
        (0.060, 0.590),
        (0.105, 0.670),
        (0.165, 0.712),
    ];
    let plate = [(0.165, 0.712), (0.165, low - 0.0005)];
    let lid = [(0.165, low - 0.0005), (0.0, low - 0.0005)];
    // Open where it stands on the floor.
    model.lathe(&[(&trumpet, 36), (&plate, 1), (&lid, 1)], 57, materials.chrome, place);
}

/// A vase, a ball of glass, and a bowl with fruit.
pub(super) fn things(model: &mut Model, materials: &Materials, place: DAffine3) {
    let on_top = |x: f64, z: f64| place * turned(0.0, DVec3::new(x, HEIGHT, z));
    let outside = [
        (0.0, 0.0),
        (0.040, 0.0),
        (0.058, 0.016),
        (0.082, 0.070),
        (0.084, 0.120),
        (0.058, 0.180),
        (0.030, 0.225),
        (0.024, 0.265),
        (0.030, 0.300),
        (0.040, 0.312),
        (0.034, 0.309),
        (0.020, 0.270),
        (0.018, 0.230),
        (0.0, 0.200),
    ];
    model.lathe(&[(&outside, 44)], 32, materials.porcelain, on_top(-0.10, -0.16));
    let ball = place.transform_point3(DVec3::new(0.27, HEIGHT + 0.0751, 0.12));
    model.ball(ball, 0.075, (36, 24), materials.crystal);
    let bowl = [
        (0.0, 0.0),
        (0.050, 0.0),
        (0.060, 0.008),
        (0.110, 0.030),
        (0.150, 0.070),
        (0.156, 0.082),
        (0.148, 0.076),
        (0.105, 0.038),
        (0.055, 0.018),
        (0.0, 0.014),
    ];
    let at = on_top(-0.22, 0.20);
    model.lathe(&[(&bowl, 24)], 38, materials.chrome, at);
    let fruit = [
        (-0.048, 0.050, 0.015),
        (0.047, 0.050, 0.025),
        (0.000, 0.051, -0.055),
        (0.0, 0.110, -0.005),
    ];
    for (x, y, z) in fruit {
        let centre = at.transform_point3(DVec3::new(x, y + 0.012, z));
        model.ball(centre, 0.040, (16, 10), materials.fruit);
    }
}
