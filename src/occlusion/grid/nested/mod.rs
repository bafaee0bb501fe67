//! Grids within grids: every crowded voxel holds a grid of its own, of some 32 voxels at most, no more than
//! 4 along an axis, fitted to what it holds.
//!
//! A recursive grid (Jevans & Wyvill 1989) with small grids, and a loose one (Ulrich 2000): each triangle belongs to the one
//! voxel that its middle is in. Where the ray goes is not stepped through: what the voxels hold, eights of triangles and grids,
//! has boxes that are fitted to the triangles and may reach beyond the voxel, and they are tested sixteen at once (`group`).
//! So empty space costs nothing, a grid costs about as much as a node of a wide BVH, and as each triangle is there
//! once, eights can be stored as a vector test wants them.
//!
//! Wins over a uniform grid wherever detail is uneven, which is everywhere, and is built in half of the time
//! that Embree's BVH takes, in no more memory. Loses to it in shadow rays by a third, where many long triangles overlap by more:
//! Embree chooses where to split.
//!
//! **Exact,** because nothing is lost. All of it lives in the unit cube of the scene, in f32. A box reaches beyond its triangles by
//! the padding, which is [`MISPLACED`] and what a test may err by ([slack](Triangles::slack)). So where the ray comes within
//! the slack of a triangle, that point of the ray is inside of every box around the triangle by [`MISPLACED`] at least, and the
//! walk misplaces it by less. Where only a part of the scene is sorted, boxes end at twice the padding beyond the part. In units of
//! u = 2⁻²⁴ and of the cube's side:
//!
//! | error of a place | bound |
//! | --- | --- |
//! | origin: difference, scale, product, of magnitudes up to 1.5 | 4.5 u |
//! | direction: scale, product, its inverse | 4.5 u |
//! | plane of a box and origin, each times the inverse, rounded; their difference | 5 u |
//! | corners of the triangle, in the cube | 1 u |
//! | planes of a box: corner of the part, padding added twice | 4 u |
//!
//! Together 19 u < 2⁻¹⁹ = 32 u = [`MISPLACED`]. So it is where the slack is little beside the cube. It may be as long as the side, of a speck far
//! from where coordinates are zero: then places and planes are up to 2 and distances up to 2.5, which makes 26 u. In cubes of
//! more than 8.5e37 the scale is denormal and errs by up to 8 u: by 5 u more of a place, as it is the same for origin and
//! direction, and by 24 u in all.
//!
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.
//! Ulrich: Loose Octrees. Game Programming Gems, 2000.

mod build;
mod cut;
mod group;
mod sort;
mod walk;

use std::ops::Range;

use glam::{DVec3, UVec3, Vec3A};

use group::{GROUP, Group};

use crate::geometry::lanes::Lanes;
use crate::geometry::{Bounds, Ray, TriangleId, Triangles};
use crate::occlusion::clip::{Clip, LEAST_EXTENT, clip};
use crate::occlusion::{Cell, Eight, Visit, VisitMany, Walk};

/// How far from its place the walk may take a point to be; see the table above.
const MISPLACED: f32 = 1.0 / (1 << 19) as f32;

/// Voxels along an axis of one grid at most. Of the 64 that there are numbers for, it has some half at most (`build`).
const MOST: u32 = 4;

/// Things that the voxels of one grid may hold: a bit each.
const SLOTS: usize = 64;

/// Who sorts triangles.
#[derive(Clone, Copy, Debug)]
pub(super) enum Threads {
    /// All that there are, where lists are long. Whoever waits for the others takes in any work that it finds.
    Many,
    /// Whoever asks, and does nothing else meanwhile.
    One,
}

impl Threads {
    /// Lists of fewer are not worth a further thread.
    fn least(self) -> usize {
        match self {
            Self::Many => 4096,
            Self::One => usize::MAX,
        }
    }
}

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
    /// The cube over what is in a box; what a test may err by is that of the whole scene.
    fn over(bounds: Option<Bounds>, slack: f64) -> Self {
        let bounds = bounds.unwrap_or_default();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let side = (max - min).max_element().max(slack).max(LEAST_EXTENT);
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

/// Where the voxels of one grid are. Rays need not know.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// The corner with the least coordinates.
    min: Vec3A,
    /// Sides of a voxel. Voxels beyond the grid's resolution are there, outside its box, and empty.
    side: Vec3A,
}

/// Grids within grids over the triangles' box.
pub struct NestedGrid {
    cube: Cube,
    /// The outermost grid first; none if there is nothing in it.
    nodes: Vec<Node>,
    /// What the voxels of each grid hold, one grid after another; the outermost has the first so many.
    groups: Vec<Group>,
    outermost: usize,
    /// The triangles, eight by eight; where there are fewer, the last one is repeated.
    order: Vec<TriangleId>,
    eights: Vec<Eight>,
}

impl NestedGrid {
    /// Sorts the triangles into voxels, in parallel. Without triangles, it is a grid of nothing.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        build::build(triangles)
    }

    /// The same for some of the triangles, wherever they are.
    pub(in crate::occlusion) fn among(triangles: &Triangles, ids: Range<TriangleId>) -> Self {
        build::build_among(triangles, ids)
    }

    /// The same for some of the triangles, by one thread or many, and only where they are in a box; `None` if that
    /// would gain nothing over testing all of them.
    pub(super) fn within(
        triangles: &Triangles,
        list: &[TriangleId],
        low: DVec3,
        high: DVec3,
        threads: Threads,
    ) -> Option<Self> {
        build::divide(triangles, list, low, high, threads)
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

    /// The cell with a triangle, found by a point of it: its eight. An empty one if the point is not near the triangle.
    #[must_use]
    pub fn cell_with(&self, triangle: TriangleId, point: DVec3) -> Cell {
        let place = self.cube.place(point).as_vec3a();
        self.find(0..self.outermost, triangle, place).unwrap_or_default()
    }

    fn find(&self, groups: Range<usize>, triangle: TriangleId, place: Vec3A) -> Option<Cell> {
        let slots =
            self.groups[groups].iter().flat_map(|group| (0..GROUP).map(move |slot| (group, slot)));
        slots.filter(|(group, slot)| group.holds(*slot, place)).find_map(|(group, slot)| {
            if group.is_divided(slot) {
                return self.find(group.groups(slot), triangle, place);
            }
            let cell = group.cell(slot);
            self.listed(cell).contains(&triangle).then_some(cell)
        })
    }

    /// The triangles of an eight.
    #[inline(always)]
    fn listed(&self, cell: Cell) -> &[TriangleId] {
        &self.order[cell.start as usize..cell.end as usize]
    }

    /// The part of a ray that is in the cube.
    fn clip(&self, ray: &Ray) -> Clip {
        clip(ray, self.cube.low, self.cube.high)
    }
}

impl Walk for NestedGrid {
    const IN_PLACE: bool = true;

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
        size_of_val(&*self.nodes)
            + size_of_val(&*self.eights)
            + size_of_val(&*self.groups)
            + size_of_val(&*self.order)
    }
}
