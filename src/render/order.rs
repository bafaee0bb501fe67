//! The order in which pixels are rendered, and how it is cut into units of work.

/// Pixels along the side of a tile.
const TILE: u32 = 16;

/// The order in which pixels are rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Order {
    /// Row by row, each from left to right.
    Scanline,
    /// Row by row, every second one from right to left (§8 of the paper).
    Serpentine,
    /// Tiles of 16×16 pixels in Morton order, and so the pixels within.
    #[default]
    Tiles,
}

/// A pixel: column and row.
pub type Place = (u32, u32);

impl Order {
    /// Whether the queries of a whole unit may be asked together, light by light. The scanline orders
    /// are the paper's: there one sample is finished before the next begins.
    #[must_use]
    pub fn batches(self) -> bool {
        self == Self::Tiles
    }

    /// The pixels of each unit, in the order in which they are rendered.
    #[must_use]
    pub fn units(self, width: u32, height: u32, rows_per_unit: u32) -> Vec<Vec<Place>> {
        match self {
            Self::Scanline | Self::Serpentine => (0..height)
                .step_by(rows_per_unit as usize)
                .map(|first| {
                    let rows = first..height.min(first.saturating_add(rows_per_unit));
                    rows.flat_map(|y| self.row(y, width)).collect()
                })
                .collect(),
            Self::Tiles => tiles(width, height),
        }
    }

    fn row(self, y: u32, width: u32) -> impl Iterator<Item = Place> {
        let backward = self == Self::Serpentine && y % 2 == 1;
        (0..width).map(move |x| (if backward { width - 1 - x } else { x }, y))
    }
}

fn tiles(width: u32, height: u32) -> Vec<Vec<Place>> {
    let (across, down) = (width.div_ceil(TILE), height.div_ceil(TILE));
    let mut corners: Vec<Place> =
        (0..down).flat_map(|y| (0..across).map(move |x| (x, y))).collect();
    corners.sort_by_key(|&(x, y)| morton(x, y));
    let within: Vec<Place> = {
        let mut places: Vec<Place> =
            (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))).collect();
        places.sort_by_key(|&(x, y)| morton(x, y));
        places
    };
    corners
        .into_iter()
        .map(|(tile_x, tile_y)| {
            let places = within.iter().map(|&(x, y)| (tile_x * TILE + x, tile_y * TILE + y));
            places.filter(|&(x, y)| x < width && y < height).collect()
        })
        .collect()
}

/// The bits of x and y interleaved: places near each other on the Z-order curve are near each other.
fn morton(x: u32, y: u32) -> u64 {
    let spread = |v: u32| {
        let mut v = u64::from(v);
        for (shift, mask) in [
            (16, 0x0000_ffff_0000_ffff),
            (8, 0x00ff_00ff_00ff_00ff),
            (4, 0x0f0f_0f0f_0f0f_0f0f),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555),
        ] {
            v = (v | v << shift) & mask;
        }
        v
    };
    spread(x) | spread(y) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_renders_every_pixel_once() {
        for order in [Order::Scanline, Order::Serpentine, Order::Tiles] {
            for (width, height) in [(1, 1), (17, 33), (100, 3), (16, 16)] {
                let mut places: Vec<Place> = order.units(width, height, 8).concat();
                places.sort_unstable();
                let all: Vec<Place> =
                    (0..width).flat_map(|x| (0..height).map(move |y| (x, y))).collect();
                assert_eq!(places, all, "{order:?} {width}x{height}");
            }
        }
    }

    #[test]
    fn serpentine_rows_meet_end_to_end() {
        let places = Order::Serpentine.units(5, 4, 4).concat();
        assert!(places.windows(2).all(|pair| pair[0].0.abs_diff(pair[1].0) <= 1));
    }
}
