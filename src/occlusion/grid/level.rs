//! One grid: the whole scene's, or that of a crowded voxel.

use glam::DVec3;

use super::PADDING;
use crate::geometry::Bounds;
use crate::occlusion::clip::padding;

/// Where the voxels of one grid are.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// Lower corner of voxel (0, 0, 0).
    pub min: DVec3,
    /// Sides of a voxel, and their inverses.
    pub side: DVec3,
    pub inverse_side: DVec3,
    /// How far outside a voxel its triangles may be.
    pub pad: f64,
    pub resolution: [u32; 3],
    /// Its first voxel among those of all grids.
    pub first: usize,
}

impl Level {
    /// A grid of this resolution from `min` to `max`; `scene` tells how large coordinates are.
    pub fn new(min: DVec3, max: DVec3, resolution: [u32; 3], scene: &Bounds) -> Self {
        let side = (max - min) / DVec3::from(resolution.map(f64::from));
        let pad = padding(scene, side.min_element() * PADDING);
        Self { min, side, inverse_side: side.recip(), pad, resolution, first: 0 }
    }

    pub fn voxel_count(&self) -> usize {
        self.resolution.iter().map(|&n| n as usize).product()
    }

    /// The voxel that holds a point; the nearest one for a point outside.
    #[inline(always)]
    pub fn voxel_of(&self, point: DVec3) -> [u32; 3] {
        let place = (point - self.min) * self.inverse_side;
        // `as` saturates, and takes NaN to 0.
        let [width, height, depth] = self.resolution;
        [
            (place.x as u32).min(width - 1),
            (place.y as u32).min(height - 1),
            (place.z as u32).min(depth - 1),
        ]
    }

    /// The place of a voxel among those of all grids.
    #[inline(always)]
    pub fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [width, height, _] = self.resolution.map(|n| n as usize);
        self.first + x as usize + width * (y as usize + height * z as usize)
    }

    /// The corner of a voxel with the least coordinates; exact to a few roundings in f64.
    #[inline(always)]
    pub fn corner(&self, voxel: [u32; 3]) -> DVec3 {
        self.min + DVec3::from(voxel.map(f64::from)) * self.side
    }
}

/// What a voxel holds: nothing, a list of triangles, or a grid of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Content(u32);

/// Marks a grid among contents.
const NESTED: u32 = 1 << 31;

impl Content {
    pub const EMPTY: Self = Self(0);

    pub fn of_list(list: usize) -> Self {
        let content = u32::try_from(list + 1).ok().filter(|content| content & NESTED == 0);
        Self(content.expect("fewer than 2^31 lists"))
    }

    pub fn of_nested(level: usize) -> Self {
        let content = u32::try_from(level).ok().filter(|content| content & NESTED == 0);
        Self(content.expect("fewer than 2^31 grids") | NESTED)
    }

    #[inline(always)]
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    /// The list, if it holds one.
    #[inline(always)]
    pub fn list(self) -> Option<usize> {
        (!self.is_empty() && self.0 & NESTED == 0).then(|| self.0 as usize - 1)
    }

    /// The grid, if it holds one.
    #[inline(always)]
    pub fn nested(self) -> Option<usize> {
        (self.0 & NESTED != 0).then_some((self.0 & !NESTED) as usize)
    }
}
