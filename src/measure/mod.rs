//! The measuring bench.

pub mod compare;
pub mod contender;
mod error;
pub mod extremes;
mod numbers;
pub mod paper;
pub mod recording;
pub mod report;
pub mod tradeoff;
mod truth;
mod turns;
pub mod wilson;

pub use error::MeasureError;
use numbers::{bits, told};
pub(crate) use numbers::{count, grouped, size};
