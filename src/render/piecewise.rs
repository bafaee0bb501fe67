//! A render by one worker that goes on piece by piece: so several can take turns.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;

use super::order::Place;
use super::whitted::Unit;
use super::{Progress, Settings, SettingsError, Statistics};
use crate::occlusion::Occlusion;
use crate::scene::Scene;
use crate::shadow::Prepared;

/// Samples of a scanline that make a piece: some milliseconds of work. A system that shares its
/// processors often leaves that undisturbed, and it is too much for branches to be learnt by heart.
const SAMPLES_A_PIECE: u32 = 640;

/// A render in one thread, in pieces of a few milliseconds: stretches of scanlines, whose memories
/// last to the end of the picture; or tiles, each with memories of its own.
pub struct Piecewise<'a> {
    scene: &'a Scene,
    backend: &'a dyn Occlusion,
    shadows: &'a dyn Prepared,
    settings: &'a Settings,
    /// The worker of all scanlines.
    unit: Unit<'a>,
    pixels: Vec<Place>,
    pieces: Vec<Range<usize>>,
    next: usize,
    /// What the workers of the tiles have done.
    colours: Vec<Vec3>,
    statistics: Statistics,
}

/// What a piecewise render gives.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    /// The pixels that were rendered and their colours, row by row from left to right.
    pub colours: Vec<(Place, Vec3)>,
    /// All counts.
    pub statistics: Statistics,
}

impl<'a> Piecewise<'a> {
    /// Nothing is rendered yet. One of every so many scanlines, or tiles, will be.
    ///
    /// # Errors
    /// If the settings make no picture.
    ///
    /// # Panics
    /// If `every` is 0.
    pub fn new(
        scene: &'a Scene,
        backend: &'a dyn Occlusion,
        shadows: &'a dyn Prepared,
        settings: &'a Settings,
        every: u32,
    ) -> Result<Self, SettingsError> {
        settings.check()?;
        let Settings { width, height, samples, order, .. } = *settings;
        let stretch = (SAMPLES_A_PIECE / (samples * samples)).max(1) as usize;
        let (mut pixels, mut pieces) = (Vec::new(), Vec::new());
        for (row, unit) in order.units([width, height], 1, samples).into_iter().enumerate() {
            if !Self::picks(row as u32, every) {
                continue;
            }
            let length = if order.batches() { unit.len() } else { stretch };
            for piece in unit.chunks(length) {
                pieces.push(pixels.len()..pixels.len() + piece.len());
                pixels.extend_from_slice(piece);
            }
        }
        let unit = Unit::new(scene, backend, shadows, settings);
        let (colours, statistics) = (Vec::new(), Statistics::default());
        Ok(Self {
            scene,
            backend,
            shadows,
            settings,
            unit,
            pixels,
            pieces,
            next: 0,
            colours,
            statistics,
        })
    }

    /// Whether a scanline, or tile, is among one of every so many. Of twice so many the middle two are: two
    /// neighbours, an even and an odd one, so serpentine scanlines turn as they do in the whole picture.
    #[must_use]
    pub fn picks(row: u32, every: u32) -> bool {
        let place = u64::from(row) % (2 * u64::from(every));
        place + 1 == u64::from(every) || place == u64::from(every)
    }

    /// Number of pieces in all.
    #[must_use]
    pub fn count(&self) -> usize {
        self.pieces.len()
    }

    /// Renders the next piece; `false` if there is none.
    pub fn advance(&mut self, progress: &Progress) -> bool {
        let Some(piece) = self.pieces.get(self.next).cloned() else { return false };
        self.next += 1;
        progress.pixels.fetch_add(piece.len() as u64, Relaxed);
        if self.settings.order.batches() {
            let unit = Unit::new(self.scene, self.backend, self.shadows, self.settings);
            let done = unit.run(&self.pixels[piece], progress);
            self.colours.extend(done.colours);
            self.statistics += done.statistics;
        } else {
            self.unit.stretch(&self.pixels, piece, progress);
        }
        true
    }

    /// What was rendered so far.
    #[must_use]
    pub fn finish(mut self) -> Pieces {
        let done = self.unit.finish();
        self.colours.extend(done.colours);
        self.statistics += done.statistics;
        let mut colours: Vec<_> = self.pixels.into_iter().zip(self.colours).collect();
        colours.sort_by_key(|&((x, y), _)| (y, x));
        Pieces { colours, statistics: self.statistics }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_row_of_every_so_many_is_picked_and_as_many_even_ones_as_odd_ones() {
        for every in 1..20 {
            let height = 2 * every * 30;
            let rows: Vec<u32> = (0..height).filter(|&row| Piecewise::picks(row, every)).collect();
            assert_eq!(rows.len() as u32, height / every, "one in {every}");
            assert!(rows.chunks(2).all(|pair| pair[0] + 1 == pair[1]), "one in {every}: {rows:?}");
        }
    }

    #[test]
    fn some_row_is_picked_from_every_picture() {
        for height in 1..50 {
            for every in 1..=height {
                assert!((0..height).any(|row| Piecewise::picks(row, every)), "{every} of {height}");
            }
        }
    }
}
