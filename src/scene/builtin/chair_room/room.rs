//! The room itself: tiled floor, walls with panelling, a window in its niche, a framed mirror.

use glam::{DAffine3, DVec3};

use super::Materials;
use crate::scene::builtin::model::{MaterialId, Model};

/// Half the length of the room along X and Z.
const HALF: f64 = 3.0;
/// Height of the ceiling.
pub(super) const HEIGHT: f64 = 2.8;
/// Tiles along each side of the floor.
const TILES: u32 = 10;
/// Height of the panelling.
const PANELLING: f64 = 0.82;
/// The window in the left wall: from and to along Z, then along Y.
const WINDOW: [(f64, f64); 2] = [(-1.9, 0.1), (0.95, 2.35)];
/// How deep the window lies in the wall.
const NICHE: f64 = 0.22;
/// The mirror on the back wall: from and to along X, then along Y.
const MIRROR: [(f64, f64); 2] = [(-0.45, 1.45), (0.07, 2.20)];

/// Everything that does not move.
pub(super) fn describe(model: &mut Model, materials: &Materials) {
    floor(model, materials);
    let (x, y, z) = (DVec3::X * 2.0 * HALF, DVec3::Y * HEIGHT, DVec3::Z * 2.0 * HALF);
    let corner = DVec3::new(-HALF, 0.0, -HALF);
    model.panel(corner + y, x, z, (1, 1), materials.ceiling);
    model.panel(corner, x, y, (1, 1), materials.wall);
    model.panel(corner + x, z, y, (1, 1), materials.wall);
    model.panel(corner + x + z, -x, y, (2, 2), materials.wall);
    window_wall(model, materials);
    panelling(model, materials.panelling);
    mirror(model, materials);
}

fn floor(model: &mut Model, materials: &Materials) {
    let side = 2.0 * HALF / f64::from(TILES);
    for row in 0..TILES {
        for column in 0..TILES {
            let (x, z) = (f64::from(column) * side - HALF, f64::from(row) * side - HALF);
            let tile = materials.tiles[((row + column) % 2) as usize];
            model.panel(DVec3::new(x, 0.0, z), DVec3::Z * side, DVec3::X * side, (1, 1), tile);
        }
    }
}

/// The left wall around the window, the niche, the frame with its bars, and the sky behind.
fn window_wall(model: &mut Model, materials: &Materials) {
    let [(near, far), (low, high)] = WINDOW;
    let mut part = |z: (f64, f64), y: (f64, f64)| {
        let corner = DVec3::new(-HALF, y.0, z.0);
        let (across, along) = (DVec3::Y * (y.1 - y.0), DVec3::Z * (z.1 - z.0));
        model.panel(corner, across, along, (1, 1), materials.wall);
    };
    part((-HALF, near), (0.0, HEIGHT));
    part((far, HALF), (0.0, HEIGHT));
    part((near, far), (0.0, low));
    part((near, far), (high, HEIGHT));
    let outer = DVec3::new(-HALF - NICHE, low, near);
    let (depth, up, along) = (DVec3::X * NICHE, DVec3::Y * (high - low), DVec3::Z * (far - near));
    model.panel(outer, along, depth, (1, 1), materials.panelling);
    model.panel(outer + up, depth, along, (1, 1), materials.panelling);
    model.panel(outer, depth, up, (1, 1), materials.panelling);
    model.panel(outer + along, up, depth, (1, 1), materials.panelling);
    model.panel(outer, up, along, (1, 1), materials.sky);
    let bar = 0.022;
    let inner = -HALF - NICHE + 0.05;
    let mut bars = |y: (f64, f64), z: (f64, f64)| {
        let (from, to) = (DVec3::new(inner - 0.03, y.0, z.0), DVec3::new(inner, y.1, z.1));
        model.cuboid(from, to, materials.panelling, DAffine3::IDENTITY);
    };
    let middle = 0.5 * (near + far);
    let rail = low + 0.68 * (high - low);
    bars((low, high), (middle - bar, middle + bar));
    bars((rail - bar, rail + bar), (near, far));
    bars((low, low + 2.0 * bar), (near, far));
    bars((high - 2.0 * bar, high), (near, far));
    bars((low, high), (near, near + 2.0 * bar));
    bars((low, high), (far - 2.0 * bar, far));
    let sill = (
        DVec3::new(-HALF - NICHE, low - 0.03, near - 0.05),
        DVec3::new(-HALF + 0.05, low, far + 0.05),
    );
    model.cuboid(sill.0, sill.1, materials.panelling, DAffine3::IDENTITY);
}

/// Along all four walls: a skirting board, raised fields, a rail.
fn panelling(model: &mut Model, paint: MaterialId) {
    const FIELDS: u32 = 5;
    for quarter in 0..4 {
        let place = crate::scene::builtin::model::turned(f64::from(quarter) * 0.25, DVec3::ZERO);
        let mut board = |x: (f64, f64), y: (f64, f64), depth: f64| {
            let low = DVec3::new(x.0, y.0, -HALF);
            model.cuboid(low, DVec3::new(x.1, y.1, -HALF + depth), paint, place);
        };
        board((-HALF, HALF), (0.0, PANELLING), 0.010);
        board((-HALF, HALF), (0.0, 0.11), 0.024);
        board((-HALF, HALF), (PANELLING, PANELLING + 0.045), 0.035);
        let pitch = 2.0 * HALF / f64::from(FIELDS);
        for field in 0..FIELDS {
            let from = f64::from(field) * pitch - HALF;
            board((from + 0.12, from + pitch - 0.12), (0.21, PANELLING - 0.11), 0.020);
        }
    }
}

fn mirror(model: &mut Model, materials: &Materials) {
    let [(left, right), (low, high)] = MIRROR;
    let front = -HALF + 0.05;
    let corner = DVec3::new(left, low, front);
    model.panel(
        corner,
        DVec3::X * (right - left),
        DVec3::Y * (high - low),
        (1, 1),
        materials.mirror,
    );
    let wide = 0.065;
    let mut bar = |x: (f64, f64), y: (f64, f64)| {
        let (from, to) = (DVec3::new(x.0, y.0, -HALF), DVec3::new(x.1, y.1, front + 0.03));
        model.cuboid(from, to, materials.frame, DAffine3::IDENTITY);
    };
    bar((left - wide, right + wide), (low - wide, low));
    bar((left - wide, right + wide), (high, high + wide));
    bar((left - wide, left), (low, high));
    bar((right, right + wide), (low, high));
}
