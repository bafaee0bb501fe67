//! How much memory may be spent on what is prepared.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Bytes that are left for prepared structures; they share one budget, and whatever grows while queries
/// are answered asks for each part before it makes it.
#[derive(Debug)]
pub struct Budget {
    left: AtomicU64,
}

impl Budget {
    /// So many bytes.
    #[must_use]
    pub fn new(bytes: u64) -> Self {
        Self { left: AtomicU64::new(bytes) }
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
}
