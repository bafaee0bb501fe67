//! Whose turn it is, of several that are measured side by side.

use std::hash::{DefaultHasher, Hash, Hasher};

/// The numbers below `count` in an order drawn for a round, the same in every run: whoever ran before is not always the same.
pub fn order_of(count: usize, round: impl Hash) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_cached_key(|which| {
        let mut hasher = DefaultHasher::new();
        (which, &round).hash(&mut hasher);
        hasher.finish()
    });
    order
}
