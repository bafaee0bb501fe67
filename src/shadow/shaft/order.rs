//! Queries in the order of the directions in which their light sees them: along Hilbert's curve.
//!
//! What a mirror or a curved surface sees next lies all over the scene; sorted, neighbours in the order are
//! next to each other as the light sees them, and their shafts are thin. Two that are in line share all of the nearer one's way:
//! so it is directions that count (`view`), not places. The rectangle of all is halved along its longer side, the half likewise, and so
//! on: so a narrow one is cut into as many cells as a square, squares of them in a row. A curve goes through each square, and
//! ends where the next one begins. Queries in one cell keep their order.

use super::bundle::{OriginBox, PACKET};
use super::columns::{Columns, Row};
use super::source::Source;
use super::view::Perspective;
use crate::geometry::along_hilbert;
use crate::geometry::lanes::{Lanes, LanesJob, Sixteen};

/// So often is the rectangle of all halved at most, a bit of a key each: the counts of all cells stay in the nearest cache.
const MOST_BITS: u32 = 13;

/// Which queries, in which order; kept from one time to the next.
#[derive(Default)]
pub(super) struct Order {
    /// Packets whose queries are sorted.
    pub packets: Vec<u32>,
    /// Places in order.
    pub places: Vec<u32>,
    /// Directions of the queries of these packets, by axis.
    seen: Vec<[Row; 2]>,
    /// And their cells.
    cells: Vec<[u16; PACKET]>,
    /// Of each cell, how many queries it has; then, where the next one goes.
    counts: Vec<u32>,
}

/// Sorts the queries of packets by where their light sees them; those that are not asked are left out.
pub(super) struct SortByDirection<'a> {
    pub order: &'a mut Order,
    pub columns: &'a Columns,
    pub source: &'a Source,
}

impl LanesJob for SortByDirection<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Order { packets, places, seen, cells, counts } = self.order;
        let Columns { origins, asked, boxes } = self.columns;
        let mut all = OriginBox::EMPTY;
        for &packet in &*packets {
            all = all.union(boxes[packet as usize]);
        }
        let perspective = Perspective::new(self.source, &all);
        seen.resize(packets.len(), [Row::ZERO; 2]);
        let (mut low, mut high) =
            ([L::Sixteen::splat(f32::INFINITY); 2], [L::Sixteen::splat(f32::NEG_INFINITY); 2]);
        for (seen, &packet) in seen.iter_mut().zip(&*packets) {
            let directions = perspective.unfold::<L::Sixteen>(&origins[packet as usize]);
            for (side, values) in directions.into_iter().enumerate() {
                if asked[packet as usize] != 0 {
                    (low[side], high[side]) = (low[side].min(values), high[side].max(values));
                }
                values.store(&mut seen[side].0);
            }
        }
        let low = [low[0].least(), low[1].least()];
        let high = [high[0].greatest(), high[1].greatest()];
        // About as many cells as queries: with more, clearing and adding up their counts would take longer than sorting.
        let bits = (packets.len() * PACKET).ilog2().min(MOST_BITS);
        let curve = Curve::through(low, high, bits);
        cells.resize(packets.len(), [0; PACKET]);
        counts.clear();
        counts.resize(1 << bits, 0);
        let last = (1 << bits) - 1;
        let mut count = 0;
        for ((cells, &packet), seen) in cells.iter_mut().zip(&*packets).zip(&*seen) {
            *cells = curve.cells(seen);
            each(asked[packet as usize], |lane| counts[usize::from(cells[lane]) & last] += 1);
            count += asked[packet as usize].count_ones() as usize;
        }
        let mut sum = 0;
        for count in counts.iter_mut() {
            sum += std::mem::replace(count, sum);
        }
        places.resize(count, 0);
        for (cells, &packet) in cells.iter().zip(&*packets) {
            each(asked[packet as usize], |lane| {
                let next = &mut counts[usize::from(cells[lane]) & last];
                places[*next as usize] = packet * PACKET as u32 + lane as u32;
                *next += 1;
            });
        }
    }
}

/// Does something for each bit.
#[inline(always)]
fn each(bits: u16, mut act: impl FnMut(usize)) {
    if bits == u16::MAX {
        (0..PACKET).for_each(act);
        return;
    }
    let mut left = bits;
    while left != 0 {
        act(left.trailing_zeros() as usize);
        left &= left - 1;
    }
}

/// How a rectangle is cut into cells, and in which order they come.
struct Curve {
    low: [f32; 2],
    /// Cells for a unit of way, by axis.
    scale: [f32; 2],
    /// Halvings of each axis. Those of the longer one that the other has not make squares in a row.
    halvings: [u32; 2],
}

impl Curve {
    fn through(low: [f32; 2], high: [f32; 2], bits: u32) -> Self {
        let mut size = [high[0] - low[0], high[1] - low[1]];
        let mut halvings = [0; 2];
        for _ in 0..bits {
            let longer = usize::from(size[1] > size[0]);
            size[longer] *= 0.5;
            halvings[longer] += 1;
        }
        let mut scale = [0.0; 2];
        for axis in 0..2 {
            let extent = high[axis] - low[axis];
            let cells = (1 << halvings[axis]) as f32;
            scale[axis] = if extent > 0.0 { cells / extent } else { 0.0 };
        }
        Self { low, scale, halvings }
    }

