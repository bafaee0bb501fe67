//! Dividing what is crowded, from the whole scene down.
//!
//! A grid costs about as much as a vector test or two, so a voxel is divided where the tests that are expected to be left,
//! in the voxels that a ray passes, and the grid cost less than testing all. A ray that passes a box passes a voxel in it
//! with the ratio of their surfaces (MacDonald & Booth 1990).
//!
//! Dividing lists a triangle again in each voxel that it comes near. So that long thin ones do not fill the memory, there
//! is a limit to how many times more entries all divisions down to a voxel may make. Eights of triangles with a box each cost no
//! entries: that is what lists are made of wherever there is room, and what is done with the long ones that are not divided, the
//! fans above all.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.

use std::slice::Chunks;

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::group::{GROUP, Group};
use super::sort::{Extent, Lattice};
use super::walk::MOST_DEPTH;
use super::{Cube, NestedGrid, Node, SLOTS};
use crate::geometry::{TriangleId, Triangles, is_finite};
use crate::occlusion::Cell;

/// A voxel with at most so many triangles, five vectors full, is never divided.
const FEW: usize = 40;

/// Triangles of one vector test.
const AT_ONCE: usize = 8;

/// Triangles to a voxel of a grid, and voxels at most: half of what there are bits for, so that there is room for eights.
const PER_VOXEL: usize = 4;
const MOST_VOXELS: usize = SLOTS / 2;

/// What a grid costs, in vector tests.
const GRID_COST: f32 = 1.5;

/// How many times as many entries may be made as there are triangles, on the way down to a voxel.
const MOST_GROWTH: f32 = 10.0;

/// A voxel whose longest side is fewer paddings than this is not divided.
const FEWEST_PADDINGS: f32 = 8.0;

/// Lists longer than this are sorted by several threads.
const WORTH_A_THREAD: usize = 4096;

/// Sorts all triangles.
pub(super) fn build(triangles: &Triangles) -> NestedGrid {
    let cube = Cube::over(triangles);
    let all: Vec<TriangleId> = (0..triangles.len() as TriangleId).collect();
    let sorter = Sorter::new(triangles, cube, &all);
    let list: Vec<u32> = (0..sorter.ids.len() as u32).collect();
    // Places of entries have 32 bits.
    let growth = MOST_GROWTH.min((u32::MAX / list.len().max(1) as u32) as f32);
    let root =
        sorter.bounds().and_then(|bounds| sorter.grid(bounds, &list, Depth { level: 0, growth }));
    sorter.finish(root)
}

/// Sorts some of the triangles, and only where they are in a box of the scene.
pub(super) fn divide(
    triangles: &Triangles,
    list: &[TriangleId],
    low: DVec3,
    high: DVec3,
) -> Option<NestedGrid> {
    let cube = Cube::over(triangles);
    let place = |corner| cube.place(corner).as_vec3a();
    let extent = Extent { low: place(low) - cube.padding, high: place(high) + cube.padding };
    let sorter = Sorter::new(triangles, cube, list);
    let list: Vec<u32> = (0..sorter.ids.len() as u32).collect();
    let bounds = sorter.bounds()?.within(extent, cube.padding);
    let root = sorter.grid(bounds, &list, Depth { level: 1, growth: MOST_GROWTH })?;
    Some(sorter.finish(Some(root)))
}

/// How far down, and how many times more entries there may yet be.
#[derive(Clone, Copy)]
struct Depth {
    level: usize,
    growth: f32,
}

/// A grid in the making.
struct Grid {
    node: Node,
    /// What its voxels hold.
    slots: Vec<Slot>,
    /// The grids in those that are divided.
    inside: Vec<Grid>,
    /// The lists of the others, one after another.
    lists: Vec<u32>,
}

/// Something that a voxel holds: a grid, a list or a part of it.
struct Slot {
    voxel: u32,
    /// Where its list ends. That of a grid is empty.
    end: u32,
    bounds: Extent,
}

/// The triangles of a list, by voxel.
struct Sorted {
    list: Vec<u32>,
    /// The voxels that hold any.
    parts: Vec<Part>,
}

/// A voxel that holds something.
#[derive(Clone, Copy)]
struct Part {
    voxel: u32,
    /// Of the sorted list.
    start: u32,
    end: u32,
    /// The box of its triangles, where they are in it.
    bounds: Extent,
}

struct Sorter {
    cube: Cube,
    /// The triangles that are finite, and where they are in the cube.
    ids: Vec<TriangleId>,
    corners: Vec<[Vec3A; 3]>,
}

