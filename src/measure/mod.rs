//! The measuring bench.

pub mod compare;
pub mod contender;
mod grouped;
pub mod paper;
pub mod recording;
pub mod wilson;

pub(crate) use grouped::grouped;
