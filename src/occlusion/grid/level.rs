//! Where the voxels of a uniform grid are.

use glam::DVec3;

use super::PADDING;
use crate::geometry::Bounds;
use crate::occlusion::clip::padding;

/// Where voxels are.
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
}

impl Level {
    /// A grid of this resolution from `min` to `max`; `scene` tells how large coordinates are.
    pub fn new(min: DVec3, max: DVec3, resolution: [u32; 3], scene: &Bounds) -> Self {
        let side = (max - min) / DVec3::from(resolution.map(f64::from));
        let pad = padding(scene, side.min_element() * PADDING);
        Self { min, side, inverse_side: side.recip(), pad, resolution }
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

    /// The place of a voxel among all.
    #[inline(always)]
    pub fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [width, height, _] = self.resolution.map(|n| n as usize);
        x as usize + width * (y as usize + height * z as usize)
    }

    /// The corner of a voxel with the least coordinates; exact to a few roundings in f64.
    #[inline(always)]
    pub fn corner(&self, voxel: [u32; 3]) -> DVec3 {
        self.min + DVec3::from(voxel.map(f64::from)) * self.side
    }
}
