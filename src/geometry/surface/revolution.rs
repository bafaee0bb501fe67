//! Surfaces of revolution: a cubic Bézier profile turned around the Y axis.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Cubic, SecondDerivatives, Surface, Topology, cosine_and_sine};

/// A profile of (radius, height) turned around the Y axis: u is the angle, v runs along the profile.
///
/// A profile that climbs has its normal outwards. An end of radius zero is a pole; the profile
/// should meet the axis at a right angle there, or the pole is a tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolution {
    /// The profile.
    pub profile: Cubic<DVec2>,
}

impl Surface for Revolution {
    fn point(&self, u: f64, v: f64) -> DVec3 {
        let profile = self.profile.point(v);
        let (cosine, sine) = cosine_and_sine(u);
        DVec3::new(profile.x * cosine, profile.y, -profile.x * sine)
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        let slope = self.profile.derivative(v);
        let (cosine, sine) = cosine_and_sine(u);
        DVec3::new(slope.y * cosine, -slope.x, -slope.y * sine).normalize()
    }

    fn second_derivatives(&self) -> SecondDerivatives {
        // A Bézier curve stays within the range of its control points.
        let widest = |values: &[DVec2]| values.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
        let bend = self.profile.second_differences().map(DVec2::length);
        SecondDerivatives {
            uu: TAU * TAU * widest(&self.profile.0),
            uv: TAU * widest(&self.profile.differences()),
            vv: bend[0].max(bend[1]),
        }
    }

    fn topology(&self) -> Topology {
        Topology {
            closed_u: true,
            pole_at_start: self.profile.0[0].x == 0.0,
            pole_at_end: self.profile.0[3].x == 0.0,
        }
    }
}
