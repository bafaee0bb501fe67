//! The measuring bench.

pub mod paper;
