//! The pinhole camera.

use glam::{DVec2, DVec3};

use crate::geometry::Ray;

/// A pinhole camera. Rays are computed in f64 and rounded once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub position: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Unit vector into the picture.
    pub forward: DVec3,
    /// Vertical field of view in radians.
    pub field_of_view: f64,
}

impl Camera {
    /// A camera at `position` that looks at `target`, with `up` upwards in the picture.
    ///
    /// Where `up` is parallel to the view, another one is taken; `field_of_view` is vertical, in radians.
    #[must_use]
    pub fn look_at(position: DVec3, target: DVec3, up: DVec3, field_of_view: f64) -> Self {
        Self::facing(position, target - position, up, field_of_view)
    }

    /// A camera at `position` that looks along `forward`, which may have any length.
    ///
    /// Where `up` is parallel to the view, another one is taken; `field_of_view` is vertical, in radians.
    #[must_use]
    pub fn facing(position: DVec3, forward: DVec3, up: DVec3, field_of_view: f64) -> Self {
        let forward = forward.normalize_or(DVec3::NEG_Z);
        let right =
            forward.cross(up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        Self { position, right, up: right.cross(forward), forward, field_of_view }
    }

    /// The ray through a point of the picture: `place` runs from (0, 0) at the top left corner to
    /// (1, 1) at the bottom right; `aspect` is width over height.
    #[must_use]
    pub fn ray(&self, place: DVec2, aspect: f64) -> Ray {
        let half_height = (0.5 * self.field_of_view).tan();
        let x = (2.0 * place.x - 1.0) * half_height * aspect;
        let y = (1.0 - 2.0 * place.y) * half_height;
        let direction = self.forward + x * self.right + y * self.up;
        Ray::towards(self.position.as_vec3(), direction.normalize().as_vec3())
    }

    /// Whether its place is finite, also in f32, its axes are unit vectors at right angles, but for rounding, and its field of view
    /// is between 0 and 180 degrees.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        /// What a few operations in f32 leave of a right angle and of a length of one.
        const ROUNDING: f64 = 1e-4;
        let [right, up, forward] = [self.right, self.up, self.forward];
        let is_one = |product: f64| (product - 1.0).abs() < ROUNDING;
        let is_zero = |product: f64| product.abs() < ROUNDING;
        self.position.as_vec3().is_finite()
            && [right, up, forward].iter().all(|axis| is_one(axis.length()))
            && [right.dot(up), up.dot(forward), forward.dot(right)].into_iter().all(is_zero)
            && self.field_of_view > 0.0
            && self.field_of_view < std::f64::consts::PI
    }
}
