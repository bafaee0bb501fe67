//! The chair room: moulded chairs around a glass table, a polished floor, a mirror.

mod chair;
mod room;
mod table;

use glam::{DVec3, Vec3};

use super::model::{MaterialId, Model, turned};
use crate::scene::{Camera, Light, Material};

/// Where the table stands.
const TABLE: DVec3 = DVec3::new(0.0, 0.0, -0.35);

/// Puts the scene together.
pub(super) fn describe(model: &mut Model) {
    let materials = Materials::add(model);
    room::describe(model, &materials);
    let table_place = turned(0.0, TABLE);
    table::table(model, &materials, table_place);
    table::things(model, &materials, table_place);
    // Each looks at the table, a little askew: its own front is +Z.
    for (turns, distance, askew, shell) in [
        (0.055, 0.84, 0.035, materials.shells[0]),
        (0.33, 0.74, -0.02, materials.shells[1]),
        (0.61, 0.76, 0.015, materials.shells[2]),
        (0.84, 0.88, 0.03, materials.shells[1]),
    ] {
        let away = turned(turns, TABLE).transform_vector3(DVec3::Z * distance);
        let place = turned(turns + 0.5 + askew, TABLE + away);
        chair::shell_chair(model, shell, materials.chrome, materials.rubber, place);
    }
    chair::cantilever_chair(
        model,
        materials.shells[3],
        turned(0.12, DVec3::new(-1.95, 0.0, -1.75)),
    );
    light(model, &materials);
    look(model);
}

/// Four lamps under the ceiling, each below a disc that seems to shine.
fn light(model: &mut Model, materials: &Materials) {
    let lamps = [(-1.5, 1.1), (1.5, 1.1), (-1.5, -1.5), (1.5, -1.5)];
    for (x, z) in lamps {
        let disc = [(0.0, 0.0), (0.13, 0.0), (0.15, 0.02), (0.15, 0.05)];
        let place = turned(0.0, DVec3::new(x, room::HEIGHT - 0.045, z));
        model.lathe(&[(&disc, 6)], 25, materials.lamp, place);
        let position = DVec3::new(x, room::HEIGHT - 0.12, z);
        model.draft.lights.push(Light::Point { position, intensity: Vec3::new(7.4, 6.7, 5.8) });
    }
}

fn look(model: &mut Model) {
    model.draft.camera = Some(Camera::look_at(
        DVec3::new(1.55, 1.38, 2.55),
        DVec3::new(-0.16, 0.66, -0.55),
        DVec3::Y,
        0.66,
    ));
    model.draft.ambient = Vec3::new(0.13, 0.125, 0.12);
    model.draft.exposure = Some(1.0);
}

/// What things in the room are made of.
struct Materials {
    tiles: [MaterialId; 2],
    wall: MaterialId,
    panelling: MaterialId,
    ceiling: MaterialId,
    sky: MaterialId,
    lamp: MaterialId,
    mirror: MaterialId,
    frame: MaterialId,
    glass: MaterialId,
    crystal: MaterialId,
    chrome: MaterialId,
    rubber: MaterialId,
    porcelain: MaterialId,
    fruit: MaterialId,
    shells: [MaterialId; 4],
}

impl Materials {
    fn add(model: &mut Model) -> Self {
        let matt = |r: f32, g: f32, b: f32| Material {
            diffuse: Vec3::new(r, g, b),
            ..Material::default()
        };
        let glossy = |r: f32, g: f32, b: f32, reflection: f32| Material {
            reflection: Vec3::splat(reflection),
            highlight: Vec3::splat(0.16),
            shininess: 90.0,
            ..matt(r, g, b)
        };
        let glass = |r: f32, g: f32, b: f32| Material {
            transmission: Vec3::new(r, g, b),
            refraction_index: 1.5,
            highlight: Vec3::splat(0.2),
            shininess: 300.0,
            ..glossy(0.0, 0.0, 0.0, 0.0)
        };
        let shining = |r: f32, g: f32, b: f32| Material {
            emission: Vec3::new(r, g, b),
            ..matt(0.0, 0.0, 0.0)
        };
        Self {
            tiles: [
                model.material("light tile", glossy(0.62, 0.56, 0.47, 0.10)),
                model.material("dark tile", glossy(0.23, 0.20, 0.18, 0.10)),
            ],
            wall: model.material("wall", matt(0.60, 0.52, 0.42)),
            panelling: model.material("panelling", matt(0.78, 0.74, 0.66)),
            ceiling: model.material("ceiling", matt(0.85, 0.83, 0.79)),
            sky: model.material("sky", shining(0.62, 0.78, 0.98)),
            lamp: model.material("lamp", shining(1.0, 0.95, 0.85)),
            mirror: model.material(
                "mirror",
                Material { reflection: Vec3::new(0.88, 0.90, 0.89), ..matt(0.01, 0.01, 0.01) },
            ),
            frame: model
                .material("frame", Material { shininess: 40.0, ..glossy(0.30, 0.17, 0.08, 0.05) }),
            glass: model.material("glass", glass(0.90, 0.96, 0.93)),
            crystal: model.material("crystal", glass(0.96, 0.96, 0.97)),
            chrome: model.material(
                "chrome",
                Material {
                    reflection: Vec3::new(0.78, 0.79, 0.80),
                    highlight: Vec3::splat(0.3),
                    shininess: 200.0,
                    ..matt(0.03, 0.03, 0.03)
                },
            ),
            rubber: model.material("rubber", matt(0.03, 0.03, 0.03)),
            porcelain: model.material("porcelain", glossy(0.10, 0.25, 0.42, 0.06)),
            fruit: model.material("fruit", glossy(0.85, 0.42, 0.06, 0.02)),
            shells: [
                model.material("red shell", glossy(0.62, 0.07, 0.05, 0.05)),
                model.material("mustard shell", glossy(0.78, 0.50, 0.08, 0.05)),
                model.material("petrol shell", glossy(0.04, 0.28, 0.32, 0.05)),
                model.material("white shell", glossy(0.80, 0.78, 0.74, 0.05)),
            ],
        }
    }
}
