//! Dividing few triangles: they are sorted, and every cut is weighed.
//!
//! Anywhere, not only between full clusters: two that are not full but apart are often cheaper than one and a rest.
//!
//! A third of the time of building is spent here. So items stay where they are, in the nearest cache, and bytes are sorted that
//! say which; to sort is to count, for each, how many come before it, which vectors do without a branch; and all of it is one job in
//! those vectors. *A part* is here a row of such bytes.

use glam::{Mat4, Vec4};

use super::WIDTH;
use super::collapse::Tree;
use super::divide::{Around, INTEGERS, Item};
use crate::geometry::TriangleId;
use crate::geometry::lanes::{Available, Lanes, LanesJob};

/// So many at most.
pub(super) const FEW: usize = 128;

// Numbers of items, and how many there are, are bytes; a key has room for a number of seven bits and a place of eight.
const _: () = assert!(FEW <= 128);

/// Bits of a key: the place along the axis, and below it the number of the item, so that no two are alike. With a sign, sixteen
/// of them are one vector of AVX2; that leaves the place a 256th of the extent, or better.
const KEY_BITS: u32 = 15;

/// Adds the tree over [`FEW`] items or less, which stay where they are; their triangles are put into `sorted` so that those of a
/// cluster are in a row. `first` is the place of the first one among all.
pub(super) fn add(
    tree: &mut Tree,
    items: &[Item],
    sorted: &mut [TriangleId],
    first: u32,
    sweeps: &mut Sweeps,
    arithmetic: Available,
) {
    let Arranged { order, cuts } = arithmetic.run(Arrange { items, sweeps });
    let order = &order[..items.len()];
    for (id, &number) in sorted.iter_mut().zip(order) {
        *id = items[usize::from(number)].id();
    }
    add_part(tree, &mut cuts.into_iter(), items, order, first);
}

/// Adds the tree over a part, as the next cuts have it.
fn add_part(
    tree: &mut Tree,
    cuts: &mut impl Iterator<Item = u8>,
    items: &[Item],
    order: &[u8],
    first: u32,
) {
    match cuts.next() {
        Some(at @ 1..) => {
            let (left, right) = order.split_at(at.into());
            add_part(tree, cuts, items, left, first);
            let left = tree.last();
            add_part(tree, cuts, items, right, first + u32::from(at));
            tree.join(left);
        }
        _ => {
            let mut around = Around::NOTHING;
            for &number in order {
                around.join(&items[usize::from(number)].0);
            }
            tree.add_cluster(around.bounds(), first..first + order.len() as u32);
        }
    }
}

/// In which order items are, and where they are cut.
struct Arranged {
    order: [u8; FEW],
    /// Of each part, how many of its items are to the left; 0 where it is a cluster. A part comes before all that is to its
    /// left, and that before all that is to its right.
    cuts: [u8; 2 * FEW],
}

struct Arrange<'a> {
    items: &'a [Item],
    sweeps: &'a mut Sweeps,
}

impl LanesJob for Arrange<'_> {
    type Answer = Arranged;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Arranged {
        let Self { items, sweeps } = self;
        let (mut order, mut cuts) = ([0; FEW], [0; 2 * FEW]);
        for (number, place) in order.iter_mut().enumerate() {
            *place = number as u8;
        }
        // Where the parts end that are still to be cut, the next one last.
        let mut ends = [0; FEW];
        ends[0] = items.len() as u8;
        let (mut open, mut start, mut number) = (1, 0, 0);
        while open > 0 {
            let part = &mut order[start..usize::from(ends[open - 1])];
            if part.len() <= WIDTH {
                open -= 1;
                start += part.len();
            } else {
                let at = divide(items, part, sweeps);
                cuts[number] = at as u8;
                ends[open] = (start + at) as u8;
                open += 1;
            }
            number += 1;
        }
        Arranged { order, cuts }
    }
}

