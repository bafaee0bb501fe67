//! Grids within grids: every crowded voxel holds a grid of its own, of at most 4×4×4 voxels, fitted to what it
//! holds.
//!
//! A recursive grid (Jevans & Wyvill 1989) with small grids. Where the ray goes is not stepped through: what
//! the voxels hold, lists and grids, has boxes, fitted to what of it is in the voxel, and they are tested sixteen at once (`group`).
//! So empty space costs nothing, and a grid about as much as a node of a wide BVH; yet voxels are disjoint,
//! as the paper's caches want them. Where a list is long, its eights of triangles have a box each.
//!
//! Wins over a uniform grid wherever detail is uneven, which is everywhere: 3 to 10 times, and it is smaller. Loses to
//! Embree's BVH, which lists each triangle once and so can afford to store eights side by side.
//!
//! **Exact,** because nothing is lost. All of it lives in the unit cube of the scene, in f32. Triangles are listed in all
//! voxels within `padding` of them, which is [`MISPLACED`] and what a test may err by ([slack](Triangles::slack)); a box reaches beyond
//! its triangles by as much, and beyond its voxel by twice that. So where the ray comes within the slack of a triangle, that point of
//! the ray is in a voxel that lists it and inside of its box by [`MISPLACED`] at least, and the walk misplaces it by less. In units of
//! u = 2⁻²⁴ and of the cube's side:
//!
//! | error of a place | bound |
//! | --- | --- |
//! | origin: difference, scale, product, of magnitudes up to 1.5 | 4.5 u |
//! | direction: scale, product, its inverse | 4.5 u |
//! | plane of a box and origin, each times the inverse, rounded; their difference | 5 u |
//! | corners of the triangle, in the cube | 1 u |
//! | planes of a box: padding added twice, corner of the voxel | 4 u |
//! | which voxels a box spans, when it is sorted in | 4 u |
//!
//! Together 23 u < 2⁻¹⁹ = 32 u = [`MISPLACED`]. The test of triangle and voxel in `sort` has an allowance of its own.
//!
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.

mod build;
mod group;
mod sort;
mod walk;

use glam::{DVec3, UVec3, Vec3A};

use group::{GROUP, Group};

use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::clip::{Clip, clip};
use crate::occlusion::{Cell, Visit, VisitMany, Walk};

/// How far from its place the walk may take a point to be; see the table above.
const MISPLACED: f32 = 1.0 / (1 << 19) as f32;

/// Voxels along an axis of one grid at most: 64 in all, a bit each.
const MOST: u32 = 4;

/// Things that the voxels of one grid may hold: a bit each.
const SLOTS: usize = 64;

/// The unit cube that a scene or a part of it is mapped to.
#[derive(Clone, Copy, Debug)]
struct Cube {
    /// Its lower corner, and the inverse of its side.
    min: DVec3,
    scale: f64,
    /// The same in f32: the corner exactly.
    corner: Vec3A,
    factor: f32,
    /// The part of it that holds anything, for rays from afar.
    low: DVec3,
    high: DVec3,
    /// How far outside a voxel its triangles may be, in sides of the cube.
    padding: f32,
}

impl Cube {
    /// The cube over all of the triangles.
    fn over(triangles: &Triangles) -> Self {
        /// A scene that is one point has some side too.
        const LEAST: f64 = 1e-60;
        let (bounds, slack) = (triangles.bounds().unwrap_or_default(), triangles.slack());
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let side = (max - min).max_element().max(slack).max(LEAST);
        let scale = side.recip();
        // Rounded up: what is a little wider loses nothing.
        let padding = MISPLACED + (slack * scale * (1.0 + f64::from(f32::EPSILON))) as f32;
        let beyond = DVec3::splat(2.0 * f64::from(padding) * side);
        Self {
            min,
            scale,
            corner: Vec3A::from(bounds.min),
            factor: scale as f32,
            low: min - beyond,
            high: max + beyond,
            padding,
        }
    }

    /// A point of the scene in the cube.
    fn place(&self, point: DVec3) -> DVec3 {
        (point - self.min) * self.scale
    }
}

/// One grid: where it is, and what its voxels hold.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
struct Node {
    /// The corner with the least coordinates.
    min: Vec3A,
    /// Sides of a voxel. Voxels beyond the grid's resolution are there, outside its box, and empty.
    side: Vec3A,
    /// The first of the groups of what its voxels hold, which follow each other; likewise the first of the grids.
    first_group: u32,
    first_grid: u32,
    /// How many things its voxels hold.
    slots: u32,
    /// Which of those are grids, a bit each.
    divided: u64,
}

