//! The measuring bench.

pub mod contender;
pub mod extremes;
pub mod paper;
pub mod recording;
pub mod wilson;
