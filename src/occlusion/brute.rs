//! No structure at all: every triangle, every time. The measure of the others' answers.

use super::{Cell, Visit, Walk};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// Triangles that form one cell.
const BLOCK: u32 = 8;

/// Looks at every triangle.
pub struct Brute {
    order: Vec<TriangleId>,
}

impl Brute {
    /// Nothing to build but the list.
    #[must_use]
    pub fn new(triangles: &Triangles) -> Self {
        Self { order: (0..triangles.len() as u32).collect() }
    }
}

impl Walk for Brute {
    const INLINED: bool = false;
    // The measure of all others has nothing in common with them.
    const APART: bool = false;

    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, _: &Ray, visitor: &mut V) {
        visit_all(&self.order, BLOCK, visitor);
    }

    fn order(&self) -> &[TriangleId] {
        &self.order
    }

    fn memory(&self) -> usize {
        size_of_val(&*self.order)
    }
}

/// Visits all there is, in blocks.
#[inline(always)]
pub(super) fn visit_all<V: Visit + ?Sized>(order: &[TriangleId], block: u32, visitor: &mut V) {
    let mut start = 0;
    for triangles in order.chunks(block as usize) {
        let cell = Cell { start, end: start + triangles.len() as u32 };
        if visitor.visit(cell, triangles).is_break() {
            return;
        }
        start = cell.end;
    }
}
