//! Queries in the order of where they start: along a Morton curve.
//!
//! What a mirror or a curved surface sees next lies all over the scene; sorted, neighbours in the order are
//! neighbours in space again, and shafts are thin. Queries that start in one cell keep their order.
//!
//! Morton: A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing. IBM, 1966.

use glam::Vec3;

use crate::shadow::ShadowQuery;

/// Bits of a cell's place by axis: 32 cells along the longest side of what is sorted.
const BITS: u32 = 5;

/// Bits that are sorted by at once: half of a key.
const DIGIT: u32 = (3 * BITS).div_ceil(2);

/// Which queries, in which order; kept from one time to the next.
#[derive(Default)]
pub(super) struct Order {
    pub places: Vec<u32>,
    /// A key, and the place of its query.
    keyed: [Vec<(u32, u32)>; 2],
}

impl Order {
    /// Sorts by where queries start.
    pub fn by_place(&mut self, queries: &[ShadowQuery]) {
        let Self { places, keyed: [keyed, other] } = self;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &place in &*places {
            let origin = queries[place as usize].ray.origin;
            low = low.min(origin);
            high = high.max(origin);
        }
        let scale = (1 << BITS) as f32 / (high - low).max_element();
        keyed.clear();
        for &place in &*places {
            // Conversions saturate, and NaN is 0: any order is a good one.
            let cell = (queries[place as usize].ray.origin - low) * scale;
            let [x, y, z] = cell.to_array().map(|cell| (cell as u32).min((1 << BITS) - 1));
            keyed.push((spread(x) | spread(y) << 1 | spread(z) << 2, place));
        }
        other.resize(keyed.len(), (0, 0));
        sort_by_digit(keyed, other, 0);
        sort_by_digit(other, keyed, DIGIT);
        for (place, keyed) in places.iter_mut().zip(keyed) {
            *place = keyed.1;
        }
    }
}

/// Bit `i` to bit `3 i`.
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 8) & 0x0000_f00f;
    let bits = (bits | bits << 4) & 0x000c_30c3;
    (bits | bits << 2) & 0x0024_9249
}

/// Sorts by one digit of the keys; what is equal keeps its order.
fn sort_by_digit(from: &[(u32, u32)], to: &mut [(u32, u32)], shift: u32) {
    const DIGITS: usize = 1 << DIGIT;
    let digit = |key: u32| (key >> shift) as usize % DIGITS;
    let mut next = [0u32; DIGITS];
    for &(key, _) in from {
        next[digit(key)] += 1;
    }
    let mut sum = 0;
    for next in &mut next {
        sum += std::mem::replace(next, sum);
    }
    for &keyed in from {
        let next = &mut next[digit(keyed.0)];
        to[*next as usize] = keyed;
        *next += 1;
    }
}
