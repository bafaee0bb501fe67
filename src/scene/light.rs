//! Point, spot and directional lights.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;

/// A light without extent: its shadows are hard, one query decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines alike in all directions.
    Point {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity; falls with the square of the distance.
        intensity: Vec3,
    },
    /// Shines into a cone.
    Spot {
        /// Where it is.
        position: DVec3,
        /// Unit vector along the axis, away from the light.
        axis: DVec3,
        /// Radiant intensity on the axis.
        intensity: Vec3,
        /// Half angle of the fully lit cone, radians.
        inner: f64,
        /// Half angle beyond which it is dark, radians.
        outer: f64,
    },
    /// So far away that its rays are parallel.
    Directional {
        /// Unit vector from the scene to the light.
        direction: DVec3,
        /// Irradiance on a surface that faces it.
        irradiance: Vec3,
    },
}

/// A vector whose length is one but for the rounding of f32 is left as it is, bit for bit.
const NEARLY_ONE: f64 = 1e-6;

/// A vector of the same direction with length one; `None` if it has none.
fn unit(vector: DVec3) -> Option<DVec3> {
    if (vector.length() - 1.0).abs() < NEARLY_ONE {
        return Some(vector);
    }
    // Squares of what is longest would overflow.
    let longest = vector.abs().max_element();
    if vector.is_finite() { (vector / longest).try_normalize() } else { None }
}

/// What a light sends to a point, shadows apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit vector from the point to the light.
    pub direction: Vec3,
    /// Irradiance on a surface that faces the light.
    pub irradiance: Vec3,
}

impl Light {
    /// The shadow ray from `origin`: to the point of the light with `end` 1, or along its direction
    /// with an infinite `end`.
    #[must_use]
    #[inline]
    pub fn shadow_ray(&self, origin: Vec3) -> Ray {
        match self {
            Self::Point { position, .. } | Self::Spot { position, .. } => {
                Ray::between(origin, position.as_vec3())
            }
            Self::Directional { direction, .. } => Ray::towards(origin, direction.as_vec3()),
        }
    }

    /// What arrives at `point` where nothing is in between; `None` outside the cone of a spot light
    /// and at the place of the light itself.
    #[must_use]
    #[inline]
    pub fn illuminate(&self, point: DVec3) -> Option<Illumination> {
        let from = |position: DVec3, intensity: Vec3| {
            let to_light = position - point;
            let squared = to_light.length_squared();
            (squared > 0.0).then(|| Illumination {
                direction: (to_light / squared.sqrt()).as_vec3(),
                irradiance: intensity * (1.0 / squared) as f32,
            })
        };
        match *self {
            Self::Point { position, intensity } => from(position, intensity),
            Self::Spot { position, axis, intensity, inner, outer } => {
                let mut light = from(position, intensity)?;
                let cosine = -axis.dot(light.direction.as_dvec3());
                let (inner, outer) = (inner.cos(), outer.cos());
                if cosine <= outer {
                    return None;
                }
                // The falloff that KHR_lights_punctual recommends: a squared linear ramp of the cosine.
                let ramp = ((cosine - outer) / (inner - outer).max(1e-9)).clamp(0.0, 1.0);
                light.irradiance *= (ramp * ramp) as f32;
                Some(light)
            }
            Self::Directional { direction, irradiance } => {
                Some(Illumination { direction: direction.as_vec3(), irradiance })
            }
        }
    }

    /// Whether its numbers are finite, also in f32, its vectors point somewhere, its colour is not negative, and the
    /// half angles of a spot are 0 ≤ inner ≤ outer ≤ π with outer above 0.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let place = |place: &DVec3| place.as_vec3().is_finite();
        match self {
            Self::Point { position, intensity } => place(position) && is_colour(intensity),
            Self::Spot { position, axis, intensity, inner, outer } => {
                let vectors = place(position) && unit(*axis).is_some();
                // Half a turn as f32 has it, for files do, is a little more than as f64 has it.
                let half_a_turn = f64::from(std::f32::consts::PI);
                let cone = *outer > 0.0 && *outer <= half_a_turn && (0.0..=*outer).contains(inner);
                vectors && is_colour(intensity) && cone
            }
            Self::Directional { direction, irradiance } => {
                unit(*direction).is_some() && is_colour(irradiance)
            }
        }
    }

    /// The same light with vectors of length one.
    #[must_use]
    pub(super) fn with_unit_vectors(mut self) -> Self {
        if let Self::Spot { axis: vector, .. } | Self::Directional { direction: vector, .. } =
            &mut self
        {
            *vector = unit(*vector).unwrap_or(*vector);
        }
        self
    }

    /// The same light with its place moved by `-origin`.
    #[must_use]
    pub(super) fn relative_to(mut self, origin: DVec3) -> Self {
        if let Self::Point { position, .. } | Self::Spot { position, .. } = &mut self {
            *position -= origin;
        }
        self
    }
}

/// Whether a colour is finite and nowhere negative.
pub(super) fn is_colour(colour: &Vec3) -> bool {
    colour.is_finite() && colour.cmpge(Vec3::ZERO).all()
}

/// Whether a factor from radiance to picture values is one.
pub(super) fn is_exposure(factor: f32) -> bool {
    factor > 0.0 && factor.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(direction: DVec3) -> Light {
        Light::Directional { direction, irradiance: Vec3::ONE }
    }

    #[test]
    fn directions_of_any_length_become_unit_vectors_and_unit_vectors_stay_as_they_are() {
        let way = DVec3::new(3.0, 0.0, -4.0);
        for length in [1e-300, 1e-30, 0.5, 1.1, 1e30, 1e300] {
            let light = sun(length * way);
            assert!(light.is_sound());
            let Light::Directional { direction, .. } = light.with_unit_vectors() else { panic!() };
            assert!((direction - way / 5.0).length() < 1e-15, "{length}: {direction}");
        }
        let rounded = Vec3::new(1.0, 2.0, 3.0).normalize().as_dvec3();
        assert_eq!(sun(rounded).with_unit_vectors(), sun(rounded));
    }

    #[test]
    fn a_cone_that_is_wider_within_than_without_is_no_light() {
        let spot = |inner: f64, outer: f64| Light::Spot {
            position: DVec3::ZERO,
            axis: DVec3::NEG_Y,
            intensity: Vec3::ONE,
            inner,
            outer,
        };
        for (inner, outer) in [(0.0, 0.5), (0.5, 0.5), (0.0, 180f64.to_radians())] {
            assert!(spot(inner, outer).is_sound(), "{inner} {outer}");
        }
        for (inner, outer) in [(0.5, 0.4), (-0.1, 0.5), (0.0, 0.0), (0.0, 4.0), (f64::NAN, 0.5)] {
            assert!(!spot(inner, outer).is_sound(), "{inner} {outer}");
        }
    }

    #[test]
    fn what_points_nowhere_or_is_beyond_f32_is_no_light() {
        for direction in [DVec3::ZERO, DVec3::NAN, DVec3::X * f64::INFINITY] {
            assert!(!sun(direction).is_sound(), "{direction}");
        }
        let point = |x: f64| Light::Point { position: DVec3::X * x, intensity: Vec3::ONE };
        assert!(point(1e38).is_sound() && !point(1e39).is_sound());
    }
}
