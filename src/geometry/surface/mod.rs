//! Parametric surfaces and their triangles.
//!
//! A [`Surface`] can be evaluated at any parameter, so the error of its triangles can be measured
//! against the surface itself. Everything is computed with `+ − × ÷ √` in f64, which IEEE 754
//! defines to the last bit: the same surface gives the same triangles on every machine.

mod bezier;
mod circle;
mod deviation;
mod revolution;
mod sweep;
mod tessellate;
#[cfg(test)]
mod tests;

pub use bezier::{Cubic, Path, Point, Sheet};
pub use circle::cosine_and_sine;
pub use deviation::Deviation;
pub use revolution::Revolution;
pub use sweep::Tube;
pub use tessellate::{Mesh, Resolution, tessellate, triangle_count};

use glam::DVec3;

/// A surface over the unit square of parameters.
pub trait Surface {
    /// The point at (u, v).
    fn point(&self, u: f64, v: f64) -> DVec3;

    /// The unit normal at (u, v), on the side of ∂u × ∂v.
    fn normal(&self, u: f64, v: f64) -> DVec3;

    /// Bounds of the second derivatives, from which the tessellator takes its resolution. They may
    /// jump from piece to piece; the first derivatives may not.
    fn second_derivatives(&self) -> SecondDerivatives;

    /// Which of its edges are one.
    fn topology(&self) -> Topology;
}

/// Upper bounds of the lengths of a surface's second derivatives over its pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondDerivatives {
    /// Of ∂²/∂u².
    pub uu: f64,
    /// Of ∂²/∂u∂v.
    pub uv: f64,
    /// Of ∂²/∂v².
    pub vv: f64,
}

/// How the edges of the unit square meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// The edge u = 1 is the edge u = 0.
    pub closed_u: bool,
    /// The edge v = 0 is a single point.
    pub pole_at_start: bool,
    /// The edge v = 1 is a single point.
    pub pole_at_end: bool,
}