/// Sorts some items, more than a cluster has; after how many to cut them.
#[inline(always)]
fn divide(items: &[Item], order: &mut [u8], sweeps: &mut Sweeps) -> usize {
    if sort(items, order) { cheapest_cut(items, order, sweeps) } else { order.len() / 2 }
}

/// Sorts them along the longest axis of the box around their places; what is closer than a 255th of it stays in its order.
/// `false`, with all as it was, if that axis has no length, or one that is no number.
#[inline(always)]
fn sort(items: &[Item], order: &mut [u8]) -> bool {
    let mut places = Around::NOTHING;
    for &number in &*order {
        places.join_place(items[usize::from(number)].place());
    }
    let (axis, extent) = places.longest();
    let number_bits = (order.len() - 1).ilog2() + 1;
    let last = ((1 << (KEY_BITS - number_bits)) - 1) as f32;
    let (low, scale) = (places.low(axis), last / extent);
    if !scale.is_finite() {
        return false;
    }
    let (mut keys, mut unsorted) = ([i16::MAX; FEW], [0; FEW]);
    for number in 0..order.len() {
        unsorted[number] = order[number];
        let place = (items[usize::from(order[number])].place_along(axis) - low) * scale;
        let place = if place < last { place } else { last };
        let place = (place + INTEGERS).to_bits() as i16;
        keys[number] = place << number_bits | number as i16;
    }
    let mut before = [0; FEW];
    match order.len().div_ceil(TOGETHER) {
        1 => count_before::<1>(&keys, order.len(), &mut before),
        2 => count_before::<2>(&keys, order.len(), &mut before),
        _ => count_before::<4>(&keys, order.len(), &mut before),
    }
    for number in 0..order.len() {
        order[before[number] as usize] = unsorted[number];
    }
    true
}

/// After how many of those that are sorted.
#[inline(always)]
fn cheapest_cut(items: &[Item], order: &[u8], sweeps: &mut Sweeps) -> usize {
    let count = order.len();
    let Sweeps { left, right, costs } = sweeps;
    let (mut left_around, mut right_around) = (Around::NOTHING, Around::NOTHING);
    for number in 1..count {
        left_around.join(&items[usize::from(order[number - 1])].0);
        left[number] = left_around.extent();
        right_around.join(&items[usize::from(order[count - number])].0);
        right[count - number] = right_around.extent();
    }
    // No cut before the first, and none after the last; what `right` has there is of another part.
    left[0] = Vec4::INFINITY;
    left[count..count.next_multiple_of(AT_ONCE)].fill(Vec4::INFINITY);
    let (left_clusters, right_clusters) = (&CLUSTERS.0, &CLUSTERS.1[FEW - count..]);
    let mut least = Vec4::INFINITY;
    let costs = &mut costs[..count.div_ceil(AT_ONCE)];
    for (block, costs) in costs.iter_mut().enumerate() {
        let first = block * AT_ONCE;
        let left = half_areas(&left[first..]) * Vec4::from_slice(&left_clusters[first..]);
        let right = half_areas(&right[first..]) * Vec4::from_slice(&right_clusters[first..]);
        *costs = left + right;
        // Not `min`, which on some processors gives the one that is no number.
        least = Vec4::select(costs.cmplt(least), *costs, least);
    }
    let least = least.min_element();
    if least < f32::INFINITY {
        for (block, costs) in costs.iter().enumerate() {
            let found = costs.cmpeq(Vec4::splat(least)).bitmask();
            if found != 0 {
                return block * AT_ONCE + found.trailing_zeros() as usize;
            }
        }
    }
    // No cost is a number.
    count / 2
}

/// Cuts that are weighed at once.
const AT_ONCE: usize = 4;

/// Room for what cuts leave on either side, lent to each of many parts.
pub(super) struct Sweeps {
    /// The extents of boxes.
    left: [Vec4; FEW],
    right: [Vec4; FEW],
    costs: [Vec4; FEW / AT_ONCE],
}

