//! The shaft between a light and a box of origins: which boxes of a node does it meet?
//!
//! The shaft is all points L + t (B − L), 0 ≤ t ≤ 1, of a box B: at each `t` a box again, whose sides move
//! linearly. So a box is met iff six inequalities, each linear in `t`, hold at a common `t`: exact for
//! this convex hull, and as cheap as a ray. Towards a direction, the box B moves along it.
//!
//! **Rounding.** With u = 2⁻²⁴ and M the largest coordinate that enters (of origins, light and the centre that boxes are relative to; towards a
//! direction of all triangles too, as rays have no end there), in units of way along an axis:
//!
//! | what | u·M |
//! | --- | --- |
//! | a box of origins, moved to the centre and back | 3 |
//! | the direction of a ray, L − P, and of a side, B − L | 2 |
//! | a box's plane less the side's, its inverse slope, their product: 3u of at most 2 M | 6 |
//! | the pad itself, added to sides | 2 |
//!
//! Both sides of a comparison err, each by its own plane, and each plane is moved by [`PAD`]: 16.
//!
//! Haines, Wallace: Shaft Culling for Efficient Ray-Cast Radiosity. Eurographics Workshop on Rendering 1991.

use glam::Vec3;

use super::bundle::OriginBox;
use super::source::Source;
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use crate::occlusion::{Node, WIDTH};

/// Rounding of all coordinates that enter, in units of the largest: sixteen roundings.
pub(super) const PAD: f32 = 1.0 / (1 << 20) as f32;

/// Stands for the inverse of a slope of zero.
const STEEPEST: f32 = 1e30;

/// The shaft of a part of a bundle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    /// Of the upper side by axis: where it is at t = 0, and t for a unit of way.
    upper: [f32; 3],
    upper_inverse: [f32; 3],
    /// Of the lower side.
    lower: [f32; 3],
    lower_inverse: [f32; 3],
    end: f32,
    /// The longest side of the box of origins.
    extent: f32,
    narrows: bool,
}

/// Boxes of a node that a shaft meets, and those of them that are narrower than it is there: a bit each.
pub(super) struct Met {
    pub met: u32,
    pub narrower: u32,
}

pub(super) fn inverse(slope: f32) -> f32 {
    let inverse = slope.recip();
    if inverse.abs() < STEEPEST { inverse } else { STEEPEST.copysign(slope) }
}

impl Shaft {
    pub const EMPTY: Self = Self {
        upper: [0.0; 3],
        upper_inverse: [0.0; 3],
        lower: [0.0; 3],
        lower_inverse: [0.0; 3],
        end: 0.0,
        extent: 0.0,
        narrows: false,
    };

    pub fn new(source: &Source, centre: Vec3, origins: &OriginBox, largest: f32) -> Self {
        let pad = Vec3::splat(PAD * largest);
        let (low, high) = (centre + origins.low - pad, centre + origins.high + pad);
        let extent = (origins.high - origins.low).max_element();
        let (upper, lower, rise, fall) = match *source {
            Source::Point(light) => (light + pad, light - pad, high - light, low - light),
            Source::Direction(direction) => (high, low, direction, direction),
        };
        Self {
            upper: upper.to_array(),
            upper_inverse: rise.to_array().map(inverse),
            lower: lower.to_array(),
            lower_inverse: fall.to_array().map(inverse),
            end: source.end(),
            extent,
            narrows: matches!(source, Source::Point(_)),
        }
    }

    /// That of one ray.
    #[inline(always)]
    pub fn of_ray(ray: &Ray, largest: f32) -> Self {
        let pad = Vec3::splat(PAD * largest);
        let slope = ray.direction.to_array().map(inverse);
        Self {
            upper: (ray.origin + pad).to_array(),
            upper_inverse: slope,
            lower: (ray.origin - pad).to_array(),
            lower_inverse: slope,
            end: ray.end,
            extent: 0.0,
            narrows: false,
        }
    }

    /// The boxes of a node that are met.
    #[inline(always)]
    pub fn meets<L: Lanes>(&self, node: &Node) -> Met {
        let (mut met, mut narrower) = (0, 0);
        let mut first = 0;
        while first < WIDTH {
            let (mut enter, mut leave) = (L::splat(0.0), L::splat(self.end));
            for axis in 0..3 {
                // upper + t·rise ≥ low, and lower + t·fall ≤ high.
                let below = L::load(&node.low[axis], first).sub(L::splat(self.upper[axis]));
                let t = below.mul(L::splat(self.upper_inverse[axis]));
                if self.upper_inverse[axis] > 0.0 {
                    enter = enter.max(t);
                } else {
                    leave = leave.min(t);
                }
                let above = L::load(&node.high[axis], first).sub(L::splat(self.lower[axis]));
                let t = above.mul(L::splat(self.lower_inverse[axis]));
                if self.lower_inverse[axis] > 0.0 {
                    leave = leave.min(t);
                } else {
                    enter = enter.max(t);
                }
            }
            met |= L::bits(enter.less_equal(leave)) << first;
            let extent = L::splat(self.extent);
            let width = if self.narrows { extent.mul(leave) } else { extent };
            narrower |= L::bits(L::load(&node.extent, first).less(width)) << first;
            first += L::COUNT;
        }
        Met { met, narrower: met & narrower }
    }
}
