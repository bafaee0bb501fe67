//! The measuring bench.

pub mod compare;
pub mod contender;
pub mod extremes;
mod grouped;
pub mod paper;
pub mod recording;
pub mod wilson;

pub(crate) use grouped::grouped;
