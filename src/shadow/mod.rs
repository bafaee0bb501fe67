//! What stands before a backend: shadow methods.
//!
//! A query asks verdicts first (prepared, shared, settle some queries as lit or blocked), then
//! memories (owned by the worker, may only say "blocked", on a triangle's word), then the backend.
//! For any content of any of them the answer is that of the backend alone, bit for bit.

mod method;
mod query;
mod tally;
mod trace;
mod transparent;

pub use method::{Method, MethodError, prepare};
pub use query::{Answer, Outcome, Path, ShadowQuery};
pub use tally::ShadowTally;
pub use trace::Trace;
pub use transparent::Attenuation;

/// A method made ready for one scene; shared by all workers.
pub trait Prepared: Send + Sync {
    /// What one worker uses, with memories of its own.
    fn worker(&self) -> Box<dyn Shadows + '_>;

    /// Bytes of what was prepared, the backend apart.
    fn memory(&self) -> usize {
        0
    }
}

/// Answers shadow queries for one worker.
pub trait Shadows {
    /// Answers queries towards one light. Transparent triangles do not count here.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]);

    /// A new scanline begins: §8 of the paper forgets what was remembered.
    fn begin_scanline(&mut self) {}

    /// What was counted so far.
    fn tally(&self) -> ShadowTally;
}
