//! The measuring bench.

pub mod contender;
pub mod paper;
pub mod recording;
pub mod report;
pub mod tradeoff;
pub mod wilson;
