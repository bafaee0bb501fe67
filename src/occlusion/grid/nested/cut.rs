//! Cutting a list of triangles into parts of neighbours: in two, where boxes' surfaces leave the fewest tests, and so on.
//!
//! Long lists are cut into parts that are all full, along the longest axis. Short ones become eights, where it counts: they are
//! cut along whichever axis is best, and anywhere, for two eights that are not full but apart are often cheaper than one and a rest.

use rayon::prelude::*;

use super::Threads;
use super::build::{FEW, MOST_VOXELS};
use super::sort::Extent;
use crate::occlusion::eight::WIDTH;

/// Most boxes between which a cut is sought: those of parts, one to a voxel, or of single triangles.
const MOST_BOXES: usize = if MOST_VOXELS > FEW { MOST_VOXELS } else { FEW };

/// The box of the middles of some triangles.
pub(super) fn middles(extents: &[Extent], list: &[u32], threads: Threads) -> Extent {
    let middle = |&index: &u32| Extent::at(extents[index as usize].middle());
    let shared = list.par_iter().with_min_len(threads.least());
    shared.map(middle).reduce(|| Extent::EMPTY, Extent::union)
}

/// Sorts a list so that parts of `size`, of which the last may have less, are neighbours. At most [`MOST_VOXELS`].
pub(super) fn into_parts(extents: &[Extent], list: &mut [u32], size: usize, threads: Threads) {
    if list.len() <= size {
        return;
    }
    let Extent { low, high } = middles(extents, list, threads);
    let mut keys = vec![0; list.len()];
    sort(extents, list, (high - low).max_position(), &mut keys);
    put_in_order(list, &keys);
    let (left, right) = list.split_at_mut(cheapest(extents, &keys, size, size).at);
    let on = |part: &mut [u32]| into_parts(extents, part, size, threads);
    if left.len() + right.len() > threads.least() {
        rayon::join(|| on(left), || on(right));
    } else {
        on(left);
        on(right);
    }
}

/// Takes a list of at most [`FEW`] apart into eights, or less, of neighbours.
pub(super) fn into_eights<'l>(
    extents: &[Extent],
    list: &'l mut [u32],
    eights: &mut Vec<&'l mut [u32]>,
) {
    if list.len() <= WIDTH {
        eights.push(list);
        return;
    }
    let mut keys = [[0; FEW]; 3];
    let mut best: Option<(Cut, usize)> = None;
    for (axis, keys) in keys.iter_mut().enumerate() {
        let keys = &mut keys[..list.len()];
        sort(extents, list, axis, keys);
        let cut = cheapest(extents, keys, 1, WIDTH);
        if best.is_none_or(|(least, _)| cut.cost < least.cost) {
            best = Some((cut, axis));
        }
    }
    let (cut, axis) = best.expect("there are three axes");
    put_in_order(list, &keys[axis]);
    let (left, right) = list.split_at_mut(cut.at);
    into_eights(extents, left, eights);
    into_eights(extents, right, eights);
}

/// Sorts the numbers of a list along an axis; they are the lower halves of the keys.
fn sort(extents: &[Extent], list: &[u32], axis: usize, keys: &mut [u64]) {
    for (key, &number) in keys.iter_mut().zip(list) {
        let place = in_order(extents[number as usize].middle()[axis]);
        *key = u64::from(place) << 32 | u64::from(number);
    }
    keys.sort_unstable();
}

