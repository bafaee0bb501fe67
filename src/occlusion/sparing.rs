//! The search for an occluder that leaves triangles out.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::engine::{Engine, Job, admit, test_each};
use super::walk::walk_any;
use super::{Cell, LeftOut, Occluder, Tally, Visit, Walk};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// Lanes of the widest arithmetic.
const MOST_LANES: usize = 16;

pub(super) struct SparingOccluder<'a> {
    pub ray: &'a Ray,
    pub within: Option<Cell>,
    pub left_out: &'a mut LeftOut,
    pub tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for SparingOccluder<'_> {
    type Answer = Option<Occluder>;

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) -> Option<Occluder> {
        let Self { ray, within, left_out, tally } = self;
        if !admit(ray, tally) {
            return None;
        }
        let mut visitor = SparingVisitor::<T, L> {
            triangles: engine.triangles(),
            ray,
            lanes: RayLanes::of::<T>(ray),
            left_out,
            tally,
            found: None,
            test: PhantomData,
        };
        match within {
            None => {
                visitor.tally.traversals += 1;
                walk_any::<W, L>(engine.walk(), ray, &mut visitor);
            }
            Some(cell) => {
                let run = &engine.walk().order()[cell.start as usize..cell.end as usize];
                let _ = visitor.visit(cell, run);
            }
        }
        visitor.found
    }
}

struct SparingVisitor<'a, T, L> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    lanes: RayLanes<L>,
    left_out: &'a mut LeftOut,
    tally: &'a mut Tally,
    found: Option<Occluder>,
    test: PhantomData<T>,
}

impl<T: TriangleTest, L: Lanes> SparingVisitor<'_, T, L> {
    /// Tests up to a vector full of opaque triangles, and notes them if none blocks.
    #[inline(always)]
    fn test(&mut self, cell: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        let Self { triangles, ray, lanes, left_out, tally, found, .. } = self;
        let wanted = |_| true;
        test_each::<T, L>(triangles, ray, lanes, ids, tally, wanted, |triangle| {
            *found = Some(Occluder::shown(triangle, cell));
            ControlFlow::Break(())
        })?;
        ids.iter().for_each(|&id| left_out.note(id));
        ControlFlow::Continue(())
    }
}

impl<T: TriangleTest, L: Lanes> Visit for SparingVisitor<'_, T, L> {
    #[inline(always)]
    fn visit(&mut self, cell: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        const { assert!(L::COUNT <= MOST_LANES) }
        if self.left_out.holds_cell(cell) {
            return ControlFlow::Continue(());
        }
        self.tally.cells += 1;
        let opaque = self.triangles.opaque_count();
        let mut kept = [0; MOST_LANES];
        let mut count = 0;
        for &id in ids {
            if id < opaque && !self.left_out.holds(id) {
                kept[count] = id;
                count += 1;
                if count == L::COUNT {
                    self.test(cell, &kept[..count])?;
                    count = 0;
                }
            }
        }
        if count > 0 { self.test(cell, &kept[..count]) } else { ControlFlow::Continue(()) }
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.ray.end
    }
}