impl Sorter {
    fn new(triangles: &Triangles, cube: Cube, list: &[TriangleId]) -> Self {
        let finite = |id: &&TriangleId| is_finite(&triangles.get(**id));
        let ids: Vec<TriangleId> = list.par_iter().filter(finite).copied().collect();
        let place = |corner: Vec3A| cube.place(corner.as_dvec3()).as_vec3a();
        let corners =
            ids.par_iter().map(|&id| triangles.corners()[id as usize].map(place)).collect();
        Self { cube, ids, corners }
    }

    /// The box of all, with padding; none without any.
    fn bounds(&self) -> Option<Extent> {
        let boxes = self.corners.iter().map(Extent::of);
        boxes.reduce(Extent::union).map(|tight| tight.within(Extent::ALL, self.cube.padding))
    }

    /// The grid of a list of triangles that are in a box; `None` if it gains too little.
    fn grid(&self, bounds: Extent, list: &[u32], depth: Depth) -> Option<Grid> {
        let padding = self.cube.padding;
        let mut lattice = Lattice::over(bounds, MOST_VOXELS.min(list.len() / PER_VOXEL), padding);
        let Sorted { list: mut sorted, mut parts } = self.sort(&lattice, list);
        let mut growth = sorted.len() as f32 / list.len() as f32;
        if depth.level == 0 {
            // There must be an outermost grid, if only of one voxel.
            if growth > depth.growth {
                lattice = Lattice::over(bounds, 1, padding);
                sorted = list.to_vec();
                parts = vec![Part { voxel: 0, start: 0, end: list.len() as u32, bounds }];
                growth = 1.0;
            }
        } else {
            let left: f32 = parts.iter().map(|part| tests(part.len())).sum();
            let pays = lattice.share() * left + GRID_COST < tests(list.len());
            let too_small = lattice.side.max_element() < FEWEST_PADDINGS * padding;
            if !pays || too_small || growth > depth.growth {
                return None;
            }
        }
        let depth = Depth { level: depth.level + 1, growth: depth.growth / growth };
        let divide = |part: &Part| {
            let (list, bounds) = (part.of(&sorted), part.bounds);
            let crowded = list.len() > FEW && depth.level < MOST_DEPTH;
            crowded.then(|| {
                self.grid(bounds, list, depth).unwrap_or_else(|| self.bundle(bounds, list))
            })
        };
        let divided: Vec<Option<Grid>> = if list.len() > WORTH_A_THREAD {
            parts.par_iter().map(divide).collect()
        } else {
            parts.iter().map(divide).collect()
        };
        let mut grid = Grid::over(&lattice);
        let undivided = parts.iter().zip(&divided).filter(|(_, inside)| inside.is_none());
        grid.lists.reserve_exact(undivided.map(|(part, _)| part.len()).sum());
        grid.slots.reserve_exact(SLOTS);
        // Eights are worth a box each as long as there are bits for them.
        let mut room = SLOTS - parts.len();
        for (part, inside) in parts.iter().zip(divided) {
            if let Some(inside) = inside {
                grid.add_grid(part.voxel, part.bounds, inside);
                continue;
            }
            let list = part.of(&sorted);
            let more = list.len().div_ceil(AT_ONCE) - 1;
            if more > 0 && more <= room {
                room -= more;
                self.add_parts(&mut grid, &lattice, part.voxel, list.chunks(AT_ONCE));
            } else if more > 1 {
                grid.add_grid(part.voxel, part.bounds, self.bundle(part.bounds, list));
            } else {
                grid.add_list(part.voxel, part.bounds, list);
            }
        }
        Some(grid)
    }

    /// A long list that is not divided, in eights with a box each: a grid of one voxel.
    fn bundle(&self, bounds: Extent, list: &[u32]) -> Grid {
        let lattice = Lattice::over(bounds, 1, self.cube.padding);
        let mut grid = Grid::over(&lattice);
        grid.lists.reserve_exact(list.len());
        let eights = list.len().div_ceil(AT_ONCE).div_ceil(SLOTS);
        self.add_parts(&mut grid, &lattice, 0, list.chunks(eights * AT_ONCE));
        grid
    }

    /// Adds parts of the list of a voxel, each with the box of its triangles where they are in the voxel.
    fn add_parts(&self, grid: &mut Grid, lattice: &Lattice, voxel: u32, parts: Chunks<u32>) {
        for part in parts {
            let boxes = part.iter().map(|&index| Extent::of(&self.corners[index as usize]));
            let bounds = boxes.fold(Extent::EMPTY, Extent::union);
            grid.add_list(voxel, lattice.within(voxel, bounds), part);
        }
    }

