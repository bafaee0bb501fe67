//! Size, place and shape of what is shot at.

use glam::DVec3;

use super::{Case, FEW, Situation, at_target, plain, shoot, soup_of_few};
use crate::exact::random::power_of_two;
use crate::geometry::Ray;
use crate::measure::extremes::mesh::{place, rounded, thin};
use crate::measure::extremes::shot::through;

/// From where nothing can be culled and expansions decide about every triangle, one ray in so many comes.
const FEWER_FAR: usize = 10;

/// Everything scaled alike, denormals and signed zeros included.
pub(super) fn scales(cases: &mut Vec<Case>) {
    let scales: [(&str, f64); 9] = [
        ("1e-30", 1e-30),
        ("1e-24", 1e-24),
        ("1e-18", 1e-18),
        ("1e-12", 1e-12),
        ("1e-6", 1e-6),
        ("1", 1.0),
        ("1e6", 1e6),
        ("1e12", 1e12),
        ("1e18", 1e18),
    ];
    for (name, scale) in scales {
        cases.push(Case::shots(
            format!("scale-{name}"),
            format!("everything {name} in size"),
            move |random| place(&soup_of_few(random), scale, DVec3::ZERO),
            at_target,
        ));
    }
    for (name, exponent) in [("denormal", -130), ("few-bits", -143)] {
        cases.push(Case::shots(
            name,
            format!("denormals only: everything 2^{exponent} in size"),
            move |random| place(&soup_of_few(random), power_of_two(exponent), DVec3::ZERO),
            at_target,
        ));
    }
    cases.push(Case::shots(
        "signed-zero",
        "coordinates and directions of -1, -0, 0 and 1",
        |random| {
            let corners = |_| [0; 3].map(|_| random.lattice_point(1));
            rounded(&(0..FEW / 10).map(corners).collect::<Vec<_>>())
        },
        |_, random| {
            let (origin, direction) = (random.lattice_point(1), random.lattice_point(1));
            let end = [1.0, 2.0, f32::INFINITY][random.below(3)];
            Ray { origin: origin.as_vec3(), direction: direction.as_vec3(), end }
        },
    ));
    cases.push(Case::shots(
        "direction-length",
        "directions 1e-30 to 1e30 long, with ends that make up for it",
        plain,
        |range, random| {
            let ray = at_target(range, random);
            let factor = random.power_of_two(-100, 100);
            let direction = (factor * ray.direction.as_dvec3()).as_vec3();
            Ray { direction, end: (f64::from(ray.end) / factor) as f32, ..ray }
        },
    ));
}

/// Far from the zero point, and seen from far away.
pub(super) fn places(cases: &mut Vec<Case>) {
    for (name, sizes) in [("1e1", 1e1), ("1e3", 1e3), ("1e5", 1e5), ("1e6", 1e6), ("1e7", 1e7)] {
        cases.push(Case::shots(
            format!("offset-{name}"),
            format!("{name} times its size from the zero point"),
            move |random| place(&soup_of_few(random), 1.0, sizes * DVec3::new(2.0, -0.62, 1.54)),
            at_target,
        ));
    }
    for (name, sizes) in [("1e3", 1e3), ("1e6", 1e6), ("1e12", 1e12), ("1e30", 1e30)] {
        let fewer = if sizes > 1e9 { FEWER_FAR } else { 1 };
        cases.push(Case::new(
            format!("origin-{name}-away"),
            format!("rays from {name} times the scene's size away"),
            move |random, count| {
                let triangles = plain(random);
                let rays = shoot(&triangles, random, count.div_ceil(fewer), |range, random| {
                    through(sizes * random.point().normalize(), range.target(random), random)
                });
                Situation { triangles, rays }
            },
        ));
    }
}

/// Triangles that are hardly triangles.
pub(super) fn shapes(cases: &mut Vec<Case>) {
    for (name, needles) in [("slivers", false), ("needles", true)] {
        cases.push(Case::shots(
            name,
            format!("{name} 1:65,000 to 1:10,000,000"),
            move |random| rounded(&thin(random, FEW, needles)),
            |range, random| {
                let target = match random.below(4) {
                    0 => range.corner(random),
                    1 => range.face(random) + 1e-3 * range.nudge(random),
                    _ => range.face(random),
                };
                through(range.anywhere(random), target, random)
            },
        ));
    }
    cases.push(Case::new(
        "any-bits",
        "triangles and rays of any bits, infinite and NaN among them",
        |random, count| Situation {
            triangles: (0..FEW).map(|_| random.any_triangle()).collect(),
            rays: (0..count).map(|_| random.any_ray()).collect(),
        },
    ));
    cases.push(Case::shots(
        "garbage-among-good",
        "every fifth triangle of any bits",
        |random| {
            let mut mesh = plain(random);
            mesh.iter_mut().step_by(5).for_each(|triangle| *triangle = random.any_triangle());
            mesh
        },
        |_, random| through(random.point(), random.point(), random),
    ));
}
