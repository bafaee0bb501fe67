//! Dividing many triangles: several levels of the tree in two passes over them.
//!
//! One pass counts what is in the cells of a regular grid, and how far it reaches. There are far fewer cells than triangles:
//! they are divided by the surface area heuristic, at any boundary between cells, along any axis. The other pass puts each
//! triangle where its part is. HLBVH does so with Morton codes, where cuts are at powers of two.
//!
//! Garanzha, Pantaleoni, McAllister: Simpler and Faster HLBVH with Work Queues. High Performance Graphics 2011.

use std::ops::Range;

use glam::{Vec3, Vec4};

use super::divide::{Around, Heap, INTEGERS, Item, TO_FLOOR};
use super::few::FEW;
use crate::large_pages::vec_with_room;

/// Fewer items are divided one cut at a time: two passes over a grid of its own cost a range of these as much.
pub(super) const MANY: usize = 512;

/// Items a cell, if they were spread evenly.
const A_CELL: usize = 16;

/// Cells at most, in bits: what is known of so many is a mebibyte, which the second cache holds, and a number is a `u16`.
const MOST_BITS: u32 = 15;

/// Cells along an axis at most, in bits.
const MOST_ALONG_BITS: u32 = 6;
const MOST_ALONG: usize = 1 << MOST_ALONG_BITS;

/// No part has fewer items: below that, every cut is weighed.
const LEAST: usize = 64;

/// Items in a tree of ranges.
pub(super) struct Part {
    pub items: Range<usize>,
    pub inside: Option<Box<[Part; 2]>>,
}

/// Fills `sorted`, part by part, with as many items, each of which `item` gives by its number, twice. The box is around their places,
/// or somewhat larger.
pub(super) fn sort(sorted: &mut [Item], places: &Around, item: impl Fn(usize) -> Item) -> Part {
    let mut cells = Cells::new(sorted.len(), places);
    let mut cell_of = vec_with_room(sorted.len());
    cell_of.extend((0..sorted.len()).map(|number| cells.count(&item(number))));
    let part = cells.divide(cells.all(), 0..sorted.len());
    for (number, &cell) in cell_of.iter().enumerate() {
        let place = &mut cells.next[usize::from(cell)];
        sorted[*place as usize] = item(number);
        *place += 1;
    }
    part
}

/// A regular grid, and what is in its cells.
struct Cells {
    /// Of how many cells there are along each axis: the bits of a coordinate in a cell's number.
    bits: [u32; 3],
    low: Vec4,
    /// Cells for a unit of length.
    scale: Vec4,
    /// The coordinates of the last cell.
    last: Vec4,
    counts: Vec<u32>,
    boxes: Vec<Around>,
    /// Where the next item of a cell is to go.
    next: Vec<u32>,
    /// Lent to each region: the slabs of cells across each axis, and all that is right of each along one.
    slabs: [[Heap; MOST_ALONG]; 3],
    right: [Heap; MOST_ALONG + 1],
}

impl Cells {
    fn new(count: usize, places: &Around) -> Self {
        let bounds = places.bounds();
        let mut bits = [0; 3];
        let mut side = bounds.extent();
        for _ in 0..(count / A_CELL).max(1).ilog2().min(MOST_BITS) {
            let axis = side.max_position();
            // No axis is left that may be divided and has a length, or that is a number: sums of places may be infinite.
            if side[axis].is_nan() || side[axis] <= 0.0 {
                break;
            }
            bits[axis] += 1;
            side[axis] = if bits[axis] < MOST_ALONG_BITS { 0.5 * side[axis] } else { 0.0 };
        }
        let along = Vec3::from(bits.map(|bits| (1u32 << bits) as f32));
        let scale = along / bounds.extent();
        let cells = 1 << bits.iter().sum::<u32>();
        Self {
            bits,
            // The fourth coordinate of an item is its number in bits, and some processors are slow to multiply those.
            low: bounds.min.extend(-1.0),
            // Where the box is flat or has no length in f32, all are in the first cell, or where they are infinite in the last.
            scale: Vec3::select(scale.is_finite_mask(), scale, Vec3::ZERO).extend(0.0),
            last: (along - 1.0).extend(0.0),
            counts: vec![0; cells],
            boxes: vec![Around::NOTHING; cells],
            next: vec![0; cells],
            slabs: [[Heap::EMPTY; MOST_ALONG]; 3],
            right: [Heap::EMPTY; MOST_ALONG + 1],
        }
    }

    /// The cell that an item is in, having counted it.
    #[inline(always)]
    fn count(&mut self, item: &Item) -> u16 {
        let place = (item.place() - self.low) * self.scale - TO_FLOOR;
        let place = place.min(self.last).max(Vec4::ZERO) + INTEGERS;
        let [x, y, z, _] = place.to_array().map(|place| place.to_bits() as usize % MOST_ALONG);
        let cell = self.row(y, z) | x;
        self.counts[cell] += 1;
        self.boxes[cell].join(&item.0);
        cell as u16
    }

    /// The first cell of a row along the first axis.
    #[inline(always)]
    fn row(&self, y: usize, z: usize) -> usize {
        (y | z << self.bits[1]) << self.bits[0]
    }

    fn all(&self) -> Region {
        Region { low: [0; 3], high: self.bits.map(|bits| 1 << bits) }
    }

