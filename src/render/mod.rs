//! The Whitted ray tracer: what asks the shadow queries.
//!
//! Work is cut into units (bands of rows, or tiles) whose number and content do not depend on the
//! number of threads. Each unit has a worker of its own, with fresh memories; so picture and counters
//! are the same for any number of threads, bit for bit; but if methods are chosen by the clock, or the memory
//! does not hold all that they prepare, who answered a query is not. Within a unit, rays are followed
//! generation by generation, and the shadow queries of a generation are asked light by light.

mod answers;
mod film;
mod forecast;
mod label;
mod legend;
mod order;
mod output;
pub mod palette;
mod piecewise;
mod settings;
mod shading;
mod statistics;
mod whitted;
mod work;

pub use answers::{AnswerMap, Answered, Shown};
pub use film::{Film, Seen, ShadowMask};
pub use forecast::forecast;
pub use legend::{UNASKED, from_srgb, with_legend};
pub use order::{Order, Place};
pub use output::{OutputError, Picture, encode_picture, write_picture};
pub use piecewise::{Pieces, Piecewise};
pub use settings::{MOST_SAMPLES, Settings, SettingsError};
pub use statistics::{RayCounts, Statistics};
pub use whitted::RecordedQuery;

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use crate::occlusion::Occlusion;
use crate::scene::Scene;
use crate::shadow::Prepared;
use whitted::Unit;
use work::Units;

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture, linear radiance.
    pub film: Film,
    /// Which primary hits each light reaches, if asked for.
    pub mask: Option<ShadowMask>,
    /// How the shadow queries of each pixel were answered, if asked for.
    pub answers: Option<AnswerMap>,
    /// All shadow queries, unit by unit, within each light by light in each generation; empty if not asked for.
    pub queries: Vec<Vec<RecordedQuery>>,
    /// Counts.
    pub statistics: Statistics,
}

/// How far a render is; read by whoever shows it.
#[derive(Debug, Default)]
pub struct Progress {
    /// Pixels finished.
    pub pixels: AtomicU64,
    /// Rays of all kinds so far.
    pub rays: AtomicU64,
}

/// Renders a scene.
///
/// ```
/// use umbra::occlusion::{Backend, BuildOptions, Test, build};
/// use umbra::render::{Picture, Progress, Settings, encode_picture, render};
/// use umbra::scene::builtin;
/// use umbra::shadow::{Method, prepare};
///
/// let scene = builtin::draft_at("drum", 0.01)?.finish()?;
/// let backend = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default())?;
/// let shadows = prepare(Method::ObjectCache, &scene, &*backend)?;
/// let settings = Settings { width: 16, height: 12, ..Settings::default() };
/// let film = render(&scene, &*backend, &*shadows, &settings, &Progress::default())?.film;
///
/// let png = encode_picture(&film, film.automatic_exposure(), Picture::Png8);
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Runs in the current rayon pool; to choose the number of threads, install one. The backend is one over the scene's
/// triangles, and `shadows` were [prepared](crate::shadow::prepare) for that scene and backend.
///
/// # Errors
/// If the settings make no picture of this scene.
///
/// # Panics
/// If the backend is over triangles of another scene, and a ray meets one that this scene does not have.
pub fn render(
    scene: &Scene,
    backend: &dyn Occlusion,
    shadows: &dyn Prepared,
    settings: &Settings,
    progress: &Progress,
) -> Result<Rendered, SettingsError> {
    settings.check_for(scene.lights.len())?;
    let Units { pixels: units, order } = Units::of(scene, backend, settings);
    // One by one in this order: a range would be halved, and its second half begun as soon as its first.
    let mut done: Vec<_> = order
        .into_iter()
        .par_bridge()
        .map(|number| {
            let unit = Unit::new(scene, backend, shadows, settings).run(&units[number], progress);
            progress.pixels.fetch_add(units[number].len() as u64, Relaxed);
            (number, unit)
        })
        .collect();
    done.sort_unstable_by_key(|(number, _)| *number);
    let mut film = Film::new(settings.width, settings.height);
    let mut mask =
        settings.mask.then(|| ShadowMask::new(settings.width, settings.height, scene.lights.len()));
    let mut answers = settings.answers.map(|_| AnswerMap::new(settings.width, settings.height));
    let mut statistics = Statistics::default();
    let mut queries = Vec::new();
    for (pixels, (_, unit)) in units.iter().zip(done) {
        for (place, colour) in pixels.iter().zip(&unit.colours) {
            film.set(*place, *colour);
        }
        if let Some(mask) = &mut mask {
            for (place, seen) in pixels.iter().zip(unit.seen.chunks(scene.lights.len().max(1))) {
                mask.set(*place, seen);
            }
        }
        if let Some(answers) = &mut answers {
            for (place, answered) in pixels.iter().zip(unit.answered) {
                answers.set(*place, answered);
            }
        }
        statistics += unit.statistics;
        if settings.record {
            queries.push(unit.queries);
        }
    }
    Ok(Rendered { film, mask, answers, queries, statistics })
}

/// Hands over all shadow queries of a render, unit by unit, in the order of the units.
///
/// # Errors
/// If the settings make no picture.
pub fn record(
    scene: &Scene,
    backend: &dyn Occlusion,
    shadows: &dyn Prepared,
    settings: &Settings,
    mut take: impl FnMut(Vec<RecordedQuery>),
) -> Result<(), SettingsError> {
    settings.check_for(scene.lights.len())?;
    let settings = Settings { record: true, ..*settings };
    for pixels in &Units::of(scene, backend, &settings).pixels {
        let unit = Unit::new(scene, backend, shadows, &settings);
        take(unit.run(pixels, &Progress::default()).queries);
    }
    Ok(())
}
