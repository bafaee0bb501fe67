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
//! Both sides of a comparison err, each by its own plane, and each plane is moved by [`PAD`]: 16. Those of a ray alone are moved twice
//! as far (`rays`).
//!
//! Haines, Wallace: Shaft Culling for Efficient Ray-Cast Radiosity. Eurographics Workshop on Rendering 1991.

use glam::{Vec3, Vec3A};

use super::bundle::OriginBox;
use super::source::Source;
use crate::geometry::lanes::Lanes;
use crate::occlusion::{Node, WIDTH};

/// Rounding of all coordinates that enter, in units of the largest: sixteen roundings.
pub(super) const PAD: f32 = 1.0 / (1 << 20) as f32;

/// Stands for the inverse of a slope of zero.
pub(super) const STEEPEST: f32 = 1e30;

/// The shaft of a part of a bundle, or of one ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    /// Of the upper side by axis: where it is at t = 0, and t for a unit of way.
    upper: Vec3A,
    upper_inverse: Vec3A,
    /// Of the lower side.
    lower: Vec3A,
    lower_inverse: Vec3A,
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

#[inline(always)]
fn inverse(slope: Vec3A) -> Vec3A {
    slope.recip().max(Vec3A::splat(-STEEPEST)).min(Vec3A::splat(STEEPEST))
}

impl Shaft {
    pub const EMPTY: Self = Self {
        upper: Vec3A::ZERO,
        upper_inverse: Vec3A::ZERO,
        lower: Vec3A::ZERO,
        lower_inverse: Vec3A::ZERO,
        end: 0.0,
        extent: 0.0,
        narrows: false,
    };

    /// Makes it that of a box of origins, in place: a copy of what was just written in parts would be waited for.
    #[inline(always)]
    pub fn set(&mut self, source: &Source, centre: Vec3, origins: &OriginBox, largest: f32) {
        let pad = Vec3A::splat(PAD * largest);
        let centre = Vec3A::from(centre);
        let (low, high) = (Vec3A::from(origins.low), Vec3A::from(origins.high));
        self.extent = (high - low).max_element();
        let (low, high) = (centre + low - pad, centre + high + pad);
        let (rise, fall);
        match *source {
            Source::Point(light) => {
                let light = Vec3A::from(light);
                (self.upper, self.lower) = (light + pad, light - pad);
                (rise, fall) = (high - light, low - light);
            }
            Source::Direction(direction) => {
                (self.upper, self.lower) = (high, low);
                (rise, fall) = (Vec3A::from(direction), Vec3A::from(direction));
            }
        }
        self.upper_inverse = inverse(rise);
        self.lower_inverse = inverse(fall);
        self.end = source.end();
        self.narrows = matches!(source, Source::Point(_));
    }

    /// That of one ray, of which the inverses of the slopes are known; its planes are moved by `pad`.
    #[inline(always)]
    pub fn of_ray(origin: Vec3, inverses: [f32; 3], end: f32, pad: f32) -> Self {
        Self {
            upper: (origin + pad).into(),
            upper_inverse: inverses.into(),
            lower: (origin - pad).into(),
            lower_inverse: inverses.into(),
            end,
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
