//! Shell, heads and hoops: everything that is turned around the drum's axis. The snare wires too.

use glam::{DAffine3, DVec3};

use super::{HEIGHT, Materials, RADIUS, STRAINER};
use crate::geometry::surface::cosine_and_sine;
use crate::scene::builtin::model::{Model, aimed, turned};

/// Cells around the drum.
const AROUND: usize = 114;
/// Snare wires, and the distance between them.
const WIRES: u32 = 20;
const WIRE_PITCH: f64 = 0.0026;
/// A wire's coil.
const COIL_RADIUS: f64 = 0.0010;
const COIL_TURNS: u32 = 17;
/// Half the length of the coils.
const COIL_REACH: f64 = 0.128;

pub(super) fn describe(model: &mut Model, materials: &Materials, place: DAffine3) {
    let shell = [
        (0.000, 0.034, 4, materials.lacquer),
        (0.034, 0.039, 1, materials.inlay),
        (0.039, HEIGHT - 0.039, 8, materials.lacquer),
        (HEIGHT - 0.039, HEIGHT - 0.034, 1, materials.inlay),
        (HEIGHT - 0.034, HEIGHT, 4, materials.lacquer),
    ];
    for (from, to, along, material) in shell {
        model.lathe(&[(&[(RADIUS, from), (RADIUS, to)], along)], AROUND, material, place);
    }
    heads(model, materials, place);
    hoop(model, materials, place);
    hoop(model, materials, place * upside_down());
    wires(model, materials, place * turned(STRAINER, DVec3::ZERO));
    badge(model, materials, place);
}

/// Upper edge and lower edge of the drum change places, by half a turn about X.
pub(super) fn upside_down() -> DAffine3 {
    DAffine3::from_mat3_translation(
        glam::DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z),
        DVec3::Y * HEIGHT,
    )
}

/// Each head is tucked over the edge of the shell; the upper one has a dot in its middle.
fn heads(model: &mut Model, materials: &Materials, place: DAffine3) {
    let (out, top) = (RADIUS + 0.0025, HEIGHT + 0.003);
    let collar = [
        (out + 0.002, HEIGHT - 0.008),
        (out, HEIGHT - 0.002),
        (out - 0.002, HEIGHT + 0.002),
        (out - 0.006, top),
    ];
    let dot = 0.052;
    let skin = [(out - 0.006, top), (dot, top)];
    let thick = [(dot, top), (dot - 0.0006, top + 0.0005), (dot - 0.002, top + 0.0006)];
    let middle = [(dot - 0.002, top + 0.0006), (0.0, top + 0.0006)];
    model.lathe(&[(&collar, 6), (&skin, 5)], AROUND, materials.coated, place);
    model.lathe(&[(&thick, 2), (&middle, 3)], 90, materials.dot, place);
    let whole = [(out - 0.006, top), (0.0, top)];
    let below = place * upside_down();
    model.lathe(&[(&collar, 4), (&whole, 6)], AROUND, materials.film, below);
}

/// A triple-flanged hoop around the upper edge.
fn hoop(model: &mut Model, materials: &Materials, place: DAffine3) {
    let at = |(radius, height): (f64, f64)| (RADIUS + radius, HEIGHT + height);
    let bottom = [(0.0055, -0.017), (0.0120, -0.0172), (0.0190, -0.017)].map(at);
    let outside = [
        (0.0190, -0.017),
        (0.0197, -0.0155),
        (0.0188, -0.0140),
        (0.0120, -0.0130),
        (0.0088, -0.0100),
        (0.0082, 0.0000),
        (0.0086, 0.0085),
        (0.0110, 0.0112),
        (0.0150, 0.0120),
        (0.0160, 0.0134),
        (0.0148, 0.0148),
        (0.0095, 0.0142),
        (0.0060, 0.0105),
        (0.0055, 0.0000),
        (0.0055, -0.0170),
    ]
    .map(at);
    model.lathe(&[(&bottom, 2), (&outside, 20)], AROUND, materials.chrome, place);
}

/// Twenty coiled wires under the lower head, between two plates.
fn wires(model: &mut Model, materials: &Materials, place: DAffine3) {
    const POINTS_A_TURN: u32 = 6;
    let level = -0.003 - 0.0006 - COIL_RADIUS - 0.0004;
    for wire in 0..WIRES {
        let z = (f64::from(wire) - 0.5 * f64::from(WIRES - 1)) * WIRE_PITCH;
        let points: Vec<_> = (0..=COIL_TURNS * POINTS_A_TURN)
            .map(|step| {
                let turns = f64::from(step) / f64::from(POINTS_A_TURN);
                let (cosine, sine) = cosine_and_sine(turns);
                let along = COIL_REACH * (2.0 * turns / f64::from(COIL_TURNS) - 1.0);
                DVec3::new(along, level + COIL_RADIUS * cosine, z + COIL_RADIUS * sine)
            })
            .collect();
        // The coils are wide open: X is not far from their direction, so the side is across it.
        model.tube(
            &points,
            0.00045,
            DVec3::Y,
            (3, (COIL_TURNS * POINTS_A_TURN) as usize),
            materials.steel,
            place,
        );
    }
    let half = 0.5 * f64::from(WIRES) * WIRE_PITCH + 0.002;
    for x in [-COIL_REACH, COIL_REACH] {
        let low = DVec3::new(x - 0.006, level - 0.0016, -half);
        let high = DVec3::new(x + 0.006, level + 0.0012, half);
        model.cuboid(low, high, materials.chrome, place);
    }
}

/// A brass badge on the front of the shell.
fn badge(model: &mut Model, materials: &Materials, place: DAffine3) {
    const TURNS: f64 = 0.70;
    let plate = [(0.0170, 0.0), (0.0170, 0.0012), (0.0160, 0.0018), (0.0148, 0.0014)];
    let face = [(0.0148, 0.0014), (0.0, 0.0010)];
    let at = DVec3::new(RADIUS - 0.0008, 0.5 * HEIGHT, 0.0);
    let front = place * turned(TURNS, DVec3::ZERO) * aimed(DVec3::X, at);
    model.lathe(&[(&plate, 4), (&face, 2)], 30, materials.brass, front);
}
