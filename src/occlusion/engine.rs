//! A culler and a triangle test make a backend.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::any::{AnyOccluders, OccluderIn};
use super::eight::{Eight, WIDTH};
use super::nearest::NearestHit;
use super::sparing::SparingOccluder;
use super::transparent::{AllTransparent, among_transparent};
use super::{Cell, LeftOut, Nearest, NestedGrid, Occluder, Occlusion, Tally, Walk};
use crate::geometry::intersect::{Claims, RayLanes, TriangleTest};
use crate::geometry::lanes::{Arithmetic, Available, Kernel, Lanes, LanesJob};
use crate::geometry::{Ray, TriangleId, Triangles};

/// The backend that culls by `W` and decides by `T`.
pub struct Engine<W, T> {
    triangles: Arc<Triangles>,
    walk: W,
    /// Over the transparent triangles alone, where they are the lesser part.
    transparent: Option<NestedGrid>,
    arithmetic: Available,
    test: PhantomData<T>,
}

impl<W: Walk, T: TriangleTest> Engine<W, T> {
    /// Puts culler and test together; the arithmetic is that of this CPU unless another is named.
    ///
    /// # Panics
    /// If this CPU lacks the arithmetic: see [`Arithmetic::is_available`].
    #[must_use]
    pub fn new(triangles: Arc<Triangles>, walk: W, arithmetic: Option<Arithmetic>) -> Self {
        let arithmetic = match arithmetic {
            None => Available::newest(),
            Some(wanted) => Available::find(wanted)
                .unwrap_or_else(|| panic!("this CPU has no {} arithmetic", wanted.name())),
        };
        let transparent = W::APART.then(|| among_transparent(&triangles)).flatten();
        Self { triangles, walk, transparent, arithmetic, test: PhantomData }
    }

    /// The culler.
    #[must_use]
    pub fn walk(&self) -> &W {
        &self.walk
    }

    pub(super) fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    /// What finds the transparent triangles alone, if there is something that does.
    pub(super) fn among_transparent(&self) -> Option<&NestedGrid> {
        self.transparent.as_ref()
    }

    /// Runs a job compiled for the instruction set of the arithmetic.
    #[inline]
    fn run<J: Job<W, T>>(&self, job: J) -> J::Answer {
        self.arithmetic.run(WithEngine(job, self))
    }
}

/// Something to do with an engine, in lanes of any kind.
pub(super) trait Job<W: Walk, T: TriangleTest> {
    type Answer;
    fn run<L: Lanes>(self, engine: &Engine<W, T>) -> Self::Answer;
}

struct WithEngine<'a, J, W, T>(J, &'a Engine<W, T>);

impl<W: Walk, T: TriangleTest, J: Job<W, T>> LanesJob for WithEngine<'_, J, W, T> {
    type Answer = J::Answer;

    #[inline(always)]
    fn run<L: Lanes>(self) -> J::Answer {
        self.0.run::<L>(self.1)
    }
}

impl<W: Walk, T: TriangleTest> Occlusion for Engine<W, T> {
    fn occluder(&self, ray: &Ray, tally: &mut Tally) -> Option<Occluder> {
        let mut found = [None];
        self.run(AnyOccluders { rays: std::slice::from_ref(ray), found: &mut found, tally });
        found[0]
    }

    fn occluded_many(&self, rays: &[Ray], blocked: &mut [bool], tally: &mut Tally) {
        /// Rays of one job: what is found of them stays in the nearest cache.
        const AT_ONCE: usize = 64;
        assert_eq!(rays.len(), blocked.len(), "one answer a ray");
        for (rays, blocked) in rays.chunks(AT_ONCE).zip(blocked.chunks_mut(AT_ONCE)) {
            let mut found = [None; AT_ONCE];
            let found = &mut found[..rays.len()];
            self.run(AnyOccluders { rays, found, tally });
            blocked.iter_mut().zip(found).for_each(|(blocked, found)| *blocked = found.is_some());
        }
    }

    fn occluder_in(&self, cell: Cell, ray: &Ray, tally: &mut Tally) -> Option<Occluder> {
        self.run(OccluderIn { cell, ray, tally })
    }

    fn occluder_except(
        &self,
        ray: &Ray,
        within: Option<Cell>,
        left_out: &mut LeftOut,
        tally: &mut Tally,
    ) -> Option<Occluder> {
        self.run(SparingOccluder { ray, within, left_out, tally })
    }

    fn meets(&self, triangle: TriangleId, ray: &Ray, tally: &mut Tally) -> bool {
        self.run(One { ray, triangle, tally })
    }

    fn transparent(&self, ray: &Ray, found: &mut Vec<TriangleId>, tally: &mut Tally) {
        found.clear();
        if (self.triangles.opaque_count() as usize) < self.triangles.len() {
            self.run(AllTransparent { ray, found, tally });
            found.sort_unstable();
            found.dedup();
        }
    }

    fn nearest(&self, ray: &Ray, tally: &mut Tally) -> Option<Nearest> {
        self.run(NearestHit { ray, tally })
    }

    fn order(&self) -> &[TriangleId] {
        self.walk.order()
    }

    fn memory(&self) -> usize {
        self.walk.memory() + self.transparent.as_ref().map_or(0, Walk::memory)
    }
}

