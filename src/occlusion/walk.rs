//! Culling: which triangles might a ray meet?

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::{Cell, Eight};
use crate::geometry::lanes::{Kernel, Lanes};
use crate::geometry::{Ray, TriangleId};

/// Takes the triangles that a culler could not rule out.
pub trait Visit {
    /// Triangles that the ray might meet, and the cell they are (part) of. Break ends the walk.
    fn visit(&mut self, cell: Cell, triangles: &[TriangleId]) -> ControlFlow<()>;

    /// The same of up to eight triangles whose corners the culler stores side by side.
    #[inline(always)]
    fn visit_eight(&mut self, cell: Cell, triangles: &[TriangleId], _: &Eight) -> ControlFlow<()> {
        self.visit(cell, triangles)
    }

    /// Nothing beyond this `t` is of interest any more.
    fn end(&self) -> f32;

    /// Whether what is nearer had better come first, because [`end`](Self::end) falls; else any order is as good.
    #[inline(always)]
    fn is_ordered(&self) -> bool {
        false
    }
}

/// Takes the triangles that a culler could not rule out, for many rays.
pub trait VisitMany {
    /// What takes those of one ray.
    type One<'a>: Visit
    where
        Self: 'a;

    /// Counts a query; whether the ray can be answered at all.
    fn admits(&mut self, ray: usize) -> bool;

    /// For one ray, by its number.
    fn one(&mut self, ray: usize) -> Self::One<'_>;
}

/// A structure over triangles that only culls.
///
/// The promise: every triangle that the closed segment comes within [`slack`](crate::geometry::Triangles::slack)
/// of, along every axis, is visited, for any valid ray of any length, direction and origin; more may be, and
/// several times. So tests that round lose no hit that counts, and the exact test none at all.
pub trait Walk: Send + Sync + 'static {
    /// Whether queries for any hit and for the nearest get a copy of the walk of their own for each triangle test and each
    /// wide instruction set, with the test inlined; costs some seconds of compilation each.
    const INLINED: bool = true;

    /// Whether visitors are called from code that is compiled for the lanes, and not from a closure of somebody else's, in which
    /// every operation of a test would be a call: then tests may be done in place.
    const IN_PLACE: bool = false;

    /// Whether transparent triangles, where they are the lesser part, are looked for in a grid of their own.
    const APART: bool = true;

    /// Visits what the ray might meet, nearer parts mostly first; lanes of whatever kind serve the culling.
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V);

    /// The same for many rays.
    #[inline(always)]
    fn walk_many<L: Lanes, V: VisitMany>(&self, rays: &[Ray], visitors: &mut V) {
        for (number, ray) in rays.iter().enumerate() {
            if visitors.admits(number) {
                self.walk::<L, _>(ray, &mut visitors.one(number));
            }
        }
    }

    /// The triangles in an order that keeps each cell together.
    fn order(&self) -> &[TriangleId];

    /// Bytes held.
    fn memory(&self) -> usize;
}

impl<W: Walk> Walk for Arc<W> {
    const INLINED: bool = false;
    // Whoever shares a culler asks about what is opaque.
    const APART: bool = false;

    #[inline(always)]
    fn walk<L: Lanes, V: Visit + ?Sized>(&self, ray: &Ray, visitor: &mut V) {
        W::walk::<L, V>(self, ray, visitor);
    }

    fn order(&self) -> &[TriangleId] {
        W::order(self)
    }

    fn memory(&self) -> usize {
        W::memory(self)
    }
}

/// A walk that is compiled once for a culler and an instruction set, whatever visits: for queries that are not worth a
/// copy of the walk for each triangle test. Costs a virtual call a cell.
pub(super) fn walk_any<W: Walk, L: Lanes>(walk: &W, ray: &Ray, visitor: &mut dyn Visit) {
    L::run(WalkAny::<W, L> { walk, ray, visitor, lanes: PhantomData });
}

struct WalkAny<'a, W, L> {
    walk: &'a W,
    ray: &'a Ray,
    visitor: &'a mut dyn Visit,
    lanes: PhantomData<L>,
}

impl<W: Walk, L: Lanes> Kernel for WalkAny<'_, W, L> {
    type Answer = ();

    #[inline(always)]
    fn run(self) {
        self.walk.walk::<L, dyn Visit>(self.ray, self.visitor);
    }
}
