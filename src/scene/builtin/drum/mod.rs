//! Spanky the snare drum, on its stand on a rostrum. Chrome and lacquer reflect, as few parts did in the
//! paper's, where a tree of caches gains 2.7 %.

mod body;
mod hardware;
mod stand;

use glam::{DAffine3, DVec3, Vec3};

use super::model::{MaterialId, Model};
use crate::geometry::surface::Sheet;
use crate::scene::{Camera, Light, Material};

/// Radius of the shell: a drum of 14 inches.
const RADIUS: f64 = 0.178;
/// Height of the shell: five and a half inches.
const HEIGHT: f64 = 0.140;
/// Height of the shell's lower edge over the floor of the rostrum.
const LIFT: f64 = 0.30;

/// Where the strainer is, as a fraction of a turn: to the right, seen from the camera.
const STRAINER: f64 = 0.80;

/// Puts the scene together.
pub(super) fn describe(model: &mut Model) {
    let materials = Materials::add(model);
    // The drum leans a little towards the drummer.
    let lean = super::model::aimed(DVec3::new(0.0, 1.0, 0.10), DVec3::Y * LIFT);
    body::describe(model, &materials, lean);
    hardware::describe(model, &materials, lean);
    stand::describe(model, &materials, lean);
    studio(model, &materials);
    lights(model);
    model.draft.camera = Some(Camera::look_at(
        DVec3::new(-0.44, 0.80, 1.10),
        DVec3::new(0.005, 0.262, 0.0),
        DVec3::Y,
        0.50,
    ));
    model.draft.ambient = Vec3::splat(0.10);
    model.draft.exposure = Some(1.0);
}

/// The rostrum, and a backdrop that rises from the ground in one curve.
fn studio(model: &mut Model, materials: &Materials) {
    let (wide, low) = (0.46, -0.05);
    let side = [(wide, low), (wide, -0.006)];
    let edge = [(wide, -0.006), (wide - 0.002, -0.002), (wide - 0.006, 0.0)];
    let top = [(wide - 0.006, 0.0), (0.0, 0.0)];
    model.lathe(&[(&side, 1), (&edge, 3), (&top, 3)], 120, materials.rostrum, DAffine3::IDENTITY);
    let profile = [
        (2.4, low),
        (1.2, low),
        (0.0, low),
        (-1.0, low),
        (-1.7, 0.05),
        (-2.1, 0.5),
        (-2.25, 1.3),
        (-2.3, 2.4),
    ];
    let rows: Vec<Vec<DVec3>> = profile
        .iter()
        .map(|&(z, y)| [-3.0, 0.0, 3.0].map(|x| DVec3::new(x, y, z)).to_vec())
        .collect();
    model.surface(&Sheet::through(&rows), (8, 48), materials.backdrop, DAffine3::IDENTITY);
}

fn lights(model: &mut Model) {
    let lamps = [
        (DVec3::new(-1.1, 1.7, 1.2), Vec3::new(4.6, 4.3, 3.8)),
        (DVec3::new(1.4, 1.2, 1.3), Vec3::new(2.6, 2.7, 3.0)),
        (DVec3::new(0.2, 2.1, 0.1), Vec3::new(2.4, 2.3, 2.2)),
        (DVec3::new(-1.3, 1.1, -0.9), Vec3::new(2.4, 2.6, 3.2)),
        (DVec3::new(1.2, 1.3, -1.0), Vec3::new(3.4, 2.9, 2.3)),
        (DVec3::new(-0.2, 0.6, 2.0), Vec3::new(2.0, 2.0, 2.0)),
    ];
    for (position, intensity) in lamps {
        model.draft.lights.push(Light::Point { position, intensity });
    }
}

/// What the drum and its studio are made of.
struct Materials {
    lacquer: MaterialId,
    inlay: MaterialId,
    coated: MaterialId,
    dot: MaterialId,
    film: MaterialId,
    brass: MaterialId,
    chrome: MaterialId,
    steel: MaterialId,
    wood: MaterialId,
    rubber: MaterialId,
    rostrum: MaterialId,
    backdrop: MaterialId,
}

impl Materials {
    fn add(model: &mut Model) -> Self {
        let matt = |r: f32, g: f32, b: f32| Material {
            diffuse: Vec3::new(r, g, b),
            ..Material::default()
        };
        let glossy = |r: f32, g: f32, b: f32, reflection: f32| Material {
            reflection: Vec3::splat(reflection),
            highlight: Vec3::splat(0.15),
            shininess: 80.0,
            ..matt(r, g, b)
        };
        let metal = |reflection: f32| Material {
            highlight: Vec3::splat(0.3),
            shininess: 150.0,
            ..glossy(0.06, 0.06, 0.065, reflection)
        };
        let satin = |r: f32, g: f32, b: f32| Material {
            highlight: Vec3::splat(0.04),
            shininess: 25.0,
            ..matt(r, g, b)
        };
        Self {
            lacquer: model.material("lacquer", glossy(0.38, 0.022, 0.02, 0.07)),
            inlay: model.material("inlay", glossy(0.80, 0.72, 0.52, 0.05)),
            coated: model.material("coated head", satin(0.84, 0.83, 0.79)),
            dot: model.material("centre dot", satin(0.74, 0.73, 0.70)),
            film: model.material("snare side head", satin(0.70, 0.71, 0.70)),
            brass: model.material(
                "brass",
                Material {
                    reflection: Vec3::new(0.55, 0.42, 0.18),
                    ..glossy(0.30, 0.21, 0.07, 0.0)
                },
            ),
            chrome: model.material("chrome", metal(0.72)),
            steel: model.material(
                "steel wire",
                Material { diffuse: Vec3::splat(0.45), ..satin(0.45, 0.45, 0.46) },
            ),
            wood: model.material("hickory", satin(0.72, 0.50, 0.28)),
            rubber: model.material("rubber", satin(0.04, 0.04, 0.04)),
            rostrum: model.material("rostrum", satin(0.05, 0.05, 0.06)),
            backdrop: model.material("backdrop", matt(0.30, 0.37, 0.42)),
        }
    }
}
