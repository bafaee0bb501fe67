//! Axis-aligned boxes.

use glam::Vec3;

/// A closed axis-aligned box; by default, the zero point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box that holds all three corners.
    #[must_use]
    pub fn of(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths, rounded.
    #[must_use]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Middle, computed in f64 so that it cannot overflow.
    #[must_use]
    pub fn centre(&self) -> glam::DVec3 {
        0.5 * (self.min.as_dvec3() + self.max.as_dvec3())
    }

    /// Length of the diagonal in f64.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (self.max.as_dvec3() - self.min.as_dvec3()).length()
    }

    /// The largest magnitude of a coordinate.
    #[must_use]
    pub fn largest_coordinate(&self) -> f32 {
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// Whether the point is in the closed box.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }
}
