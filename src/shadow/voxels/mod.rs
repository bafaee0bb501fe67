//! Voxels, and what can be proven about all rays from one of them to a light: the ground of
//! `voxel-occlusion` and `shadow-polygons`.

mod neighbours;
mod shaft;
mod source;

use std::sync::Arc;

use glam::DVec3;

pub(super) use neighbours::{Neighbours, edge};
pub(super) use shaft::{Facing, Shaft, widened};
pub(super) use source::Source;

use super::Budget;
use crate::exact::Exact;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::{Clip, Engine, Grid, GridOptions, Level, Occlusion, Steps, Tally, Walk};

/// A closed box in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub low: DVec3,
    pub high: DVec3,
}

impl Span {
    #[inline]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }
}

/// Bytes of a grid for each of its voxels, and for each triangle in its lists, about.
const VOXEL_BYTES: f64 = 8.0;
const LISTED_BYTES: f64 = 8.0;

/// A uniform grid of its own, whatever the backend; answers by the exact test.
pub(super) struct Voxels {
    triangles: Arc<Triangles>,
    grid: Arc<Grid>,
    exact: Engine<Arc<Grid>, Exact>,
}

impl Voxels {
    /// A grid with `density` voxels to a triangle, or coarser where the budget does not allow for it and
    /// another `bytes_a_voxel`, which are all taken from the budget. `None` where that leaves too few.
    /// Also says whether it had to be coarser.
    fn within(
        triangles: &Arc<Triangles>,
        density: f64,
        bytes_a_voxel: f64,
        budget: &Budget,
    ) -> Option<(Self, bool)> {
        let wanted = wanted(triangles, density);
        let mut voxels = wanted;
        while voxels >= FEWEST {
            // A grid that will not fit need not be tried.
            if Self::bytes(triangles, voxels, bytes_a_voxel) <= budget.left() as f64 {
                let options = GridOptions::uniform(triangles, voxels as usize);
                let grid = Grid::new(triangles, options);
                let held = (grid.voxel_count() as f64 * bytes_a_voxel) as usize;
                if budget.take(grid.memory() + held) {
                    return Some((Self::over(triangles, grid), voxels < wanted));
                }
            }
            voxels /= COARSER;
        }
        None
    }

    /// Bytes of so many voxels, at least.
    fn bytes(triangles: &Triangles, voxels: f64, bytes_a_voxel: f64) -> f64 {
        voxels * (VOXEL_BYTES + bytes_a_voxel) + triangles.len() as f64 * LISTED_BYTES
    }

    /// The same, and which triangles lie beyond whose edges; says in `notes` what the budget does not allow.
    pub fn with_neighbours(
        triangles: &Arc<Triangles>,
        density: f64,
        bytes_a_voxel: f64,
        budget: &Budget,
        notes: &mut Vec<String>,
    ) -> Option<(Self, Neighbours)> {
        let bytes = Neighbours::bytes(triangles);
        let left = budget.left();
        if budget.take(bytes) {
            if let Some((voxels, coarser)) = Self::within(triangles, density, bytes_a_voxel, budget)
            {
                if coarser {
                    let [x, y, z] = voxels.level().resolution;
                    let wanted = Self::bytes(triangles, wanted(triangles, density), bytes_a_voxel);
                    let advice =
                        budget.advice((wanted as u64).saturating_sub(voxels.memory() as u64));
                    notes.push(format!(
                        "{x} by {y} by {z} voxels only, to keep the memory limit; {advice}"
                    ));
                }
                return Some((voxels, Neighbours::new(triangles)));
            }
            budget.give_back(bytes);
        }
        let wanted = Self::bytes(triangles, wanted(triangles, density), bytes_a_voxel);
        let advice = budget.advice(bytes as u64 + wanted as u64);
        notes.push(format!(
            "steps aside: the memory limit leaves {left} bytes, too few for voxels; {advice}"
        ));
        None
    }

    fn over(triangles: &Arc<Triangles>, grid: Grid) -> Self {
        let grid = Arc::new(grid);
        let exact = Engine::new(triangles.clone(), grid.clone(), None);
        Self { triangles: triangles.clone(), grid, exact }
    }

    pub fn count(&self) -> usize {
        self.grid.voxel_count()
    }

    pub fn level(&self) -> &Level {
        self.grid.level()
    }

    pub fn memory(&self) -> usize {
        self.grid.memory()
    }

    /// A voxel with all that a ray said to be in it may touch.
    pub fn span(&self, voxel: [u32; 3]) -> Span {
        let level = self.level();
        let low = level.corner(voxel);
        Span { low: low - level.pad, high: low + level.side + level.pad }
    }

    /// The opaque triangles that come near a voxel, in ascending order.
    pub fn opaque_in(&self, index: usize) -> &[TriangleId] {
        let cell = self.grid.listed(index);
        let all = &self.grid.order()[cell.start as usize..cell.end as usize];
        &all[..all.partition_point(|&id| self.triangles.is_opaque(id))]
    }

    pub fn corners(&self, id: TriangleId) -> [DVec3; 3] {
        widened(self.triangles.get(id))
    }

    /// The voxels along a ray; `None` for one from too far away to say.
    #[inline]
    pub fn steps(&self, ray: &Ray) -> Option<Steps<'_>> {
        match self.grid.clip(ray) {
            Clip::Inside(enter, leave) => Some(Steps::new(self.level(), ray, enter, leave)),
            Clip::Outside | Clip::Everything => None,
        }
    }

    /// Whether an opaque triangle that is listed in a voxel blocks the ray, wherever.
    #[inline]
    pub fn blocked_in(&self, index: usize, ray: &Ray, tally: &mut Tally) -> bool {
        let cell = self.grid.listed(index);
        cell.start < cell.end && self.exact.occluder_in(cell, ray, tally).is_some()
    }

    /// A triangle that blocks the ray.
    pub fn occluder(&self, ray: &Ray, tally: &mut Tally) -> Option<TriangleId> {
        self.exact.occluder(ray, tally).map(|found| found.triangle)
    }
}

/// With fewer voxels than this, nothing is worth preparing.
const FEWEST: f64 = 64.0;

/// Voxels of a grid with so many to a triangle.
fn wanted(triangles: &Triangles, density: f64) -> f64 {
    (density * triangles.len() as f64).clamp(FEWEST, MOST)
}

/// Most voxels of a grid: what is decided a voxel would take longer than rays could win back.
const MOST: f64 = (1 << 21) as f64;

/// How many times fewer voxels the next coarser grid has.
const COARSER: f64 = 8.0;
