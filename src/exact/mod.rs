//! Exact decisions: does the open ray meet the closed triangle, as real arithmetic on the given bits says?
//!
//! Three stages, each asked only about what the one before could not certify: [`filter`] (f32, many triangles
//! at a time), then [`certified`] (f64, then [`expansion`]s).
//! The [`oracle`] answers the same question by big integers and shares no code with them;
//! [`adversary`] makes queries that are hard to get right, and [`campaign`] holds the stages against each other
//! and against the oracle on them.
//!
//! All of it assumes the floating-point environment that Rust guarantees: rounding to nearest, and denormals not flushed to zero.

pub mod adversary;
pub mod campaign;
pub mod certified;
pub mod expansion;
pub mod filter;
pub mod oracle;
pub(crate) mod random;

pub use certified::{Stage, blocks, decide};
pub use filter::Exact;
pub use oracle::Verdict;
