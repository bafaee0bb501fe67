//! Queries in the order of where they start: along a Morton curve.
//!
//! What a mirror or a curved surface sees next lies all over the scene; sorted, neighbours in the order are
//! neighbours in space again, and shafts are thin. Queries that start in one cell keep their order.
//!
//! Morton: A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing. IBM, 1966.

use glam::Vec3;

use super::bundle::PACKET;
use crate::geometry::lanes::{Lanes, LanesJob};
use crate::shadow::ShadowQuery;

/// Bits of a cell's place by axis: 32 cells along the longest side of what is sorted.
const BITS: u32 = 5;

/// Bits that are sorted by at once: half of a key.
const DIGIT: u32 = (3 * BITS).div_ceil(2);

/// Digits that there are.
const DIGITS: usize = 1 << DIGIT;

/// Of the queries of a packet, and of all that are sorted, one in so many is looked at to find how far apart they are.
const LOOKED_AT: usize = 5;

/// Whether packets of these queries are on average larger than this.
pub(super) fn are_apart(queries: &[ShadowQuery], size: f32) -> bool {
    let (mut sum, mut count) = (0.0, 0.0);
    for packet in queries.chunks(PACKET) {
        let (mut low, mut high) = (packet[0].ray.origin, packet[0].ray.origin);
        let mut place = LOOKED_AT;
        while place < packet.len() {
            low = low.min(packet[place].ray.origin);
            high = high.max(packet[place].ray.origin);
            place += LOOKED_AT;
        }
        sum += (high - low).max_element();
        count += 1.0;
    }
    sum > size * count
}

/// Which queries, in which order; kept from one time to the next.
#[derive(Default)]
pub(super) struct Order {
    pub places: Vec<u32>,
    /// Keys with places: by places, then half sorted.
    keyed: Vec<u64>,
    halfway: Vec<u64>,
}

/// Sorts places by where their queries start.
pub(super) struct SortByPlace<'a> {
    pub order: &'a mut Order,
    pub queries: &'a [ShadowQuery],
}

impl LanesJob for SortByPlace<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Order { places, keyed, halfway } = self.order;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut looked_at = 0;
        while looked_at < places.len() {
            let origin = self.queries[places[looked_at] as usize].ray.origin;
            (low, high) = (low.min(origin), high.max(origin));
            looked_at += LOOKED_AT;
        }
        let longest = (high - low).max_element();
        let cells = (1 << BITS) as f32;
        let scale = if longest > 0.0 { cells / longest } else { 0.0 };
        let mut counts = [[0u32; DIGITS]; 2];
        keyed.resize(places.len(), 0);
        halfway.resize(places.len(), 0);
        for (keyed, &place) in keyed.iter_mut().zip(&*places) {
            let origin = self.queries[place as usize].ray.origin;
            let mut key = 0;
            for axis in 0..3 {
                // The conversion saturates, and NaN is 0: what lies outside belongs to a cell at the side.
                let cell = ((origin[axis] - low[axis]) * scale).min(cells - 1.0) as u32;
                key |= spread(cell) << axis;
            }
            counts[0][key as usize % DIGITS] += 1;
            counts[1][key as usize / DIGITS] += 1;
            *keyed = u64::from(key) << 32 | u64::from(place);
        }
        for counts in &mut counts {
            let mut sum = 0;
            for count in counts {
                sum += std::mem::replace(count, sum);
            }
        }
        for &keyed in &*keyed {
            let next = &mut counts[0][(keyed >> 32) as usize % DIGITS];
            halfway[*next as usize] = keyed;
            *next += 1;
        }
        for &keyed in &*halfway {
            let next = &mut counts[1][(keyed >> 32) as usize / DIGITS];
            places[*next as usize] = keyed as u32;
            *next += 1;
        }
    }
}

/// Bit `i` to bit `3 i`, of five bits.
#[inline(always)]
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 8) & 0x0000_100f;
    let bits = (bits | bits << 4) & 0x0000_10c3;
    (bits | bits << 2) & 0x0000_1249
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::geometry::Ray;
    use crate::geometry::lanes::Arithmetic;
    use crate::shadow::Path;

    #[test]
    fn five_bits_are_spread_apart() {
        for bits in 0..32u32 {
            let expected = (0..5).fold(0, |sum, bit| sum | (bits >> bit & 1) << (3 * bit));
            assert_eq!(spread(bits), expected, "{bits:05b}");
        }
    }

    #[test]
    fn sorted_places_are_all_there_along_the_curve_and_keep_their_order_within_a_cell() {
        let origin = |place: u32| {
            let part = |prime: u32| (place * prime % 4) as f32;
            8.0 * Vec3::new(part(7), part(5), part(3)) - 3.0
        };
        let query = |place| ShadowQuery {
            ray: Ray::towards(origin(place), Vec3::X),
            path: Path::EYE,
            spawner: 0,
        };
        let queries: Vec<ShadowQuery> = (0..1000).map(query).collect();
        for arithmetic in Arithmetic::ALL.into_iter().filter(|a| a.is_available()) {
            let mut order = Order { places: (0..1000).rev().collect(), ..Order::default() };
            arithmetic.run(SortByPlace { order: &mut order, queries: &queries });
            let mut all = order.places.clone();
            all.sort_unstable();
            assert_eq!(all, (0..1000).collect::<Vec<u32>>());
            let key = |place: u32| {
                let cell = ((origin(place) + 3.0) / 24.0 * 32.0).as_uvec3().min(UVec3::splat(31));
                spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
            };
            for pair in order.places.windows(2) {
                let (a, b) = (key(pair[0]), key(pair[1]));
                assert!(a < b || (a == b && pair[0] > pair[1]), "{pair:?}");
            }
        }
    }
}
