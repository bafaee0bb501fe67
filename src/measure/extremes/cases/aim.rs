//! Where rays start, pass and end.

use glam::{DMat3, DVec3};

use super::{Case, Situation, on_lattice, plain, shoot};
use crate::exact::random::Random;
use crate::geometry::{Triangle, Triangles};
use crate::measure::extremes::mesh::{rounded, soup, sphere, square};
use crate::measure::extremes::shot::{Range, segment, through};
use crate::occlusion::NestedGrid;

/// A turn about two axes by angles of Pythagorean triangles, so that no function of a library has to round.
const TILT: DMat3 = DMat3::from_cols_array(&[
    0.8 * 12.0 / 13.0,
    0.6,
    0.8 * 5.0 / 13.0,
    -0.6 * 12.0 / 13.0,
    0.8,
    -0.6 * 5.0 / 13.0,
    -5.0 / 13.0,
    0.0,
    12.0 / 13.0,
]);

/// Rays aimed at what is hard to decide.
pub(super) fn aims(cases: &mut Vec<Case>) {
    type Target = fn(&Range, &mut Random) -> DVec3;
    let targets: [(&str, &str, Target); 4] = [
        ("at-edges", "rays at edges", |range, random| range.edge(random)),
        ("at-vertices", "rays at vertices", |range, random| range.corner(random)),
        ("near-edges", "rays within 1e-9 to 1e-4 of edges", |range, random| {
            range.edge(random) + range.nudge(random)
        }),
        ("near-vertices", "rays within 1e-9 to 1e-4 of vertices", |range, random| {
            range.corner(random) + range.nudge(random)
        }),
    ];
    for (name, what, target) in targets {
        cases.push(Case::shots(name, what, plain, move |range, random| {
            through(range.anywhere(random), target(range, random), random)
        }));
    }
    for (name, mesh) in [("soup", plain as fn(&mut Random) -> _), ("lattice", on_lattice)] {
        cases.push(Case::shots(
            format!("axis-parallel-{name}"),
            "rays along an axis, through vertices and edges too",
            mesh,
            |range, random| {
                let target = range.target(random);
                let mut origin = target;
                let axis = random.below(3);
                origin[axis] = range.anywhere(random)[axis];
                through(origin, target.as_vec3().as_dvec3(), random)
            },
        ));
    }
    cases.push(Case::shots(
        "in-triangle-plane",
        "rays in the plane of a triangle",
        on_lattice,
        |range, random| {
            let [a, b, c] = range.triangle(random);
            let mut place =
                || a + random.lattice(4) / 2.0 * (b - a) + random.lattice(4) / 2.0 * (c - a);
            let (origin, target) = (place(), place());
            through(origin, target, random)
        },
    ));
    cases.push(Case::new(
        "in-voxel-wall",
        "rays in the walls of the grid's voxels",
        |random, count| {
            let triangles = on_lattice(random);
            let grid = grid_over(&triangles);
            let rays = shoot(&triangles, random, count, |range, random| {
                let axis = random.below(3);
                let wall = wall_corner(&grid, random)[axis];
                let (mut origin, mut target) = (range.anywhere(random), range.target(random));
                origin[axis] = wall;
                target[axis] = f64::from(wall as f32);
                through(origin, target, random)
            });
            Situation { triangles, rays }
        },
    ));
    cases.push(Case::shots(
        "grazing",
        "slopes of 1e-7 to 0.1 over a tilted floor, from both sides",
        |random| {
            let floor = square(1, 0.0, 12).into_iter().chain(soup(random, 30, 0.05));
            let tilted = floor.map(|triangle| triangle.map(|corner| TILT * corner));
            rounded(&tilted.collect::<Vec<_>>())
        },
        |range, random| {
            let slope = random.power_of_two(-24, -4) * (1.0 + random.unit()) * random.signed();
            let target = range.target(random);
            let away = random.point().with_y(slope);
            through(target + TILT * away, target, random)
        },
    ));
}

/// Where rays start and end.
pub(super) fn ends(cases: &mut Vec<Case>) {
    type Place = fn(&Range, &mut Random) -> DVec3;
    let places: [(&str, &str, Place); 3] = [
        ("edge", "an edge", |range, random| range.edge(random)),
        ("vertex", "a vertex", |range, random| range.corner(random)),
        ("surface", "a surface", |range, random| range.face(random)),
    ];
    for (name, what, place) in places {
        cases.push(Case::shots(
            format!("origin-on-{name}"),
            format!("rays that start on {what}"),
            on_lattice,
            move |range, random| through(place(range, random), range.target(random), random),
        ));
        cases.push(Case::shots(
            format!("light-on-{name}"),
            format!("lights on {what}"),
            on_lattice,
            move |range, random| segment(range.anywhere(random), place(range, random)),
        ));
    }
    cases.push(Case::new(
        "origin-on-voxel-corner",
        "rays that start at a corner of a voxel, or pass one",
        |random, count| {
            let triangles = on_lattice(random);
            let grid = grid_over(&triangles);
            let rays = shoot(&triangles, random, count, |range, random| {
                let corner = wall_corner(&grid, random);
                match random.below(3) {
                    0 => through(corner, wall_corner(&grid, random), random),
                    1 => through(corner, corner + range.size() * random.lattice_point(1), random),
                    _ => through(corner, range.target(random), random),
                }
            });
            Situation { triangles, rays }
        },
    ));
    cases.push(Case::shots(
        "light-in-solid",
        "lights inside a closed sphere, seen from outside",
        |_| rounded(&sphere(12)),
        |_, random| segment(3.0 * random.point().normalize(), 0.5 * random.point()),
    ));
    cases.push(Case::shots(
        "light-at-bound",
        "lights on the scene's box, and at its corners",
        on_lattice,
        |range, random| {
            let signs = random.lattice_point(1) + 0.5;
            let corner = range.half * DVec3::ONE.copysign(signs);
            let mut light = range.half * random.point();
            let axis = random.below(3);
            light[axis] = corner[axis];
            if random.one_in(2) {
                light = corner;
            }
            segment(range.anywhere(random), range.centre + light)
        },
    ));
    cases.push(Case::shots("light-1e30-away", "lights 1e30 away", plain, |range, random| {
        segment(range.anywhere(random), 1e30 * random.point().normalize())
    }));
}

fn grid_over(triangles: &[Triangle]) -> NestedGrid {
    NestedGrid::new(&triangles.iter().copied().collect::<Triangles>())
}

/// A corner of a voxel of any of the grids.
fn wall_corner(grid: &NestedGrid, random: &mut Random) -> DVec3 {
    let corner = [0; 3].map(|_: u32| random.below(5) as u32);
    grid.corner(random.below(grid.grid_count()), corner)
}
