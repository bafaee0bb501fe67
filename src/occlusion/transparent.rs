//! All transparent triangles that a ray meets.
//!
//! What is transparent is mostly a small part of a scene, and no hit ends the search. So it lies in a grid of its own: through that of the
//! whole scene, a ray to a light would come to every opaque triangle on its way.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use super::engine::{Engine, Job, TestEach, TestEight, admit};
use super::walk::walk_any;
use super::{Cell, Eight, NestedGrid, Tally, Visit, Walk};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Ray, TriangleId, Triangles};

/// Whether what is transparent gets a structure of its own: if it is less than half of all. With more, that would cost much and gain little.
pub(super) fn is_transparent_apart(triangles: &Triangles) -> bool {
    let transparent = triangles.len() as TriangleId - triangles.opaque_count();
    (1..triangles.opaque_count()).contains(&transparent)
}

/// A grid of what is transparent, if it gets one.
pub(super) fn among_transparent(triangles: &Triangles) -> Option<NestedGrid> {
    let transparent = triangles.opaque_count()..triangles.len() as TriangleId;
    is_transparent_apart(triangles).then(|| NestedGrid::among(triangles, transparent))
}

/// The search; what it finds is in no order, and may be there several times.
pub(super) struct AllTransparent<'a> {
    pub ray: &'a Ray,
    pub found: &'a mut Vec<TriangleId>,
    pub tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for AllTransparent<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) {
        let Self { ray, found, tally } = self;
        if !admit(ray, tally) {
            return;
        }
        tally.traversals += 1;
        let lanes = RayLanes::<L>::of::<T>(ray);
        let triangles = engine.triangles();
        let mut visitor =
            TransparentVisitor::<T, L> { triangles, ray, lanes, found, tally, test: PhantomData };
        match engine.among_transparent() {
            Some(grid) => walk_any::<NestedGrid, L>(grid, ray, &mut visitor),
            None => walk_any::<W, L>(engine.walk(), ray, &mut visitor),
        }
    }
}

struct TransparentVisitor<'a, T, L> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    lanes: RayLanes<L>,
    found: &'a mut Vec<TriangleId>,
    tally: &'a mut Tally,
    test: PhantomData<T>,
}

impl<'a, T: TriangleTest, L: Lanes> TransparentVisitor<'a, T, L> {
    /// The test of some triangles, counted.
    #[inline(always)]
    fn test<'v>(
        &'v mut self,
        ids: &'v [TriangleId],
    ) -> TestEach<
        'v,
        T,
        L,
        impl Fn(TriangleId) -> bool + use<'v, 'a, T, L>,
        impl FnMut(TriangleId) -> ControlFlow<()> + use<'v, 'a, T, L>,
    > {
        let Self { triangles, ray, lanes, found, tally, .. } = self;
        tally.cells += 1;
        tally.triangle_tests += ids.len() as u64;
        let opaque = triangles.opaque_count();
        TestEach {
            triangles,
            ray,
            lanes,
            ids,
            wanted: move |id| id >= opaque,
            hit: move |triangle| {
                found.push(triangle);
                ControlFlow::Continue(())
            },
            test: PhantomData,
        }
    }
}

impl<T: TriangleTest, L: Lanes> Visit for TransparentVisitor<'_, T, L> {
    #[inline(always)]
    fn visit(&mut self, _: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        L::run(self.test(ids))
    }

    #[inline(always)]
    fn visit_eight(&mut self, _: Cell, ids: &[TriangleId], eight: &Eight) -> ControlFlow<()> {
        L::run(TestEight { eight, each: self.test(ids) })
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.ray.end
    }
}
