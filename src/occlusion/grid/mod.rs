//! The uniform grid: voxels with lists of triangles, walked in order along the ray.
//!
//! Fast to build, and its voxels are the neighbourhoods that the paper's caches remember. Weak where
//! detail is uneven: one resolution serves the whole scene.
//!
//! Exact, because nothing is lost: a triangle is listed in every voxel that it comes within
//! [`PADDING`] of a voxel's side of (`voxelize`), and the walk errs by much less (`walk`): wherever
//! rounding makes it pass a corner on the wrong side, the voxel it takes instead lists the triangle too.
//!
//! Fujimoto, Tanaka, Iwata: ARTS: Accelerated Ray-Tracing System. IEEE CG&A 6(4), 1986.
//! Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing. Eurographics 1987.

mod voxelize;
mod walk;

use glam::DVec3;

use super::clip::padding;
use super::{Cell, Visit, Walk};
use crate::geometry::{Bounds, Ray, TriangleId, Triangles};

/// How far outside a voxel its triangles may be, as a part of its side.
const PADDING: f64 = 1.0 / 1024.0;

/// Voxels to a triangle, where nothing else is asked for.
const DEFAULT_DENSITY: f64 = 4.0;

/// Most voxels along one axis.
const MOST_VOXELS: f64 = 1024.0;

/// How finely the grid divides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GridOptions {
    /// About this many voxels to a triangle, as near to cubes as the scene's box allows.
    Density(f64),
    /// This many voxels along x, y and z.
    Resolution([u32; 3]),
}

impl Default for GridOptions {
    fn default() -> Self {
        Self::Density(DEFAULT_DENSITY)
    }
}

/// A uniform grid over the triangles' box.
pub struct Grid {
    /// Lower corner of voxel (0, 0, 0).
    min: DVec3,
    /// Upper corner of the last voxel.
    max: DVec3,
    /// Sides of a voxel, and their inverses.
    side: DVec3,
    inverse_side: DVec3,
    /// How far outside a voxel its triangles may be.
    pad: f64,
    resolution: [u32; 3],
    /// Where in `order` the triangles of each voxel start; one more than there are voxels.
    starts: Vec<u32>,
    order: Vec<TriangleId>,
}

impl Grid {
    /// Sorts the triangles into voxels, in parallel.
    ///
    /// # Panics
    /// Without triangles.
    #[must_use]
    pub fn new(triangles: &Triangles, options: GridOptions) -> Self {
        let bounds = triangles.bounds().expect("there are triangles");
        let resolution = resolution(&bounds, triangles.len(), options);
        let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
        // A flat scene gets a box with some depth, so that a voxel has a volume.
        let thickness = padding(&bounds, extent.max_element() * PADDING / MOST_VOXELS);
        let (min, max) = (bounds.min.as_dvec3() - thickness, bounds.max.as_dvec3() + thickness);
        let side = (max - min) / DVec3::from(resolution.map(f64::from));
        let mut grid = Self {
            min,
            max,
            side,
            inverse_side: side.recip(),
            pad: padding(&bounds, side.min_element() * PADDING),
            resolution,
            starts: Vec::new(),
            order: Vec::new(),
        };
        (grid.starts, grid.order) = voxelize::voxelize(&grid, triangles);
        grid
    }

    /// Voxels along x, y and z.
    #[must_use]
    pub fn resolution(&self) -> [u32; 3] {
        self.resolution
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxel_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The triangles of a voxel.
    #[inline(always)]
    fn cell(&self, voxel: usize) -> Cell {
        Cell { start: self.starts[voxel], end: self.starts[voxel + 1] }
    }

    /// The voxel that holds a point of the scene's box; the nearest one for a point outside.
    #[must_use]
    pub fn cell_at(&self, point: DVec3) -> Cell {
        let [x, y, z] = self.voxel_of(point);
        self.cell(self.index(x, y, z))
    }

    #[inline(always)]
    fn voxel_of(&self, point: DVec3) -> [u32; 3] {
        let place = (point - self.min) * self.inverse_side;
        std::array::from_fn(|axis| {
            // `as` saturates, and takes NaN to 0.
            (place[axis] as u32).min(self.resolution[axis] - 1)
        })
    }

    #[inline(always)]
    fn index(&self, x: u32, y: u32, z: u32) -> usize {
        let [width, height, _] = self.resolution.map(|n| n as usize);
        x as usize + width * (y as usize + height * z as usize)
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
        size_of_val(&*self.starts) + size_of_val(&*self.order)
    }
}

/// Voxels along each axis.
fn resolution(bounds: &Bounds, triangles: usize, options: GridOptions) -> [u32; 3] {
    let density = match options {
        GridOptions::Resolution(resolution) => return resolution.map(|n| n.clamp(1, 1024)),
        GridOptions::Density(density) => density,
    };
    let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    // Thin scenes count as this thick, so that voxels stay near cubes.
    let extent = extent.max(DVec3::splat(extent.max_element() / MOST_VOXELS));
    let voxels = density * triangles as f64;
    let per_length = (voxels / extent.element_product()).cbrt();
    (extent * per_length).to_array().map(|n| n.ceil().clamp(1.0, MOST_VOXELS) as u32)
}
