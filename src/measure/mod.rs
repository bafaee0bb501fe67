//! The measuring bench.

pub mod paper;
pub mod report;
pub mod tradeoff;
