//! One ray, and what it hit.

use std::{
    mem::{align_of, offset_of, size_of},
    num::NonZeroU32,
};

use crate::bindings::{RTCHit, RTCRay, RTCRayHit};

/// A ray segment: the points `origin + t * direction` for `tnear <= t <= tfar`. The direction need not be normalised.
///
/// Aligned as Embree demands, and with a mask that sees every geometry: a mask of 0 would see nothing, so there is none.
/// Whether a hit exactly at an end counts is not specified by Embree. `tfar < 0` and NaN hit nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(16))]
pub struct Ray {
    /// Where it starts from.
    pub origin: [f32; 3],
    /// The least `t`.
    pub tnear: f32,
    /// Where it goes; `t` is measured in its length.
    pub direction: [f32; 3],
    time: f32,
    /// The greatest `t`.
    pub tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

const _: () = {
    assert!(size_of::<Ray>() == size_of::<RTCRay>() && align_of::<Ray>() == align_of::<RTCRay>());
    assert!(offset_of!(Ray, origin) == offset_of!(RTCRay, org_x));
    assert!(offset_of!(Ray, tnear) == offset_of!(RTCRay, tnear));
    assert!(offset_of!(Ray, direction) == offset_of!(RTCRay, dir_x));
    assert!(offset_of!(Ray, time) == offset_of!(RTCRay, time));
    assert!(offset_of!(Ray, tfar) == offset_of!(RTCRay, tfar));
    assert!(offset_of!(Ray, mask) == offset_of!(RTCRay, mask));
    assert!(offset_of!(Ray, id) == offset_of!(RTCRay, id));
    assert!(offset_of!(Ray, flags) == offset_of!(RTCRay, flags));
};

impl Ray {
    /// From `origin` along `direction`, `0 <= t <= infinity`.
    #[must_use]
    #[inline]
    pub const fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self {
            origin,
            tnear: 0.0,
            direction,
            time: 0.0,
            tfar: f32::INFINITY,
            mask: !0,
            id: 0,
            flags: 0,
        }
    }

    /// From `from` (t = 0) to `to` (t = 1).
    #[must_use]
    #[inline]
    pub fn between(from: [f32; 3], to: [f32; 3]) -> Self {
        Self::new(from, [to[0] - from[0], to[1] - from[1], to[2] - from[2]]).with_interval(0.0, 1.0)
    }

    /// The same ray with other ends.
    #[must_use]
    #[inline]
    pub const fn with_interval(self, tnear: f32, tfar: f32) -> Self {
        Self { tnear, tfar, ..self }
    }

    /// The same ray, seeing only geometries whose mask shares a bit with this one.
    #[must_use]
    #[inline]
    pub const fn with_mask(self, mask: NonZeroU32) -> Self {
        Self { mask: mask.get(), ..self }
    }

    /// The mask; all bits unless [`with_mask`](Self::with_mask) said otherwise.
    #[must_use]
    #[inline]
    pub const fn mask(&self) -> u32 {
        self.mask
    }

    /// Whether [`Scene::occluded1`](crate::Scene::occluded1) has found it blocked: that sets `tfar` to minus infinity.
    #[must_use]
    #[inline]
    pub fn is_occluded(&self) -> bool {
        self.tfar == f32::NEG_INFINITY
    }

    #[inline]
    pub(crate) fn as_raw(&mut self) -> *mut RTCRay {
        (&raw mut *self).cast()
    }

    pub(crate) fn with_room_for_hit(self) -> RTCRayHit {
        let Self { origin: [org_x, org_y, org_z], direction: [dir_x, dir_y, dir_z], .. } = self;
        let Self { tnear, time, tfar, mask, id, flags, .. } = self;
        let ray =
            RTCRay { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags };
        let (nowhere, none) = (0.0, !0);
        let hit = RTCHit {
            Ng_x: nowhere,
            Ng_y: nowhere,
            Ng_z: nowhere,
            u: nowhere,
            v: nowhere,
            primID: none,
            geomID: none,
            instID: [none],
            instPrimID: [none],
        };
        RTCRayHit { ray, hit }
    }
}

/// A point where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The mesh, as numbered by [`SceneBuilder::add`](crate::SceneBuilder::add).
    pub geometry: u32,
    /// The triangle's place in its mesh.
    pub primitive: u32,
    /// Where on the ray.
    pub t: f32,
    /// Barycentric coordinate towards the second vertex.
    pub u: f32,
    /// Barycentric coordinate towards the third vertex.
    pub v: f32,
    /// The triangle's normal, not normalised: `(v1 - v0) x (v2 - v0)` up to rounding.
    pub normal: [f32; 3],
}

impl Hit {
    pub(crate) fn from_raw(RTCRayHit { ray, hit }: &RTCRayHit) -> Option<Self> {
        (hit.geomID != !0).then_some(Self {
            geometry: hit.geomID,
            primitive: hit.primID,
            t: ray.tfar,
            u: hit.u,
            v: hit.v,
            normal: [hit.Ng_x, hit.Ng_y, hit.Ng_z],
        })
    }
}
