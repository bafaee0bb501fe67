//! Speed against accuracy, measured: three trades that a user can make.
//!
//! *Engines*: every contender answers the same recorded queries, and what it says is held against exact
//! arithmetic. *Tessellation*: fewer triangles of curved surfaces are faster, and farther from the surfaces.
//! *Samples*: fewer samples of a pixel are faster, and farther from the picture of many. All that is compared
//! takes turns in one run; medians count.

mod charts;
mod csv;
mod disagreements;
mod engines;
mod masks;
mod page;
mod pareto;
mod picture_error;
mod pictures;
mod table;
mod timing;

use std::sync::Arc;

use serde::Serialize;

use super::MeasureError;
use super::contender::Contender;
use super::recording::Recording;
use crate::render::{Film, Progress, Settings};
use crate::scene::{Scene, builtin};
use masks::Masks;

pub use charts::plot;
pub use csv::csv;
pub use disagreements::Disagreement;
pub use engines::EnginePoint;
pub use page::page;
pub use pareto::front;
pub use picture_error::PictureError;
pub use pictures::{PictureTrade, SamplesPoint, TessellationPoint};
pub use table::table;
pub use timing::Timing;

/// What is measured.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Who answers queries.
    pub contenders: Vec<Contender>,
    /// The picture whose queries are answered.
    pub settings: Settings,
    /// How often everything is measured.
    pub repetitions: usize,
    /// Factors on a built-in scene's triangles, ascending.
    pub tessellations: Vec<f64>,
    /// The factor of the picture that they are held against.
    pub reference_tessellation: f64,
    /// Samples along each side of a pixel, ascending.
    pub samples: Vec<u32>,
    /// Those of the picture that they are held against.
    pub reference_samples: u32,
}

impl Conditions {
    /// Whether it can be measured.
    ///
    /// # Errors
    /// Says why not.
    pub fn check(&self) -> Result<(), MeasureError> {
        if self.repetitions == 0 {
            return Err(MeasureError::Repetitions);
        }
        Ok(self.settings.check()?)
    }

    /// Steps that [`measure`] counts as pixels of its progress.
    #[must_use]
    pub fn steps(&self, scene: &Scene) -> u64 {
        let tessellations =
            if is_curved(scene) { 1 + self.repetitions * self.tessellations.len() } else { 0 };
        let samples = 1 + self.repetitions * self.samples.len();
        (self.repetitions * self.contenders.len() + tessellations + samples) as u64
    }
}

/// Where and how it was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Circumstances {
    /// The scene.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// Its lights.
    pub lights: usize,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples of a pixel.
    pub samples_per_pixel: u32,
    /// Shadow queries.
    pub queries: usize,
    /// Those that are blocked.
    pub blocked: usize,
    /// Threads.
    pub threads: usize,
    /// The processor, as it calls itself.
    pub processor: String,
    /// The version of umbra.
    pub version: &'static str,
    /// How often everything was measured.
    pub repetitions: usize,
    /// What was left out, and why.
    pub notes: Vec<String>,
}

/// Places among the points of engines that no other beats.
#[derive(Clone, Debug, Serialize)]
pub struct Fronts {
    /// Speed of what is built against wrong answers.
    pub warm: Vec<usize>,
    /// Speed with the building against wrong answers.
    pub with_build: Vec<usize>,
    /// Speed of what is built against memory.
    pub memory: Vec<usize>,
}

/// What was measured. Its pictures are not part of the JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Where and how.
    pub circumstances: Circumstances,
    /// Every contender.
    pub engines: Vec<EnginePoint>,
    /// Those that no other beats.
    pub fronts: Fronts,
    /// Tessellations, if the scene has curved surfaces.
    pub tessellations: Vec<TessellationPoint>,
    /// Numbers of samples.
    pub samples: Vec<SamplesPoint>,
    /// Queries with the most wrong answers, the worst first.
    pub disagreements: Vec<Disagreement>,
    /// Queries that any contender answered otherwise than exactly, ties included.
    pub differing_queries: usize,
    #[serde(skip)]
    pictures: Pictures,
}

/// What the report shows besides numbers.
#[derive(Clone, Debug)]
struct Pictures {
    /// The picture whose queries were asked.
    film: Film,
    exposure: f32,
    masks: Masks,
    tessellation: Option<(String, Arc<Film>, f32)>,
    samples: (String, Arc<Film>, f32),
}

