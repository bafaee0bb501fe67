//! Dividing what is crowded, from the whole scene down.
//!
//! A grid costs about as much as a vector test or two, so a voxel is divided where the tests that are expected to be left,
//! in the voxels that a ray passes, and the grid cost less than testing all. A ray that passes a box passes a voxel in it
//! with the ratio of their surfaces (MacDonald & Booth 1990).
//!
//! Dividing lists a triangle again in each voxel that it comes near. So that long thin ones do not fill the memory, there
//! is a limit to how many times more entries all divisions down to a voxel may make.
//!
//! MacDonald, Booth: Heuristics for Ray Tracing Using Space Subdivision. The Visual Computer 6(3), 1990.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::sort::{Extent, Lattice};
use super::walk::MOST_DEPTH;
use super::{Cube, NestedGrid, Node};
use crate::geometry::{TriangleId, Triangles, is_finite};

/// A voxel with at most so many triangles, two vectors full, is never divided.
const FEW: usize = 16;

/// Triangles of one vector test.
const AT_ONCE: usize = 8;

/// What a grid costs, in vector tests.
const GRID_COST: f32 = 1.2;

/// How many times as many entries may be made as there are triangles, on the way down to a voxel.
const MOST_GROWTH: f32 = 16.0;

/// A voxel whose longest side is fewer paddings than this is not divided.
const FEWEST_PADDINGS: f32 = 8.0;

/// Lists longer than this are sorted by several threads.
const WORTH_A_THREAD: usize = 4096;

/// Sorts all triangles.
pub(super) fn build(triangles: &Triangles) -> NestedGrid {
    let cube = Cube::over(triangles);
    let everything = Extent { low: Vec3A::splat(-1.0), high: Vec3A::splat(2.0) };
    let all: Vec<TriangleId> = (0..triangles.len() as TriangleId).collect();
    let sorter = Sorter::new(triangles, cube, &all);
    let list: Vec<u32> = (0..sorter.ids.len() as u32).collect();
    // Places of entries have 32 bits.
    let growth = MOST_GROWTH.min((u32::MAX / list.len().max(1) as u32) as f32);
    let root = sorter.grid(everything, &list, Depth { level: 0, growth });
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
    let root = sorter.grid(extent, &list, Depth { level: 1, growth: MOST_GROWTH })?;
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
    /// The lists of its voxels that are not divided, one after another, and where each ends.
    lists: Vec<u32>,
    ends: Vec<u32>,
    /// The grids in those that are.
    inside: Vec<Grid>,
}

/// The triangles of a list, by voxel.
struct Sorted {
    list: Vec<u32>,
    /// The voxels that hold any, and where the part of each ends.
    voxels: Vec<(u32, usize)>,
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

    /// The grid of what a voxel holds; `None` if it gains too little.
    fn grid(&self, voxel: Extent, list: &[u32], depth: Depth) -> Option<Grid> {
        let padding = self.cube.padding;
        let boxes = list.iter().map(|&index| Extent::of(&self.corners[index as usize]));
        let tight = boxes.reduce(Extent::union)?;
        let bounds = Extent {
            low: tight.low.max(voxel.low) - padding,
            high: tight.high.min(voxel.high) + padding,
        };
        let mut lattice = Lattice::over(bounds, list.len(), padding);
        let Sorted { list: mut sorted, mut voxels } = self.sort(&lattice, list);
        let mut growth = sorted.len() as f32 / list.len() as f32;
        if depth.level == 0 {
            // There must be an outermost grid, if only of one voxel.
            if growth > depth.growth {
                lattice = Lattice::over(bounds, 1, padding);
                (sorted, voxels, growth) = (list.to_vec(), vec![(0, list.len())], 1.0);
            }
        } else {
            let ends = voxels.iter().map(|&(_, end)| end);
            let starts = std::iter::once(0).chain(ends.clone());
            let left: f32 = starts.zip(ends).map(|(start, end)| tests(end - start)).sum();
            let pays = lattice.share() * left + GRID_COST < tests(list.len());
            let too_small = lattice.side.max_element() < FEWEST_PADDINGS * padding;
            if !pays || too_small || growth > depth.growth {
                return None;
            }
        }
        let depth = Depth { level: depth.level + 1, growth: depth.growth / growth };
        let parts: Vec<(u32, &[u32])> = voxels
            .iter()
            .scan(0, |start, &(voxel, end)| {
                let part = (voxel, &sorted[*start..end]);
                *start = end;
                Some(part)
            })
            .collect();
        let divide = |&(voxel, part): &(u32, &[u32])| {
            let crowded = part.len() > FEW && depth.level < MOST_DEPTH;
            crowded.then(|| self.grid(lattice.extent(voxel), part, depth)).flatten()
        };
        let divided: Vec<Option<Grid>> = if list.len() > WORTH_A_THREAD {
            parts.par_iter().map(divide).collect()
        } else {
            parts.iter().map(divide).collect()
        };
        let node = Node { min: lattice.min, side: lattice.side, ..Node::default() };
        let mut grid = Grid { node, lists: Vec::new(), ends: Vec::new(), inside: Vec::new() };
        for ((voxel, part), inside) in parts.into_iter().zip(divided) {
            grid.add(voxel, part, inside);
        }
        Some(grid)
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
        let mut sorted = vec![0; total];
        for (&index, &voxels) in list.iter().zip(&voxels) {
            for voxel in ones(voxels) {
                sorted[ends[voxel]] = index;
                ends[voxel] += 1;
            }
        }
        let occupied = (0..64).filter(|&voxel| counts[voxel] > 0);
        Sorted { list: sorted, voxels: occupied.map(|voxel| (voxel as u32, ends[voxel])).collect() }
    }

    /// Puts the grids side by side.
    fn finish(self, root: Option<Grid>) -> NestedGrid {
        let mut grid = NestedGrid {
            cube: self.cube,
            nodes: Vec::new(),
            starts: Vec::new(),
            order: Vec::new(),
        };
        if let Some(root) = root {
            grid.nodes.push(Node::default());
            self.put(root, 0, &mut grid);
        }
        grid.starts.push(end_of(&grid.order));
        grid.nodes.shrink_to_fit();
        grid.starts.shrink_to_fit();
        grid.order.shrink_to_fit();
        grid
    }

    fn put(
        &self,
        Grid { mut node, lists, ends, inside }: Grid,
        place: usize,
        grid: &mut NestedGrid,
    ) {
        let first = grid.nodes.len();
        node.first_node = first as u32;
        node.first_list = grid.starts.len() as u32;
        grid.nodes[place] = node;
        let before = end_of(&grid.order);
        let starts = std::iter::once(0).chain(ends).take(node.list_count());
        grid.starts.extend(starts.map(|start| before + start));
        grid.order.extend(lists.into_iter().map(|index| self.ids[index as usize]));
        grid.nodes.resize(first + inside.len(), Node::default());
        for (number, inside) in inside.into_iter().enumerate() {
            self.put(inside, first + number, grid);
        }
    }
}

impl Grid {
    fn add(&mut self, voxel: u32, list: &[u32], inside: Option<Grid>) {
        self.node.occupied |= 1 << voxel;
        if let Some(inside) = inside {
            self.node.divided |= 1 << voxel;
            self.inside.push(inside);
        } else {
            self.lists.extend_from_slice(list);
            self.ends.push(self.lists.len() as u32);
        }
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