/// What a voxel holds.
enum Content {
    List(Cell),
    Grid(usize),
}

impl Node {
    /// The groups of what its voxels hold.
    #[inline(always)]
    fn groups(&self) -> std::ops::Range<usize> {
        let first = self.first_group as usize;
        first..first + (self.slots as usize).div_ceil(GROUP)
    }

    /// The voxel that holds a point; the nearest one for a point outside.
    fn voxel_of(&self, point: Vec3A) -> u32 {
        let most = Vec3A::splat((MOST - 1) as f32);
        let place = ((point - self.min) / self.side).clamp(Vec3A::ZERO, most).as_uvec3();
        place.dot(UVec3::new(1, MOST, MOST * MOST))
    }
}

/// Grids within grids over the triangles' box.
pub struct NestedGrid {
    cube: Cube,
    /// The outermost grid first; none if there is nothing in it.
    nodes: Vec<Node>,
    groups: Vec<Group>,
    order: Vec<TriangleId>,
}

impl NestedGrid {
    /// Sorts the triangles into voxels, in parallel. Without triangles, it is a grid of nothing.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        build::build(triangles)
    }

    /// The same for some of the triangles, and only where they are in a box; `None` if that would gain nothing over
    /// testing all of them.
    pub(super) fn within(
        triangles: &Triangles,
        list: &[TriangleId],
        low: DVec3,
        high: DVec3,
    ) -> Option<Self> {
        build::divide(triangles, list, low, high)
    }

    /// Number of grids.
    #[must_use]
    pub fn grid_count(&self) -> usize {
        self.nodes.len()
    }

    /// A corner of a voxel of one of the grids, from 0 to 4 along each axis.
    ///
    /// # Panics
    /// If there is no such grid.
    #[must_use]
    pub fn corner(&self, grid: usize, corner: [u32; 3]) -> DVec3 {
        let Node { min, side, .. } = self.nodes[grid];
        let place = min + side * UVec3::from(corner).as_vec3a();
        self.cube.min + place.as_dvec3() / self.cube.scale
    }

    /// The innermost voxel that holds a point of the scene's box; the nearest one for a point outside.
    #[must_use]
    pub fn cell_at(&self, point: DVec3) -> Cell {
        let point = self.cube.place(point).as_vec3a();
        let mut node = self.nodes.first();
        while let Some(grid) = node {
            let voxel = grid.voxel_of(point);
            let held = |&slot: &usize| self.group_of(grid, slot).voxel(slot % GROUP) == voxel;
            // The eights of a list follow each other.
            let mut slots = (0..grid.slots as usize).filter(held);
            match slots.next().map(|slot| self.content(grid, slot)) {
                None => break,
                Some(Content::Grid(inside)) => node = self.nodes.get(inside),
                Some(Content::List(first)) => {
                    let last = slots.next_back().map(|slot| self.content(grid, slot));
                    return match last {
                        Some(Content::List(last)) => Cell { end: last.end, ..first },
                        _ => first,
                    };
                }
            }
        }
        Cell::default()
    }

    /// The group that something is in.
    #[inline(always)]
    fn group_of(&self, node: &Node, slot: usize) -> &Group {
        &self.groups[node.first_group as usize + slot / GROUP]
    }

    /// What voxels hold, by its number.
    #[inline(always)]
    fn content(&self, node: &Node, slot: usize) -> Content {
        let bit = 1u64 << slot;
        if node.divided & bit != 0 {
            let before = (node.divided & (bit - 1)).count_ones();
            Content::Grid((node.first_grid + before) as usize)
        } else {
            Content::List(self.group_of(node, slot).list(slot % GROUP))
        }
    }

    /// The part of a ray that is in the cube.
    fn clip(&self, ray: &Ray) -> Clip {
        clip(ray, self.cube.low, self.cube.high)
    }
}

impl Walk for NestedGrid {
    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        walk::walk::<L, V>(self, ray, visitor);
    }

    #[inline(always)]
    fn walk_many<L: Lanes, V: VisitMany>(&self, rays: &[Ray], visitors: &mut V) {
        walk::walk_many::<L, V>(self, rays, visitors);
    }

    fn order(&self) -> &[TriangleId] {
        &self.order
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.groups) + size_of_val(&*self.order)
    }
}
