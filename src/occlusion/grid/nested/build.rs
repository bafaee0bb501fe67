//! Dividing what is crowded, from the whole scene down.
//!
//! Every triangle is in one voxel: that which the middle of its box is in. So each is stored once, boxes of voxels' contents
//! overlap a little, and a list is sorted in one pass. What is much longer than a voxel would make its box as long. Such
//! triangles are kept apart, as a further content of the grid, where boxes' surfaces say that it pays: a ray that passes a
//! box passes one in it with the ratio of their surfaces (MacDonald & Booth 1990).
//!
//! A list that is short enough is cut into eights of neighbours with a box each, where surfaces say. A list that voxels do not
//! take apart, copies above all, is cut into equal parts.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.

use std::ops::Range;

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::cut::{into_eights, into_parts, middles};
use super::group::{GROUP, Group};
use super::sort::{Extent, Lattice};
use super::walk::MOST_DEPTH;
use super::{Cube, MOST, NestedGrid, Node, SLOTS, Threads};
use crate::geometry::lanes::Available;
use crate::geometry::{Bounds, TriangleId, Triangles, is_finite};
use crate::large_pages::vec_with_room;
use crate::occlusion::eight::{AHEAD, Eight, WIDTH};

/// A voxel with at most so many triangles, six vectors full, is never divided.
pub(super) const FEW: usize = 48;

// Were each triangle by itself, there would still be a place for each.
const _: () = assert!(FEW <= SLOTS);

/// A part of a scene with at most so many triangles, two vectors full, gains nothing by a grid of its own.
const LEAST_DIVIDED: usize = 16;

/// Triangles to a voxel of a grid, and the voxels that it gets if there are triangles enough: half of what there are bits for,
/// so that there is room for eights. It may get a few more, for they are counted along axes: 36 at most.
const PER_VOXEL: usize = 6;
pub(super) const MOST_VOXELS: usize = SLOTS / 2;

/// Voxels that there are numbers for.
const VOXELS: usize = (MOST * MOST * MOST) as usize;

/// Triangles that are more than one of these times as long as a voxel, along some axis, may be kept apart from all voxels.
const LARGE: [f32; 3] = [1.0, 2.0, 4.0];
const SIZES: usize = LARGE.len() + 1;

/// From this depth on lists are cut, and not sorted into voxels: each step leaves a thirty-second, so seven are enough for
/// 2³² triangles, and one more for what does not find room.
const CUT_FROM: usize = MOST_DEPTH - 8;

/// Sorts all triangles.
pub(super) fn build(triangles: &Triangles) -> NestedGrid {
    let all: Vec<TriangleId> = (0..triangles.len() as TriangleId).collect();
    let cube = Cube::over(triangles.bounds(), triangles.slack());
    Sorter::new(triangles, cube, &all, Extent::ALL, Threads::Many).build()
}

/// Sorts some of the triangles, in a cube that is as large as they are.
pub(super) fn build_among(triangles: &Triangles, ids: Range<TriangleId>) -> NestedGrid {
    let list: Vec<TriangleId> = ids.filter(|&id| is_finite(&triangles.get(id))).collect();
    let bounds = list.iter().map(|&id| triangles.bounds_of(id)).reduce(Bounds::union);
    let cube = Cube::over(bounds, triangles.slack());
    Sorter::new(triangles, cube, &list, Extent::ALL, Threads::Many).build()
}

/// Sorts some of the triangles, and only where they are in a box of the scene.
pub(super) fn divide(
    triangles: &Triangles,
    list: &[TriangleId],
    low: DVec3,
    high: DVec3,
    threads: Threads,
) -> Option<NestedGrid> {
    let cube = Cube::over(triangles.bounds(), triangles.slack());
    let place = |corner| cube.place(corner).as_vec3a();
    let around = Extent { low: place(low) - cube.padding, high: place(high) + cube.padding };
    let sorter = || Sorter::new(triangles, cube, list, around, threads);
    (list.len() > LEAST_DIVIDED).then(|| sorter().build())
}

/// A grid in the making.
struct Grid {
    node: Node,
    /// What its voxels hold.
    slots: Vec<Slot>,
}

/// Something that a voxel holds.
struct Slot {
    bounds: Extent,
    content: Content,
}

