//! The nearest hit, for rays that see rather than ask.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use glam::DVec3;

use super::engine::{Engine, Job, TestEach, TestEight, admit};
use super::walk::walk_any;
use super::{Cell, Eight, Tally, Visit, Walk};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::{Kernel, Lanes};
use crate::geometry::{Ray, Triangle, TriangleId, Triangles};

/// Where a ray first meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The triangle.
    pub triangle: TriangleId,
    /// Distance in units of the ray's direction.
    pub t: f64,
}

/// Distance along the ray to the triangle's plane, in f64; `None` behind the origin or if parallel.
///
/// A test that rounds also reports triangles that the ray almost grazes, whose planes it may meet far beside them: beyond where a
/// culler looks for them. So the distance is at most as far from the triangle's box as `slack` allows.
#[inline]
pub(super) fn distance(ray: &Ray, &[a, b, c]: &Triangle, slack: f64) -> Option<f64> {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a - origin) / normal.dot(direction);
    if !(t > 0.0 && t.is_finite()) {
        return None;
    }
    let (low, high) = around([a, b, c], slack);
    let place = origin + t * direction;
    let is_within = place.cmpge(low).all() && place.cmple(high).all();
    Some(if is_within { t } else { clamp(t, ray, low, high) })
}

/// Where the ray comes to a triangle that it does meet, though in f64 the plane seems to be behind the origin, or nowhere.
#[cold]
fn entry(ray: &Ray, triangle: &Triangle, slack: f64) -> f64 {
    let (low, high) = around(triangle.map(|corner| corner.as_dvec3()), slack);
    clamp(0.0, ray, low, high).max(f64::MIN_POSITIVE)
}

/// The box of a triangle, and some slack around it.
fn around([a, b, c]: [DVec3; 3], slack: f64) -> (DVec3, DVec3) {
    (a.min(b).min(c) - slack, a.max(b).max(c) + slack)
}

/// The distance within a box that is nearest to `t`; `t` if the ray misses it.
#[cold]
fn clamp(t: f64, ray: &Ray, low: DVec3, high: DVec3) -> f64 {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (mut enter, mut leave) = (0.0f64, f64::from(ray.end));
    for axis in (0..3).filter(|&axis| direction[axis] != 0.0) {
        let low = (low[axis] - origin[axis]) / direction[axis];
        let high = (high[axis] - origin[axis]) / direction[axis];
        enter = enter.max(low.min(high));
        leave = leave.min(low.max(high));
    }
    if enter <= leave { t.clamp(enter, leave) } else { t }
}

pub(super) struct NearestHit<'a> {
    pub ray: &'a Ray,
    pub tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for NearestHit<'_> {
    type Answer = Option<Nearest>;

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) -> Option<Nearest> {
        let Self { ray, tally } = self;
        if !admit(ray, tally) {
            return None;
        }
        tally.traversals += 1;
        let triangles = engine.triangles();
        // `IN_PLACE` is for walks that are compiled for the lanes.
        if W::IN_PLACE && W::INLINED && L::COUNT > 4 {
            let mut visitor = NearestVisitor::<T, L, true>::new(triangles, ray, tally);
            engine.walk().walk::<L, _>(ray, &mut visitor);
            return visitor.best;
        }
        let mut visitor = NearestVisitor::<T, L, false>::new(triangles, ray, tally);
        if W::INLINED && L::COUNT > 4 {
            engine.walk().walk::<L, _>(ray, &mut visitor);
        } else {
            walk_any::<W, L>(engine.walk(), ray, &mut visitor);
        }
        visitor.best
    }
}

/// `IN_PLACE`: see [`Walk::IN_PLACE`].
struct NearestVisitor<'a, T, L, const IN_PLACE: bool> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    lanes: RayLanes<L>,
    tally: &'a mut Tally,
    best: Option<Nearest>,
    test: PhantomData<T>,
}

impl<'a, T: TriangleTest, L: Lanes, const IN_PLACE: bool> NearestVisitor<'a, T, L, IN_PLACE> {
    #[inline(always)]
    fn new(triangles: &'a Triangles, ray: &'a Ray, tally: &'a mut Tally) -> Self {
        let lanes = RayLanes::of::<T>(ray);
        Self { triangles, ray, lanes, tally, best: None, test: PhantomData }
    }

    /// The test of some triangles, counted.
    #[inline(always)]
    fn test<'v>(
        &'v mut self,
        ids: &'v [TriangleId],
    ) -> TestEach<
        'v,
        T,
        L,
        impl Fn(TriangleId) -> bool + use<'v, 'a, T, L, IN_PLACE>,
        impl FnMut(TriangleId) -> ControlFlow<()> + use<'v, 'a, T, L, IN_PLACE>,
    > {
        let Self { triangles, ray, lanes, tally, best, .. } = self;
        tally.cells += 1;
        tally.triangle_tests += ids.len() as u64;
        TestEach {
            triangles,
            ray,
            lanes,
            ids,
            wanted: |_| true,
            hit: move |triangle| {
                let (corners, slack) = (triangles.get(triangle), triangles.slack());
                let distance = distance(ray, &corners, slack);
                // A hit that is certain is not lost to the rounding of its distance.
                let distance =
                    distance.or_else(|| T::IS_EXACT.then(|| entry(ray, &corners, slack)));
                if let Some(t) = distance {
                    let nearer = best.is_none_or(|best| (t, triangle) < (best.t, best.triangle));
                    if nearer {
                        *best = Some(Nearest { triangle, t });
                    }
                }
                ControlFlow::Continue(())
            },
            test: PhantomData,
        }
    }
}

impl<T: TriangleTest, L: Lanes, const IN_PLACE: bool> Visit for NearestVisitor<'_, T, L, IN_PLACE> {
    #[inline(always)]
    fn visit(&mut self, _: Cell, ids: &[TriangleId]) -> ControlFlow<()> {
        let job = self.test(ids);
        if IN_PLACE { job.run() } else { L::run(job) }
    }

    #[inline(always)]
    fn visit_eight(&mut self, _: Cell, ids: &[TriangleId], eight: &Eight) -> ControlFlow<()> {
        let job = TestEight { eight, each: self.test(ids) };
        if IN_PLACE { job.run() } else { L::run(job) }
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.best.map_or(self.ray.end, |best| (best.t as f32).next_up())
    }

    #[inline(always)]
    fn is_ordered(&self) -> bool {
        true
    }
}