impl Sweeps {
    pub const fn new() -> Self {
        Self {
            left: [Vec4::ZERO; FEW],
            right: [Vec4::ZERO; FEW],
            costs: [Vec4::ZERO; FEW / AT_ONCE],
        }
    }
}

/// Half of the surfaces of the first four boxes, of which these are the extents.
#[inline(always)]
fn half_areas(extents: &[Vec4]) -> Vec4 {
    let sides = Mat4::from_cols(extents[0], extents[1], extents[2], extents[3]).transpose();
    let [x, y, z] = [sides.x_axis, sides.y_axis, sides.z_axis];
    x * y + y * z + z * x
}

/// How many clusters so many triangles take; and as many as are left of [`FEW`] without so many. Beyond that 1, as nothing times an
/// infinite surface is no number.
static CLUSTERS: ([f32; FEW + AT_ONCE], [f32; FEW + AT_ONCE]) = {
    let (mut left, mut right) = ([1.0; FEW + AT_ONCE], [1.0; FEW + AT_ONCE]);
    let mut count = 1;
    while count <= FEW {
        left[count] = count.div_ceil(WIDTH) as f32;
        right[FEW - count] = left[count];
        count += 1;
    }
    (left, right)
};

/// Keys that are counted for at once at least: two vectors of AVX2, four of SSE2.
const TOGETHER: usize = 32;

