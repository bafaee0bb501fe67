//! What rays a picture will take, before it is rendered: those of a small picture of the same view. Nobody answers its shadow
//! queries; they count as blocked, and so cost no shading.

use rayon::prelude::*;

use super::order::Place;
use super::{Progress, RayCounts, Settings, SettingsError, whitted::Unit};
use crate::occlusion::Occlusion;
use crate::scene::Scene;
use crate::shadow::{Answer, Prepared, ShadowQuery, ShadowTally, Shadows};

/// Pixels of the picture to one of the small one, along each side: a thousandth of all pixels is looked at.
pub(super) const STRIDE: u32 = 32;

/// About how many shadow queries a render will ask.
///
/// # Errors
/// If the settings make no picture.
pub fn forecast(
    scene: &Scene,
    backend: &dyn Occlusion,
    settings: &Settings,
) -> Result<u64, SettingsError> {
    settings.check()?;
    let small = Small::of(scene, backend, settings, STRIDE);
    let asked: u64 = small.rays.iter().map(|rays| rays.shadow).sum();
    let Settings { width, height, samples, .. } = *settings;
    let times = f64::from(width) * f64::from(height) * f64::from(samples).powi(2)
        / (f64::from(small.width) * f64::from(small.height));
    Ok((asked as f64 * times) as u64)
}

/// The rays of a small picture of one sample a pixel.
pub(super) struct Small {
    width: u32,
    height: u32,
    /// Row by row.
    rays: Vec<RayCounts>,
}

impl Small {
    /// The same view in so many times fewer pixels along each side; of settings that were checked.
    pub fn of(scene: &Scene, backend: &dyn Occlusion, settings: &Settings, stride: u32) -> Self {
        let (width, height) = (settings.width.div_ceil(stride), settings.height.div_ceil(stride));
        let small = Settings {
            width,
            height,
            samples: 1,
            mask: false,
            answers: None,
            record: false,
            ..*settings
        };
        let rays = (0..width * height).into_par_iter().map(|pixel| {
            let unit = Unit::new(scene, backend, &Unanswered, &small);
            unit.run(&[(pixel % width, pixel / width)], &Progress::default()).statistics.rays
        });
        Self { width, height, rays: rays.collect() }
    }

    /// The rays of one sample of a pixel of the picture, which is so large: those of the place of the small one where it lies.
    pub fn rays_at(&self, (x, y): Place, settings: &Settings) -> &RayCounts {
        let along = |place: u32, small: u32, all: u32| {
            (u64::from(place) * u64::from(small) / u64::from(all)) as usize
        };
        let row = along(y, self.height, settings.height);
        let column = along(x, self.width, settings.width);
        &self.rays[row * self.width as usize + column]
    }
}

/// Says that everything is blocked.
struct Unanswered;

impl Prepared for Unanswered {
    fn worker(&self) -> Box<dyn Shadows + '_> {
        Box::new(Self)
    }
}

impl Shadows for Unanswered {
    fn answer(&mut self, _: usize, _: &[ShadowQuery], answers: &mut [Answer]) {
        for answer in answers {
            answer.blocked = true;
        }
    }

    fn tally(&self) -> ShadowTally {
        ShadowTally::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::{Backend, BuildOptions, Test, build};
    use crate::render::render;
    use crate::scene::builtin;
    use crate::shadow::Trace;

    #[test]
    fn a_forecast_is_right_by_a_fifth() {
        for name in builtin::NAMES {
            let scene = builtin::draft_at(name, 0.1).unwrap().finish().unwrap();
            let options = BuildOptions::default();
            let grid = build(Backend::Grid, Test::Exact, &scene.triangles, &options).unwrap();
            let settings = Settings { samples: 2, depth: 3, ..Settings::default() };
            let expected = forecast(&scene, &*grid, &settings).unwrap() as f64;
            let small = Settings { width: 160, height: 120, samples: 1, ..settings };
            let rendered =
                render(&scene, &*grid, &Trace::new(&*grid), &small, &Progress::default()).unwrap();
            let pixels = |settings: &Settings| {
                f64::from(settings.width * settings.height * settings.samples.pow(2))
            };
            let all = rendered.statistics.rays.shadow as f64 * pixels(&settings) / pixels(&small);
            assert!((0.8..1.25).contains(&(expected / all)), "{name}: {expected} of {all}");
        }
    }
}
