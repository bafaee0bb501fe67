//! The jittered polygons: a lattice of squares, each moved and turned at random, in an open box.
//!
//! The paper says 40 × 40 × 40 polygons of 8 triangles, but its Table 2 counts 551,408 triangles:
//! 41³ squares and 5 walls of 8 triangles each, to the last one.

use glam::{DMat3, DVec3, Vec3};

use super::{Random, check_memory};
use crate::geometry::surface::cosine_and_sine;
use crate::scene::{Camera, Draft, DraftTriangle, Light, Material, SceneError};

/// Squares along each edge of the lattice.
const SIDE: u64 = 41;
/// Walls of the box; its front is open.
const WALLS: u64 = 5;
/// Triangles of each square and each wall.
const TRIANGLES: f64 = 8.0;
/// Standard deviation of the jitter, in units of its bounds; the paper does not say it. At a third
/// the bounds cut off three numbers in a thousand.
const DEVIATION: f64 = 1.0 / 3.0;
/// How far the walls are from the outermost lattice points: jitter 1 and half a diagonal 0.71 fit.
const MARGIN: f64 = 2.0;
/// Where lights begin and end along Z, in units of half the box.
const NEAREST: f64 = 0.3;
const FARTHEST: f64 = 1.9;
/// Number of lights.
const LIGHTS: usize = 15;

/// How a lattice is cut into triangles.
#[derive(Clone, Copy)]
struct Cut {
    /// Squares along each edge of the lattice.
    side: u64,
    /// Cells of each square, and of each wall, along its edges.
    cells: (u64, u64),
}

impl Cut {
    /// The cut nearest to a multiple of the paper's triangles. A square has two triangles at least,
    /// so below a quarter there are fewer squares in a smaller box instead.
    fn at(tessellation: f64) -> Self {
        let nearest = |wanted: f64, candidates: &mut dyn Iterator<Item = (u64, u64)>| {
            candidates
                .min_by(|a, b| {
                    let missed = |made: u64| (made as f64 - wanted).abs();
                    missed(a.1).total_cmp(&missed(b.1))
                })
                .map_or(1, |candidate| candidate.0)
        };
        let cells = 0.5 * TRIANGLES * tessellation;
        if cells < 1.0 {
            let squares = cells * SIDE.pow(3) as f64;
            let side = nearest(squares, &mut (1..=SIDE).map(|side| (side, side.pow(3))));
            return Self { side, cells: (1, 1) };
        }
        // As square as possible, but not at the cost of the number.
        let square = cells.sqrt() as u64;
        let along = |across: u64| (cells / across as f64).round() as u64;
        let tried = (square.div_ceil(2)..=square).rev();
        let across = nearest(cells, &mut tried.map(|across| (across, across * along(across))));
        Self { side: SIDE, cells: (across, along(across)) }
    }

    fn triangles(self) -> u64 {
        2 * self.cells.0 * self.cells.1 * (self.side.pow(3) + WALLS)
    }
}

pub(super) fn triangle_count(tessellation: f64) -> u64 {
    Cut::at(tessellation).triangles()
}

/// The scene with squares of the given edge; the same jitter for every edge.
pub(super) fn draft(name: &str, edge: f64, tessellation: f64) -> Result<Draft, SceneError> {
    let cut = Cut::at(tessellation);
    check_memory(name, cut.triangles())?;
    let mut draft = Draft {
        name: name.to_owned(),
        materials: materials(),
        triangles: Vec::with_capacity(cut.triangles() as usize),
        ambient: Vec3::splat(0.03),
        ..Draft::default()
    };
    let middle = 0.5 * (cut.side - 1) as f64;
    let mut random = Random::seeded(1991);
    for index in 0..cut.side.pow(3) {
        let lattice =
            [index / (cut.side * cut.side), index / cut.side % cut.side, index % cut.side];
        let mut jitter = || DVec3::from_array([0; 3].map(|_| random.truncated_gaussian(DEVIATION)));
        let centre = DVec3::from_array(lattice.map(|i| i as f64 - middle)) + jitter();
        // The same generator, in units of a quarter turn.
        let turned = rotation(jitter() * 0.25);
        let material = (random.uniform() * SQUARE_COLOURS.len() as f64) as u32;
        let (across, along) = (turned.x_axis * edge, turned.y_axis * edge);
        square(&mut draft, centre - 0.5 * (across + along), across, along, cut.cells, material);
    }
    let half = middle + MARGIN;
    walls(&mut draft, half, cut.cells);
    lights(&mut draft, half, &mut random);
    draft.camera = Some(camera(half));
    draft.exposure = Some(1.0);
    Ok(draft)
}

