//! How a memory and its caster ask the backend: of everything, or leaving out what need not or must
//! not be tested.

use super::ShadowQuery;
use crate::geometry::TriangleId;
use crate::occlusion::{Cell, LeftOut, Occluder, Occlusion, Tally};

/// Asks a backend; owned by a worker. What a memory names is checked here, so that it may name
/// anything: a triangle that is none, or not opaque, and a cell out of range are "not there".
pub trait Inquiry: Send {
    /// A new query begins.
    fn begin(&mut self, query: &ShadowQuery);

    /// Whether there is such an opaque triangle, and it may block the query.
    fn is_occluder(&self, triangle: TriangleId) -> bool;

    /// Whether there is such a cell, with something in it.
    fn is_cell(&self, cell: Cell) -> bool;

    /// Whether the query's ray meets the triangle, which [`is_occluder`](Self::is_occluder).
    fn meets(&mut self, triangle: TriangleId, query: &ShadowQuery, tally: &mut Tally) -> bool;

    /// An occluder in the cell, which [`is_cell`](Self::is_cell).
    fn in_cell(&mut self, cell: Cell, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder>;

    /// An occluder anywhere.
    fn anywhere(&mut self, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder>;
}

/// Asks of all triangles.
pub struct Direct<'a> {
    backend: &'a dyn Occlusion,
    opaque: u32,
    places: u32,
}

impl<'a> Direct<'a> {
    /// Asks this backend, over so many opaque triangles.
    #[must_use]
    pub fn new(backend: &'a dyn Occlusion, opaque: u32) -> Self {
        Self { backend, opaque, places: backend.order().len() as u32 }
    }

    /// The same for memories that need no cells; to others, none is there.
    #[must_use]
    pub fn without_cells(backend: &'a dyn Occlusion, opaque: u32) -> Self {
        Self { backend, opaque, places: 0 }
    }
}

impl Inquiry for Direct<'_> {
    #[inline(always)]
    fn begin(&mut self, _: &ShadowQuery) {}

    #[inline(always)]
    fn is_occluder(&self, triangle: TriangleId) -> bool {
        triangle < self.opaque
    }

    #[inline(always)]
    fn is_cell(&self, cell: Cell) -> bool {
        cell.start < cell.end && cell.end <= self.places
    }

    #[inline(always)]
    fn meets(&mut self, triangle: TriangleId, query: &ShadowQuery, tally: &mut Tally) -> bool {
        self.backend.meets(triangle, &query.ray, tally)
    }

    #[inline(always)]
    fn in_cell(&mut self, cell: Cell, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder> {
        self.backend.occluder_in(cell, &query.ray, tally)
    }

    #[inline(always)]
    fn anywhere(&mut self, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder> {
        self.backend.occluder(&query.ray, tally)
    }
}

/// Leaves out the spawning triangle, or what was tested already, or both.
pub struct Sparing<'a> {
    direct: Direct<'a>,
    left_out: LeftOut,
    spawner: bool,
    cells: bool,
}

impl<'a> Sparing<'a> {
    /// Leaves out the spawner if asked to; notes cells, or single triangles, or neither.
    #[must_use]
    pub fn new(direct: Direct<'a>, spawner: bool, retest: Retest) -> Self {
        let left_out = LeftOut::new(direct.opaque, retest == Retest::NotTriangles);
        Self { direct, left_out, spawner, cells: retest == Retest::NotCell }
    }
}

impl Inquiry for Sparing<'_> {
    #[inline(always)]
    fn begin(&mut self, query: &ShadowQuery) {
        self.left_out.begin(self.spawner.then_some(query.spawner));
    }

    #[inline(always)]
    fn is_occluder(&self, triangle: TriangleId) -> bool {
        self.direct.is_occluder(triangle) && !self.left_out.is_spawner(triangle)
    }

    #[inline(always)]
    fn is_cell(&self, cell: Cell) -> bool {
        self.direct.is_cell(cell)
    }

    #[inline(always)]
    fn meets(&mut self, triangle: TriangleId, query: &ShadowQuery, tally: &mut Tally) -> bool {
        let meets = self.direct.meets(triangle, query, tally);
        if !meets {
            self.left_out.note(triangle);
        }
        meets
    }

    #[inline(always)]
    fn in_cell(&mut self, cell: Cell, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder> {
        let backend = self.direct.backend;
        let found = backend.occluder_except(&query.ray, Some(cell), &mut self.left_out, tally);
        if found.is_none() && self.cells {
            self.left_out.note_cell(cell);
        }
        found
    }

    #[inline(always)]
    fn anywhere(&mut self, query: &ShadowQuery, tally: &mut Tally) -> Option<Occluder> {
        self.direct.backend.occluder_except(&query.ray, None, &mut self.left_out, tally)
    }
}

/// Whether triangles that a memory tested in vain are tested again by the traversal (§9 of the paper).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Retest {
    /// They are.
    #[default]
    Again,
    /// The remembered cell is passed over.
    NotCell,
    /// No triangle is tested twice, in whatever cells: the paper's mailbox.
    NotTriangles,
}
