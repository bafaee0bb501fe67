//! Sweeps: a circle moved along a curve, which gives tubes, rods, legs and wires.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Cubic, Path, SecondDerivatives, Surface, Topology, cosine_and_sine};

/// A tube of constant radius: u runs around it, v along its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// The middle of the tube.
    pub path: Path<DVec3>,
    /// Its radius, less than the path's radius of curvature.
    pub radius: f64,
    /// A unit vector that the path never runs along: angle zero of the circle is on its side, which
    /// keeps the tube from twisting. For a plane curve take the normal of its plane.
    pub side: DVec3,
}

impl Surface for Tube {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        self.path.point(v) + self.normal(u, v) * self.radius
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        let tangent = self.path.derivative(v).normalize();
        let first = (self.side - tangent * self.side.dot(tangent)).normalize();
        let (cosine, sine) = cosine_and_sine(u);
        first * cosine + tangent.cross(first) * sine
    }

    fn second_derivatives(&self) -> SecondDerivatives {
        /// Parts of each piece that are bounded by themselves: the finer, the tighter.
        const PARTS: usize = 8;
        let cuts = |part: usize| part as f64 / PARTS as f64;
        let parts =
            self.path.pieces().iter().flat_map(|piece| {
                (0..PARTS).map(move |part| piece.part(cuts(part), cuts(part + 1)))
            });
        let per_part = (PARTS * self.path.pieces().len()) as f64;
        let mut bounds = SecondDerivatives { uu: TAU * TAU * self.radius, uv: 0.0, vv: 0.0 };
        for part in parts {
            let (turn, bend) = self.bounds(&part);
            bounds.uv = bounds.uv.max(TAU * self.radius * turn * per_part);
            bounds.vv = bounds.vv.max(bend * per_part * per_part);
        }
        bounds
    }

    fn topology(&self) -> Topology {
        Topology { closed_u: true, ..Topology::default() }
    }
}

impl Tube {
    /// Over a part of the path, bounds of the first derivative of the normal and of the second one
    /// of the surface, along v.
    fn bounds(&self, part: &Cubic<DVec3>) -> (f64, f64) {
        let (slopes, bends) = (part.differences(), part.second_differences());
        let longest = |vectors: &[DVec3]| vectors.iter().map(|d| d.length()).fold(0.0, f64::max);
        let shortest = |vectors: [DVec3; 3]| {
            let middle = (vectors[0] + vectors[1] + vectors[2]).normalize_or_zero();
            vectors.iter().map(|d| d.dot(middle)).fold(f64::INFINITY, f64::min).max(0.0)
        };
        let (fastest, bend) = (longest(&slopes), longest(&bends));
        let tangent = unit(shortest(slopes), bend, (bends[1] - bends[0]).length());
        // The part of `side` across the tangent, which makes the first vector of the circle.
        let across = shortest(slopes.map(|slope| self.side.cross(slope))) / fastest;
        let first = unit(across, 2.0 * tangent.0, 2.0 * tangent.1 + 2.0 * tangent.0 * tangent.0);
        let second = (tangent.0 + first.0, tangent.1 + 2.0 * tangent.0 * first.0 + first.1);
        (first.0 + second.0, bend + self.radius * (first.1 + second.1))
    }
}

/// Bounds of the first two derivatives of w/|w|, from |w| ≥ `least` and bounds of those of w.
fn unit(least: f64, first: f64, second: f64) -> (f64, f64) {
    let slope = first / least;
    (slope, second / least + 3.0 * slope * slope)
}