/// Turned about X, then Y, then Z.
fn rotation(turns: DVec3) -> DMat3 {
    let [x, y, z] = turns.to_array().map(cosine_and_sine);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.0, x.1), DVec3::new(0.0, -x.1, x.0));
    let about_y = DMat3::from_cols(DVec3::new(y.0, 0.0, -y.1), DVec3::Y, DVec3::new(y.1, 0.0, y.0));
    let about_z = DMat3::from_cols(DVec3::new(z.0, z.1, 0.0), DVec3::new(-z.1, z.0, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

fn square(
    draft: &mut Draft,
    corner: DVec3,
    across: DVec3,
    along: DVec3,
    cells: (u64, u64),
    material: u32,
) {
    let point = |u: u64, v: u64| {
        corner + across * (u as f64 / cells.0 as f64) + along * (v as f64 / cells.1 as f64)
    };
    for v in 0..cells.1 {
        for u in 0..cells.0 {
            let (a, b, c, d) = (point(u, v), point(u + 1, v), point(u, v + 1), point(u + 1, v + 1));
            draft.triangles.extend([[a, b, d], [a, d, c]].map(|corners| DraftTriangle {
                corners,
                normals: [Vec3::ZERO; 3],
                material,
            }));
        }
    }
}

/// Floor, ceiling, left, right and back of the cube [−half, half]³, their fronts inwards.
fn walls(draft: &mut Draft, half: f64, cells: (u64, u64)) {
    let (x, y, z) = (DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half, DVec3::Z * 2.0 * half);
    let low = DVec3::splat(-half);
    let wall = SQUARE_COLOURS.len() as u32;
    square(draft, low, z, x, cells, wall);
    square(draft, low + y, x, z, cells, wall);
    square(draft, low, y, z, cells, wall);
    square(draft, low + x, z, y, cells, wall);
    square(draft, low, x, y, cells, wall);
}

const SQUARE_COLOURS: [Vec3; 4] = [
    Vec3::new(0.75, 0.45, 0.30),
    Vec3::new(0.35, 0.55, 0.70),
    Vec3::new(0.70, 0.66, 0.45),
    Vec3::new(0.45, 0.60, 0.42),
];

fn materials() -> Vec<Material> {
    let squares = SQUARE_COLOURS.iter().enumerate().map(|(index, &diffuse)| Material {
        name: format!("square {}", index + 1),
        diffuse,
        ..Material::default()
    });
    let wall =
        Material { name: "wall".to_owned(), diffuse: Vec3::splat(0.7), ..Material::default() };
    squares.chain([wall]).collect()
}

/// Lights at random places across the box, in even steps along Z.
///
/// The paper does not say where they were. Lights deep in the box face few of the polygons that the
/// camera sees, lights in front of it nearly all; this range gives the paper's ratio of rays between
/// the sparse and the dense scene.
fn lights(draft: &mut Draft, half: f64, random: &mut Random) {
    let intensity = Vec3::splat((0.36 * half * half) as f32);
    for light in 0..LIGHTS {
        let [x, y] = [0; 2].map(|_| random.uniform());
        let z = (light as f64 + 0.5) / LIGHTS as f64;
        let position = DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, NEAREST + (FARTHEST - NEAREST) * z);
        draft.lights.push(Light::Point { position: position * half, intensity });
    }
}

/// Looks in through the open front, from near enough that the walls are all around the picture.
fn camera(half: f64) -> Camera {
    Camera::look_at(DVec3::Z * (2.045 * half), DVec3::ZERO, DVec3::Y, 0.75)
}
