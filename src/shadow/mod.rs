//! What stands before a backend: shadow methods.
//!
//! A query asks verdicts first (prepared, shared, settle some queries as lit or blocked), then
//! memories (owned by the worker, may only say "blocked", on a triangle's word), then the backend.
//! Before a backend with the exact test no method changes an answer, whatever it remembers. Before an f32 test, or Embree, memories keep
//! the backend's bits, as they ask its own test; verdicts give the exact answer instead.
//!
//! | verdict | what proves it |
//! | --- | --- |
//! | `shaft` | between a light and 256 neighbouring origins lies nothing, or something that planes through the light decide |
//! | `light-buffer` | what lies in one direction of a light, nearest first |
//! | `voxel-occlusion` | between a light and a voxel all light comes through, or none |
//! | `shadow-polygons` | the shadow volumes that reach into a voxel, counted |
//!
//! A method is a memory on a shelf, which says where memories live, behind any verdicts:
//!
//! | method | memory | shelf |
//! | --- | --- | --- |
//! | `trace` | none | |
//! | `object-cache` | [`LastOccluder`] | [`PerLight`] |
//! | `voxel-cache` | [`LastVoxel`] | [`PerLight`] |
//! | `cache-tree` | [`LastVoxel`] | [`PerPath`] |
//! | `cache-tree-tolerance` | [`Nearby`]`<LastVoxel>` | [`PerPath`] |
//! | `woo` | [`LastCell`] | [`PerLight`] |
//!
//! [`Auto`] stands before several of them, and asks now this one, now that, whichever is cheapest.

mod auto;
mod budget;
mod cache_tree;
mod caster;
mod combination;
mod debug;
mod inquiry;
mod kind;
mod light_buffer;
mod memory;
mod method;
mod object_cache;
mod plan;
mod query;
mod shadow_polygons;
mod shaft;
mod shelf;
mod stock;
mod tally;
mod tolerance;
mod trace;
mod transparent;
mod verdict;
mod voxel_cache;
mod voxel_occlusion;
mod voxels;
mod woo;

pub use auto::{Auto, CandidateShare, LightChoices};
pub use budget::Budget;
pub use cache_tree::PerPath;
pub use caster::{Cached, Caster};
pub use combination::{Combination, CombinationError, VerdictSet};
pub use inquiry::{Direct, Inquiry, Retest, Sparing};
pub use kind::VerdictKind;
pub use memory::{Forgetful, Memory};
pub use method::Method;
pub use object_cache::LastOccluder;
pub use plan::{MethodError, Plan, SelfShadow, prepare};
pub use query::{Answer, Outcome, Path, ShadowQuery};
pub use shelf::{PerLight, Shelf};
pub use tally::ShadowTally;
pub use tolerance::{Nearby, Tolerance};
pub use trace::Trace;
pub use transparent::{Attenuation, Glass, Panes};
pub use verdict::{Settled, Verdict, VerdictReport, Verdicts};
pub use voxel_cache::LastVoxel;
pub use woo::{Fronts, LastCell};

/// A method made ready for one scene; shared by all workers.
pub trait Prepared: Send + Sync {
    /// What one worker uses, with memories of its own.
    fn worker(&self) -> Box<dyn Shadows + '_>;

    /// Bytes of what was prepared, the backend apart.
    fn memory(&self) -> usize {
        0
    }

    /// What each verdict took to prepare, so far.
    fn verdicts(&self) -> Vec<VerdictReport> {
        Vec::new()
    }

    /// What finds the transparent triangles that queries meet; `None` if nothing does yet.
    fn glass(&self) -> Option<&dyn Glass> {
        None
    }

    /// Who answered, and why; empty if there was no choice.
    fn choices(&self) -> Vec<LightChoices> {
        Vec::new()
    }

    /// Whether a query's own triangle is left out; its ray then starts on the surface itself.
    fn leaves_out_spawner(&self) -> bool {
        false
    }
}

/// Answers shadow queries for one worker; may move to another thread, but serves one at a time.
pub trait Shadows: Send {
    /// Answers queries towards one light, by its index in the scene that the method was prepared for. Transparent triangles do not
    /// count here.
    ///
    /// # Panics
    /// If the slices differ in length. If the scene has no such light, methods that prepare something for each light
    /// panic, and the others answer.
    fn answer(&mut self, light: usize, queries: &[ShadowQuery], answers: &mut [Answer]);

    /// A new scanline begins: §8 of the paper forgets what was remembered.
    fn begin_scanline(&mut self) {}

    /// What was counted so far.
    fn tally(&self) -> ShadowTally;
}
