//! Where memories live.

use super::Path;

/// Says which memory a query consults. Owned by a worker; a memory is made when it is first asked for.
pub trait Shelf<M>: Clone + Send + Sync {
    /// The memory of a light, for queries spawned there in the ray tree.
    fn at(&mut self, light: usize, path: Path) -> &mut M;

    /// Forgets everything.
    fn clear(&mut self);

    /// Memories made.
    fn count(&self) -> usize;
}

/// One memory a light.
#[derive(Clone, Debug)]
pub struct PerLight<M>(Vec<M>);

impl<M> Default for PerLight<M> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<M: Clone + Default + Send + Sync> Shelf<M> for PerLight<M> {
    #[inline(always)]
    fn at(&mut self, light: usize, _: Path) -> &mut M {
        if light >= self.0.len() {
            self.0.resize_with(light + 1, M::default);
        }
        &mut self.0[light]
    }

    fn clear(&mut self) {
        self.0.clear();
    }

    fn count(&self) -> usize {
        self.0.len()
    }
}
