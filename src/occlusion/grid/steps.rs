//! The voxels of a uniform grid along a ray, empty ones included (Amanatides & Woo 1987).
//!
//! In f64, and each plane's `t` is computed afresh from its index, so that errors do not add up. An
//! error of `t` displaces the walk by a few 2⁻⁵² of the coordinates, against a padding of 2⁻¹⁰ of a
//! voxel's side and at least 2⁻¹⁷ of the coordinates: a factor of billions.

use glam::DVec3;

use super::level::Level;
use crate::geometry::Ray;

/// A voxel on the way of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Its place along x, y and z.
    pub voxel: [u32; 3],
    /// Its place among all.
    pub index: usize,
    /// `t` at which the ray leaves it.
    pub leave: f64,
}

/// Goes from voxel to voxel.
pub(crate) struct Steps<'g> {
    level: &'g Level,
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
    /// The next voxel, and `t` at which the ray crosses its far plane along each axis.
    voxel: [u32; 3],
    crossings: [f64; 3],
    /// `t` at which the ray leaves the grid or ends.
    leave: f64,
    ended: bool,
}

impl<'g> Steps<'g> {
    /// The voxels from one `t` to another, as `clip` gives them.
    #[inline]
    pub fn new(level: &'g Level, ray: &Ray, enter: f64, leave: f64) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let mut steps = Self {
            level,
            origin,
            direction,
            inverse: direction.recip(),
            voxel: level.voxel_of(origin + enter * direction),
            crossings: [f64::INFINITY; 3],
            leave,
            ended: false,
        };
        for axis in 0..3 {
            if direction[axis] != 0.0 {
                steps.crossings[axis] = steps.crossing(axis);
            }
        }
        steps
    }

    #[inline(always)]
    fn crossing(&self, axis: usize) -> f64 {
        let forward = u32::from(self.direction[axis] > 0.0);
        let plane = f64::from(self.voxel[axis] + forward) * self.level.side[axis];
        (self.level.min[axis] + plane - self.origin[axis]) * self.inverse[axis]
    }

    /// Goes on along an axis; `false` where the grid ends.
    #[inline(always)]
    fn advance(&mut self, axis: usize) -> bool {
        if self.direction[axis] > 0.0 {
            self.voxel[axis] += 1;
            if self.voxel[axis] == self.level.resolution[axis] {
                return false;
            }
        } else {
            if self.voxel[axis] == 0 {
                return false;
            }
            self.voxel[axis] -= 1;
        }
        self.crossings[axis] = self.crossing(axis);
        true
    }
}

impl Iterator for Steps<'_> {
    type Item = Step;

    #[inline(always)]
    fn next(&mut self) -> Option<Step> {
        if self.ended {
            return None;
        }
        let [x, y, z] = self.crossings;
        let axis = if x < y && x < z {
            0
        } else if y < z {
            1
        } else {
            2
        };
        let crossing = self.crossings[axis];
        let index = self.level.index(self.voxel);
        let step = Step { voxel: self.voxel, index, leave: crossing };
        let goes_on = crossing <= self.leave && self.advance(axis);
        self.ended = !goes_on;
        Some(step)
    }
}
