//! Cells for an engine that shows no leaves: those of a grid beside it.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::{Cell, NestedGrid, Visit, Walk};

/// A grid that is built when a cell is first asked for, and not otherwise: it takes as long as a good part of Embree's own structure.
pub(super) struct Cells {
    triangles: Arc<Triangles>,
    grid: OnceLock<NestedGrid>,
}

impl Cells {
    pub fn new(triangles: Arc<Triangles>) -> Self {
        Self { triangles, grid: OnceLock::new() }
    }

    pub fn are_there(&self) -> bool {
        self.grid.get().is_some()
    }

    /// The cell of a triangle at a point of it; an empty one while nobody has asked for cells.
    pub fn at(&self, triangle: TriangleId, point: DVec3) -> Cell {
        self.grid.get().map_or_else(Cell::default, |grid| grid.cell_with(triangle, point))
    }

    fn grid(&self) -> &NestedGrid {
        self.grid.get_or_init(|| NestedGrid::new(&self.triangles))
    }
}

impl Walk for Cells {
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        self.grid().walk::<L, V>(ray, visitor);
    }

    fn order(&self) -> &[TriangleId] {
        self.grid().order()
    }

    fn memory(&self) -> usize {
        self.grid.get().map_or(0, Walk::memory)
    }
}