enum Content {
    Grid(Grid),
    /// Eight triangles, or fewer: how many. The last one is repeated.
    Eight([u32; WIDTH], usize),
}

/// The triangles of a list, by voxel.
struct Sorted {
    list: Vec<u32>,
    /// The voxels that hold any.
    parts: Vec<Part>,
}

/// A voxel that holds something, and where it is in the sorted list.
#[derive(Clone, Copy)]
struct Part {
    start: usize,
    end: usize,
}

/// Some triangles: how many, and their box.
#[derive(Clone, Copy)]
struct Heap {
    count: u32,
    bounds: Extent,
}

impl Heap {
    const EMPTY: Self = Self { count: 0, bounds: Extent::EMPTY };

    #[inline(always)]
    fn add(&mut self, bounds: Extent) {
        self.count += 1;
        self.bounds = self.bounds.union(bounds);
    }

    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.bounds = self.bounds.union(other.bounds);
    }

    /// What it costs the rays that meet the box, as many as its surface. Less than one test a triangle, for
    /// what is many is divided further.
    fn cost(&self) -> f32 {
        if self.count == 0 { 0.0 } else { (self.count as f32).sqrt() * self.bounds.half_area() }
    }
}

/// Where a triangle goes: its voxel, and how many of the lengths in [`LARGE`] it exceeds.
#[derive(Clone, Copy)]
struct Place {
    voxel: u8,
    size: u8,
}

struct Sorter<'a> {
    triangles: &'a Triangles,
    cube: Cube,
    /// The box outside of which nothing matters.
    around: Extent,
    /// The triangles that are finite, and their boxes in the cube.
    ids: Vec<TriangleId>,
    extents: Vec<Extent>,
    threads: Threads,
}

impl<'a> Sorter<'a> {
    fn new(
        triangles: &'a Triangles,
        cube: Cube,
        list: &[TriangleId],
        around: Extent,
        threads: Threads,
    ) -> Self {
        let finite = |id: &&TriangleId| is_finite(&triangles.get(**id));
        let shared = list.par_iter().with_min_len(threads.least());
        let ids: Vec<TriangleId> = shared.filter(finite).copied().collect();
        let place = |corner: Vec3A| cube.place(corner.as_dvec3()).as_vec3a();
        let extent = |&id: &TriangleId| Extent::of(&triangles.corners()[id as usize].map(place));
        let mut extents = vec_with_room(ids.len());
        let shared = ids.par_iter().with_min_len(threads.least());
        shared.map(extent).collect_into_vec(&mut extents);
        Self { triangles, cube, around, ids, extents, threads }
    }

    fn build(self) -> NestedGrid {
        let list: Vec<u32> = (0..self.ids.len() as u32).collect();
        let root = (!list.is_empty()).then(|| self.grid(list, 0));
        self.finish(root)
    }

    /// The grid of a list of triangles.
    fn grid(&self, list: Vec<u32>, level: usize) -> Grid {
        let voxels = MOST_VOXELS.min(list.len() / PER_VOXEL).max(1);
        let lattice = Lattice::over(middles(&self.extents, &list, self.threads), voxels);
        let Sorted { mut list, parts } = self.sorted(&lattice, list, level);
        let divide = |part: &Part| {
            (part.len() > FEW).then(|| self.grid(list[part.range()].to_vec(), level + 1))
        };
        // One by one if they are worth threads together.
        let least = if list.len() > self.threads.least() { 1 } else { usize::MAX };
        let divided: Vec<_> = parts.par_iter().with_min_len(least).map(divide).collect();
        let mut slots = Vec::with_capacity(SLOTS);
        let mut room = SLOTS - parts.len();
        for (part, inside) in parts.iter().zip(divided) {
            let list = &mut list[part.range()];
            if let Some(inside) = inside {
                slots.push(self.slot(list, Some(inside)));
                continue;
            }
            let mut eights = self.eights(list);
            let more = eights.len() - 1;
            if more <= room {
                room -= more;
                slots.append(&mut eights);
            } else {
                // A grid of nothing but its eights.
                slots.push(self.slot(list, Some(Grid::new(&lattice, eights))));
            }
        }
        Grid::new(&lattice, slots)
    }

