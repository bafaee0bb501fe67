//! How much memory may be spent on what is prepared.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::occlusion::Occlusion;
use crate::scene::{Scene, default_budget};

/// Bytes to a triangle that prepared structures take together, unless more is allowed: what Embree's structure over the
/// scene takes (64 to 70).
const BYTES_PER_TRIANGLE: u64 = 64;

/// But in small scenes so many bytes; what is prepared for a light has a size of its own.
const LEAST: u64 = 1 << 20;

/// Bytes that are left for prepared structures; they share one budget, and whatever grows while queries
/// are answered asks for each part before it makes it.
#[derive(Debug)]
pub struct Budget {
    left: AtomicU64,
    /// Bytes that there were.
    all: u64,
    /// Bytes that the backend beside takes, or would under a larger limit.
    backend: u64,
}

impl Budget {
    /// So many bytes.
    #[must_use]
    pub fn new(bytes: u64) -> Self {
        Self { left: AtomicU64::new(bytes), all: bytes, backend: 0 }
    }

    /// What a limit leaves beside a backend, which may be a coarser one than that of `wanted` bytes. Without a limit, what
    /// Embree would take over the scene, and no more than is left of the machine's share.
    #[must_use]
    pub fn beside(backend: &dyn Occlusion, wanted: u64, scene: &Scene, limit: Option<u64>) -> Self {
        let backend = backend.memory() as u64;
        let rest = limit.unwrap_or_else(default_budget).saturating_sub(backend);
        let modest = (BYTES_PER_TRIANGLE * scene.triangles.len() as u64).max(LEAST);
        let bytes = if limit.is_some() { rest } else { rest.min(modest) };
        Self { backend: backend.max(wanted), ..Self::new(bytes) }
    }

    /// What a user may do so that so many more bytes fit: no more than a try, as others may grow into the same room.
    #[must_use]
    pub fn advice(&self, missing: u64) -> String {
        let wanted = self.backend + (self.all - self.left().min(self.all)) + missing;
        format!("try --memory {}M or more", wanted.div_ceil(1 << 20))
    }

    /// Bytes left.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.left.load(Relaxed)
    }

    /// Takes bytes if there are so many.
    #[must_use]
    pub fn take(&self, bytes: usize) -> bool {
        let without = |left: u64| left.checked_sub(bytes as u64);
        self.left.fetch_update(Relaxed, Relaxed, without).is_ok()
    }

    /// Gives back bytes that were taken and turned out not to be needed.
    pub fn give_back(&self, bytes: usize) {
        self.left.fetch_add(bytes as u64, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_never_overdrawn() {
        let budget = Budget::new(100);
        assert!(budget.take(60) && !budget.take(41) && budget.take(40) && !budget.take(1));
        budget.give_back(10);
        assert_eq!(budget.left(), 10);
    }

    #[test]
    fn without_a_limit_no_more_is_taken_than_embree_takes() {
        let scene = crate::scene::load("jittered-dense").unwrap();
        let backend = crate::occlusion::build(
            crate::occlusion::Backend::Brute,
            crate::occlusion::Test::Exact,
            &scene.triangles,
            &crate::occlusion::BuildOptions::default(),
        );
        let backend = &*backend.unwrap();
        let triangles = scene.triangles.len() as u64;
        assert_eq!(Budget::beside(backend, 0, &scene, None).left(), 64 * triangles);
        let given = Budget::beside(backend, 0, &scene, Some(1 << 30));
        assert_eq!(given.left(), (1 << 30) - backend.memory() as u64);
    }

    #[test]
    fn the_advice_counts_what_was_taken_and_what_is_missing() {
        let budget = Budget::new(10 << 20);
        assert!(budget.take(6 << 20) && !budget.take(7 << 20));
        assert_eq!(budget.advice(7 << 20), "try --memory 13M or more");
    }
}
