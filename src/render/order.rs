//! The order in which pixels are rendered, and how it is cut into units of work.

use std::fmt;
use std::str::FromStr;

use crate::geometry::along_hilbert;
use crate::occlusion::{UnknownName, named};

/// Pixels along the side of the smallest and the largest tiles.
const SIDES: [u32; 2] = [8, 64];

/// A tile has at most so many samples: shadow queries to one light are answered together, and what a tile asks
/// should stay in the cache of a core.
const MOST_SAMPLES: u32 = 10_000;

/// Tiles are made smaller, down to 16 pixels, until there are so many: threads share them.
const ENOUGH: u32 = 64;

/// The order in which pixels are rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// Row by row, each from left to right.
    Scanline,
    /// Row by row, every second one from right to left (§8 of the paper).
    Serpentine,
    /// Square tiles of some thousand samples along a Hilbert curve, and so the pixels within.
    #[default]
    Tiles,
}

/// A pixel: column and row.
pub type Place = (u32, u32);

impl Order {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Scanline, Self::Serpentine, Self::Tiles];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scanline => "scanline",
            Self::Serpentine => "serpentine",
            Self::Tiles => "tiles",
        }
    }

    /// Whether the queries of a whole unit may be asked together, light by light. The scanline orders
    /// are the paper's: there one sample is finished before the next begins.
    #[must_use]
    pub fn batches(self) -> bool {
        self == Self::Tiles
    }

    /// The pixels of each unit before dear ones are cut, in the order in which they are rendered; `samples` of them along a pixel's side.
    ///
    /// # Panics
    /// If a unit of a scanline order has no rows.
    #[must_use]
    pub fn units(
        self,
        [width, height]: [u32; 2],
        rows_per_unit: u32,
        samples: u32,
    ) -> Vec<Vec<Place>> {
        match self {
            Self::Scanline | Self::Serpentine => (0..height)
                .step_by(rows_per_unit as usize)
                .map(|first| {
                    let rows = first..height.min(first.saturating_add(rows_per_unit));
                    rows.flat_map(|y| self.row(y, width)).collect()
                })
                .collect(),
            Self::Tiles => tiles(width, height, side_of_tiles(width, height, samples)),
        }
    }

    fn row(self, y: u32, width: u32) -> impl Iterator<Item = Place> {
        let backward = self == Self::Serpentine && y % 2 == 1;
        (0..width).map(move |x| (if backward { width - 1 - x } else { x }, y))
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Order {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        named("order", name, &Self::ALL)
    }
}

/// Pixels along the side of a tile: a power of two.
fn side_of_tiles(width: u32, height: u32, samples: u32) -> u32 {
    let [least, mut side] = SIDES;
    let a_pixel = samples.saturating_mul(samples);
    while side > least && (side * side).saturating_mul(a_pixel) > MOST_SAMPLES {
        side /= 2;
    }
    while side > 16 && width.div_ceil(side).saturating_mul(height.div_ceil(side)) < ENOUGH {
        side /= 2;
    }
    side
}

fn tiles(width: u32, height: u32, side: u32) -> Vec<Vec<Place>> {
    let (across, down) = (width.div_ceil(side), height.div_ceil(side));
    let mut corners: Vec<Place> =
        (0..down).flat_map(|y| (0..across).map(move |x| (x, y))).collect();
    let levels = across.max(down).next_power_of_two().ilog2();
    corners.sort_by_key(|&(x, y)| along_hilbert([x], [y], levels));
    let within: Vec<Place> = {
        let mut places: Vec<Place> =
            (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).collect();
        places.sort_by_key(|&(x, y)| along_hilbert([x], [y], side.ilog2()));
        places
    };
    corners
        .into_iter()
        .map(|(tile_x, tile_y)| {
            let places = within.iter().map(|&(x, y)| (tile_x * side + x, tile_y * side + y));
            places.filter(|&(x, y)| x < width && y < height).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_renders_every_pixel_once() {
        for order in Order::ALL {
            for (width, height) in [(1, 1), (17, 33), (100, 3), (16, 16)] {
                let mut places: Vec<Place> = order.units([width, height], 8, 2).concat();
                places.sort_unstable();
                let all: Vec<Place> =
                    (0..width).flat_map(|x| (0..height).map(move |y| (x, y))).collect();
                assert_eq!(places, all, "{order:?} {width}x{height}");
            }
        }
    }

    #[test]
    fn a_pixel_of_a_whole_tile_lies_beside_the_one_before_it() {
        for unit in Order::Tiles.units([64, 128], 8, 3) {
            let step =
                |pair: &[Place]| pair[0].0.abs_diff(pair[1].0) + pair[0].1.abs_diff(pair[1].1);
            assert!(unit.len() > 1 && unit.windows(2).all(|pair| step(pair) == 1));
        }
    }

    #[test]
    fn tiles_hold_some_thousand_samples_of_large_pictures_and_are_many_in_small_ones() {
        for (samples, side) in [(1, 64), (2, 32), (3, 32), (4, 16), (8, 8), (u32::MAX, 8)] {
            assert_eq!(side_of_tiles(640, 486, samples), side, "{samples}");
        }
        assert_eq!(side_of_tiles(160, 120, 1), 16);
        assert_eq!(side_of_tiles(1, 1, 1), 16);
    }

    #[test]
    fn serpentine_rows_meet_end_to_end() {
        let places = Order::Serpentine.units([5, 4], 4, 1).concat();
        assert!(places.windows(2).all(|pair| pair[0].0.abs_diff(pair[1].0) <= 1));
    }
}
