//! What a user of the library may hand over by mistake is refused in one clear line, and never renders nonsense.

mod engines;
mod names;
mod pictures;
mod scenes;

use umbra::glam::{DVec3, Vec3};
use umbra::scene::{Draft, DraftTriangle, Scene};

/// A triangle over the origin.
const SHEET: DraftTriangle = DraftTriangle {
    corners: [DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0)],
    normals: [Vec3::ZERO; 3],
    material: 0,
};

fn draft() -> Draft {
    Draft { triangles: vec![SHEET], ..Draft::default() }
}

fn scene() -> Scene {
    draft().finish().unwrap()
}
