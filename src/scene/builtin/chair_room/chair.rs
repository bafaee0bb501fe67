//! Chairs: a moulded shell on chromed legs, and a cantilever from one piece.

use glam::{DAffine3, DVec3};

use crate::geometry::surface::{Sheet, cosine_and_sine};
use crate::scene::builtin::model::{MaterialId, Model};

/// One cross-section of a moulded body, which faces +Z: its middle lies in the plane X = 0.
struct Station {
    /// Place of the middle along Z and Y.
    z: f64,
    y: f64,
    /// Half the width.
    half_width: f64,
    /// How far the sides bend out of the middle, towards the person who sits.
    dish: f64,
}

const fn station(z: f64, y: f64, half_width: f64, dish: f64) -> Station {
    Station { z, y, half_width, dish }
}

/// Points around each cross-section.
const AROUND: usize = 12;

/// A body around stations; the first and the last one are its round ends and have no width.
fn body(stations: &[Station], half_thickness: f64) -> Sheet {
    let middle = |i: usize| DVec3::new(0.0, stations[i].y, stations[i].z);
    let last = stations.len() - 1;
    let loops: Vec<Vec<DVec3>> = (1..last)
        .map(|i| {
            let along = (middle(i + 1) - middle(i - 1)).normalize();
            let below = along.cross(DVec3::X);
            let Station { half_width, dish, .. } = stations[i];
            (0..AROUND)
                .map(|k| {
                    let (cosine, sine) = cosine_and_sine(k as f64 / AROUND as f64);
                    // Fuller than an ellipse, so that the shell keeps its thickness to the rim.
                    let fullness = sine * (2.0 - sine * sine);
                    let depth = half_thickness * fullness - dish * cosine * cosine;
                    middle(i) + DVec3::X * (half_width * cosine) + below * depth
                })
                .collect()
        })
        .collect();
    Sheet::body(middle(0), &loops, middle(last))
}

/// From the front edge of the seat to the top of the back, with a waist between them.
const SHELL: [Station; 15] = [
    station(0.240, 0.438, 0.0, 0.0),
    station(0.232, 0.446, 0.110, 0.000),
    station(0.205, 0.454, 0.180, 0.002),
    station(0.150, 0.457, 0.214, 0.008),
    station(0.070, 0.452, 0.228, 0.014),
    station(-0.020, 0.445, 0.226, 0.018),
    station(-0.110, 0.442, 0.200, 0.016),
    station(-0.180, 0.458, 0.158, 0.012),
    station(-0.222, 0.510, 0.132, 0.010),
    station(-0.246, 0.590, 0.150, 0.016),
    station(-0.266, 0.670, 0.188, 0.030),
    station(-0.286, 0.745, 0.205, 0.036),
    station(-0.303, 0.805, 0.188, 0.028),
    station(-0.314, 0.842, 0.120, 0.012),
    station(-0.317, 0.853, 0.0, 0.0),
];

/// A chair at `place`, its legs ending at Y = 0.
pub(super) fn shell_chair(
    model: &mut Model,
    shell: MaterialId,
    chrome: MaterialId,
    rubber: MaterialId,
    place: DAffine3,
) {
    model.surface(&body(&SHELL, 0.007), (36, 46), shell, place);
    // A disc under the seat, from which the legs spread.
    let hub = [(0.0, 0.410), (0.045, 0.410), (0.060, 0.416), (0.060, 0.436)];
    let below = place * DAffine3::from_translation(DVec3::new(0.0, 0.0, -0.01));
    model.lathe(&[(&hub, 4)], 18, chrome, below);
    for (x, z) in [(0.21, 0.19), (-0.21, 0.19), (-0.20, -0.215), (0.20, -0.215)] {
        let leg = |reach: f64, height: f64| DVec3::new(x * reach, height, z * reach);
        let points = [
            leg(0.10, 0.424),
            leg(0.40, 0.422),
            leg(0.66, 0.412),
            leg(0.80, 0.370),
            leg(0.87, 0.270),
            leg(0.94, 0.130),
            leg(1.00, 0.012),
        ];
        let side = DVec3::new(z, 0.0, -x);
        model.tube(&points, 0.0085, side, (9, 20), chrome, below);
        let foot = [(0.0, 0.0), (0.013, 0.0), (0.014, 0.010), (0.0105, 0.024), (0.0, 0.026)];
        let at = below * DAffine3::from_translation(leg(1.005, 0.0));
        model.lathe(&[(&foot, 5)], 9, rubber, at);
    }
}

/// From the tail on the floor up to the front edge, back along the seat, up to the top.
const CANTILEVER: [Station; 19] = [
    station(-0.300, 0.012, 0.0, 0.0),
    station(-0.285, 0.016, 0.150, 0.004),
    station(-0.220, 0.024, 0.235, 0.010),
    station(-0.120, 0.034, 0.245, 0.024),
    station(-0.010, 0.055, 0.225, 0.040),
    station(0.090, 0.110, 0.210, 0.050),
    station(0.150, 0.205, 0.205, 0.050),
    station(0.190, 0.310, 0.212, 0.036),
    station(0.222, 0.395, 0.222, 0.004),
    station(0.200, 0.438, 0.232, -0.020),
    station(0.100, 0.436, 0.240, 0.016),
    station(-0.010, 0.420, 0.240, 0.036),
    station(-0.110, 0.416, 0.232, 0.044),
    station(-0.190, 0.448, 0.222, 0.048),
    station(-0.235, 0.530, 0.212, 0.046),
    station(-0.262, 0.640, 0.208, 0.040),
    station(-0.288, 0.745, 0.196, 0.030),
    station(-0.310, 0.820, 0.130, 0.012),
    station(-0.316, 0.838, 0.0, 0.0),
];

/// A chair of one piece that swings forward from its foot.
pub(super) fn cantilever_chair(model: &mut Model, shell: MaterialId, place: DAffine3) {
    model.surface(&body(&CANTILEVER, 0.009), (44, 64), shell, place);
}
