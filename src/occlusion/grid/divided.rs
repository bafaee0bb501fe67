//! The uniform grid whose crowded voxels hold grids of their own: from the beginning, or from when a ray first comes to one
//! (Jevans & Wyvill 1989).
//!
//! For whoever asks for a resolution, and for scenes of which rays come to a small part: what no ray comes to
//! is never divided. Loses to the grid that is nested from the scene's box down: empty voxels are stepped
//! through, a voxel's grid is found through a cell of its own, and the lists inside are no runs of one
//! order. So a cache of voxels remembers the outer voxel, if it is not too large, and else none.
//!
//! Sound under threads: a voxel's cell is written once, and whoever comes while another thread divides
//! it waits. Nobody waits for ever, for a thread that divides a voxel for a ray does so alone. Were it to share the work
//! out, it would take in other work while it waits for the others, and that may be a ray that comes to the same voxel, or to
//! one whose thread waits for this one. What a voxel is divided into depends on its triangles alone, so it does not
//! matter which ray comes first, unless memory runs out: then voxels stay as they are. Exact for the reasons that
//! the other grids are.
//!
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use super::nested::Threads;
use super::{Grid, GridError, GridOptions, NestedGrid, Steps};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::brute::visit_all;
use crate::occlusion::clip::Clip;
use crate::occlusion::{Cell, Eight, Visit, Walk};

/// A voxel with more triangles than this is divided.
const CROWDED: usize = 16;

/// A divided voxel with more triangles than this is not remembered: testing all would cost more than a walk.
const MOST_REMEMBERED: u32 = 64;

/// The grid of a crowded voxel, when it is known whether dividing it gains anything.
type Inside = OnceLock<Option<Box<NestedGrid>>>;

/// A uniform grid over the triangles' box, and grids in its crowded voxels.
pub struct DividedGrid {
    triangles: Arc<Triangles>,
    outer: Grid,
    /// By list of the outer grid.
    insides: Box<[Inside]>,
    /// Bytes that voxels may still be divided for.
    left: AtomicU64,
}

impl DividedGrid {
    /// Sorts the triangles into voxels, in parallel; divides those that are crowded, unless the options say that it is to
    /// be done when rays come.
    ///
    /// # Errors
    /// If a resolution is asked for with which there would be too many voxels or entries.
    pub fn new(triangles: &Arc<Triangles>, options: GridOptions) -> Result<Self, GridError> {
        let outer = Grid::of_resolution(triangles, GridOptions { nested: true, ..options })?;
        let insides: Box<[Inside]> = (0..outer.list_count()).map(|_| OnceLock::new()).collect();
        let held = (outer.memory() + size_of_val(&*insides)) as u64;
        let most = if options.lazy { options.most_bytes } else { None };
        let left = AtomicU64::new(most.unwrap_or(u64::MAX).saturating_sub(held));
        let grid = Self { triangles: triangles.clone(), outer, insides, left };
        if !options.lazy {
            (0..grid.outer.voxel_count()).into_par_iter().for_each(|voxel| {
                let triangles = grid.listed(voxel);
                if let Some(list) = grid.outer.list_of(voxel)
                    && triangles.len() > CROWDED
                {
                    // Outside of the cell, which no ray comes to yet: so threads may help each other.
                    let inside = grid.divide(voxel, triangles, Threads::Many);
                    let _ = grid.insides[list].set(inside);
                }
            });
        }
        Ok(grid)
    }

    /// Number of voxels that were divided so far.
    #[must_use]
    pub fn divided_count(&self) -> usize {
        self.divided().count()
    }

    fn divided(&self) -> impl Iterator<Item = &NestedGrid> {
        self.insides.iter().filter_map(|inside| inside.get()?.as_deref())
    }

    #[inline(always)]
    fn listed(&self, voxel: usize) -> &[TriangleId] {
        let cell = self.outer.listed(voxel);
        &self.order()[cell.start as usize..cell.end as usize]
    }

