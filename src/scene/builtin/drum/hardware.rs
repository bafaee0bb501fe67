//! Lugs, tension rods and claws, the strainer with its lever, and the sticks on the head.

use glam::{DAffine3, DVec3};

use super::body::upside_down;
use super::{HEIGHT, Materials, RADIUS, STRAINER};
use crate::scene::builtin::model::{Model, aimed, turned};

/// Lugs around the shell.
const LUGS: u32 = 10;
/// How far the rods are from the shell.
const ROD: f64 = RADIUS + 0.0145;

pub(super) fn describe(model: &mut Model, materials: &Materials, place: DAffine3) {
    for lug in 0..LUGS {
        let turns = (f64::from(lug) + 0.5) / f64::from(LUGS);
        let around = place * turned(turns, DVec3::ZERO);
        lug_body(model, materials, around);
        rod(model, materials, around);
        // Half a turn about X keeps the rod in its place: it lies in the plane z = 0.
        rod(model, materials, around * upside_down());
    }
    strainer(model, materials, place);
    sticks(model, materials, place);
}

/// A turned post for both rods, on two feet.
fn lug_body(model: &mut Model, materials: &Materials, place: DAffine3) {
    let profile = [
        (0.0, 0.030),
        (0.0050, 0.0302),
        (0.0064, 0.034),
        (0.0060, 0.040),
        (0.0072, 0.043),
        (0.0072, 0.048),
        (0.0056, 0.053),
        (0.0050, 0.070),
        (0.0056, 0.087),
        (0.0072, 0.092),
        (0.0072, 0.097),
        (0.0060, 0.100),
        (0.0064, 0.106),
        (0.0050, 0.1098),
        (0.0, 0.110),
    ];
    let post = place * DAffine3::from_translation(DVec3::X * ROD);
    model.lathe(&[(&profile, 22)], 14, materials.chrome, post);
    for height in [0.0455, 0.0945] {
        let foot = [(0.0085, 0.0), (0.0080, 0.002), (0.0045, 0.004), (0.0040, 0.0145)];
        let at = place * aimed(DVec3::X, DVec3::new(RADIUS - 0.0005, height, 0.0));
        model.lathe(&[(&foot, 4)], 10, materials.chrome, at);
    }
}

/// The upper rod: its shaft, the claw that holds the hoop, the washer and the head.
fn rod(model: &mut Model, materials: &Materials, place: DAffine3) {
    let axis = place * DAffine3::from_translation(DVec3::X * ROD);
    let shaft = [(0.0026, 0.108), (0.0026, HEIGHT - 0.013)];
    model.lathe(&[(&shaft, 2)], 9, materials.chrome, axis);
    let claw = [
        (0.0030, HEIGHT - 0.0215),
        (0.0068, HEIGHT - 0.0205),
        (0.0076, HEIGHT - 0.0165),
        (0.0074, HEIGHT - 0.0120),
        (0.0066, HEIGHT - 0.0095),
        (0.0052, HEIGHT - 0.0090),
    ];
    model.lathe(&[(&claw, 6)], 12, materials.chrome, axis);
    let washer = [
        (0.0052, HEIGHT - 0.0090),
        (0.0054, HEIGHT - 0.0080),
        (0.0040, HEIGHT - 0.0074),
        (0.0036, HEIGHT - 0.0060),
    ];
    model.lathe(&[(&washer, 3)], 12, materials.chrome, axis);
    let head = [(0.0036, HEIGHT - 0.0060), (0.0034, HEIGHT + 0.0015)];
    let lid = [(0.0034, HEIGHT + 0.0015), (0.0, HEIGHT + 0.0020)];
    model.lathe(&[(&head, 1), (&lid, 1)], 8, materials.chrome, axis);
}

/// The throw-off on one side, its counterpart on the other.
fn strainer(model: &mut Model, materials: &Materials, place: DAffine3) {
    let block = |model: &mut Model, x: (f64, f64), y: (f64, f64), half: f64, place: DAffine3| {
        let (low, high) = (DVec3::new(x.0, y.0, -half), DVec3::new(x.1, y.1, half));
        model.cuboid(low, high, materials.chrome, place);
    };
    let front = place * turned(STRAINER, DVec3::ZERO);
    block(model, (RADIUS - 0.002, RADIUS + 0.006), (0.020, 0.105), 0.017, front);
    block(model, (RADIUS + 0.006, RADIUS + 0.020), (0.030, 0.085), 0.012, front);
    block(model, (RADIUS + 0.008, RADIUS + 0.016), (-0.010, 0.030), 0.010, front);
    let knob = [(0.0060, 0.0), (0.0064, 0.001), (0.0064, 0.011), (0.0056, 0.013), (0.0, 0.0135)];
    let on_top = front * DAffine3::from_translation(DVec3::new(RADIUS + 0.013, 0.085, 0.0));
    model.lathe(&[(&knob, 10)], 18, materials.chrome, on_top);
    // The lever: thrown off, it would hang down.
    let lever = [
        DVec3::new(RADIUS + 0.021, 0.042, 0.0),
        DVec3::new(RADIUS + 0.028, 0.060, 0.0),
        DVec3::new(RADIUS + 0.030, 0.080, 0.0),
        DVec3::new(RADIUS + 0.036, 0.100, 0.0),
    ];
    model.tube(&lever, 0.0045, DVec3::Z, (12, 18), materials.chrome, front);
    let tip = front.transform_point3(lever[3]);
    model.ball(tip, 0.0062, (16, 10), materials.rubber);
    let back = place * turned(STRAINER + 0.5, DVec3::ZERO);
    block(model, (RADIUS - 0.002, RADIUS + 0.008), (0.015, 0.060), 0.016, back);
    block(model, (RADIUS + 0.008, RADIUS + 0.013), (-0.010, 0.045), 0.011, back);
}

/// Two sticks crossed on the head.
fn sticks(model: &mut Model, materials: &Materials, place: DAffine3) {
    let profile = [
        (0.0, 0.0),
        (0.0030, 0.0012),
        (0.0048, 0.0060),
        (0.0046, 0.0100),
        (0.0030, 0.0150),
        (0.0031, 0.0200),
        (0.0048, 0.0600),
        (0.0070, 0.1300),
        (0.0073, 0.2400),
        (0.0073, 0.3850),
        (0.0068, 0.3960),
        (0.0040, 0.4035),
        (0.0, 0.4050),
    ];
    // The first lies on the head and the hoop; the second on the head and, beyond its middle, on
    // the first.
    let head = HEIGHT + 0.003;
    let laid = [
        (DVec3::new(-0.078, head + 0.0050, -0.118), DVec3::new(0.022, 0.0143, 0.302)),
        (DVec3::new(0.140, head + 0.0055, -0.029), DVec3::new(-0.250, 0.0345, 0.206)),
    ];
    for (tip, along) in laid {
        let at = place * aimed(along, tip);
        model.lathe(&[(&profile, 42)], 18, materials.wood, at);
    }
}
