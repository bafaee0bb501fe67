//! Table 2 of Pearce & Jevans 1991 beside ours.
//!
//! *Rays* are counted as the paper counts them: those of all samples, shadow rays included, and a
//! shadow ray only towards lights that the surface faces. The two *rates* are conditional: of the
//! queries for which the remembered object was tested, those that it blocked (with the object cache
//! alone); of those for which the object failed and the voxel was tested, those that the voxel blocked
//! (with one voxel cache a light). A *gain* is the share of the entire process that is saved: making
//! and tessellating the scene, building the structure, rendering; all in one thread.

mod callgrind;
mod lockstep;
mod meter;
mod published;
mod table;
mod variants;

use std::path::PathBuf;

use serde::Serialize;

use super::MeasureError;
use crate::geometry::lanes::Arithmetic;
use crate::occlusion::{Backend, BuildOptions, Test, build};
use crate::render::{Order, Piecewise, Progress, RayCounts, Settings};
use crate::scene::builtin;
use crate::shadow::{LastVoxel, Method, MethodError, PerPath, Plan, ShadowTally, prepare};
use lockstep::{Contestant, Taken, render_all};

pub use callgrind::{Callgrind, LOG, callgrind};
pub use meter::{Meter, Unit, process_time, thread_time};
pub use published::{Published, Storage, TABLE, storage};
pub use table::storage_table;
pub use variants::{VARIANTS, Variant, VariantCost, VariantReport, compare_variants};

/// Bytes of a node of our cache trees.
pub const NODE_BYTES: usize = PerPath::<LastVoxel>::NODE_BYTES;

/// The methods of Table 2, none to compare them with, and none once more: what that gains over itself
/// is the error of the measure.
const METHODS: [Method; 5] =
    [Method::Trace, Method::ObjectCache, Method::VoxelCache, Method::CacheTree, Method::Trace];

/// How the table is made.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// The backends: a column each.
    pub backends: Vec<Backend>,
    /// The triangle test; each backend's own choice if none is named.
    pub test: Option<Test>,
    /// Size of the pictures, instead of the paper's.
    pub size: Option<(u32, u32)>,
    /// Samples along each side of a pixel, instead of the paper's.
    pub samples: Option<u32>,
    /// Only one of every so many scanlines is rendered: see [`Piecewise::picks`].
    pub every: u32,
    /// Reflections and refractions that a ray may go through.
    pub depth: u8,
    /// Factor on the paper's triangles.
    pub tessellation: f64,
    /// How often the work is measured.
    pub repetitions: usize,
    /// What the methods have in common.
    pub plan: Plan,
    /// How the engines are built.
    pub build: BuildOptions,
    /// The folder in which Callgrind writes, if it shall count.
    pub callgrind: Option<PathBuf>,
}

impl Conditions {
    /// The picture that will be made of a scene.
    fn settings(&self, scene: &str) -> Settings {
        let view = builtin::view(scene).expect("a scene of the table");
        let (width, height) = self.size.unwrap_or((view.width, view.height));
        Settings {
            width,
            height,
            samples: self.samples.unwrap_or(view.samples_per_side),
            depth: self.depth,
            order: Order::Scanline,
            rows_per_unit: height,
            ..Settings::default()
        }
    }

    /// Starts counting what this thread does.
    fn meter(&self) -> Result<Meter, MeasureError> {
        match &self.callgrind {
            None => Ok(Meter::start()),
            Some(folder) => {
                Callgrind::start(folder).map(Meter::Callgrind).ok_or(MeasureError::NoCallgrind)
            }
        }
    }

    /// Whether pictures of these scenes can be made like this.
    ///
    /// # Errors
    /// Says why not.
    pub fn check<'a>(
        &self,
        scenes: impl Iterator<Item = &'a Published>,
    ) -> Result<(), MeasureError> {
        if self.repetitions == 0 {
            return Err(MeasureError::Repetitions);
        }
        for published in scenes {
            let settings = self.settings(published.scene);
            settings.check()?;
            if !(1..=settings.height).contains(&self.every) {
                return Err(MeasureError::Every { every: self.every, height: settings.height });
            }
        }
        Ok(())
    }

    /// Whether the variants can be compared in these scenes, besides what [`check`](Self::check) looks at.
    ///
    /// # Errors
    /// Says why not.
    pub fn check_variants<'a>(
        &self,
        scenes: impl Iterator<Item = &'a Published>,
    ) -> Result<(), MeasureError> {
        let every = self.every;
        for published in scenes {
            let Settings { width, height, samples, rows_per_unit, .. } =
                self.settings(published.scene);
            // More are rendered where dear ones are cut; how many only the scene would tell.
            let tiles = Order::Tiles.units([width, height], rows_per_unit, samples).len() as u32;
            if every > tiles {
                return Err(MeasureError::EveryTile { every, tiles });
            }
        }
        Ok(())
    }

    /// Pixels that will be rendered of a scene, over all repetitions of so many methods.
    fn pixels_by(&self, scene: &str, methods: usize) -> u64 {
        let Settings { width, height, .. } = self.settings(scene);
        // See `lockstep`.
        let times = if self.callgrind.is_some() { 1 } else { 2 * self.repetitions };
        let pictures = times * self.backends.len() * methods;
        let rows = (0..height).filter(|&row| Piecewise::picks(row, self.every)).count();
        u64::from(width) * (rows * pictures) as u64
    }

    /// Pixels that will be rendered for the table of a scene.
    #[must_use]
    pub fn pixels(&self, scene: &str) -> u64 {
        self.pixels_by(scene, METHODS.len())
    }

    /// Pixels that will be rendered to compare the variants in a scene.
    #[must_use]
    pub fn pixels_of_variants(&self, scene: &str) -> u64 {
        self.pixels_by(scene, VARIANTS.len())
    }
}

