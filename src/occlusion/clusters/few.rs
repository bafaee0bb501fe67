//! Dividing few triangles: they are sorted, and every cut is weighed.
//!
//! Anywhere, not only between full clusters: two that are not full but apart are often cheaper than one and a rest.
//!
//! To sort so few is to count, for each, how many come before it, which vectors do without a branch.

use super::divide::{Around, Divided, Heap, Item, places_of};
use crate::geometry::lanes::{Available, Lanes, LanesJob};

/// So many at most.
pub(super) const FEW: usize = 128;

/// Bits of a key: the place along the axis, and below it the number of the item, so that no two are alike. With a sign, sixteen
/// of them are one vector of AVX2; that leaves the place a 256th of the extent, or better.
const KEY_BITS: u32 = 15;

/// Divides [`FEW`] items or less, but more than a cluster has.
pub(super) fn divide(items: &mut [Item], places: &Around, arithmetic: Available) -> Divided {
    let sorted = sort(items, places, arithmetic);
    let best = if sorted { cheapest_cut(items) } else { None };
    let at = best.unwrap_or(items.len() / 2);
    let (left, right) = items.split_at(at);
    Divided { at, sides: [places_of(left), places_of(right)] }
}

/// Sorts them along the longest axis of the box around their places, but for those that are very close; whether there is one.
fn sort(items: &mut [Item], places: &Around, arithmetic: Available) -> bool {
    let (axis, extent) = places.longest();
    let number_bits = (items.len() - 1).ilog2() + 1;
    let last = (1 << (KEY_BITS - number_bits)) - 1;
    let (low, scale) = (places.low(axis), f32::from(last) / extent);
    if !scale.is_finite() {
        return false;
    }
    let mut keys = [i16::MAX; FEW];
    for (number, item) in items.iter().enumerate() {
        let place = (((item.place()[axis] - low) * scale) as i16).min(last);
        keys[number] = place << number_bits | number as i16;
    }
    let mut before = [0; FEW];
    arithmetic.run(CountBefore { keys: &keys, count: items.len(), before: &mut before });
    let mut unsorted = [Item(Around::NOTHING); FEW];
    let unsorted = &mut unsorted[..items.len()];
    unsorted.copy_from_slice(items);
    for (item, &before) in unsorted.iter().zip(&before) {
        items[before as usize] = *item;
    }
    true
}

/// After how many items; `None` if no cost is a number.
fn cheapest_cut(items: &[Item]) -> Option<usize> {
    let mut right = [0.0; FEW];
    let mut heap = Heap::EMPTY;
    for (number, item) in items.iter().enumerate().skip(1).rev() {
        heap.add(item);
        right[number] = heap.cost();
    }
    let (mut best, mut least) = (None, f32::INFINITY);
    let mut heap = Heap::EMPTY;
    for number in 1..items.len() {
        heap.add(&items[number - 1]);
        let cost = heap.cost() + right[number];
        if cost < least {
            (best, least) = (Some(number), cost);
        }
    }
    best
}

/// For each of `count` keys, how many are less.
struct CountBefore<'a> {
    keys: &'a [i16; FEW],
    count: usize,
    before: &'a mut [i16; FEW],
}

impl LanesJob for CountBefore<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        /// Keys that are counted for at once: two vectors of AVX2, four of SSE2.
        const TOGETHER: usize = 32;
        for first in (0..self.count).step_by(TOGETHER) {
            let keys: &[i16; TOGETHER] = self.keys[first..first + TOGETHER].try_into().unwrap();
            let mut before = [0; TOGETHER];
            for other in &self.keys[..self.count] {
                for lane in 0..TOGETHER {
                    before[lane] += i16::from(*other < keys[lane]);
                }
            }
            self.before[first..first + TOGETHER].copy_from_slice(&before);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use proptest::prelude::*;

    use super::super::WIDTH;
    use super::*;

    /// Cubes that begin here along the first axis.
    fn items(places: &[f32]) -> Vec<Item> {
        let item = |(id, &place): (usize, &f32)| {
            let low = Vec3A::new(place, 0.0, 0.0);
            Item::new([low, low, low + 1.0], id as u32)
        };
        places.iter().enumerate().map(item).collect()
    }

    proptest! {
        #[test]
        fn items_are_sorted_to_a_part_of_their_extent_and_none_is_lost(
            places in prop::collection::vec(-50.0f32..70.0, WIDTH + 1..=FEW),
        ) {
            for arithmetic in Available::all() {
                let mut items = items(&places);
                let around = places_of(&items);
                prop_assert!(sort(&mut items, &around, arithmetic));
                let close = around.longest().1 / 254.0;
                for pair in items.windows(2) {
                    prop_assert!(pair[0].place().x < pair[1].place().x + close);
                }
                let mut ids: Vec<u32> = items.iter().map(Item::id).collect();
                ids.sort_unstable();
                prop_assert_eq!(ids, (0..places.len() as u32).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn the_cut_is_where_boxes_are_apart() {
        // 24 and 16, which full clusters divide; and one less in the first heap.
        let far = |n: u8| f32::from(n % 5) + 100.0 * f32::from(u8::from(n % 5 > 2));
        for first in [0, 1] {
            let places: Vec<f32> = (first..40).map(far).collect();
            let mut items = items(&places);
            let around = places_of(&items);
            let Divided { at, sides } = divide(&mut items, &around, Available::newest());
            assert_eq!(at, 24 - usize::from(first));
            assert_eq!(sides.map(|side| side.longest().1), [4.0, 2.0]);
        }
    }

    #[test]
    fn items_in_one_place_are_halved() {
        let mut items = items(&[7.0; 80]);
        let around = places_of(&items);
        assert_eq!(divide(&mut items, &around, Available::newest()).at, 40);
    }
}
