//! The ray of a query.

use glam::Vec3;

/// The points `origin + t·direction` with `0 < t < end`: one shadow query.
///
/// The direction is not normalised. Towards a point light it is `light − origin`, rounded once
/// to f32, and `end` is 1; towards a directional light `end` is infinite. Every backend gets these
/// same bits, and the exact verdict is about these bits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts; the interval is open, so the origin itself is not on the ray.
    pub origin: Vec3,
    /// Direction, of any length.
    pub direction: Vec3,
    /// End of the open interval of `t`: 1 towards a point, infinite towards a direction.
    pub end: f32,
}

impl Ray {
    /// The open segment between two points.
    #[must_use]
    pub fn between(origin: Vec3, target: Vec3) -> Self {
        Self { origin, direction: target - origin, end: 1.0 }
    }

    /// The open half line from `origin`.
    #[must_use]
    pub fn towards(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, end: f32::INFINITY }
    }

    /// Whether origin and direction are finite and `end` is above zero and not NaN.
    ///
    /// Any other ray is answered "not blocked" by every backend, and counted as invalid.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.end > 0.0
    }

    /// The point at `t`, in f64.
    #[must_use]
    pub fn at(&self, t: f64) -> glam::DVec3 {
        self.origin.as_dvec3() + t * self.direction.as_dvec3()
    }
}
