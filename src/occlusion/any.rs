//! The search for any occluder, of one ray or of many, everywhere or in a cell.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::engine::{Engine, Job, TestEach, TestEight, admit};
use super::walk::walk_any;
use super::{Cell, Eight, Occluder, Tally, Visit, VisitMany, Walk};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::{Kernel, Lanes};
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
        if W::INLINED && L::COUNT > 4 {
            if W::IN_PLACE {
                self.inlined::<W, T, L, true>(engine);
            } else {
                self.inlined::<W, T, L, false>(engine);
            }
            return;
        }
        let Self { rays, found, tally } = self;
        let triangles = engine.triangles();
        for (ray, found) in rays.iter().zip(found) {
            if admit(ray, tally) {
                tally.traversals += 1;
                let mut visitor = AnyVisitor::<T, L, false>::new(triangles, ray, found, tally);
                walk_any::<W, L>(engine.walk(), ray, &mut visitor);
            }
        }
    }
}

impl AnyOccluders<'_> {
    /// With the walk compiled for the lanes; `IN_PLACE`: see [`Walk::IN_PLACE`].
    #[inline(always)]
    fn inlined<W: Walk, T: TriangleTest, L: Lanes, const IN_PLACE: bool>(
        self,
        engine: &Engine<W, T>,
    ) {
        let Self { rays, found, tally } = self;
        let triangles = engine.triangles();
        let mut visitors =
            AnyVisitors::<T, L, IN_PLACE> { triangles, rays, found, tally, kind: PhantomData };
        engine.walk().walk_many::<L, _>(rays, &mut visitors);
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
        let mut visitor =
            AnyVisitor::<T, L, false>::new(engine.triangles(), ray, &mut found, tally);
        let _ = visitor.visit(cell, run);
        found
    }
}

/// The visitors of many rays.
struct AnyVisitors<'a, T, L, const IN_PLACE: bool> {
    triangles: &'a Triangles,
    rays: &'a [Ray],
    found: &'a mut [Option<Occluder>],
    tally: &'a mut Tally,
    kind: PhantomData<(T, L)>,
}

impl<T: TriangleTest, L: Lanes, const IN_PLACE: bool> VisitMany
    for AnyVisitors<'_, T, L, IN_PLACE>
{
    type One<'a>
        = AnyVisitor<'a, T, L, IN_PLACE>
    where
        Self: 'a;

    #[inline(always)]
    fn admits(&mut self, ray: usize) -> bool {
        let admits = admit(&self.rays[ray], self.tally);
        self.tally.traversals += u64::from(admits);
        admits
    }

    #[inline(always)]
    fn one(&mut self, ray: usize) -> AnyVisitor<'_, T, L, IN_PLACE> {
        AnyVisitor::new(self.triangles, &self.rays[ray], &mut self.found[ray], self.tally)
    }
}

/// `IN_PLACE`: see [`Walk::IN_PLACE`].
struct AnyVisitor<'a, T, L, const IN_PLACE: bool> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    lanes: RayLanes<L>,
    tally: &'a mut Tally,
    found: &'a mut Option<Occluder>,
    test: PhantomData<T>,
}

impl<'a, T: TriangleTest, L: Lanes, const IN_PLACE: bool> AnyVisitor<'a, T, L, IN_PLACE> {
    #[inline(always)]
    fn new(
        triangles: &'a Triangles,
        ray: &'a Ray,
        found: &'a mut Option<Occluder>,
        tally: &'a mut Tally,
    ) -> Self {
        Self { triangles, ray, lanes: RayLanes::of::<T>(ray), tally, found, test: PhantomData }
    }

    /// The test of some triangles, counted.
    #[inline(always)]
    fn test<'v>(
        &'v mut self,
        cell: Cell,
        ids: &'v [TriangleId],
    ) -> TestEach<
        'v,
        T,
        L,
        impl Fn(TriangleId) -> bool + use<'v, 'a, T, L, IN_PLACE>,
        impl FnMut(TriangleId) -> ControlFlow<()> + use<'v, 'a, T, L, IN_PLACE>,
    > {
        let Self { triangles, ray, lanes, tally, found, .. } = self;
        tally.cells += 1;
        tally.triangle_tests += ids.len() as u64;
        let opaque = triangles.opaque_count();
        TestEach {
            triangles,
            ray,
            lanes,
            ids,
            wanted: move |id| id < opaque,
            hit: move |triangle| {
                **found = Some(Occluder::shown(triangle, cell));
                ControlFlow::Break(())
            },
            test: PhantomData,
        }
    }
}

impl<T: TriangleTest, L: Lanes, const IN_PLACE: bool> Visit for AnyVisitor<'_, T, L, IN_PLACE> {
    #[inline(always)]
    fn visit(&mut self, cell: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        let job = self.test(cell, ids);
        if IN_PLACE { job.run() } else { L::run(job) }
    }

    #[inline(always)]
    fn visit_eight(&mut self, cell: Cell, ids: &[TriangleId], eight: &Eight) -> ControlFlow<()> {
        let job = TestEight { eight, each: self.test(cell, ids) };
        if IN_PLACE { job.run() } else { L::run(job) }
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.ray.end
    }
}
