//! A render by one worker that goes on piece by piece: so several can take turns.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;

use super::order::Place;
use super::whitted::Unit;
use super::work::Units;
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
    /// Nothing is rendered yet. One of every so many scanlines will be, or of tiles (dear ones are cut and come first, as in a render).
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
        let Settings { samples, order, .. } = *settings;
        let stretch = (SAMPLES_A_PIECE / (samples * samples)).max(1) as usize;
        let (mut pixels, mut pieces) = (Vec::new(), Vec::new());
        let rows = Settings { rows_per_unit: 1, ..*settings };
        let units = Units::of(scene, backend, &rows);
        for (row, &unit) in units.order.iter().enumerate() {
            if !Self::picks(row as u32, every) {
                continue;
            }
            let unit = &units.pixels[unit];
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

    /// Whether a scanline, or tile, is the one that is picked of every so many: one in their middle, in turn an
    /// even and an odd one, so that serpentine scanlines turn.
    #[must_use]
    pub fn picks(row: u32, every: u32) -> bool {
        let group = row / every;
        let middle = group * every + every / 2;
        // Where the parity is not that of the group's number, the neighbour is picked.
        row == middle ^ ((middle ^ group) & 1)
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
    fn one_row_of_every_so_many_is_picked_in_turn_an_even_and_an_odd_one() {
        for every in 1..20 {
            let rows = (0..every * 60).filter(|&row| Piecewise::picks(row, every));
            let rows: Vec<u32> = rows.collect();
            assert_eq!(rows.len(), 60, "one in {every}");
            for (group, &row) in (0..).zip(&rows) {
                assert_eq!(row / every, group, "one in {every}: {rows:?}");
                assert_eq!(row % 2, group % 2, "one in {every}: {rows:?}");
            }
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