/// A share of the process that is saved, in per cent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// From the least measurement of each piece of the picture.
    pub percent: f64,
    /// Half the distance between what the even and the odd repetitions say by themselves; none if
    /// nothing was repeated.
    pub spread: Option<f64>,
}

impl Gain {
    /// Of one way over another, when so much work comes before either.
    fn over(without: &Taken, with: &Taken, before: u64) -> Self {
        let saved = |without: u64, with: u64| {
            100.0 * (1.0 - (before + with) as f64 / (before + without) as f64)
        };
        let [even, odd] = [0, 1].map(|half| saved(without.halves[half], with.halves[half]));
        Self {
            percent: saved(without.least, with.least),
            spread: without.repeated.then_some(0.5 * (even - odd).abs()),
        }
    }
}

/// What one method did over one backend.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    /// The method.
    pub method: &'static str,
    /// How queries were answered.
    pub shadows: ShadowTally,
    /// What rendering took, in the unit of the report.
    pub render: u64,
    /// The same by the even and by the odd repetitions alone.
    pub halves: [u64; 2],
}

/// Table 2 for one scene over one backend.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// The backend.
    pub backend: &'static str,
    /// Its triangle test.
    pub test: &'static str,
    /// Rays by kind.
    pub rays: RayCounts,
    /// As the paper defines it, in per cent.
    pub object_rate: f64,
    /// As the paper defines it, in per cent.
    pub voxel_rate: f64,
    /// Of an object cache over none.
    pub object_gain: Gain,
    /// Of a voxel cache over an object cache.
    pub voxel_gain: Gain,
    /// Of a cache tree over a voxel cache.
    pub tree_gain: Gain,
    /// Of none over none: the error of the measure.
    pub error: Gain,
    /// What building the backend took.
    pub build: u64,
    /// The methods.
    pub methods: Vec<Cost>,
    /// Whether all methods made the same picture, bit for bit.
    pub agree: bool,
}

/// Table 2 for one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// What the paper says.
    pub published: Published,
    /// Triangles here.
    pub triangles: usize,
    /// Lights here.
    pub lights: usize,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples a pixel.
    pub samples_per_pixel: u32,
    /// Of every so many scanlines one was rendered: to that share all counts and measures belong.
    pub every: u32,
    /// What work is counted in.
    pub unit: Unit,
    /// The instruction set of our kernels.
    pub arithmetic: &'static str,
    /// What making and tessellating the scene took.
    pub load: u64,
    /// A column a backend.
    pub columns: Vec<Column>,
}

/// Makes a column group of the table: runs in the current thread, so install a rayon pool of one.
///
/// # Errors
/// If scene, backend, method or picture cannot be made.
pub fn reproduce(
    published: &Published,
    conditions: &Conditions,
    progress: &Progress,
) -> Result<SceneReport, MeasureError> {
    let settings = conditions.settings(published.scene);
    let meter = conditions.meter()?;
    let before = meter.read()?;
    let scene = builtin::draft_at(published.scene, conditions.tessellation)?.finish()?;
    let load = meter.read()? - before;
    let mut columns = Vec::new();
    for &backend in &conditions.backends {
        let test = conditions.test.unwrap_or_else(|| backend.default_test());
        let before = meter.read()?;
        let engine = build(backend, test, &scene.triangles, &conditions.build)?;
        let contestants = METHODS
            .iter()
            .map(|&method| {
                let method = prepare(Plan { method, ..conditions.plan }, &scene, &*engine)?;
                Ok(Contestant { method, settings })
            })
            .collect::<Result<Vec<_>, MethodError>>()?;
        let build = meter.read()? - before;
        let Conditions { every, repetitions, .. } = *conditions;
        let taken =
            render_all(&scene, &*engine, &contestants, every, repetitions, &meter, progress)?;
        columns.push(column((backend, test), (load, build), every, &taken));
    }
    Ok(SceneReport {
        published: *published,
        triangles: scene.triangles.len(),
        lights: scene.lights.len(),
        width: settings.width,
        height: settings.height,
        samples_per_pixel: settings.samples * settings.samples,
        every: conditions.every,
        unit: meter.unit(),
        arithmetic: Arithmetic::of_this_cpu().name(),
        load,
        columns,
    })
}

fn column(
    (backend, test): (Backend, Test),
    (load, build): (u64, u64),
    every: u32,
    taken: &[Taken],
) -> Column {
    let [none, object, voxel, tree, again] = taken else { unreachable!("a measurement a method") };
    // Of a part of the picture, the work before it is charged that part only.
    let before = (load + build) / u64::from(every);
    let gain = |without: &Taken, with: &Taken| Gain::over(without, with, before);
    let (haines, pearce) = (object.statistics.shadows, voxel.statistics.shadows);
    let methods = METHODS.iter().zip(taken).map(|(method, taken)| Cost {
        method: method.name(),
        shadows: taken.statistics.shadows,
        render: taken.least,
        halves: taken.halves,
    });
    Column {
        backend: backend.name(),
        test: test.name(),
        rays: none.statistics.rays,
        object_rate: percent(haines.object_hits, haines.object_tested),
        voxel_rate: percent(pearce.voxel_hits, pearce.voxel_tested),
        object_gain: gain(none, object),
        voxel_gain: gain(object, voxel),
        tree_gain: gain(voxel, tree),
        error: gain(none, again),
        build,
        methods: methods.collect(),
        agree: taken.iter().all(|taken| taken.colours == none.colours),
    }
}

/// A share in per cent.
fn percent(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}
