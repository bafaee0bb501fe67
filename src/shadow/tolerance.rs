//! `cache-tree-tolerance`: the tolerance check of §14, around the memories of the cache tree. With
//! what blocked, the point and the direction of the ray that it blocked are remembered; a ray from
//! elsewhere, or to elsewhere, is traced without testing what is remembered.
//!
//! Saves the tests that fail because queries jump, at the price of those that would have succeeded
//! over a distance, of 24 bytes a memory and of the check. Exact because it only omits tests.
//!
//! Pearce, Jevans: Exploiting Shadow Coherence in Ray Tracing. Graphics Interface 1991.

use glam::Vec3;

use super::{Inquiry, Memory, Outcome, ShadowQuery, ShadowTally};
use crate::geometry::Ray;
use crate::occlusion::Occluder;

/// How far from the remembered ray a ray may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    squared_distance: f32,
    squared_cosine: f32,
}

impl Tolerance {
    /// Points may be `distance` apart, directions half a turn times `share` (0 to 0.5).
    #[must_use]
    pub fn new(distance: f32, share: f32) -> Self {
        let cosine = (share.clamp(0.0, 0.5) * std::f32::consts::PI).cos();
        Self { squared_distance: distance * distance, squared_cosine: cosine * cosine }
    }
}

/// A memory, and the ray that was blocked last by what it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nearby<M> {
    /// The memory.
    pub memory: M,
    /// The ray's origin.
    pub origin: Vec3,
    /// The ray's direction.
    pub direction: Vec3,
}

impl<M> Nearby<M> {
    fn is_near(&self, ray: &Ray, tolerance: &Tolerance) -> bool {
        let cosine = self.direction.dot(ray.direction);
        let lengths = self.direction.length_squared() * ray.direction.length_squared();
        self.origin.distance_squared(ray.origin) <= tolerance.squared_distance
            && cosine >= 0.0
            && cosine * cosine >= tolerance.squared_cosine * lengths
    }

    fn set(&mut self, ray: &Ray) {
        (self.origin, self.direction) = (ray.origin, ray.direction);
    }
}

impl<M: Memory> Memory for Nearby<M> {
    type Shared = (Tolerance, M::Shared);

    const NEEDS_CELLS: bool = M::NEEDS_CELLS;

    #[inline(always)]
    fn recall<I: Inquiry>(
        &mut self,
        query: &ShadowQuery,
        (tolerance, shared): &mut Self::Shared,
        inquiry: &mut I,
        tally: &mut ShadowTally,
    ) -> Option<Outcome> {
        if !self.is_near(&query.ray, tolerance) {
            return None;
        }
        let outcome = self.memory.recall(query, shared, inquiry, tally)?;
        self.set(&query.ray);
        Some(outcome)
    }

    #[inline(always)]
    fn record(
        &mut self,
        query: &ShadowQuery,
        (_, shared): &mut Self::Shared,
        found: Option<Occluder>,
    ) {
        self.memory.record(query, shared, found);
        if found.is_some() {
            self.set(&query.ray);
        }
    }
}
