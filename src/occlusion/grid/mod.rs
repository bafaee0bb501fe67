//! The grid: voxels with lists of triangles, walked in order along the ray.
//!
//! A uniform grid is fast to build, and its voxels are the neighbourhoods that the paper's caches
//! remember; but one resolution cannot serve a scene with uneven detail. So a voxel that is crowded is
//! divided by a grid of its own, and so on (adaptive voxel subdivision, Jevans & Wyvill 1989), unless a
//! plain uniform grid is asked for.
//!
//! Exact, because nothing is lost: a triangle is listed in every voxel that it comes within
//! [`PADDING`] of a voxel's side of (`voxelize`), and the walk errs by much less (`walk`): wherever
//! rounding makes it pass a corner on the wrong side, the voxel it takes instead lists the triangle too.
//!
//! Fujimoto, Tanaka, Iwata: ARTS: Accelerated Ray-Tracing System. IEEE CG&A 6(4), 1986.
//! Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing. Eurographics 1987.
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.

mod build;
mod lazy;
mod level;
mod steps;
mod voxelize;
mod walk;

use glam::DVec3;
pub use lazy::LazyGrid;
use level::Content;
pub(crate) use level::Level;
pub(crate) use steps::Steps;

use super::clip::{Clip, clip, padding};
use super::{Cell, Visit, Walk};
use crate::geometry::{Ray, TriangleId, Triangles};

/// How far outside a voxel its triangles may be, as a part of its side.
const PADDING: f64 = 1.0 / 1024.0;

/// Voxels to a triangle of a plain uniform grid, where nothing else is asked for.
const UNIFORM_DENSITY: f64 = 4.0;

/// Voxels to a triangle of the outermost grid where crowded voxels are divided.
const NESTED_DENSITY: f64 = 0.5;

/// Voxels that a triangle may lie in, on average: where many large triangles lie on each other there would be
/// more, and the grid is made coarser until there are not.
const MOST_ENTRIES: usize = 64;

/// Most voxels along one axis.
const MOST_VOXELS: f64 = 1024.0;

/// How finely the grid divides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridOptions {
    /// Voxels along x, y and z of the outermost grid; if none are given, a number that suits the number
    /// of triangles, as near to cubes as the scene's box allows.
    pub resolution: Option<[u32; 3]>,
    /// Whether crowded voxels are divided.
    pub nested: bool,
    /// Whether they are so only when a ray first comes to them.
    pub lazy: bool,
    /// Bytes beyond which none is divided any more when a ray comes to it.
    pub most_bytes: Option<u64>,
}

impl Default for GridOptions {
    fn default() -> Self {
        Self { resolution: None, nested: true, lazy: false, most_bytes: None }
    }
}

impl GridOptions {
    /// A plain uniform grid of about so many voxels, as near to cubes as the box of the triangles allows.
    #[must_use]
    pub fn uniform(triangles: &Triangles, voxels: usize) -> Self {
        let bounds = triangles.bounds().unwrap_or_default();
        let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
        let resolution = Some(resolution(extent, voxels as f64));
        Self { resolution, nested: false, ..Self::default() }
    }
}

/// A grid over the triangles' box, and grids in its crowded voxels.
pub struct Grid {
    min: DVec3,
    max: DVec3,
    /// The outermost grid first.
    levels: Vec<Level>,
    /// The voxels of all levels.
    voxels: Vec<Content>,
    /// Where in `order` each list starts; one more than there are lists.
    starts: Vec<u32>,
    order: Vec<TriangleId>,
}

impl Grid {
    /// Sorts the triangles into voxels, in parallel. Without triangles, it is a grid of nothing.
    #[must_use]
    pub fn new(triangles: &Triangles, options: GridOptions) -> Self {
        let density = if options.nested { NESTED_DENSITY } else { UNIFORM_DENSITY };
        Self::fitting(triangles, options.resolution, density, options.nested)
    }

    /// The outermost grid alone of one whose crowded voxels are to be divided.
    fn undivided(triangles: &Triangles, resolution: Option<[u32; 3]>) -> Self {
        Self::fitting(triangles, resolution, NESTED_DENSITY, false)
    }

