//! The search for any occluder, of one ray or of many, everywhere or in a cell.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::engine::{Engine, Job, admit, test_each};
use super::walk::walk_any;
use super::{Cell, Occluder, Tally, Visit, VisitMany, Walk};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// Any occluder of each ray.
pub(super) struct AnyOccluders<'a> {
    pub rays: &'a [Ray],
    pub found: &'a mut [Option<Occluder>],
    pub tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for AnyOccluders<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) {
        let Self { rays, found, tally } = self;
        let triangles = engine.triangles();
        if W::INLINED && L::COUNT > 4 {
            let mut visitors =
                AnyVisitors::<T, L> { triangles, rays, found, tally, kind: PhantomData };
            engine.walk().walk_many::<L, _>(rays, &mut visitors);
            return;
        }
        for (ray, found) in rays.iter().zip(found) {
            if admit(ray, tally) {
                tally.traversals += 1;
                let mut visitor = AnyVisitor::<T, L>::new(triangles, ray, found, tally);
                walk_any::<W, L>(engine.walk(), ray, &mut visitor);
            }
        }
    }
}

/// The first occluder of a cell.
pub(super) struct OccluderIn<'a> {
    pub cell: Cell,
    pub ray: &'a Ray,
    pub tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for OccluderIn<'_> {
    type Answer = Option<Occluder>;

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) -> Option<Occluder> {
        let Self { cell, ray, tally } = self;
        if !admit(ray, tally) {
            return None;
        }
        let run = &engine.walk().order()[cell.start as usize..cell.end as usize];
        let mut found = None;
        let mut visitor = AnyVisitor::<T, L>::new(engine.triangles(), ray, &mut found, tally);
        let _ = visitor.visit(cell, run);
        found
    }
}

/// The visitors of many rays.
struct AnyVisitors<'a, T, L> {
    triangles: &'a Triangles,
    rays: &'a [Ray],
    found: &'a mut [Option<Occluder>],
    tally: &'a mut Tally,
    kind: PhantomData<(T, L)>,
}

impl<T: TriangleTest, L: Lanes> VisitMany for AnyVisitors<'_, T, L> {
    type One<'a>
        = AnyVisitor<'a, T, L>
    where
        Self: 'a;

    #[inline(always)]
    fn admits(&mut self, ray: usize) -> bool {
        let admits = admit(&self.rays[ray], self.tally);
        self.tally.traversals += u64::from(admits);
        admits
    }

    #[inline(always)]
    fn one(&mut self, ray: usize) -> AnyVisitor<'_, T, L> {
        AnyVisitor::new(self.triangles, &self.rays[ray], &mut self.found[ray], self.tally)
    }
}

struct AnyVisitor<'a, T, L> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    lanes: RayLanes<L>,
    tally: &'a mut Tally,
    found: &'a mut Option<Occluder>,
    test: PhantomData<T>,
}

impl<'a, T: TriangleTest, L: Lanes> AnyVisitor<'a, T, L> {
    #[inline(always)]
    fn new(
        triangles: &'a Triangles,
        ray: &'a Ray,
        found: &'a mut Option<Occluder>,
        tally: &'a mut Tally,
    ) -> Self {
        Self { triangles, ray, lanes: RayLanes::of::<T>(ray), tally, found, test: PhantomData }
    }
}

impl<T: TriangleTest, L: Lanes> Visit for AnyVisitor<'_, T, L> {
    #[inline(always)]
    fn visit(&mut self, cell: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        let Self { triangles, ray, lanes, tally, found, .. } = self;
        tally.cells += 1;
        let opaque = triangles.opaque_count();
        test_each::<T, L>(
            triangles,
            ray,
            lanes,
            ids,
            tally,
            |id| id < opaque,
            |triangle| {
                **found = Some(Occluder { triangle, cell });
                ControlFlow::Break(())
            },
        )
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.ray.end
    }
}