    /// A list by voxel, or cut into parts where voxels leave most of it in one.
    fn sorted(&self, lattice: &Lattice, list: Vec<u32>, level: usize) -> Sorted {
        let sorted = self.sort(lattice, list);
        let largest = sorted.parts.iter().map(Part::len).max().unwrap_or(0);
        let count = sorted.list.len();
        if count <= FEW || (level < CUT_FROM && 4 * largest <= 3 * count) {
            return sorted;
        }
        let mut list = sorted.list;
        let size = count.div_ceil(MOST_VOXELS * WIDTH) * WIDTH;
        into_parts(&self.extents, &mut list, size, self.threads);
        let part = |start| Part { start, end: count.min(start + size) };
        let parts = (0..count).step_by(size).map(part).collect();
        Sorted { list, parts }
    }

    /// The box of some triangles, with padding.
    fn bounds(&self, list: &[u32]) -> Extent {
        let boxes = list.iter().map(|&index| self.extents[index as usize]);
        boxes.fold(Extent::EMPTY, Extent::union).within(self.around, self.cube.padding)
    }

    /// A list in eights of neighbours, each with its box; ids are in ascending order in each.
    fn eights(&self, list: &mut [u32]) -> Vec<Slot> {
        let mut eights = Vec::new();
        into_eights(&self.extents, list, &mut eights);
        let slot = |eight: &mut [u32]| {
            eight.sort_unstable();
            self.slot(eight, None)
        };
        eights.into_iter().map(slot).collect()
    }

    /// A list as something that a voxel holds: a grid, or else an eight.
    fn slot(&self, list: &[u32], inside: Option<Grid>) -> Slot {
        let eight = || {
            let last = list.len() - 1;
            Content::Eight(std::array::from_fn(|lane| list[lane.min(last)]), list.len())
        };
        Slot { bounds: self.bounds(list), content: inside.map_or_else(eight, Content::Grid) }
    }

    /// Sorts a list by the voxels that the middles of the triangles are in; behind all is what is kept apart.
    fn sort(&self, lattice: &Lattice, list: Vec<u32>) -> Sorted {
        let place = |&index: &u32| {
            let extent = self.extents[index as usize];
            let length = ((extent.high - extent.low) / lattice.side).max_element();
            let size = LARGE.iter().filter(|&&large| length > large).count();
            Place { voxel: lattice.voxel_of(extent.middle()) as u8, size: size as u8 }
        };
        let shared = list.par_iter().with_min_len(self.threads.least());
        let places: Vec<Place> = shared.map(place).collect();
        let apart_from = self.apart_from(&list, &places);
        let part = |place: &Place| {
            if usize::from(place.size) >= apart_from { VOXELS } else { usize::from(place.voxel) }
        };
        let mut counts = [0; VOXELS + 1];
        places.iter().for_each(|place| counts[part(place)] += 1);
        let mut ends = [0; VOXELS + 1];
        let mut total = 0;
        for (end, count) in ends.iter_mut().zip(counts) {
            *end = total;
            total += count;
        }
        let mut sorted = vec![0; list.len()];
        for (index, place) in list.into_iter().zip(&places) {
            let end = &mut ends[part(place)];
            sorted[*end] = index;
            *end += 1;
        }
        let part = |voxel: usize| Part { start: ends[voxel] - counts[voxel], end: ends[voxel] };
        let occupied = (0..=VOXELS).filter(|&voxel| counts[voxel] > 0);
        Sorted { list: sorted, parts: occupied.map(part).collect() }
    }

    /// The size from which on it costs least to keep triangles apart; `SIZES` if none are to be.
    fn apart_from(&self, list: &[u32], places: &[Place]) -> usize {
        let mut heaps = [[Heap::EMPTY; VOXELS]; SIZES];
        for (&index, place) in list.iter().zip(places) {
            let extent = self.extents[index as usize];
            heaps[usize::from(place.size)][usize::from(place.voxel)].add(extent);
        }
        // What is not apart, by voxel.
        let mut within = [Heap::EMPTY; VOXELS];
        let mut costs = [0.0; SIZES + 1];
        for size in 0..SIZES {
            within.iter_mut().zip(&heaps[size]).for_each(|(within, heap)| within.join(heap));
            let mut apart = Heap::EMPTY;
            heaps[size + 1..].iter().flatten().for_each(|heap| apart.join(heap));
            costs[size + 1] = within.iter().map(Heap::cost).sum::<f32>() + apart.cost();
        }
        (1..=SIZES).rev().min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(SIZES)
    }

