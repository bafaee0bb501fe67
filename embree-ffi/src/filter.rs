//! Filters: asking the caller about each hit. The closure travels behind an extended query context.

use std::{
    any::Any,
    ffi::c_void,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
};

use crate::{
    Hit,
    bindings::{
        RTCFeatureFlags, RTCFilterFunctionNArguments, RTCIntersectArguments, RTCOccludedArguments,
        RTCRayQueryContext, RTCRayQueryFlags,
    },
};

/// What a filter says about a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It counts: an occlusion query ends here, an intersection query looks only nearer from here on.
    Accept,
    /// It does not: the ray goes through.
    Reject,
}

/// A query's context with a filter behind it, of which Embree knows the first part.
#[repr(C)]
pub(crate) struct FilterContext<F> {
    context: RTCRayQueryContext,
    filter: F,
    panic: Option<Box<dyn Any + Send>>,
}

impl<F: FnMut(usize, &Hit) -> Verdict> FilterContext<F> {
    /// Of the filter of a ray's lane and hit.
    pub(crate) fn new(filter: F) -> Self {
        Self { context: RTCRayQueryContext { instID: [!0], instPrimID: [!0] }, filter, panic: None }
    }

    /// Valid while `self` stays where it is and nobody else touches it.
    pub(crate) fn occluded_arguments(&mut self, flags: RTCRayQueryFlags) -> RTCOccludedArguments {
        RTCOccludedArguments {
            flags: RTCRayQueryFlags(
                flags.0 | RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER.0,
            ),
            feature_mask: RTCFeatureFlags::RTC_FEATURE_FLAG_ALL,
            context: (&raw mut *self).cast(),
            filter: Some(ask::<F>),
            occluded: None,
        }
    }

    /// Valid while `self` stays where it is and nobody else touches it.
    pub(crate) fn intersect_arguments(&mut self) -> RTCIntersectArguments {
        RTCIntersectArguments {
            flags: RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER,
            feature_mask: RTCFeatureFlags::RTC_FEATURE_FLAG_ALL,
            context: (&raw mut *self).cast(),
            filter: Some(ask::<F>),
            intersect: None,
        }
    }

    /// Goes on with the filter's panic, if it panicked.
    #[inline]
    pub(crate) fn finish(self) {
        if let Some(payload) = self.panic {
            resume_unwind(payload);
        }
    }
}

/// Called by Embree with the hits of 1, 4, 8 or 16 rays; those to be judged have a `valid` other than 0.
///
/// After a panic it accepts everything unasked, which ends an occlusion query soonest.
unsafe extern "C" fn ask<F: FnMut(usize, &Hit) -> Verdict>(
    arguments: *const RTCFilterFunctionNArguments,
) {
    // SAFETY: Embree passes its arguments, in them the context of the query, which `FilterContext` made and lent for it.
    let (arguments, asked) =
        unsafe { (&*arguments, &mut *(*arguments).context.cast::<FilterContext<F>>()) };
    let width = arguments.N as usize;
    for lane in 0..width {
        // SAFETY: there are `N` of them, ours to read and write during the call.
        let valid = unsafe { &mut *arguments.valid.add(lane) };
        if *valid == 0 || asked.panic.is_some() {
            continue;
        }
        // SAFETY: the ray and the hit are columns of `N`.
        let hit = unsafe { hit_in_lane(arguments.ray.cast(), arguments.hit.cast(), width, lane) };
        match catch_unwind(AssertUnwindSafe(|| (asked.filter)(lane, &hit))) {
            Ok(Verdict::Accept) => {}
            Ok(Verdict::Reject) => *valid = 0,
            Err(payload) => asked.panic = Some(payload),
        }
    }
}

/// Rays and hits of any width are rows of `width` words, in the order of the fields of `RTCRay` and `RTCHit`.
///
/// # Safety
/// Both are of that width, and `lane` is less.
unsafe fn hit_in_lane(ray: *const c_void, hit: *const c_void, width: usize, lane: usize) -> Hit {
    // SAFETY: rows 0 to 8 of a ray and 0 to 6 of a hit exist in each.
    let (ray, hit, ids) = unsafe {
        let row = |row: usize| row * width + lane;
        let (ray, floats, ids) = (ray.cast::<f32>(), hit.cast::<f32>(), hit.cast::<u32>());
        (
            *ray.add(row(8)),
            [0, 1, 2, 3, 4].map(|at| *floats.add(row(at))),
            [5, 6].map(|at| *ids.add(row(at))),
        )
    };
    Hit {
        geometry: ids[1],
        primitive: ids[0],
        t: ray,
        u: hit[3],
        v: hit[4],
        normal: [hit[0], hit[1], hit[2]],
    }
}