    /// Divides a region as far as that pays, and gives its items their range.
    fn divide(&mut self, region: Region, items: Range<usize>) -> Part {
        if items.len() > FEW
            && let Some(Cut { axis, at, count }) = self.best_cut(region)
        {
            let (mut left, mut right) = (region, region);
            left.high[axis] = at;
            right.low[axis] = at;
            let middle = items.start + count;
            let inside =
                [self.divide(left, items.start..middle), self.divide(right, middle..items.end)];
            return Part { items, inside: Some(Box::new(inside)) };
        }
        let mut next = items.start as u32;
        for (y, z) in region.rows() {
            for cell in self.row(y, z) + region.low[0]..self.row(y, z) + region.high[0] {
                self.next[cell] = next;
                next += self.counts[cell];
            }
        }
        Part { items, inside: None }
    }

    /// The cheapest cut that leaves enough on both sides.
    fn best_cut(&mut self, region: Region) -> Option<Cut> {
        for axis in 0..3 {
            self.slabs[axis][region.low[axis]..region.high[axis]].fill(Heap::EMPTY);
        }
        for (y, z) in region.rows() {
            for x in region.low[0]..region.high[0] {
                let cell = self.row(y, z) | x;
                let slab = Heap { count: self.counts[cell] as usize, around: self.boxes[cell] };
                if slab.count > 0 {
                    self.slabs[0][x].join(&slab);
                    self.slabs[1][y].join(&slab);
                    self.slabs[2][z].join(&slab);
                }
            }
        }
        let (mut best, mut least) = (None, f32::INFINITY);
        let right = &mut self.right;
        for (axis, slabs) in self.slabs.iter().enumerate() {
            let cells = region.low[axis]..region.high[axis];
            right[cells.end] = Heap::EMPTY;
            for at in cells.clone().rev() {
                right[at] = right[at + 1];
                right[at].join(&slabs[at]);
            }
            let mut left = Heap::EMPTY;
            for at in cells.start + 1..cells.end {
                left.join(&slabs[at - 1]);
                let cost = left.cost() + right[at].cost();
                let enough = left.count.min(right[at].count) >= LEAST;
                if enough && cost < least {
                    least = cost;
                    best = Some(Cut { axis, at, count: left.count });
                }
            }
        }
        best
    }
}

/// Cells: along each axis from `low` up to, not including, `high`.
#[derive(Clone, Copy)]
struct Region {
    low: [usize; 3],
    high: [usize; 3],
}

impl Region {
    /// Along the other two axes, where its rows along the first axis are.
    fn rows(self) -> impl Iterator<Item = (usize, usize)> {
        let Self { low: [_, low_y, low_z], high: [_, high_y, high_z] } = self;
        (low_z..high_z).flat_map(move |z| (low_y..high_y).map(move |y| (y, z)))
    }
}

/// Before which cell along an axis to cut, and how many items come before it.
struct Cut {
    axis: usize,
    at: usize,
    count: usize,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::occlusion::clusters::divide::{items_at, places_of};

    /// Its smallest parts, having looked whether each consists of its two.
    fn leaves(part: &Part) -> Vec<Range<usize>> {
        let Some(inside) = &part.inside else { return vec![part.items.clone()] };
        let [left, right] = &**inside;
        assert_eq!((left.items.start, right.items.end), (part.items.start, part.items.end));
        assert_eq!(left.items.end, right.items.start);
        [leaves(left), leaves(right)].concat()
    }

    fn sorted(items: &[Item]) -> (Vec<Item>, Part) {
        let mut sorted = vec![Item(Around::NOTHING); items.len()];
        let part = sort(&mut sorted, &places_of(items), |number| items[number]);
        (sorted, part)
    }

    proptest! {
        #[test]
        fn parts_hold_all_items_once_and_none_has_few(
            places in prop::collection::vec((0u8..200, 0u8..20, 0u8..3), 1..3000),
        ) {
            let (sorted, part) = sorted(&items_at(&places));
            prop_assert_eq!(part.items.clone(), 0..places.len());
            let leaves = leaves(&part);
            prop_assert!(leaves.len() == 1 || leaves.iter().all(|leaf| leaf.len() >= LEAST));
            let mut ids: Vec<u32> = sorted.iter().map(Item::id).collect();
            ids.sort_unstable();
            prop_assert_eq!(ids, (0..places.len() as u32).collect::<Vec<_>>());
        }
    }

    #[test]
    fn heaps_are_parts_of_their_own() {
        let places: Vec<(u8, u8, u8)> =
            (0..900).map(|number| ([0, 90, 200][number % 3], 0, 7)).collect();
        let (sorted, part) = sorted(&items_at(&places));
        let leaves = leaves(&part);
        assert_eq!(leaves.len(), 3);
        for leaf in leaves {
            let first = sorted[leaf.start].place();
            assert!(sorted[leaf].iter().all(|item| item.place().x == first.x));
        }
    }

    #[test]
    fn a_few_far_away_are_no_part_of_their_own() {
        let place = |number| if number < LEAST - 1 { (200, 0, 0) } else { (0, 7, 7) };
        let (_, part) = sorted(&items_at(&(0..900).map(place).collect::<Vec<_>>()));
        assert!(part.inside.is_none());
    }

    #[test]
    fn what_is_in_one_place_is_one_part() {
        let (_, part) = sorted(&items_at(&[(7, 7, 7); 500]));
        assert!(part.inside.is_none());
    }
}