    /// Puts the grids side by side.
    fn finish(self, root: Option<Grid>) -> NestedGrid {
        let mut grid = NestedGrid {
            cube: self.cube,
            nodes: Vec::new(),
            groups: Vec::new(),
            outermost: 0,
            order: Vec::new(),
            eights: Vec::new(),
        };
        if let Some(root) = root {
            grid.outermost = root.groups();
            grid.groups.resize(grid.outermost, Group::EMPTY);
            self.put(root, 0, &mut grid);
        }
        // Places are told in 32 bits, and so are numbers of groups, of which there are fewer.
        assert!(
            u32::try_from(grid.order.len()).is_ok(),
            "too many triangles for places in 32 bits"
        );
        grid.nodes.shrink_to_fit();
        grid.groups.shrink_to_fit();
        grid.order.shrink_to_fit();
        let arithmetic = Available::newest();
        let (ids, _) = grid.order.as_chunks::<WIDTH>();
        let eight = |number: usize| {
            if let Some(soon) = ids.get(number + AHEAD) {
                Eight::announce(self.triangles, soon);
            }
            Eight::new(self.triangles, &ids[number], arithmetic)
        };
        grid.eights = vec_with_room(ids.len());
        let shared = (0..ids.len()).into_par_iter().with_min_len(self.threads.least());
        shared.map(eight).collect_into_vec(&mut grid.eights);
        grid
    }

    /// Puts a grid where there is room for its groups, and behind all what is inside.
    fn put(&self, from: Grid, first_group: usize, grid: &mut NestedGrid) {
        grid.nodes.push(from.node);
        let mut divided = Vec::new();
        for (number, Slot { bounds, content }) in from.slots.into_iter().enumerate() {
            let (place, slot) = (first_group + number / GROUP, number % GROUP);
            match content {
                Content::Grid(inside) => {
                    let first = grid.groups.len();
                    let groups = first..first + inside.groups();
                    grid.groups.resize(groups.end, Group::EMPTY);
                    grid.groups[place].set_grid(slot, bounds, groups);
                    divided.push((inside, first));
                }
                Content::Eight(list, count) => {
                    let number = grid.order.len() / WIDTH;
                    grid.groups[place].set_eight(slot, bounds, number, count);
                    grid.order.extend(list.map(|index| self.ids[index as usize]));
                }
            }
        }
        for (inside, first) in divided {
            self.put(inside, first, grid);
        }
    }
}

impl Grid {
    /// With small boxes first: a ray that asks for any occluder takes what it meets as it stands there, and the large boxes, those of
    /// floors and walls, are mostly met by rays that start on them.
    fn new(lattice: &Lattice, mut slots: Vec<Slot>) -> Self {
        let size = |slot: &Slot| slot.bounds.half_area();
        slots.sort_by(|a, b| size(a).total_cmp(&size(b)));
        Self { node: Node { min: lattice.min, side: lattice.side }, slots }
    }

    /// Groups of what its voxels hold.
    fn groups(&self) -> usize {
        self.slots.len().div_ceil(GROUP)
    }
}

impl Part {
    fn len(&self) -> usize {
        self.end - self.start
    }

    fn range(&self) -> Range<usize> {
        self.start..self.end
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn what_a_grid_holds_is_stored_with_small_boxes_first() {
        let triangle = |n: u32| {
            let place = Vec3::new(n as f32, (n * 7 % 40) as f32, (n * 13 % 40) as f32);
            let size = 0.1 + (n * 11 % 40) as f32 / 20.0;
            [place, place + size * Vec3::X, place + size * Vec3::ONE]
        };
        let grid = build(&(0..300).map(triangle).collect());
        let held = grid.groups[..grid.outermost].iter().flat_map(Group::half_areas);
        let held: Vec<f32> = held.collect();
        assert!(held.len() > 16, "{held:?}");
        assert!(held.is_sorted(), "{held:?}");
    }
}
