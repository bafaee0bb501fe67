//! Many triangles together: crowds, closed meshes, and the hard queries of the certification.

use glam::DVec3;

use super::{Case, FEW, Situation, at_target, shoot};
use crate::exact::adversary::{Class, query};
use crate::exact::random::{Random, power_of_two};
use crate::geometry::{Ray, Triangle};
use crate::measure::extremes::mesh::{cube, place, rounded, soup, sphere, square};
use crate::measure::extremes::shot::{Range, through};

/// Where Embree's own watertightness test puts its sphere of radius 2.
const FAR_AWAY: DVec3 = DVec3::new(148_376.0, 1_234.0, -223_423.0);

/// Triangles in one voxel.
const MILLION: usize = 1_000_000;

/// Meshes with a million triangles are shot at with one ray in so many: brute force looks at all of them.
const FEWER: usize = 50;

/// Many triangles, or huge ones, in little space.
pub(super) fn crowds(cases: &mut Vec<Case>) {
    cases.push(Case::shots(
        "huge-over-tiny",
        "triangles of 1e6 across over triangles of 1e-3",
        |random| {
            let mut mesh = place(&soup(random, FEW, 0.3), 1e-3, DVec3::ZERO);
            mesh.extend(place(&soup(random, 4, 1.0), 1e6, DVec3::ZERO));
            mesh
        },
        |_, random| {
            let (origin, target) = (1e-3 * random.point(), 1e-3 * random.point());
            through(origin * [1.0, 1e3, 1e9][random.below(3)], target, random)
        },
    ));
    cases.push(Case::new(
        "million-in-a-voxel",
        "a million triangles in a ten-thousandth of the scene",
        |random, count| {
            let mut triangles = place(&soup(random, MILLION, 1e-3), 1e-4, DVec3::splat(0.3));
            triangles.extend(place(&soup(random, 2, 0.1), 1.0, DVec3::ZERO));
            let rays = shoot(&triangles, random, count.div_ceil(FEWER), |range, random| {
                through(DVec3::splat(0.3) + 2e-4 * random.point(), range.corner(random), random)
            });
            Situation { triangles, rays }
        },
    ));
    cases.push(Case::shots(
        "duplicates",
        "every triangle 20 times, corners in any order",
        |random| {
            let mesh = rounded(&soup(random, FEW / 20, 0.5));
            let mut copies: Vec<Triangle> = mesh.iter().cycle().take(FEW).copied().collect();
            for copy in &mut copies {
                copy.rotate_left(random.below(3));
                if random.one_in(2) {
                    copy.swap(0, 1);
                }
            }
            copies
        },
        at_target,
    ));
    cases.push(Case::shots(
        "coplanar",
        "one plane tiled three times over, differently",
        |_| rounded(&[square(2, 0.25, 4), square(2, 0.25, 5), square(2, 0.25, 8)].concat()),
        at_target,
    ));
    cases.push(Case::shots(
        "geometric-series",
        "triangles half as large each, about one point",
        |random| {
            let mesh: Vec<_> =
                (0..120).map(|step| [0; 3].map(|_| power_of_two(-step) * random.point())).collect();
            rounded(&mesh)
        },
        |range, random| {
            let origin = random.power_of_two(-100, 0) * random.point();
            through(origin, range.target(random), random)
        },
    ));
}

/// Closed meshes from inside: nothing may leak.
pub(super) fn closed(cases: &mut Vec<Case>) {
    type Target = fn(&Range, &mut Random) -> DVec3;
    let targets: [(&str, Target); 3] = [
        ("anywhere", |range, random| range.centre + range.size() * random.point()),
        ("at-edges", |range, random| range.edge(random)),
        ("at-vertices", |range, random| range.corner(random)),
    ];
    type Shape = fn() -> Vec<Triangle>;
    let shapes: [(&str, &str, Shape); 3] = [
        ("sphere", "a closed sphere", || rounded(&sphere(24))),
        ("room", "a closed cube", || rounded(&cube(8))),
        ("far-sphere", "Embree's far sphere of radius 2", || place(&sphere(50), 2.0, FAR_AWAY)),
    ];
    for (shape, what, mesh) in shapes {
        for (name, target) in targets {
            cases.push(Case::shots(
                format!("inside-{shape}-{name}"),
                format!("from inside {what}, {}", name.replace('-', " ")),
                move |_| mesh(),
                move |range, random| {
                    let origin = (range.centre + 0.5 * range.half * random.point()).as_vec3();
                    let towards = target(range, random) - origin.as_dvec3();
                    Ray::towards(origin, towards.as_vec3())
                },
            ));
        }
    }
    cases.push(Case::shots(
        "inside-room-axis-parallel",
        "from inside a closed cube along an axis, at vertices",
        |_| rounded(&cube(8)),
        |range, random| {
            let (target, axis) = (range.corner(random), random.below(3));
            let mut origin = target;
            origin[axis] = 0.5 * random.signed();
            Ray::towards(origin.as_vec3(), (target - origin).as_vec3())
        },
    ));
    cases.push(Case::shots(
        "towards-far-plane",
        "Embree's far plane, from the side",
        |_| place(&square(0, 0.0, 50), 6.0, DVec3::X * FAR_AWAY.x),
        |_, random| {
            let direction = DVec3::new(1.0, random.signed(), random.signed());
            Ray::towards((FAR_AWAY.x - 3.0) as f32 * glam::Vec3::X, direction.as_vec3())
        },
    ));
}

/// The families of hard queries of the certification, many triangles together.
pub(super) fn adversaries(cases: &mut Vec<Case>) {
    for &class in Class::ALL {
        cases.push(Case::new(
            format!("class-{class}"),
            format!("a mesh of the certification's class {class}"),
            move |_, count| Situation {
                triangles: (0..FEW).map(|index| query(class, index as u64).1).collect(),
                rays: (0..count).map(|index| query(class, index as u64).0).collect(),
            },
        ));
    }
}
