//! Where queries go: the light, in the bits that their rays have.

use glam::Vec3;

use crate::geometry::lanes::{Lanes, splat, sub};
use crate::scene::Light;

/// Where a light is, in the bits that shadow rays have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    Point(Vec3),
    Direction(Vec3),
}

/// Lengths of directions that count as one: error bounds are for those. To others no ray is known to go, so all are passed on.
const UNIT: std::ops::Range<f32> = 0.5..2.0;

impl Source {
    pub fn new(light: &Light) -> Self {
        match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                Self::Point(position.as_vec3())
            }
            Light::Directional { direction, .. } => {
                let direction = direction.as_vec3();
                let is_unit = UNIT.contains(&direction.length());
                Self::Direction(if is_unit { direction } else { Vec3::NAN })
            }
        }
    }

    /// Where its rays end, in units of their direction.
    #[inline(always)]
    pub fn end(&self) -> f32 {
        match self {
            Self::Point(_) => 1.0,
            Self::Direction(_) => f32::INFINITY,
        }
    }

    /// Which of the rays are rays to the light, bit for bit: a bit each. Rays as [`Lanes::rays`] gives them.
    #[inline(always)]
    pub fn sends<L: Lanes>(&self, rays: &[L; 7]) -> u32 {
        let [ox, oy, oz, dx, dy, dz, end] = *rays;
        // What is compared with the direction, and what must be finite.
        let (expected, finite) = match *self {
            Self::Point(light) => (sub(splat::<L>(light), [ox, oy, oz]), [dx, dy, dz]),
            Self::Direction(direction) => (splat::<L>(direction), [ox, oy, oz]),
        };
        let mut others = L::not_equal(end, L::splat(self.end()));
        let mut sound = L::less_equal(end, end);
        for (axis, direction) in [dx, dy, dz].into_iter().enumerate() {
            others = L::or(others, L::not_equal(direction, expected[axis]));
            sound = L::and(sound, L::less_equal(finite[axis].abs(), L::splat(f32::MAX)));
        }
        L::bits(sound) & !L::bits(others)
    }
}