impl Report {
    /// What must not be: a contender that breaks its promise.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        let point = self.engines.iter().find(|point| point.breaks_its_promise())?;
        Some(if point.steady {
            format!("{} gave answers that are not the exact ones", point.name)
        } else {
            format!("{} gave different answers to the same rays", point.name)
        })
    }
}

/// Whether the scene is built in and has surfaces that triangles only come near to.
fn is_curved(scene: &Scene) -> bool {
    builtin::NAMES.contains(&&*scene.name) && builtin::deviation(&scene.name, 1.0).is_some()
}

/// Measures all three trades, on the threads of the current pool.
///
/// # Errors
/// If an engine, a method or a picture cannot be had, or the picture asks nothing.
pub fn measure(
    scene: &Scene,
    conditions: &Conditions,
    progress: &Progress,
) -> Result<Report, MeasureError> {
    conditions.check()?;
    let Conditions { settings, repetitions, .. } = conditions;
    Recording::check(scene, settings)?;
    let recording = Recording::of(scene, settings, &Progress::default())?;
    recording.check_asked(&scene.name)?;
    let (_, film) = pictures::picture(scene, settings)?;
    let measured = engines::measure(scene, &recording, conditions, progress)?;
    let points = measured.points;
    let single = Settings { samples: 1, ..*settings };
    let mut notes = Vec::new();
    let tessellation = if is_curved(scene) {
        let (factors, reference) = (&conditions.tessellations, conditions.reference_tessellation);
        let name = &scene.name;
        Some(pictures::tessellation(name, factors, reference, &single, *repetitions, progress)?)
    } else {
        notes.push(if builtin::NAMES.contains(&&*scene.name) {
            "no trade of tessellation: all surfaces of this scene are flat, and its triangles are the \
             surfaces".to_owned()
        } else {
            "no trade of tessellation: a file has triangles only, not the surfaces they stand for; the \
             built-in scenes drum and chair-room have both".to_owned()
        });
        None
    };
    let (sides, reference) = (&conditions.samples, conditions.reference_samples);
    let samples = pictures::samples(scene, sides, reference, settings, *repetitions, progress)?;
    let circumstances = Circumstances {
        scene: scene.name.clone(),
        triangles: scene.triangles.len(),
        lights: scene.lights.len(),
        width: settings.width,
        height: settings.height,
        samples_per_pixel: settings.samples * settings.samples,
        queries: recording.queries().len(),
        blocked: recording.queries().iter().filter(|recorded| recorded.blocked).count(),
        threads: rayon::current_num_threads(),
        processor: processor(),
        version: env!("CARGO_PKG_VERSION"),
        repetitions: *repetitions,
        notes,
    };
    let front_of = |gain: fn(&EnginePoint) -> f64, cost: fn(&EnginePoint) -> f64| {
        front(&points.iter().map(|point| (gain(point), cost(point))).collect::<Vec<_>>())
    };
    let wrong: fn(&EnginePoint) -> f64 = |point| point.wrong_per_million.share;
    let warm: fn(&EnginePoint) -> f64 = |point| point.mrays_per_second.median;
    let pictures = Pictures {
        exposure: scene.exposure.unwrap_or_else(|| film.automatic_exposure()),
        film,
        masks: Masks::new(&recording, &points, &measured.truth),
        tessellation: tessellation
            .as_ref()
            .map(|trade| (trade.reference_name.clone(), trade.reference.clone(), trade.exposure)),
        samples: (samples.reference_name.clone(), samples.reference.clone(), samples.exposure),
    };
    Ok(Report {
        circumstances,
        fronts: Fronts {
            warm: front_of(warm, wrong),
            with_build: front_of(|point| point.mrays_per_second_with_build.median, wrong),
            memory: front_of(warm, |point| point.memory_bytes as f64),
        },
        disagreements: disagreements::worst(&recording, &points, &measured.truth),
        differing_queries: disagreements::count(&points),
        engines: points,
        tessellations: tessellation.map_or_else(Vec::new, |trade| trade.points),
        samples: samples.points,
        pictures,
    })
}

/// What the processor calls itself; its architecture where it does not say.
fn processor() -> String {
    let described = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    described
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
