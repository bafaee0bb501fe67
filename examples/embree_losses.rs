//! What Embree 4 gets wrong, small enough to read, and what umbra says of the same rays.
//!
//! `cargo run --release --example embree_losses`
//!
//! docs/how-wrong.md explains each.

use std::error::Error;
use std::sync::Arc;

use glam::Vec3;
use umbra::exact::Verdict;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::measure::extremes::truth;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};

/// Quads along a side of the floor.
const SIDE: usize = 16;

/// A floor from 0 to 16 times `scale` at height 0.
fn floor(scale: f32) -> Vec<Triangle> {
    let point = |i: usize, j: usize| scale * Vec3::new(i as f32, 0.0, j as f32);
    (0..SIDE * SIDE)
        .flat_map(|quad| {
            let (i, j) = (quad % SIDE, quad / SIDE);
            let [a, b] = [point(i, j), point(i + 1, j)];
            let [c, d] = [point(i, j + 1), point(i + 1, j + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect()
}

/// Straight down at every vertex.
fn down_at_vertices(scale: f32) -> Vec<Ray> {
    let vertices = (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| (i as f32, j as f32)));
    vertices.map(|(x, z)| Ray::towards(scale * Vec3::new(x, 1.0, z), scale * Vec3::NEG_Y)).collect()
}

/// Down, but not straight, at every vertex inside: the direction has no zero component.
fn aslant_at_vertices(scale: f32) -> Vec<Ray> {
    let vertices = (1..SIDE).flat_map(|i| (1..SIDE).map(move |j| (i as f32, j as f32)));
    let origin = Vec3::new(7.3, 5.1, 8.7);
    vertices
        .map(|(x, z)| Ray::towards(scale * origin, scale * (Vec3::new(x, 0.0, z) - origin)))
        .collect()
}

/// The same rays with directions of 10⁻³⁰ of the length.
fn with_short_directions(rays: Vec<Ray>) -> Vec<Ray> {
    rays.into_iter().map(|ray| Ray { direction: 1e-30 * ray.direction, ..ray }).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:44}{:>6}{:>9}{:>8}{:>8}{:>8}",
        "rays that are blocked, and who loses them", "rays", "blocked", "robust", "fast", "umbra"
    );
    compare("straight down at the vertices of a floor", floor(1.0), &down_at_vertices(1.0))?;
    compare("aslant at the vertices inside a floor", floor(1.0), &aslant_at_vertices(1.0))?;
    compare("the same, all 1e-24 in size", floor(1e-24), &aslant_at_vertices(1e-24))?;
    compare("the same, all 1e19 in size", floor(1e19), &aslant_at_vertices(1e19))?;
    let short = with_short_directions(aslant_at_vertices(1.0));
    compare("the same, directions 1e-30 as long", floor(1.0), &short)?;
    let one = [[Vec3::ZERO, 16.0 * Vec3::X, 16.0 * Vec3::Z]];
    compare("the same, on a single triangle", one.to_vec(), &short)?;
    Ok(())
}

fn compare(name: &str, mesh: Vec<Triangle>, rays: &[Ray]) -> Result<(), Box<dyn Error>> {
    let triangles = Arc::new(mesh.into_iter().collect::<Triangles>());
    let engine = |backend, test| build(backend, test, &triangles, &BuildOptions::default());
    let robust = engine(Backend::Embree, Test::Pluecker)?;
    let fast = engine(Backend::Embree, Test::Moller)?;
    let ours = engine(Backend::Grid, Test::Exact)?;
    let blocked: Vec<&Ray> =
        rays.iter().filter(|ray| truth(ray, &triangles) == Verdict::Blocked).collect();
    let lost = |engine: &dyn Occlusion| {
        blocked.iter().filter(|ray| !engine.occluded(ray, &mut Tally::default())).count()
    };
    let (robust, fast, ours) = (lost(&*robust), lost(&*fast), lost(&*ours));
    let (rays, blocked) = (rays.len(), blocked.len());
    println!("{name:44}{rays:>6}{blocked:>9}{robust:>8}{fast:>8}{ours:>8}");
    Ok(())
}
