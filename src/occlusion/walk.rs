//! Culling: which triangles might a ray meet?

use std::ops::ControlFlow;

use super::Cell;
use crate::geometry::{Ray, TriangleId};

/// Takes the triangles that a culler could not rule out.
pub trait Visit {
    /// Triangles that the ray might meet, and the cell they are (part) of. Break ends the walk.
    fn visit(&mut self, cell: Cell, triangles: &[TriangleId]) -> ControlFlow<()>;

    /// Nothing beyond this `t` is of interest any more.
    fn end(&self) -> f32;
}

/// A structure over triangles that only culls.
///
/// The promise: every triangle that holds a point of the open segment is visited, for any valid ray
/// of any length, direction and origin; more may be, and several times. Also every triangle whose
/// own box the segment passes within a few roundings of the coordinates, provided the ray comes as
/// near to the triangle's plane and edges: what a sound f32 test may still call a hit.
pub trait Walk: Send + Sync + 'static {
    /// Visits what the ray might meet, nearer parts mostly first.
    fn walk<V: Visit>(&self, ray: &Ray, visitor: &mut V);

    /// The triangles in an order that keeps each cell together.
    fn order(&self) -> &[TriangleId];

    /// Bytes held.
    fn memory(&self) -> usize;
}
