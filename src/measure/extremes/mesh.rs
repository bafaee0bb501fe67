//! Meshes, in f64; they are placed, and then rounded.

use std::f64::consts::PI;

use glam::DVec3;

use crate::exact::random::Random;
use crate::geometry::Triangle;

/// A triangle before it is rounded.
pub(super) type Exactly = [DVec3; 3];

/// Triangles of about this size in a cube of side 2.
pub(super) fn soup(random: &mut Random, count: usize, size: f64) -> Vec<Exactly> {
    let triangle = |_| {
        let centre = random.point();
        [0; 3].map(|_| centre + size * random.point())
    };
    (0..count).map(triangle).collect()
}

/// Triangles with corners on a lattice of an eighth, where planes, edges and corners meet exactly.
pub(super) fn lattice(random: &mut Random, count: usize) -> Vec<Exactly> {
    let triangle = |_| {
        let centre = random.lattice_point(6);
        [0; 3].map(|_| (centre + random.lattice_point(2)) / 8.0)
    };
    (0..count).map(triangle).collect()
}

/// A closed sphere of `rings` × 2 `rings` quads, poles up and down, as Embree's own tests have it.
pub(super) fn sphere(rings: usize) -> Vec<Exactly> {
    let point = |ring: usize, segment: usize| {
        let (theta, phi) = (PI * ring as f64 / rings as f64, PI * segment as f64 / rings as f64);
        match ring {
            0 => DVec3::Y,
            ring if ring == rings => DVec3::NEG_Y,
            _ => DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()),
        }
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for segment in 0..2 * rings {
            let next = (segment + 1) % (2 * rings);
            let [a, b] = [point(ring, segment), point(ring, next)];
            let [c, d] = [point(ring + 1, segment), point(ring + 1, next)];
            if ring > 0 {
                triangles.push([a, b, c]);
            }
            if ring + 1 < rings {
                triangles.push([b, d, c]);
            }
        }
    }
    triangles
}

/// A square from −1 to 1 across two axes at a place along the third: `side` × `side` quads.
pub(super) fn square(axis: usize, place: f64, side: usize) -> Vec<Exactly> {
    let point = |i: usize, j: usize| {
        let mut point = DVec3::ZERO;
        point[axis] = place;
        point[(axis + 1) % 3] = 2.0 * i as f64 / side as f64 - 1.0;
        point[(axis + 2) % 3] = 2.0 * j as f64 / side as f64 - 1.0;
        point
    };
    let mut triangles = Vec::new();
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let [a, b] = [point(i, j), point(i + 1, j)];
        let [c, d] = [point(i, j + 1), point(i + 1, j + 1)];
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    triangles
}

/// A closed cube from −1 to 1, each side divided.
pub(super) fn cube(side: usize) -> Vec<Exactly> {
    (0..3).flat_map(|axis| [-1.0, 1.0].map(|place| square(axis, place, side))).flatten().collect()
}

/// Triangles about `thinness` as high as long. Half lie along an axis, near zero across it, where f32 can hold them
/// as they are; the corners of the others are rounded.
pub(super) fn thin(random: &mut Random, count: usize, needles: bool) -> Vec<Exactly> {
    let triangle = |_| {
        let thinness = random.power_of_two(-23, -16) * (1.0 + random.unit());
        let (axis, along_axis) = (random.below(3), random.one_in(2));
        let mut base = random.point();
        let mut long = 0.5 * random.point();
        if along_axis {
            let place = base[axis];
            base = thinness * base;
            base[axis] = place;
            long = DVec3::ZERO;
            long[axis] = 0.5;
        }
        let across = thinness * random.point();
        // A needle has two corners side by side, a sliver the third between the others.
        let third = if needles { base + across } else { base + random.unit() * long + across };
        [base, base + long, third]
    };
    (0..count).map(triangle).collect()
}

/// Scales, moves, rounds.
pub(super) fn place(mesh: &[Exactly], scale: f64, offset: DVec3) -> Vec<Triangle> {
    mesh.iter().map(|triangle| triangle.map(|corner| (scale * corner + offset).as_vec3())).collect()
}

/// Rounds.
pub(super) fn rounded(mesh: &[Exactly]) -> Vec<Triangle> {
    place(mesh, 1.0, DVec3::ZERO)
}