/// Tests triangles of a cell; calls `hit` for each wanted one that the ray meets, in their order, until
/// it breaks.
#[inline(always)]
pub(super) fn test_each<T: TriangleTest, L: Lanes>(
    triangles: &Triangles,
    ray: &Ray,
    lanes: &RayLanes<L>,
    ids: &[TriangleId],
    tally: &mut Tally,
    wanted: impl Fn(TriangleId) -> bool,
    hit: impl FnMut(TriangleId) -> ControlFlow<()>,
) -> ControlFlow<()> {
    tally.triangle_tests += ids.len() as u64;
    // A culler may have come here through a closure of its own: see `lanes`.
    L::run(TestEach::<T, L, _, _> { triangles, ray, lanes, ids, wanted, hit, test: PhantomData })
}

/// [`test_each`] as a job, which does not count.
pub(super) struct TestEach<'a, T, L, Wanted, Hit> {
    pub triangles: &'a Triangles,
    pub ray: &'a Ray,
    pub lanes: &'a RayLanes<L>,
    pub ids: &'a [TriangleId],
    pub wanted: Wanted,
    pub hit: Hit,
    pub test: PhantomData<T>,
}

impl<T, L, Wanted, Hit> TestEach<'_, T, L, Wanted, Hit>
where
    T: TriangleTest,
    L: Lanes,
    Wanted: Fn(TriangleId) -> bool,
    Hit: FnMut(TriangleId) -> ControlFlow<()>,
{
    /// Goes through what is claimed of up to a vector full of triangles. Inlined, with only the decision of what is open out of
    /// line: what a call is handed has to be in memory, and would be written for each vector, though most are missed.
    #[inline(always)]
    fn settle(&mut self, ids: &[TriangleId], claims: Claims) -> ControlFlow<()> {
        let used = u32::MAX >> (32 - ids.len());
        let mut candidates = (claims.certain | claims.open) & used;
        while candidates != 0 {
            let lane = candidates.trailing_zeros();
            candidates &= candidates - 1;
            let id = ids[lane as usize];
            let certain = claims.certain & (1 << lane) != 0;
            if (self.wanted)(id) && (certain || decide::<T>(self.triangles, self.ray, id)) {
                (self.hit)(id)?;
            }
        }
        ControlFlow::Continue(())
    }
}

/// Decides what the vector test left open of a triangle.
#[cold]
#[inline(never)]
fn decide<T: TriangleTest>(triangles: &Triangles, ray: &Ray, id: TriangleId) -> bool {
    T::settle(ray, &triangles.get(id), triangles.slack())
}

impl<T, L, Wanted, Hit> Kernel for TestEach<'_, T, L, Wanted, Hit>
where
    T: TriangleTest,
    L: Lanes,
    Wanted: Fn(TriangleId) -> bool,
    Hit: FnMut(TriangleId) -> ControlFlow<()>,
{
    type Answer = ControlFlow<()>;

    #[inline(always)]
    fn run(mut self) -> ControlFlow<()> {
        for ids in self.ids.chunks(L::COUNT) {
            let claims = T::claims::<L>(self.lanes, &L::gather(self.triangles.corners(), ids));
            let used = u32::MAX >> (32 - ids.len());
            if (claims.certain | claims.open) & used != 0 {
                self.settle(ids, claims)?;
            }
        }
        ControlFlow::Continue(())
    }
}

/// [`TestEach`] of up to eight triangles that are stored side by side.
pub(super) struct TestEight<'a, T, L, Wanted, Hit> {
    pub eight: &'a Eight,
    pub each: TestEach<'a, T, L, Wanted, Hit>,
}

impl<T, L, Wanted, Hit> Kernel for TestEight<'_, T, L, Wanted, Hit>
where
    T: TriangleTest,
    L: Lanes,
    Wanted: Fn(TriangleId) -> bool,
    Hit: FnMut(TriangleId) -> ControlFlow<()>,
{
    type Answer = ControlFlow<()>;

    #[inline(always)]
    fn run(mut self) -> ControlFlow<()> {
        let mut first = 0;
        while first < WIDTH {
            let claims = T::claims::<L>(self.each.lanes, &self.eight.load(first));
            let claimed = claims.certain | claims.open;
            if claimed != 0 {
                let ids = self.each.ids;
                let ids = &ids[first.min(ids.len())..(first + L::COUNT).min(ids.len())];
                if !ids.is_empty() {
                    self.each.settle(ids, claims)?;
                }
            }
            first += L::COUNT;
        }
        ControlFlow::Continue(())
    }
}

/// Whether the ray can be answered at all; counts it.
#[inline(always)]
pub(super) fn admit(ray: &Ray, tally: &mut Tally) -> bool {
    let valid = ray.is_valid();
    tally.invalid_rays += u64::from(!valid);
    valid
}

struct One<'a> {
    ray: &'a Ray,
    triangle: TriangleId,
    tally: &'a mut Tally,
}

impl<W: Walk, T: TriangleTest> Job<W, T> for One<'_> {
    type Answer = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, engine: &Engine<W, T>) -> bool {
        let Self { ray, triangle, tally } = self;
        if !admit(ray, tally) {
            return false;
        }
        let lanes = RayLanes::<L>::of::<T>(ray);
        let stop = |_| ControlFlow::Break(());
        test_each::<T, L>(&engine.triangles, ray, &lanes, &[triangle], tally, |_| true, stop)
            .is_break()
    }
}
