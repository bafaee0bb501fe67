//! Sweeps: a circle moved along a curve, which gives tubes, rods, legs and wires.

use glam::DVec3;

use super::bezier::{piece, smooth_controls};
use super::{Cubic, SecondDerivatives, Surface, Topology, cosine_and_sine};

/// A smooth curve of cubic Bézier pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pieces: Vec<Cubic<DVec3>>,
}

impl Path {
    /// The smooth curve through the points.
    ///
    /// # Panics
    /// With fewer than two points.
    #[must_use]
    pub fn through(points: &[DVec3]) -> Self {
        assert!(points.len() > 1, "a path needs two points");
        let controls = smooth_controls(points, None, None);
        let pieces =
            (0..points.len() - 1).map(|i| Cubic([0, 1, 2, 3].map(|j| controls[3 * i + j])));
        Self { pieces: pieces.collect() }
    }

    /// The straight line from `a` to `b`.
    #[must_use]
    pub fn line(a: DVec3, b: DVec3) -> Self {
        Self { pieces: vec![Cubic::line(a, b)] }
    }

    /// The point at `t` from 0 to 1, and the derivative by the place within its piece.
    fn at(&self, t: f64) -> (DVec3, DVec3) {
        let (index, place) = piece(t, self.pieces.len());
        (self.pieces[index].point(place), self.pieces[index].derivative(place))
    }
}

/// A tube of constant radius: u runs around it, v along its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// The middle of the tube.
    pub path: Path,
    /// Its radius, less than the path's radius of curvature.
    pub radius: f64,
    /// A direction that the path never runs along: angle zero of the circle is on its side, which
    /// keeps the tube from twisting. For a plane curve take the normal of its plane.
    pub side: DVec3,
}

impl Tube {
    /// Two unit vectors across the path at a tangent.
    fn across(&self, tangent: DVec3) -> (DVec3, DVec3) {
        let tangent = tangent.normalize();
        let first = (self.side - tangent * self.side.dot(tangent)).normalize();
        (first, tangent.cross(first))
    }
}

impl Surface for Tube {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        self.path.at(v).0 + self.normal(u, v) * self.radius
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        let (first, second) = self.across(self.path.at(v).1);
        let (cosine, sine) = cosine_and_sine(u);
        first * cosine + second * sine
    }

    fn second_derivatives(&self) -> SecondDerivatives {
        SecondDerivatives::default()
    }

    fn topology(&self) -> Topology {
        Topology { closed_u: true, ..Topology::default() }
    }

    fn pieces(&self) -> (usize, usize) {
        (1, self.path.pieces.len())
    }
}