/// Bits that are in the order of floats.
fn in_order(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

fn put_in_order(list: &mut [u32], keys: &[u64]) {
    for (number, &key) in list.iter_mut().zip(keys) {
        *number = key as u32;
    }
}

/// Where to cut a sorted list in two, and what that costs rays.
#[derive(Clone, Copy)]
struct Cut {
    at: usize,
    cost: f32,
}

/// The cheapest cut at a multiple of `step`, where each `size` triangles that a ray comes to cost a test.
fn cheapest(extents: &[Extent], keys: &[u64], step: usize, size: usize) -> Cut {
    let mut boxes = [Extent::EMPTY; MOST_BOXES];
    for (around, keys) in boxes.iter_mut().zip(keys.chunks(step)) {
        for &key in keys {
            *around = around.union(extents[key as u32 as usize]);
        }
    }
    let cost = |around: Extent, count: usize| around.half_area() * count.div_ceil(size) as f32;
    let count = keys.len().div_ceil(step);
    let mut after = [0.0; MOST_BOXES];
    let mut right = Extent::EMPTY;
    for number in (1..count).rev() {
        right = right.union(boxes[number]);
        after[number] = cost(right, keys.len() - number * step);
    }
    // Where no cost is a number, in the middle.
    let mut best = Cut { at: count / 2 * step, cost: f32::INFINITY };
    let mut left = Extent::EMPTY;
    for number in 1..count {
        left = left.union(boxes[number - 1]);
        let cost = cost(left, number * step) + after[number];
        if cost < best.cost {
            best = Cut { at: number * step, cost };
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;
    use crate::exact::random::Random;

    /// Points at random in two cubes: every third is in the one that is far away.
    fn two_heaps(count: usize) -> Vec<Extent> {
        let mut random = Random::new(5, 0);
        let point = |number: usize| {
            let places = [0; 3].map(|_: u32| random.unit() as f32);
            Extent::at(Vec3A::from_array(places) + place(number))
        };
        (0..count).map(point).collect()
    }

    fn place(number: usize) -> f32 {
        if number.is_multiple_of(3) { 10.0 } else { 0.0 }
    }

    fn parts(extents: &[Extent], size: usize) -> Vec<Vec<u32>> {
        let mut list: Vec<u32> = (0..extents.len() as u32).collect();
        into_parts(extents, &mut list, size, Threads::Many);
        list.chunks(size).map(<[u32]>::to_vec).collect()
    }

    fn eights(extents: &[Extent]) -> Vec<Vec<u32>> {
        let mut list: Vec<u32> = (0..extents.len() as u32).collect();
        let mut eights = Vec::new();
        into_eights(extents, &mut list, &mut eights);
        eights.into_iter().map(|eight| eight.to_vec()).collect()
    }

    fn assert_nothing_is_lost(parts: &[Vec<u32>], count: usize) {
        let mut all = parts.concat();
        all.sort_unstable();
        assert_eq!(all, (0..count as u32).collect::<Vec<_>>());
    }

    #[test]
    fn nothing_is_lost_and_two_heaps_are_taken_apart() {
        let long = two_heaps(720);
        // One heap has 240, the other 480, which parts of 24 divide.
        for (parts, count) in [(parts(&long, 24), 720), (eights(&two_heaps(FEW)), FEW)] {
            for part in &parts {
                let first = place(part[0] as usize);
                assert!(part.iter().all(|&number| place(number as usize) == first), "{part:?}");
            }
            assert_nothing_is_lost(&parts, count);
        }
    }

    #[test]
    fn eights_are_left_with_room_where_triangles_are_apart() {
        // Three here and six there, which is one more than eight.
        let extents = [0.0, 0.1, 0.2, 7.0, 7.1, 7.2, 7.3, 7.4, 7.5];
        let extents = extents.map(|x| Extent::of(&[0.0, 1.0, 1.0].map(|y| Vec3A::new(x, y, y))));
        assert_eq!(eights(&extents), [vec![0, 1, 2], vec![3, 4, 5, 6, 7, 8]]);
    }

    #[test]
    fn the_axis_is_that_of_the_best_cut_and_not_the_longest() {
        // Long across x, where boxes overlap, in two floors.
        let slab = |number: usize| {
            let (x, y) = (0.2 * (number / 2) as f32, (number % 2) as f32);
            Extent { low: Vec3A::new(x, y, 0.0), high: Vec3A::new(x + 20.0, y + 0.01, 20.0) }
        };
        let extents: Vec<Extent> = (0..16).map(slab).collect();
        for eight in eights(&extents) {
            assert!(eight.iter().all(|number| number % 2 == eight[0] % 2), "{eight:?}");
        }
    }

    #[test]
    fn copies_are_cut_too() {
        let extents = vec![Extent::at(Vec3A::ONE); 100];
        assert_nothing_is_lost(&parts(&extents, 8), 100);
        assert_nothing_is_lost(&eights(&extents[..FEW]), FEW);
        let nowhere = Extent { low: Vec3A::NEG_INFINITY, high: Vec3A::INFINITY };
        assert_nothing_is_lost(&eights(&[nowhere; 20]), 20);
    }

    #[test]
    fn bits_are_in_the_order_of_floats() {
        let floats = [f32::NEG_INFINITY, -2.0, -1e-40, -0.0, 0.0, 1e-40, 0.5, 3.0, f32::INFINITY];
        assert!(floats.map(in_order).is_sorted());
    }
}