    /// A grid of the given resolution or with `density` voxels to a triangle; coarser if there were too many entries.
    fn fitting(
        triangles: &Triangles,
        mut resolution: Option<[u32; 3]>,
        density: f64,
        nested: bool,
    ) -> Self {
        // What was asked for is kept as long as places fit their 32 bits.
        let most =
            if resolution.is_some() { u32::MAX as usize } else { MOST_ENTRIES * triangles.len() };
        loop {
            let outermost = Self::place(triangles, resolution, density);
            match build::build(triangles, outermost, nested, most) {
                Ok(grid) => return grid,
                Err(build::TooFine(tried)) => resolution = Some(tried.map(|n| n.div_ceil(2))),
            }
        }
    }

    /// Where an outermost grid is, of the given resolution or with `density` voxels to a triangle.
    fn place(triangles: &Triangles, resolution: Option<[u32; 3]>, density: f64) -> Level {
        let bounds = triangles.bounds().unwrap_or_default();
        let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
        // A flat scene gets a box with some depth, so that a voxel has a volume.
        let thickness = padding(&bounds, extent.max_element() * PADDING / MOST_VOXELS);
        let (min, max) = (bounds.min.as_dvec3() - thickness, bounds.max.as_dvec3() + thickness);
        let resolution = match resolution {
            Some(resolution) => resolution.map(|n| n.clamp(1, MOST_VOXELS as u32)),
            None => self::resolution(max - min, density * triangles.len() as f64),
        };
        Level::new(min, max, resolution, &bounds)
    }

    /// Voxels along x, y and z of the outermost grid.
    #[must_use]
    pub fn resolution(&self) -> [u32; 3] {
        self.levels[0].resolution
    }

    /// The corner of a voxel of the outermost grid with the least coordinates.
    #[must_use]
    pub fn corner(&self, voxel: [u32; 3]) -> DVec3 {
        self.levels[0].corner(voxel)
    }

    /// Number of voxels, those of nested grids included.
    #[must_use]
    pub fn voxel_count(&self) -> usize {
        self.voxels.len()
    }

    /// Number of grids: one, and those in crowded voxels.
    #[must_use]
    pub fn grid_count(&self) -> usize {
        self.levels.len()
    }

    /// The innermost voxel that holds a point of the scene's box; the nearest one for a point outside.
    #[must_use]
    pub fn cell_at(&self, point: DVec3) -> Cell {
        let mut level = &self.levels[0];
        loop {
            let content = self.voxels[level.index(level.voxel_of(point))];
            match content.nested() {
                Some(nested) => level = &self.levels[nested],
                None => return self.cell(content),
            }
        }
    }

    /// Where the voxels of the outermost grid are.
    pub(crate) fn outermost(&self) -> &Level {
        &self.levels[0]
    }

    /// What an outermost voxel that is not divided lists; opaque triangles first, in ascending order.
    #[inline(always)]
    pub(crate) fn listed(&self, index: usize) -> Cell {
        self.cell(self.voxels[index])
    }

    /// Number of lists.
    fn list_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of the list of an outermost voxel, if it holds anything and is not divided.
    #[inline(always)]
    fn list_of(&self, index: usize) -> Option<usize> {
        self.voxels[index].list()
    }

    /// The part of a ray that is in the grid.
    #[inline]
    pub(crate) fn clip(&self, ray: &Ray) -> Clip {
        clip(ray, self.min, self.max)
    }

    /// The list of a voxel that is not divided.
    #[inline(always)]
    fn cell(&self, content: Content) -> Cell {
        match content.list() {
            Some(list) => Cell { start: self.starts[list], end: self.starts[list + 1] },
            None => Cell::default(),
        }
    }
}

impl Walk for Grid {
    #[inline(always)]
    fn walk<V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        walk::walk(self, ray, visitor);
    }

    fn order(&self) -> &[TriangleId] {
        &self.order
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.levels)
            + size_of_val(&*self.voxels)
            + size_of_val(&*self.starts)
            + size_of_val(&*self.order)
    }
}

/// Voxels along each axis of a box, about as many in all as asked for.
fn resolution(extent: DVec3, voxels: f64) -> [u32; 3] {
    // Thin boxes count as this thick, so that voxels stay near cubes.
    let extent = extent.max(DVec3::splat(extent.max_element() / MOST_VOXELS));
    let per_length = (voxels / extent.element_product()).cbrt();
    (extent * per_length).to_array().map(|n| n.ceil().clamp(1.0, MOST_VOXELS) as u32)
}
