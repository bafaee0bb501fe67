//! Asking a scene about one ray.

use std::ptr::null_mut;

use crate::{Hit, Ray, Scene, Verdict, bindings::RTCRayQueryFlags, filter::FilterContext};

impl Scene {
    /// Embree's own form of the question: if anything blocks the ray, its `tfar` becomes minus infinity, else it stays.
    #[inline]
    pub fn occluded1(&self, ray: &mut Ray) {
        // SAFETY: the scene is committed and alive; the ray is aligned, of the right size and ours alone. Without
        // arguments there is no filter and no context.
        unsafe { (self.api().rtcOccluded1)(self.raw(), ray.as_raw(), null_mut()) }
    }

    /// Whether anything blocks the ray.
    #[must_use]
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut ray = *ray;
        // A `tfar` that is minus infinity to begin with would look like an answer.
        if ray.is_occluded() {
            return false;
        }
        self.occluded1(&mut ray);
        ray.is_occluded()
    }

    /// Whether anything that `filter` accepts blocks the ray.
    ///
    /// Hits come in no order. To gather all of them (transparent occluders), reject each; in a scene of
    /// [`BuildQuality::High`](crate::BuildQuality::High) a triangle may then come twice. A panic of the filter goes on from
    /// here after Embree has returned.
    #[inline]
    pub fn occluded_with(&self, ray: &Ray, mut filter: impl FnMut(&Hit) -> Verdict) -> bool {
        let mut ray = *ray;
        if ray.is_occluded() {
            return false;
        }
        let mut context = FilterContext::new(|_, hit: &Hit| filter(hit));
        let mut arguments = context.occluded_arguments(RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_NONE);
        // SAFETY: as in `occluded1`; the arguments and the context in them live, unmoved, through the call.
        unsafe { (self.api().rtcOccluded1)(self.raw(), ray.as_raw(), &raw mut arguments) };
        context.finish();
        ray.is_occluded()
    }

    /// Something that blocks the ray, not necessarily the nearest. `Some` exactly when [`occluded`](Self::occluded).
    #[must_use]
    #[inline]
    pub fn occluder(&self, ray: &Ray) -> Option<Hit> {
        let mut found = None;
        self.occluded_with(ray, |hit| {
            found = Some(*hit);
            Verdict::Accept
        });
        found
    }

    /// The nearest hit.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut both = ray.with_room_for_hit();
        // SAFETY: the scene is committed and alive; ray and hit are aligned, of the size of 4.3 and later, and ours alone.
        unsafe { (self.api().rtcIntersect1)(self.raw(), &raw mut both, null_mut()) };
        Hit::from_raw(&both)
    }

    /// The nearest hit that `filter` accepts. It is asked about farther hits too, in no order. Panics as in
    /// [`occluded_with`](Self::occluded_with).
    #[inline]
    pub fn intersect_with(
        &self,
        ray: &Ray,
        mut filter: impl FnMut(&Hit) -> Verdict,
    ) -> Option<Hit> {
        let mut both = ray.with_room_for_hit();
        let mut context = FilterContext::new(|_, hit: &Hit| filter(hit));
        let mut arguments = context.intersect_arguments();
        // SAFETY: as in `intersect`; the arguments and the context in them live, unmoved, through the call.
        unsafe { (self.api().rtcIntersect1)(self.raw(), &raw mut both, &raw mut arguments) };
        context.finish();
        Hit::from_raw(&both)
    }
}
