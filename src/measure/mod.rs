//! The measuring bench.

pub mod extremes;
pub mod paper;
