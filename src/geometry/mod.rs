//! Rays, triangles, boxes: the bits every engine is given.

mod bounds;
mod hilbert;
pub mod intersect;
pub mod lanes;
mod prefetch;
pub(crate) mod random;
mod ray;
pub mod surface;
mod triangles;

pub use bounds::Bounds;
pub use hilbert::along_hilbert;
pub(crate) use prefetch::prefetch;
pub use ray::Ray;
pub(crate) use triangles::NOBODY;
pub use triangles::{Triangle, TriangleId, Triangles, is_finite};
