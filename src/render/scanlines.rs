//! A render by one worker that goes on a scanline at a time: so several can take turns.

use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;

use super::order::Place;
use super::whitted::Unit;
use super::{Progress, Settings, SettingsError, Statistics};
use crate::occlusion::Occlusion;
use crate::scene::Scene;
use crate::shadow::Prepared;

/// A render of the whole picture as one unit of work, in one thread.
pub struct Scanlines<'a> {
    unit: Unit<'a>,
    pixels: Vec<Place>,
    width: usize,
    next: usize,
}

impl<'a> Scanlines<'a> {
    /// Nothing is rendered yet. The settings' order says how scanlines run; tiles have none.
    ///
    /// # Errors
    /// If the settings make no picture.
    pub fn new(
        scene: &'a Scene,
        backend: &'a dyn Occlusion,
        shadows: &'a dyn Prepared,
        settings: &'a Settings,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        let pixels =
            settings.order.units(settings.width, settings.height, settings.height).concat();
        let unit = Unit::new(scene, backend, shadows, settings);
        Ok(Self { unit, pixels, width: settings.width as usize, next: 0 })
    }

    /// Renders the next scanline; `false` if there is none.
    pub fn advance(&mut self, progress: &Progress) -> bool {
        let end = (self.next + self.width).min(self.pixels.len());
        if self.next == end {
            return false;
        }
        self.unit.scanline(&self.pixels, self.next..end, progress);
        progress.pixels.fetch_add((end - self.next) as u64, Relaxed);
        self.next = end;
        true
    }

    /// The colours so far, in the order of the scanlines, and all counts.
    #[must_use]
    pub fn finish(self) -> (Vec<Vec3>, Statistics) {
        let done = self.unit.finish();
        (done.colours, done.statistics)
    }
}
