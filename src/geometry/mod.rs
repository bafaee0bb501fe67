//! Rays, triangles, boxes: the bits every engine is given.

mod bounds;
pub mod intersect;
pub mod lanes;
mod ray;
pub mod surface;
mod triangles;

pub use bounds::Bounds;
pub use ray::Ray;
pub use triangles::{Triangle, TriangleId, Triangles, is_finite};
