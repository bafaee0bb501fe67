//! The measuring bench.

pub mod compare;
pub mod contender;
pub mod extremes;
mod grouped;
pub mod paper;
pub mod recording;
pub mod report;
pub mod tradeoff;
mod truth;
pub mod wilson;

pub(crate) use grouped::grouped;
