//! Table 2 of Pearce & Jevans 1991 beside ours.
//!
//! *Rays* are counted as the paper counts them: those of all samples, shadow rays included, and a
//! shadow ray only towards lights that the surface faces. The two *rates* are conditional: of the
//! queries for which the remembered object was tested, those that it blocked (with the object cache
//! alone); of those for which the object failed and the voxel was tested, those that the voxel blocked
//! (with one voxel cache a light). A *gain* is the share of the entire process that is saved: making
//! and tessellating the scene, building the structure, rendering; all in one thread.

mod lockstep;
mod meter;
mod published;
mod table;

use serde::Serialize;

use crate::occlusion::{Backend, BackendError, BuildOptions, Test, build};
use crate::render::{Order, Progress, RayCounts, Settings, SettingsError};
use crate::scene::{SceneError, builtin};
use crate::shadow::{
    LastVoxel, Method, MethodError, PerPath, Plan, Prepared, ShadowTally, prepare,
};
use lockstep::{Taken, render_in_turns};

pub use meter::{Meter, Unit};
pub use published::{Published, Storage, TABLE, storage};
pub use table::storage_table;

/// Bytes of a node of our cache trees.
pub const NODE_BYTES: usize = PerPath::<LastVoxel>::NODE_BYTES;

/// The methods of Table 2, and none to compare them with.
const METHODS: [Method; 4] =
    [Method::Trace, Method::ObjectCache, Method::VoxelCache, Method::CacheTree];

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
    /// Reflections and refractions that a ray may go through.
    pub depth: u8,
    /// Factor on the paper's triangles.
    pub tessellation: f64,
    /// How often the work is measured.
    pub repetitions: usize,
    /// What the methods have in common.
    pub plan: Plan,
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

    /// Whether pictures can be made like this.
    ///
    /// # Errors
    /// Says why not.
    pub fn check(&self) -> Result<(), PaperError> {
        if self.repetitions == 0 {
            return Err(PaperError::Repetitions);
        }
        Ok(TABLE.iter().try_for_each(|column| self.settings(column.scene).check())?)
    }

    /// Pixels that will be rendered of a scene, over all methods and repetitions.
    #[must_use]
    pub fn pixels(&self, scene: &str) -> u64 {
        let Settings { width, height, .. } = self.settings(scene);
        let pictures = self.backends.len() * METHODS.len() * self.repetitions;
        u64::from(width) * u64::from(height) * pictures as u64
    }
}

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The scene cannot be made.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The engine cannot be used.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The method cannot be used.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The picture cannot be made.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Nothing would be measured.
    #[error("repetitions 0: give at least 1")]
    Repetitions,
}

/// A share of the process that is saved, in per cent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// From the least measurement of each scanline.
    pub percent: f64,
    /// Half the distance of the least and the greatest that one repetition alone would have shown.
    pub spread: f64,
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
    /// The same, by repetition.
    pub repetitions: Vec<u64>,
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
    /// What work is counted in.
    pub unit: Unit,
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
) -> Result<SceneReport, PaperError> {
    let settings = conditions.settings(published.scene);
    let meter = Meter::start();
    let before = meter.read();
    let scene = builtin::draft_at(published.scene, conditions.tessellation)?.finish()?;
    let load = meter.read() - before;
    let mut columns = Vec::new();
    for &backend in &conditions.backends {
        let test = conditions.test.unwrap_or_else(|| backend.default_test());
        let before = meter.read();
        let engine = build(backend, test, &scene.triangles, &BuildOptions::default())?;
        let methods = METHODS
            .iter()
            .map(|&method| prepare(Plan { method, ..conditions.plan }, &scene, &*engine))
            .collect::<Result<Vec<Box<dyn Prepared>>, _>>()?;
        let build = meter.read() - before;
        let repetitions = conditions.repetitions;
        let taken =
            render_in_turns(&scene, &*engine, &methods, &settings, repetitions, &meter, progress)?;
        columns.push(column(backend, test, load, build, &taken));
    }
    Ok(SceneReport {
        published: *published,
        triangles: scene.triangles.len(),
        lights: scene.lights.len(),
        width: settings.width,
        height: settings.height,
        samples_per_pixel: settings.samples * settings.samples,
        unit: meter.unit(),
        load,
        columns,
    })
}

fn column(backend: Backend, test: Test, load: u64, build: u64, taken: &[Taken]) -> Column {
    let [none, object, voxel, tree] = taken else { unreachable!("a measurement a method") };
    let gain = |without: &Taken, with: &Taken| {
        let saved = |without: u64, with: u64| {
            let whole = |render: u64| (load + build + render) as f64;
            100.0 * (1.0 - whole(with) / whole(without))
        };
        let single = without.repetitions.iter().zip(&with.repetitions);
        let (low, high) = single.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
            (low.min(saved(*a, *b)), high.max(saved(*a, *b)))
        });
        Gain { percent: saved(without.least, with.least), spread: 0.5 * (high - low) }
    };
    let rate = |hits: u64, tested: u64| 100.0 * hits as f64 / tested.max(1) as f64;
    let (haines, pearce) = (object.statistics.shadows, voxel.statistics.shadows);
    let methods = METHODS.iter().zip(taken).map(|(method, taken)| Cost {
        method: method.name(),
        shadows: taken.statistics.shadows,
        render: taken.least,
        repetitions: taken.repetitions.clone(),
    });
    Column {
        backend: backend.name(),
        test: test.name(),
        rays: none.statistics.rays,
        object_rate: rate(haines.object_hits, haines.object_tested),
        voxel_rate: rate(pearce.voxel_hits, pearce.voxel_tested),
        object_gain: gain(none, object),
        voxel_gain: gain(object, voxel),
        tree_gain: gain(voxel, tree),
        build,
        methods: methods.collect(),
        agree: taken.iter().all(|taken| taken.colours == none.colours),
    }
}