    /// The grid of a voxel, which is made now if it is the first time.
    #[inline(always)]
    fn inside(&self, voxel: usize, list: usize, triangles: &[TriangleId]) -> Option<&NestedGrid> {
        if triangles.len() <= CROWDED {
            return None;
        }
        self.insides[list].get_or_init(|| self.divide(voxel, triangles, Threads::One)).as_deref()
    }

    #[cold]
    fn divide(
        &self,
        voxel: usize,
        triangles: &[TriangleId],
        threads: Threads,
    ) -> Option<Box<NestedGrid>> {
        let level = self.outer.level();
        let [width, height, _] = level.resolution.map(|n| n as usize);
        let place = [voxel % width, voxel / width % height, voxel / (width * height)];
        // The walk around may err as much as the padding allows.
        let low = level.corner(place.map(|n| n as u32)) - level.pad;
        let high = low + level.side + DVec3::splat(2.0 * level.pad);
        let grid = NestedGrid::within(&self.triangles, triangles, low, high, threads)?;
        let bytes = bytes_of(&grid) as u64;
        let without = |left: u64| left.checked_sub(bytes);
        self.left.fetch_update(Relaxed, Relaxed, without).is_ok().then(|| Box::new(grid))
    }
}

fn bytes_of(grid: &NestedGrid) -> usize {
    size_of::<NestedGrid>() + grid.memory()
}

impl Walk for DividedGrid {
    // What is not asked is not divided.
    const APART: bool = false;

    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        let (enter, leave) = match self.outer.clip(ray) {
            Clip::Outside => return,
            Clip::Everything => return visit_all(self.order(), 8, visitor),
            Clip::Inside(enter, leave) => (enter, leave),
        };
        for step in Steps::new(self.outer.level(), ray, enter, leave) {
            if let Some(list) = self.outer.list_of(step.index) {
                let cell = self.outer.listed(step.index);
                let triangles = self.listed(step.index);
                let visited = match self.inside(step.index, list, triangles) {
                    None => visitor.visit(cell, triangles),
                    Some(grid) => {
                        let mut parts = Parts::of(cell, visitor);
                        grid.walk::<L, _>(ray, &mut parts);
                        parts.visited
                    }
                };
                if visited.is_break() {
                    return;
                }
            }
            if step.leave > f64::from(visitor.end()) {
                return;
            }
        }
    }

    fn order(&self) -> &[TriangleId] {
        self.outer.order()
    }

    fn memory(&self) -> usize {
        let divided: usize = self.divided().map(bytes_of).sum();
        self.outer.memory() + size_of_val(&*self.insides) + divided
    }
}

/// Shows the visitor parts of one outer voxel.
struct Parts<'v, V: ?Sized> {
    cell: Cell,
    visitor: &'v mut V,
    visited: ControlFlow<()>,
}

impl<'v, V: Visit + ?Sized> Parts<'v, V> {
    fn of(cell: Cell, visitor: &'v mut V) -> Self {
        let few = cell.end - cell.start <= MOST_REMEMBERED;
        Self {
            cell: if few { cell } else { Cell::NOWHERE },
            visitor,
            visited: ControlFlow::Continue(()),
        }
    }
}

impl<V: Visit + ?Sized> Visit for Parts<'_, V> {
    #[inline(always)]
    fn visit(&mut self, _: Cell, triangles: &[TriangleId]) -> ControlFlow<()> {
        self.visited = self.visitor.visit(self.cell, triangles);
        self.visited
    }

    #[inline(always)]
    fn visit_eight(&mut self, _: Cell, triangles: &[TriangleId], eight: &Eight) -> ControlFlow<()> {
        self.visited = self.visitor.visit_eight(self.cell, triangles, eight);
        self.visited
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.visitor.end()
    }

    #[inline(always)]
    fn is_ordered(&self) -> bool {
        self.visitor.is_ordered()
    }
}
