//! How far the triangles of a surface are from the surface itself.

use glam::{DAffine3, DVec3};

use super::{Resolution, Surface};

/// Where a triangle is held against its surface, as shares of its corners: its middle, and the middles
/// of its sides, where a curved surface is farthest from it.
const PLACES: [[f64; 3]; 4] =
    [[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];

/// Distances from points of triangles to the points of the surface at the same parameters, of which
/// the nearest point of the surface is at most as far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// The greatest, in the unit of the surface.
    pub greatest: f64,
    /// Sum over triangles of area times mean square distance.
    weighted_squares: f64,
    area: f64,
}

impl Deviation {
    /// The root of the mean square over all of the area.
    #[must_use]
    pub fn root_mean_square(&self) -> f64 {
        if self.area > 0.0 { (self.weighted_squares / self.area).sqrt() } else { 0.0 }
    }

    /// Of a surface's triangles at a resolution that is made [`fitting`](Resolution::fitting) first, after
    /// `place` took it to the world.
    #[must_use]
    pub fn of(surface: &impl Surface, resolution: Resolution, place: DAffine3) -> Self {
        let Resolution { u: across, v: along } = resolution.fitting(surface);
        let point = |[u, v]: [f64; 2]| place.transform_point3(surface.point(u, v));
        let mut whole = Self::default();
        for row in 0..along {
            for column in 0..across {
                let corner = |right: usize, up: usize| {
                    [(column + right) as f64 / across as f64, (row + up) as f64 / along as f64]
                };
                // The two triangles of a cell; at a pole one of them has no area.
                for parameters in [
                    [corner(0, 0), corner(1, 0), corner(1, 1)],
                    [corner(0, 0), corner(1, 1), corner(0, 1)],
                ] {
                    whole += Self::of_triangle(parameters, &point);
                }
            }
        }
        whole
    }

    fn of_triangle(parameters: [[f64; 2]; 3], point: &impl Fn([f64; 2]) -> DVec3) -> Self {
        let [a, b, c] = parameters.map(point);
        let area = 0.5 * (b - a).cross(c - a).length();
        let distances = PLACES.map(|[p, q, r]| {
            let [s, t] =
                [0, 1].map(|i| p * parameters[0][i] + q * parameters[1][i] + r * parameters[2][i]);
            (p * a + q * b + r * c).distance(point([s, t]))
        });
        let squares = distances.iter().map(|distance| distance * distance).sum::<f64>();
        Self {
            greatest: distances.into_iter().fold(0.0, f64::max),
            weighted_squares: area * squares / PLACES.len() as f64,
            area,
        }
    }
}

impl std::ops::AddAssign for Deviation {
    fn add_assign(&mut self, other: Self) {
        self.greatest = self.greatest.max(other.greatest);
        self.weighted_squares += other.weighted_squares;
        self.area += other.area;
    }
}
