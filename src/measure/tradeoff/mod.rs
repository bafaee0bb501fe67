//! Speed against accuracy, measured.
pub mod pareto;
