//! The trades that show in the picture: triangles of curved surfaces, and samples of a pixel.
//!
//! Both are measured with one engine, the grid with the exact test, so that nothing else changes.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

use serde::Serialize;

use super::picture_error::PictureError;
use super::timing::{Timing, turns};
use crate::measure::MeasureError;
use crate::occlusion::{Backend, BuildOptions, Test, build};
use crate::render::{Film, Progress, Rendered, Settings, render};
use crate::scene::{Scene, builtin};
use crate::shadow::Trace;

/// A tessellation as a point of the plane of time and accuracy.
#[derive(Clone, Debug, Serialize)]
pub struct TessellationPoint {
    /// Factor on the scene's own number of triangles.
    pub factor: f64,
    /// Triangles.
    pub triangles: usize,
    /// Making triangles, building the engine and rendering.
    pub seconds: Timing,
    /// The greatest distance of a triangle from its surface, in diagonals of the scene.
    pub greatest_deviation: f64,
    /// The root of the mean square distance, in diagonals of the scene.
    pub deviation: f64,
    /// Against the picture of the reference.
    pub picture_error: PictureError,
    /// The picture.
    #[serde(skip)]
    pub film: Arc<Film>,
}

/// A number of samples as a point of the plane of time and accuracy.
#[derive(Clone, Debug, Serialize)]
pub struct SamplesPoint {
    /// Samples of a pixel.
    pub samples_per_pixel: u32,
    /// Rendering alone.
    pub seconds: Timing,
    /// Against the picture of the reference.
    pub picture_error: PictureError,
    /// The picture.
    #[serde(skip)]
    pub film: Arc<Film>,
}

/// The points of a trade, and the picture that they are held against.
#[derive(Clone, Debug)]
pub struct PictureTrade<Point> {
    /// The points, cheapest first.
    pub points: Vec<Point>,
    /// What the reference is.
    pub reference_name: String,
    /// Its picture.
    pub reference: Arc<Film>,
    /// The exposure at which all are shown.
    pub exposure: f32,
}

/// The trade of tessellation of a built-in scene: `factors` against the picture of `reference`.
pub(super) fn tessellation(
    name: &str,
    factors: &[f64],
    reference: f64,
    settings: &Settings,
    repetitions: usize,
    progress: &Progress,
) -> Result<PictureTrade<TessellationPoint>, MeasureError> {
    let (_, scene, best) = tessellate(name, reference, settings)?;
    progress.pixels.fetch_add(1, Relaxed);
    let exposure = scene.exposure.unwrap_or_else(|| best.automatic_exposure());
    let diagonal = scene.bounds().diagonal();
    let mut seconds = vec![Vec::new(); factors.len()];
    let mut made: Vec<Option<(usize, Film)>> = vec![None; factors.len()];
    for which in turns(factors.len(), repetitions) {
        let (taken, scene, film) = tessellate(name, factors[which], settings)?;
        seconds[which].push(taken);
        made[which] = Some((scene.triangles.len(), film));
        progress.pixels.fetch_add(1, Relaxed);
    }
    let points = factors.iter().zip(seconds).zip(made).map(|((&factor, seconds), made)| {
        let (triangles, film) = made.expect("every factor had its turn");
        let deviation = builtin::deviation(name, factor).expect("a scene of curved surfaces");
        TessellationPoint {
            factor,
            triangles,
            seconds: Timing::of(seconds),
            greatest_deviation: deviation.greatest / diagonal,
            deviation: deviation.root_mean_square() / diagonal,
            picture_error: PictureError::of(&film, &best, exposure),
            film: Arc::new(film),
        }
    });
    Ok(PictureTrade {
        points: points.collect(),
        reference_name: format!("{reference} times the triangles"),
        reference: Arc::new(best),
        exposure,
    })
}

/// Seconds, scene and picture of a tessellation.
fn tessellate(
    name: &str,
    factor: f64,
    settings: &Settings,
) -> Result<(f64, Scene, Film), MeasureError> {
    let start = Instant::now();
    let scene = builtin::draft_at(name, factor)?.finish()?;
    let (_, film) = picture(&scene, settings)?;
    Ok((start.elapsed().as_secs_f64(), scene, film))
}

/// The trade of samples: so many along each side of a pixel, against the picture of `reference`.
pub(super) fn samples(
    scene: &Scene,
    sides: &[u32],
    reference: u32,
    settings: &Settings,
    repetitions: usize,
    progress: &Progress,
) -> Result<PictureTrade<SamplesPoint>, MeasureError> {
    let with = |samples: u32| picture(scene, &Settings { samples, ..*settings });
    let (_, best) = with(reference)?;
    progress.pixels.fetch_add(1, Relaxed);
    let exposure = scene.exposure.unwrap_or_else(|| best.automatic_exposure());
    let mut seconds = vec![Vec::new(); sides.len()];
    let mut films: Vec<Option<Film>> = vec![None; sides.len()];
    for which in turns(sides.len(), repetitions) {
        let (taken, film) = with(sides[which])?;
        seconds[which].push(taken);
        films[which] = Some(film);
        progress.pixels.fetch_add(1, Relaxed);
    }
    let points = sides.iter().zip(seconds).zip(films).map(|((&side, seconds), film)| {
        let film = film.expect("every number of samples had its turn");
        SamplesPoint {
            samples_per_pixel: side * side,
            seconds: Timing::of(seconds),
            picture_error: PictureError::of(&film, &best, exposure),
            film: Arc::new(film),
        }
    });
    Ok(PictureTrade {
        points: points.collect(),
        reference_name: format!("{} samples a pixel", reference * reference),
        reference: Arc::new(best),
        exposure,
    })
}

/// Seconds of rendering, the building apart, and the picture.
pub(super) fn picture(scene: &Scene, settings: &Settings) -> Result<(f64, Film), MeasureError> {
    let engine = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default())?;
    let start = Instant::now();
    let rendered = render(scene, &*engine, &Trace::new(&*engine), settings, &Progress::default());
    let Rendered { film, .. } = rendered?;
    Ok((start.elapsed().as_secs_f64(), film))
}
