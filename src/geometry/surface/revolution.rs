//! Surfaces of revolution: a profile turned around the Y axis.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Path, SecondDerivatives, Surface, Topology, cosine_and_sine};

/// A profile of (radius, height) turned around the Y axis: u is the angle, v runs along the profile.
///
/// A profile that climbs has its normal outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    profile: Path<DVec2>,
}

impl Revolution {
    /// The smooth surface whose profile passes through the points. An end of radius zero is a round
    /// pole.
    ///
    /// # Panics
    /// With fewer than two points.
    #[must_use]
    pub fn through(points: &[DVec2]) -> Self {
        // Over the axis a profile goes on as its mirror image.
        let beyond =
            |pole: DVec2, next: DVec2| (pole.x == 0.0).then(|| DVec2::new(-next.x, next.y));
        let last = points.len() - 1;
        let (before, after) =
            (beyond(points[0], points[1]), beyond(points[last], points[last - 1]));
        Self { profile: Path::through(points, before, after) }
    }
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
        let pieces = self.profile.pieces();
        let count = pieces.len() as f64;
        // A Bézier curve stays within the range of its control points.
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let radius = largest(&mut pieces.iter().flat_map(|p| p.0).map(|p| p.x.abs()));
        let slope = largest(&mut pieces.iter().flat_map(|p| p.differences()).map(|d| d.x.abs()));
        let bend =
            largest(&mut pieces.iter().flat_map(|p| p.second_differences()).map(DVec2::length));
        SecondDerivatives {
            uu: TAU * TAU * radius,
            uv: TAU * slope * count,
            vv: bend * count * count,
        }
    }

    fn topology(&self) -> Topology {
        Topology {
            closed_u: true,
            pole_at_start: self.profile.point(0.0).x == 0.0,
            pole_at_end: self.profile.point(1.0).x == 0.0,
        }
    }
}
