//! The stand: a basket of three arms, a column, a tripod.

use glam::{DAffine3, DVec3};

use super::{LIFT, Materials, RADIUS};
use crate::scene::builtin::model::{Model, turned};

/// Where the arms meet, below the lower head, along the drum's axis.
const HUB: f64 = -0.075;

pub(super) fn describe(model: &mut Model, materials: &Materials, drum: DAffine3) {
    for third in 0..3 {
        let turns = f64::from(third) / 3.0;
        arm(model, materials, drum * turned(turns + 0.19, DVec3::ZERO));
        leg(model, materials, turned(turns + 0.19, DVec3::ZERO));
    }
    let hub = drum.transform_point3(DVec3::Y * (HUB - 0.004));
    model.ball(hub, 0.024, (28, 18), materials.chrome);
    let column = [(0.0115, 0.05), (0.0115, hub.y)];
    let collar = [
        (0.0115, 0.140),
        (0.018, 0.141),
        (0.0195, 0.146),
        (0.0195, 0.166),
        (0.018, 0.171),
        (0.0115, 0.172),
    ];
    let foot = [
        (0.0, 0.046),
        (0.009, 0.046),
        (0.0165, 0.050),
        (0.0175, 0.058),
        (0.0165, 0.068),
        (0.0115, 0.070),
    ];
    let upright = DAffine3::IDENTITY;
    model.lathe(&[(&column, 4)], 20, materials.chrome, upright);
    model.lathe(&[(&collar, 12)], 20, materials.chrome, upright);
    model.lathe(&[(&foot, 12)], 20, materials.chrome, upright);
    // A wing screw on the collar.
    let screw = DVec3::new(-0.030, 0.156, 0.010);
    model.cuboid(
        screw - DVec3::new(0.012, 0.003, 0.002),
        screw + DVec3::new(0.012, 0.003, 0.002),
        materials.chrome,
        upright,
    );
}

/// From the hub outwards, up past the hoop, with a rubber grip that holds it.
fn arm(model: &mut Model, materials: &Materials, place: DAffine3) {
    let reach = RADIUS + 0.030;
    let points = [
        DVec3::new(0.012, HUB, 0.0),
        DVec3::new(0.070, HUB - 0.002, 0.0),
        DVec3::new(0.140, HUB + 0.008, 0.0),
        DVec3::new(0.190, HUB + 0.030, 0.0),
        DVec3::new(reach - 0.002, HUB + 0.060, 0.0),
        DVec3::new(reach, 0.002, 0.0),
    ];
    model.tube(&points, 0.0060, DVec3::Z, (12, 24), materials.chrome, place);
    let grip = [
        (0.0, -0.022),
        (0.0070, -0.022),
        (0.0082, -0.019),
        (0.0082, -0.008),
        (0.0074, -0.003),
        (0.0084, 0.002),
        (0.0084, 0.018),
        (0.0066, 0.021),
        (0.0, 0.022),
    ];
    let at = place * DAffine3::from_translation(DVec3::X * reach);
    model.lathe(&[(&grip, 20)], 16, materials.rubber, at);
}

/// From the collar down to the floor, a brace back to the foot of the column, a rubber shoe.
fn leg(model: &mut Model, materials: &Materials, place: DAffine3) {
    let points = [
        DVec3::new(0.018, 0.158, 0.0),
        DVec3::new(0.070, 0.142, 0.0),
        DVec3::new(0.150, 0.088, 0.0),
        DVec3::new(0.215, 0.034, 0.0),
        DVec3::new(0.250, 0.013, 0.0),
    ];
    model.tube(&points, 0.0070, DVec3::Z, (12, 18), materials.chrome, place);
    let brace = [DVec3::new(0.015, 0.058, 0.0), DVec3::new(0.150, 0.088, 0.0)];
    model.tube(&brace, 0.0042, DVec3::Z, (9, 2), materials.chrome, place);
    let shoe =
        [(0.0, 0.0), (0.013, 0.0), (0.0155, 0.004), (0.0145, 0.014), (0.0105, 0.021), (0.0, 0.023)];
    let at = place * DAffine3::from_translation(DVec3::X * 0.252);
    model.lathe(&[(&shoe, 12)], 16, materials.rubber, at);
}

const _: () = assert!(LIFT + HUB > 0.18, "the basket clears the collar");