    /// The cells of a packet.
    #[inline(always)]
    fn cells(&self, seen: &[Row; 2]) -> [u16; PACKET] {
        let mut places = [[0u32; PACKET]; 2];
        for (axis, places) in places.iter_mut().enumerate() {
            let last = ((1 << self.halvings[axis]) - 1) as f32;
            for (place, coordinate) in places.iter_mut().zip(seen[axis].0) {
                let whole = (coordinate - self.low[axis]) * self.scale[axis];
                let whole = if whole < last { whole } else { last };
                *place = (whole + WHOLE).to_bits() & ((1 << MOST_BITS) - 1);
            }
        }
        let longer = usize::from(self.halvings[1] > self.halvings[0]);
        let both = self.halvings[1 - longer];
        // Squares in a row, and the curve through each.
        let (mut squares, mut within) = (places[longer], places[longer]);
        for lane in 0..PACKET {
            squares[lane] = squares[lane] >> both << (2 * both);
            within[lane] &= (1 << both) - 1;
        }
        let within = along_hilbert(within, places[1 - longer], both);
        let mut cells = [0; PACKET];
        for lane in 0..PACKET {
            cells[lane] = (squares[lane] | within[lane]) as u16;
        }
        cells
    }
}

/// Added to a number below 2²³ it leaves the number, rounded, in the lowest bits of the sum.
const WHOLE: f32 = (1 << 23) as f32;

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::columns::Read;
    use super::*;
    use crate::geometry::Ray;
    use crate::geometry::lanes::Available;
    use crate::shadow::{Path, ShadowQuery};

    const LIGHT: Vec3 = Vec3::new(1.0, 2.0, 50.0);

    fn queries(origins: impl Iterator<Item = Vec3>) -> Vec<ShadowQuery> {
        let query =
            |origin| ShadowQuery { ray: Ray::between(origin, LIGHT), path: Path::EYE, spawner: 0 };
        origins.map(query).collect()
    }

    const SOURCE: Source = Source::Point(LIGHT);

    /// The places of queries in order, all packets sorted.
    fn sorted(arithmetic: Available, queries: &[ShadowQuery]) -> Vec<u32> {
        let mut columns = Columns::default();
        arithmetic.run(Read { columns: &mut columns, source: &SOURCE, queries });
        let packets = (0..columns.asked.len() as u32).collect();
        let mut order = Order { packets, ..Order::default() };
        arithmetic.run(SortByDirection { order: &mut order, columns: &columns, source: &SOURCE });
        order.places
    }

    #[test]
    fn the_longer_side_is_halved_first_and_narrow_rectangles_are_cut_as_often() {
        let curve = Curve::through([0.0, 0.0], [2.0, 9.0], MOST_BITS);
        assert_eq!(curve.halvings, [5, 8]);
        let mut seen = [Row::ZERO; 2];
        for (lane, [x, y]) in
            [[0.9, 0.2], [0.1, 1.2], [0.1, 4.4], [0.0, 9.0]].into_iter().enumerate()
        {
            (seen[0].0[lane], seen[1].0[lane]) = (x, y);
        }
        let cells = curve.cells(&seen);
        assert!(cells[0] < cells[1] && cells[1] < cells[2] && cells[2] < cells[3], "{cells:?}");
        assert_eq!(cells[3], (1 << MOST_BITS) - 1);
        let line = Curve::through([0.0, 1.0], [0.5, 1.0], MOST_BITS);
        assert_eq!(line.halvings, [MOST_BITS, 0], "nothing to halve");
    }

    #[test]
    fn sorted_places_are_all_there_and_neighbours_in_order_are_neighbours_to_the_light() {
        // 16 by 16 places in each of 4 planes, in an order that jumps.
        let origin = |place: u32| {
            let number = place * 77 % 1024;
            Vec3::new((number % 16) as f32, (number / 16 % 16) as f32, -((number / 256) as f32))
        };
        let queries = queries((0..1000).map(origin));
        for arithmetic in Available::all() {
            let places = sorted(arithmetic, &queries);
            let mut all = places.clone();
            all.sort_unstable();
            assert_eq!(all, (0..1000).collect::<Vec<u32>>());
            let seen = |place: u32| {
                let away = origin(place) - LIGHT;
                away / away.z.abs()
            };
            let apart = |pair: &[u32]| seen(pair[0]).distance(seen(pair[1]));
            let mean = places.windows(2).map(apart).sum::<f32>() / 999.0;
            // Places are 1/50 apart, four in line. Along Morton's curve it is 0.0146, in the old order twenty times as much.
            assert!(mean < 0.013, "{arithmetic:?}: {mean}");
        }
    }

    #[test]
    fn queries_that_are_not_to_the_light_are_left_out() {
        let mut queries = queries((0..100).map(|place| Vec3::splat((place * 37 % 100) as f32)));
        for place in [0, 15, 16, 50, 99] {
            queries[place].ray.direction.y += 1.0;
        }
        queries[70].ray.origin.x = f32::NAN;
        for arithmetic in Available::all() {
            let mut places = sorted(arithmetic, &queries);
            places.sort_unstable();
            let expected = |place: &u32| ![0, 15, 16, 50, 70, 99].contains(place);
            assert_eq!(places, (0..100).filter(expected).collect::<Vec<u32>>());
        }
    }

    #[test]
    fn queries_that_all_start_in_one_point_keep_their_order() {
        let queries = queries(std::iter::repeat_n(Vec3::ONE, 40));
        for arithmetic in Available::all() {
            assert_eq!(sorted(arithmetic, &queries), (0..40).collect::<Vec<u32>>());
        }
    }
}
