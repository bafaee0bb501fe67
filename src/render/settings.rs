//! What to render.

use super::order::Place;
use super::{Order, Shown};
use crate::shadow::Path;

/// Pixels in a picture at most: 16,384 squared, 3 GiB of film.
const MOST_PIXELS: u64 = 1 << 28;

/// Samples along each side of a pixel at most.
pub const MOST_SAMPLES: u32 = 64;

/// Size, samples, depth and order of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples along each side of a pixel: `n` gives n×n samples.
    pub samples: u32,
    /// Reflections and refractions that a ray may go through.
    pub depth: u8,
    /// The order in which pixels are rendered.
    pub order: Order,
    /// Rows of a unit of work in scanline orders; memories are fresh in each.
    pub rows_per_unit: u32,
    /// Whether to keep the shadow mask.
    pub mask: bool,
    /// Whether to keep how shadow queries were answered, and of which light.
    pub answers: Option<Shown>,
    /// Whether to keep every shadow query.
    pub record: bool,
}

impl Default for Settings {
    /// The paper's picture, with one sample.
    fn default() -> Self {
        Self {
            width: 640,
            height: 486,
            samples: 1,
            depth: 5,
            order: Order::Tiles,
            rows_per_unit: 8,
            mask: false,
            answers: None,
            record: false,
        }
    }
}

/// Why the settings make no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// Nothing to see, or more than fits.
    #[error(
        "size {width}x{height}: width and height must be at least 1, and the picture at most {MOST_PIXELS} pixels"
    )]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// None, or too many.
    #[error("samples {0}: give 1 to {MOST_SAMPLES}, the samples along each side of a pixel")]
    Samples(u32),
    /// More than the path table holds.
    #[error("depth {0}: the table of a ray's path holds {max} reflections and refractions; give 0 to {max}", max = Path::MAX_LEVEL)]
    Depth(u8),
    /// The light whose answers are to be kept is not there.
    #[error(
        "answers of light {light}: the scene has {lights} lights, counted from 0; name one of these, or none"
    )]
    Light {
        /// Its index.
        light: u32,
        /// How many there are.
        lights: usize,
    },
    /// Units without rows.
    #[error("a band of scanlines needs at least one row")]
    Rows,
}

impl Settings {
    /// The pixels of each unit of work, before dear ones are cut.
    #[must_use]
    pub(super) fn units(&self) -> Vec<Vec<Place>> {
        self.order.units([self.width, self.height], self.rows_per_unit, self.samples)
    }

    /// Whether these settings make a picture of some scene; [`render`](super::render()) also looks whether the scene has the light
    /// whose answers are to be kept.
    ///
    /// # Errors
    /// If one of them does not: says which, and what would.
    pub fn check(&self) -> Result<(), SettingsError> {
        let Self { width, height, .. } = *self;
        if width == 0 || height == 0 || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(SettingsError::Size { width, height });
        }
        if !(1..=MOST_SAMPLES).contains(&self.samples) {
            return Err(SettingsError::Samples(self.samples));
        }
        if self.depth > Path::MAX_LEVEL {
            return Err(SettingsError::Depth(self.depth));
        }
        if self.rows_per_unit == 0 {
            return Err(SettingsError::Rows);
        }
        Ok(())
    }

    /// The same of a scene with so many lights.
    pub(super) fn check_for(&self, lights: usize) -> Result<(), SettingsError> {
        self.check()?;
        match self.answers.and_then(|shown| shown.light) {
            Some(light) if light as usize >= lights => Err(SettingsError::Light { light, lights }),
            _ => Ok(()),
        }
    }
}
