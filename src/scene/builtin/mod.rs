//! The four scenes of Pearce & Jevans 1991, rebuilt.
//!
//! The paper gives their triangles and lights as numbers only (its Table 2), so the shapes, colours
//! and places are ours; the numbers are met exactly. Every scene is the same to the last bit on
//! every machine.

mod chair_room;
mod drum;
mod jittered;
mod model;
mod random;

use model::{Model, Purpose};
use random::Random;

use super::{Draft, SceneError, memory};
use crate::geometry::surface::Deviation;

/// The scenes' names.
pub const NAMES: &[&str] = &["jittered-sparse", "jittered-dense", "drum", "chair-room"];

/// Least and greatest multiple of the paper's triangles.
pub const TESSELLATION: (f64, f64) = (0.01, 100.0);

/// The picture that the paper made of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples along each side of a pixel.
    pub samples_per_side: u32,
}

/// The picture that the paper made of a scene. "All images except Spanky" had nine samples a pixel; of
/// Spanky the paper counts fewer rays than nine times its pixels, so it had one.
#[must_use]
pub fn view(name: &str) -> Option<View> {
    let (width, height, samples_per_side) =
        if name == "drum" { (512, 512, 1) } else { (640, 486, 3) };
    NAMES.contains(&name).then_some(View { width, height, samples_per_side })
}

/// The scene with the paper's number of triangles; `None` if no scene has that name or memory does not hold it: [`draft_at`] says which.
#[must_use]
pub fn draft(name: &str) -> Option<Draft> {
    draft_at(name, 1.0).ok()
}

/// The scene with `tessellation` times the paper's triangles.
///
/// # Errors
/// [`SceneError::Unknown`] if no scene has that name; [`SceneError::TooLarge`] if the tessellation
/// is out of its range or memory does not hold the triangles.
pub fn draft_at(name: &str, tessellation: f64) -> Result<Draft, SceneError> {
    let unknown = || SceneError::Unknown { name: name.to_owned(), known: NAMES.join(", ") };
    if !NAMES.contains(&name) {
        return Err(unknown());
    }
    if !is_in_range(tessellation) {
        let (least, greatest) = TESSELLATION;
        return Err(SceneError::TooLarge {
            name: name.to_owned(),
            problem: format!("tessellation {tessellation} is not between {least} and {greatest}"),
        });
    }
    match name {
        "jittered-sparse" => jittered::draft(name, 0.2, tessellation),
        "jittered-dense" => jittered::draft(name, 1.0, tessellation),
        _ => {
            let describe = description(name).ok_or_else(unknown)?;
            let density = density(describe, tessellation);
            let count = counted(describe, density);
            check_memory(name, count)?;
            let mut model = Model::new(name, density, Purpose::Make);
            describe(&mut model);
            Ok(model.draft)
        }
    }
}

/// Refuses what memory does not hold.
fn check_memory(name: &str, triangles: u64) -> Result<(), SceneError> {
    memory::check(triangles).map_err(|problem| SceneError::TooLarge {
        name: name.to_owned(),
        problem: format!("{problem}; take a smaller tessellation"),
    })
}

/// Whether there are scenes of that tessellation; NaN is none.
fn is_in_range(tessellation: f64) -> bool {
    let (least, greatest) = TESSELLATION;
    (least..=greatest).contains(&tessellation)
}

/// How many triangles [`draft_at`] makes, without making them; `None` if no scene has that name, or the tessellation is out of
/// its range ([`TESSELLATION`]).
#[must_use]
pub fn triangle_count(name: &str, tessellation: f64) -> Option<u64> {
    match name {
        _ if !is_in_range(tessellation) => None,
        "jittered-sparse" | "jittered-dense" => Some(jittered::triangle_count(tessellation)),
        _ => description(name).map(|describe| counted(describe, density(describe, tessellation))),
    }
}

/// How far the triangles of [`draft_at`] are from the curved surfaces they stand for, in the scene's unit;
/// `None` if no scene has that name, its surfaces are flat, or the tessellation is out of its range ([`TESSELLATION`]).
#[must_use]
pub fn deviation(name: &str, tessellation: f64) -> Option<Deviation> {
    let describe = description(name).filter(|_| is_in_range(tessellation))?;
    let mut model = Model::new("", density(describe, tessellation), Purpose::Measure);
    describe(&mut model);
    Some(model.deviation)
}

/// What puts a scene of surfaces together.
type Describe = fn(&mut Model);

fn description(name: &str) -> Option<Describe> {
    match name {
        "drum" => Some(drum::describe),
        "chair-room" => Some(chair_room::describe),
        _ => None,
    }
}

fn counted(describe: Describe, density: f64) -> u64 {
    let mut model = Model::new("", density, Purpose::Count);
    describe(&mut model);
    model.count
}

/// The factor on resolutions that comes nearest to the factor on triangles.
///
/// Resolutions are whole numbers and no shape goes below its fewest triangles, so the square root is
/// only a first guess; the rest is bisection over counts.
fn density(describe: Describe, tessellation: f64) -> f64 {
    /// Enough to tell apart densities that round to different resolutions.
    const STEPS: usize = 24;
    if tessellation == 1.0 {
        return 1.0;
    }
    let wanted = counted(describe, 1.0) as f64 * tessellation;
    let (mut low, mut high) = (0.0, 2.0 * tessellation.sqrt());
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if (counted(describe, middle) as f64) < wanted { low = middle } else { high = middle }
    }
    let missed = |density: f64| (counted(describe, density) as f64 - wanted).abs();
    if missed(low) < missed(high) { low } else { high }
}