/// For each of `count` keys, how many are less; for `BLOCKS` times 32 of them.
#[inline(always)]
fn count_before<const BLOCKS: usize>(keys: &[i16; FEW], count: usize, all_before: &mut [i16; FEW]) {
    let (blocks, _) = keys.as_chunks::<TOGETHER>();
    let mut before = [[0; TOGETHER]; BLOCKS];
    for other in &keys[..count] {
        // Only the last one can be the greatest, as its number has all bits set, and no key is less: nothing is left out. But without
        // a way out the compiler turns these loops inside out, which takes twice the time.
        if *other == i16::MAX {
            break;
        }
        for block in 0..BLOCKS {
            for lane in 0..TOGETHER {
                before[block][lane] += i16::from(*other < blocks[block][lane]);
            }
        }
    }
    all_before[..BLOCKS * TOGETHER].copy_from_slice(before.as_flattened());
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use proptest::prelude::*;

    use super::super::divide::items_at;
    use super::*;

    /// Cubes that begin here along the first axis.
    fn items(places: &[f32]) -> Vec<Item> {
        let item = |(id, &place): (usize, &f32)| {
            let low = Vec3A::new(place, 0.0, 0.0);
            Item::new([low, low, low + 1.0], id as u32)
        };
        places.iter().enumerate().map(item).collect()
    }

    /// The numbers of some items, as they are before they are sorted.
    fn in_order(items: &[Item]) -> Vec<u8> {
        (0..items.len() as u8).collect()
    }

    /// Whether each is on the right of the one before, or close to it.
    fn is_sorted(items: &[Item], order: &[u8]) -> bool {
        let place = |number: u8| items[usize::from(number)].place_along(0);
        let places = || order.iter().map(|&number| place(number));
        let extent = places().fold(f32::MIN, f32::max) - places().fold(f32::MAX, f32::min);
        order.windows(2).all(|pair| place(pair[0]) < place(pair[1]) + extent / 254.0)
    }

    proptest! {
        #[test]
        fn items_are_sorted_to_a_part_of_their_extent_and_none_is_lost(
            places in prop::collection::vec(-50.0f32..70.0, WIDTH + 1..=FEW),
        ) {
            let items = items(&places);
            let mut order = in_order(&items);
            prop_assert!(sort(&items, &mut order));
            prop_assert!(is_sorted(&items, &order));
            order.sort_unstable();
            prop_assert_eq!(order, in_order(&items));
        }

        #[test]
        fn every_arithmetic_makes_the_same_clusters_and_loses_nothing(
            places in prop::collection::vec(-50.0f32..70.0, 1..=FEW),
        ) {
            let items = items(&places);
            let arranged = |arithmetic: Available| {
                let arranged = arithmetic.run(Arrange { items: &items, sweeps: &mut Sweeps::new() });
                (arranged.order[..items.len()].to_vec(), arranged.cuts)
            };
            let all: Vec<_> = Available::all().map(arranged).collect();
            prop_assert!(all.iter().all(|other| *other == all[0]));
            let mut order = all[0].0.clone();
            order.sort_unstable();
            prop_assert_eq!(order, in_order(&items));

            let mut sorted = vec![TriangleId::MAX; items.len()];
            let mut tree = Tree::default();
            add(&mut tree, &items, &mut sorted, 0, &mut Sweeps::new(), Available::newest());
            let runs = tree.into_nodes().runs;
            prop_assert!(runs.iter().all(|run| (1..=WIDTH).contains(&run.len())));
            prop_assert_eq!(runs.iter().map(ExactSizeIterator::len).sum::<usize>(), items.len());
            sorted.sort_unstable();
            prop_assert!(sorted.into_iter().eq(0..items.len() as TriangleId));
        }
    }

    proptest! {
        #[test]
        fn no_cut_is_cheaper_than_the_one_that_is_found_and_none_before_it_is_as_cheap(
            corners in prop::collection::vec((0u8..40, 0u8..9, 0u8..5), WIDTH + 1..=FEW),
        ) {
            let items = items_at(&corners);
            let order = in_order(&items);
            let area = |items: &[Item]| {
                let mut around = Around::NOTHING;
                items.iter().for_each(|item| around.join(&item.0));
                around.half_area() * items.len().div_ceil(WIDTH) as f32
            };
            let cost = |at: usize| area(&items[..at]) + area(&items[at..]);
            let found = cheapest_cut(&items, &order, &mut Sweeps::new());
            prop_assert!((1..items.len()).contains(&found));
            prop_assert!((1..found).all(|at| cost(at) > cost(found)));
            prop_assert!((found..items.len()).all(|at| cost(at) >= cost(found)));
        }
    }

    #[test]
    fn where_no_cost_is_a_number_the_cut_is_in_the_middle() {
        let far = |n: u8| f32::from(n) * f32::MAX / 16.0;
        let item = |n: u8| Item::new([Vec3A::splat(-far(n)), Vec3A::splat(far(n)), Vec3A::ZERO], 0);
        let items: Vec<Item> = (3..16).map(item).collect();
        assert_eq!(cheapest_cut(&items, &in_order(&items), &mut Sweeps::new()), 6);
    }

    #[test]
    fn the_greatest_key_that_there_is_is_a_key_like_others() {
        // The last of as many as numbers have bits for, and also of one less.
        for count in [15u8, 16, 31, 32, 63, 64, 127, 128] {
            let rising: Vec<f32> = (0..count).map(f32::from).collect();
            let falling: Vec<f32> = rising.iter().rev().copied().collect();
            for places in [rising, falling] {
                let items = items(&places);
                let mut order = in_order(&items);
                assert!(sort(&items, &mut order) && is_sorted(&items, &order));
            }
        }
    }

    #[test]
    fn the_cut_is_where_boxes_are_apart() {
        // 24 and 16, which full clusters divide; and one less in the first heap.
        let far = |n: u8| f32::from(n % 5) + 100.0 * f32::from(u8::from(n % 5 > 2));
        for first in [0, 1] {
            let places: Vec<f32> = (first..40).map(far).collect();
            let items = items(&places);
            let mut order = in_order(&items);
            let at = divide(&items, &mut order, &mut Sweeps::new());
            assert_eq!(at, 24 - usize::from(first));
            assert!(order[..at].iter().all(|&number| places[usize::from(number)] < 100.0));
        }
    }

    #[test]
    fn items_in_one_place_are_halved() {
        let items = items(&[7.0; 80]);
        assert_eq!(divide(&items, &mut in_order(&items), &mut Sweeps::new()), 40);
    }
}
