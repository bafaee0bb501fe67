//! The extremes, one by one.

use glam::{DMat3, DVec3};

use super::mesh::{Exactly, cube, lattice, place, rounded, soup, sphere, square, thin};
use super::shot::{Range, segment, through};
use crate::exact::adversary::{Class, query};
use crate::exact::random::{Random, power_of_two};
use crate::geometry::{Ray, Triangle, Triangles};
use crate::occlusion::{Grid, GridOptions};

/// Triangles of a mesh, where nothing else is said: brute force and the verdicts stay quick.
const FEW: usize = 300;

/// Where Embree's own watertightness test puts its sphere of radius 2.
const FAR_AWAY: DVec3 = DVec3::new(148_376.0, 1_234.0, -223_423.0);

/// Triangles in one voxel.
const MILLION: usize = 1_000_000;

/// Meshes with a million triangles are shot at with one ray in so many: brute force looks at all of them.
const FEWER: usize = 50;

/// From where nothing can be culled and expansions decide about every triangle, one ray in so many comes.
const FEWER_FAR: usize = 10;

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

/// A mesh and rays.
pub struct Situation {
    /// The mesh.
    pub triangles: Vec<Triangle>,
    /// The rays.
    pub rays: Vec<Ray>,
}

type Make = Box<dyn Fn(&mut Random, usize) -> Situation + Send + Sync>;

/// One thing that is stressed.
pub struct Case {
    /// Its name.
    pub name: String,
    /// In words.
    pub what: String,
    /// Makes the mesh and so many rays.
    pub(super) make: Make,
}

impl Case {
    fn new(
        name: impl Into<String>,
        what: impl Into<String>,
        make: impl Fn(&mut Random, usize) -> Situation + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), what: what.into(), make: Box::new(make) }
    }

    /// Shoots at a mesh.
    fn shots(
        name: impl Into<String>,
        what: impl Into<String>,
        mesh: impl Fn(&mut Random) -> Vec<Triangle> + Send + Sync + 'static,
        shot: impl Fn(&Range, &mut Random) -> Ray + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, what, move |random, count| {
            let triangles = mesh(random);
            let rays = shoot(&triangles, random, count, &shot);
            Situation { triangles, rays }
        })
    }

    /// Its random numbers depend on its name alone.
    pub(super) fn seed(&self) -> u64 {
        self.name.bytes().fold(0, |seed: u64, byte| {
            seed.wrapping_mul(0x0100_0000_01b3).wrapping_add(u64::from(byte))
        })
    }
}

fn shoot(
    triangles: &[Triangle],
    random: &mut Random,
    count: usize,
    shot: impl Fn(&Range, &mut Random) -> Ray,
) -> Vec<Ray> {
    let range = Range::new(triangles);
    (0..count).map(|_| shot(&range, random)).collect()
}

/// Every case.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    scales(&mut cases);
    places(&mut cases);
    shapes(&mut cases);
    aims(&mut cases);
    ends(&mut cases);
    crowds(&mut cases);
    closed(&mut cases);
    adversaries(&mut cases);
    cases
}

fn soup_of_few(random: &mut Random) -> Vec<Exactly> {
    soup(random, FEW, 0.3)
}

fn plain(random: &mut Random) -> Vec<Triangle> {
    rounded(&soup_of_few(random))
}

fn on_lattice(random: &mut Random) -> Vec<Triangle> {
    rounded(&lattice(random, FEW))
}

fn at_target(range: &Range, random: &mut Random) -> Ray {
    through(range.anywhere(random), range.target(random), random)
}

/// Everything scaled alike, denormals and signed zeros included.
fn scales(cases: &mut Vec<Case>) {
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
fn places(cases: &mut Vec<Case>) {
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
fn shapes(cases: &mut Vec<Case>) {
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

/// Rays aimed at what is hard to decide.
fn aims(cases: &mut Vec<Case>) {
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
fn ends(cases: &mut Vec<Case>) {
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

/// Many triangles, or huge ones, in little space.
fn crowds(cases: &mut Vec<Case>) {
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
fn closed(cases: &mut Vec<Case>) {
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
fn adversaries(cases: &mut Vec<Case>) {
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

fn grid_over(triangles: &[Triangle]) -> Grid {
    Grid::new(&triangles.iter().copied().collect::<Triangles>(), GridOptions::default())
}

/// A corner of a voxel of the outermost grid.
fn wall_corner(grid: &Grid, random: &mut Random) -> DVec3 {
    grid.corner(grid.resolution().map(|n| random.below(n as usize + 1) as u32))
}
