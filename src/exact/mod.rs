//! Exact decisions: does the open ray meet the closed triangle, as real arithmetic on the given bits says?
//!
//! [`certified`] decides in f64 where a bound allows, else by [`expansion`]s.
//! The [`oracle`] answers the same question by big integers and shares no code with it;
//! [`adversary`] makes queries that are hard to get right.
//!
//! All of it assumes the floating-point environment that Rust guarantees: rounding to nearest, and denormals not flushed to zero.

pub mod adversary;
pub mod certified;
pub mod expansion;
pub mod oracle;

pub use certified::{Stage, blocks, decide};
pub use oracle::Verdict;