    /// Sorts a list by voxel; ids stay in ascending order.
    fn sort(&self, lattice: &Lattice, list: &[u32]) -> Sorted {
        let overlapped = |&index: &u32| lattice.overlapped(&self.corners[index as usize]);
        let voxels: Vec<u64> = if list.len() > WORTH_A_THREAD {
            list.par_iter().map(overlapped).collect()
        } else {
            list.iter().map(overlapped).collect()
        };
        let mut counts = [0; 64];
        voxels.iter().copied().flat_map(ones).for_each(|voxel| counts[voxel] += 1);
        let mut ends = [0; 64];
        let mut total = 0;
        for (end, count) in ends.iter_mut().zip(counts) {
            *end = total;
            total += count;
        }
        let mut sorted = vec![0; total as usize];
        let mut bounds = [Extent::EMPTY; 64];
        for (&index, &voxels) in list.iter().zip(&voxels) {
            let extent = Extent::of(&self.corners[index as usize]);
            for voxel in ones(voxels) {
                sorted[ends[voxel] as usize] = index;
                ends[voxel] += 1;
                bounds[voxel] = bounds[voxel].union(extent);
            }
        }
        let part = |voxel: usize| Part {
            voxel: voxel as u32,
            start: ends[voxel] - counts[voxel],
            end: ends[voxel],
            bounds: lattice.within(voxel as u32, bounds[voxel]),
        };
        let occupied = (0..64).filter(|&voxel| counts[voxel] > 0);
        Sorted { list: sorted, parts: occupied.map(part).collect() }
    }

    /// Puts the grids side by side.
    fn finish(self, root: Option<Grid>) -> NestedGrid {
        let mut grid = NestedGrid {
            cube: self.cube,
            nodes: Vec::new(),
            groups: Vec::new(),
            order: Vec::new(),
        };
        if let Some(root) = root {
            grid.nodes.push(Node::default());
            self.put(root, 0, &mut grid);
        }
        grid.nodes.shrink_to_fit();
        grid.groups.shrink_to_fit();
        grid.order.shrink_to_fit();
        grid
    }

    fn put(
        &self,
        Grid { mut node, slots, inside, lists }: Grid,
        place: usize,
        grid: &mut NestedGrid,
    ) {
        let (first_group, first_grid) = (grid.groups.len(), grid.nodes.len());
        (node.first_group, node.first_grid) = (first_group as u32, first_grid as u32);
        node.slots = slots.len() as u32;
        grid.nodes[place] = node;
        grid.groups.resize(node.groups().end, Group::EMPTY);
        let first = end_of(&grid.order);
        grid.order.extend(lists.into_iter().map(|index| self.ids[index as usize]));
        let mut start = first;
        for (number, Slot { voxel, end, bounds }) in slots.into_iter().enumerate() {
            let cell = Cell { start, end: first + end };
            let group = &mut grid.groups[first_group + number / GROUP];
            group.set(number % GROUP, voxel, bounds, cell);
            start = cell.end;
        }
        grid.nodes.resize(first_grid + inside.len(), Node::default());
        for (number, inside) in inside.into_iter().enumerate() {
            self.put(inside, first_grid + number, grid);
        }
    }
}

impl Grid {
    fn over(lattice: &Lattice) -> Self {
        let node = Node { min: lattice.min, side: lattice.side, ..Node::default() };
        Self { node, slots: Vec::new(), inside: Vec::new(), lists: Vec::new() }
    }

    fn add_list(&mut self, voxel: u32, bounds: Extent, list: &[u32]) {
        self.lists.extend_from_slice(list);
        self.slots.push(Slot { voxel, end: self.lists.len() as u32, bounds });
    }

    fn add_grid(&mut self, voxel: u32, bounds: Extent, inside: Grid) {
        self.node.divided |= 1 << self.slots.len();
        self.inside.push(inside);
        self.add_list(voxel, bounds, &[]);
    }
}

impl Part {
    fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    fn of<'a>(&self, sorted: &'a [u32]) -> &'a [u32] {
        &sorted[self.start as usize..self.end as usize]
    }
}

/// The places of the bits that are set.
fn ones(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (place < u64::BITS).then_some(place as usize)
    })
}

/// Vector tests of so many triangles.
fn tests(triangles: usize) -> f32 {
    triangles.div_ceil(AT_ONCE) as f32
}

/// Where the next list starts.
fn end_of(order: &[TriangleId]) -> u32 {
    u32::try_from(order.len()).expect("fewer than 2^32 entries in voxels")
}
