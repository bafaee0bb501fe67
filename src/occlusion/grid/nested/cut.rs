//! Cutting a list of triangles into parts of neighbours.

use rayon::prelude::*;

use super::build::WORTH_A_THREAD;
use super::sort::Extent;

/// The box of the middles of some triangles.
pub(super) fn middles(extents: &[Extent], list: &[u32]) -> Extent {
    let middle = |&index: &u32| Extent::at(extents[index as usize].middle());
    if list.len() > WORTH_A_THREAD {
        list.par_iter().map(middle).reduce(|| Extent::EMPTY, Extent::union)
    } else {
        list.iter().map(middle).fold(Extent::EMPTY, Extent::union)
    }
}

/// Sorts a list so that parts of `size`, of which the last may have less, are neighbours: in two along the longest axis,
/// where boxes' surfaces leave the fewest tests, until they are parts.
pub(super) fn cut(extents: &[Extent], list: &mut [u32], size: usize) {
    if list.len() <= size {
        return;
    }
    let Extent { low, high } = middles(extents, list);
    let axis = (high - low).max_position();
    let place = |index: u32| extents[index as usize].middle()[axis];
    list.sort_unstable_by(|&a, &b| place(a).total_cmp(&place(b)));
    let (left, right) = list.split_at_mut(cheapest(extents, list, size));
    if left.len() + right.len() > WORTH_A_THREAD {
        rayon::join(|| cut(extents, left, size), || cut(extents, right, size));
    } else {
        cut(extents, left, size);
        cut(extents, right, size);
    }
}

/// Where to cut a sorted list in two: a multiple of `size`.
fn cheapest(extents: &[Extent], list: &[u32], size: usize) -> usize {
    let bounds = |part: &[u32]| {
        let boxes = part.iter().map(|&index| extents[index as usize]);
        boxes.fold(Extent::EMPTY, Extent::union)
    };
    let parts: Vec<Extent> = list.chunks(size).map(bounds).collect();
    let cost = |bounds: Extent, parts: usize| bounds.half_area() * parts as f32;
    let mut after = vec![0.0; parts.len()];
    let mut right = Extent::EMPTY;
    for (number, &part) in parts.iter().enumerate().skip(1).rev() {
        right = right.union(part);
        after[number] = cost(right, parts.len() - number);
    }
    let mut left = Extent::EMPTY;
    let (mut best, mut least) = (1, f32::INFINITY);
    for number in 1..parts.len() {
        left = left.union(parts[number - 1]);
        let cost = cost(left, number) + after[number];
        if cost < least {
            (best, least) = (number, cost);
        }
    }
    best * size
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;
    use crate::exact::random::Random;

    #[test]
    fn nothing_is_lost_and_two_heaps_are_taken_apart() {
        let mut random = Random::new(5, 0);
        let place = |number: usize| if number.is_multiple_of(3) { 10.0 } else { 0.0 };
        let mut extent = |number| {
            let places = [0; 3].map(|_: u32| random.unit() as f32);
            Extent::at(Vec3A::from_array(places) + place(number))
        };
        let extents: Vec<Extent> = (0..72).map(&mut extent).collect();
        let mut list: Vec<u32> = (0..72).collect();
        cut(&extents, &mut list, 8);
        for part in list.chunks(8) {
            assert!(part.iter().all(|&index| place(index as usize) == place(part[0] as usize)));
        }
        list.sort_unstable();
        assert_eq!(list, (0..72).collect::<Vec<_>>());
    }

    #[test]
    fn copies_are_cut_too() {
        let extents = vec![Extent::at(Vec3A::ONE); 100];
        let mut list: Vec<u32> = (0..100).collect();
        cut(&extents, &mut list, 8);
        list.sort_unstable();
        assert_eq!(list, (0..100).collect::<Vec<_>>());
    }
}
