//! The grid whose crowded voxels are divided when a ray first comes to one (Jevans & Wyvill 1989).
//!
//! Wins where rays come to a small part of a large scene: what no ray comes to is never divided. Loses
//! to the grid that is divided beforehand where they come everywhere: a voxel's grid is found through a
//! cell of its own, and the lists inside are no runs of one order. So a cache of voxels remembers the
//! outer voxel, if it is not too large, and else none.
//!
//! Sound under threads: a voxel's cell is written once, and whoever comes while another thread divides
//! it waits. What a voxel is divided into depends on its triangles alone, so it does not matter which
//! ray comes first, unless memory runs out: then voxels stay as they are. Exact for the reasons that the other
//! grid is.
//!
//! Jevans, Wyvill: Adaptive Voxel Subdivision for Ray Tracing. Graphics Interface 1989.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

use super::build::{CROWDED, divide};
use super::walk::walk;
use super::{Grid, GridOptions, Steps};
use crate::geometry::{Bounds, Ray, TriangleId, Triangles};
use crate::occlusion::brute::visit_all;
use crate::occlusion::clip::Clip;
use crate::occlusion::{Cell, Visit, Walk};

/// A divided voxel with more triangles than this is not remembered: testing all would cost more than a walk.
const MOST_REMEMBERED: u32 = 64;

/// What is named instead: a cell that no order has, so that a memory takes it for none, and that no cell
/// holds, so that a mailbox never takes it for tested.
const NO_CELL: Cell = Cell { start: 0, end: u32::MAX };

/// The grid of a crowded voxel, when it is known whether dividing it gains anything.
type Inside = OnceLock<Option<Box<Grid>>>;

/// A grid over the triangles' box, and grids in those of its crowded voxels that rays come to.
pub struct LazyGrid {
    triangles: Arc<Triangles>,
    scene: Bounds,
    outer: Grid,
    /// By list of the outer grid.
    insides: Box<[Inside]>,
    /// Bytes that voxels may still be divided for.
    left: AtomicU64,
}

impl LazyGrid {
    /// Sorts the triangles into voxels, in parallel; divides none.
    #[must_use]
    pub fn new(triangles: &Arc<Triangles>, options: GridOptions) -> Self {
        let outer = Grid::undivided(triangles, options.resolution);
        let insides: Box<[Inside]> = (0..outer.list_count()).map(|_| OnceLock::new()).collect();
        let held = (outer.memory() + size_of_val(&*insides)) as u64;
        let left = AtomicU64::new(options.most_bytes.unwrap_or(u64::MAX).saturating_sub(held));
        let scene = triangles.bounds().unwrap_or_default();
        Self { triangles: triangles.clone(), scene, outer, insides, left }
    }

    /// Number of voxels that were divided so far.
    #[must_use]
    pub fn divided_count(&self) -> usize {
        self.divided().count()
    }

    fn divided(&self) -> impl Iterator<Item = &Grid> {
        self.insides.iter().filter_map(|inside| inside.get()?.as_deref())
    }

    /// The grid of a voxel, which is made now if it is the first time.
    #[inline(always)]
    fn inside(&self, index: usize, list: usize, triangles: &[TriangleId]) -> Option<&Grid> {
        if triangles.len() <= CROWDED {
            return None;
        }
        let make = || {
            let outer = self.outer.outermost();
            let grid = divide(&self.triangles, self.scene, outer, index, triangles)?;
            let bytes = bytes_of(&grid) as u64;
            let without = |left: u64| left.checked_sub(bytes);
            self.left.fetch_update(Relaxed, Relaxed, without).is_ok().then(|| Box::new(grid))
        };
        self.insides[list].get_or_init(make).as_deref()
    }
}

fn bytes_of(grid: &Grid) -> usize {
    size_of::<Grid>() + grid.memory()
}

impl Walk for LazyGrid {
    #[inline(always)]
    fn walk<V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        let order = self.order();
        let (enter, leave) = match self.outer.clip(ray) {
            Clip::Outside => return,
            Clip::Everything => return visit_all(order, 8, visitor),
            Clip::Inside(enter, leave) => (enter, leave),
        };
        for step in Steps::new(self.outer.outermost(), ray, enter, leave) {
            if let Some(list) = self.outer.list_of(step.index) {
                let cell = self.outer.listed(step.index);
                let triangles = &order[cell.start as usize..cell.end as usize];
                let visited = match self.inside(step.index, list, triangles) {
                    None => visitor.visit(cell, triangles),
                    Some(grid) => {
                        let mut parts = Parts::of(cell, visitor);
                        walk(grid, ray, &mut parts);
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
        Self { cell: if few { cell } else { NO_CELL }, visitor, visited: ControlFlow::Continue(()) }
    }
}

impl<V: Visit + ?Sized> Visit for Parts<'_, V> {
    #[inline(always)]
    fn visit(&mut self, _: Cell, triangles: &[TriangleId]) -> ControlFlow<()> {
        self.visited = self.visitor.visit(self.cell, triangles);
        self.visited
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.visitor.end()
    }
}
