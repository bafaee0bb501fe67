//! Boxes of triangles, and the voxels that their middles are in.

use glam::{UVec3, Vec3A};

use super::MOST;

/// A box in the cube.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub low: Vec3A,
    pub high: Vec3A,
}

impl Extent {
    /// No box, and all of the cube.
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };
    pub const ALL: Self = Self { low: Vec3A::NEG_INFINITY, high: Vec3A::INFINITY };

    #[inline(always)]
    pub fn of(&[a, b, c]: &[Vec3A; 3]) -> Self {
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// One point.
    #[inline(always)]
    pub fn at(point: Vec3A) -> Self {
        Self { low: point, high: point }
    }

    #[inline(always)]
    pub fn middle(self) -> Vec3A {
        0.5 * (self.low + self.high)
    }

    pub fn half_area(self) -> f32 {
        let [x, y, z] = (self.high - self.low).to_array();
        x * y + y * z + z * x
    }

    /// What of it is in another one, with padding all around.
    #[inline(always)]
    pub fn within(self, other: Self, padding: f32) -> Self {
        Self { low: self.low.max(other.low) - padding, high: self.high.min(other.high) + padding }
    }
}

/// Where the voxels of one grid are.
pub(super) struct Lattice {
    pub min: Vec3A,
    pub side: Vec3A,
    inverse: Vec3A,
    /// The last voxel along each axis.
    last: Vec3A,
}

impl Lattice {
    /// About so many voxels over a box, as near to cubes as it allows.
    pub fn over(bounds: Extent, voxels: usize) -> Self {
        let extent = bounds.high - bounds.low;
        let wanted = voxels.min((MOST * MOST * MOST) as usize) as u32;
        let mut resolution = UVec3::ONE;
        while resolution.element_product() < wanted {
            let side = extent / resolution.as_vec3a();
            let divisible = (0..3).filter(|&axis| resolution[axis] < MOST);
            let Some(longest) = divisible.max_by(|&a, &b| side[a].total_cmp(&side[b])) else {
                break;
            };
            resolution[longest] += 1;
        }
        let side = extent / resolution.as_vec3a();
        let last = (resolution - UVec3::ONE).as_vec3a();
        Self { min: bounds.low, side, inverse: side.recip(), last }
    }

    /// The voxel that holds a point: x + 4 y + 16 z. Where the box has no extent, the first.
    #[inline(always)]
    pub fn voxel_of(&self, point: Vec3A) -> u32 {
        let place = ((point - self.min) * self.inverse).max(Vec3A::ZERO).min(self.last);
        place.as_uvec3().dot(UVec3::new(1, MOST, MOST * MOST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_are_as_near_to_cubes_as_the_box_allows_and_hold_its_corners() {
        let bounds = Extent { low: Vec3A::splat(0.1), high: Vec3A::new(0.5, 0.3, 0.1) };
        let lattice = Lattice::over(bounds, 8);
        assert_eq!(lattice.last, Vec3A::new(3.0, 1.0, 0.0));
        assert_eq!(lattice.voxel_of(bounds.low), 0);
        assert_eq!(lattice.voxel_of(bounds.high), 3 + 4);
        assert_eq!(lattice.voxel_of(Vec3A::new(0.29, 0.21, 0.1)), 1 + 4);
    }

    #[test]
    fn a_box_of_one_point_has_one_voxel() {
        let lattice = Lattice::over(Extent::at(Vec3A::splat(0.3)), 32);
        assert_eq!(lattice.voxel_of(Vec3A::splat(0.3)), 0);
    }
}
