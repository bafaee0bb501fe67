//! What the voxels of a grid hold, sixteen at a time, and the boxes of it.
//!
//! Most of the voxels that a ray passes hold their contents in a corner that it does not pass. So it is not the
//! voxels that are tested but the boxes of what they hold, sixteen at once: six multiplications say which of them the ray
//! meets (Kay & Kajiya 1986), and nothing branches.
//!
//! Kay, Kajiya: Ray Tracing Complex Scenes. SIGGRAPH 1986.

use glam::Vec3A;

use super::sort::Extent;
use super::walk::LineLanes;
use crate::geometry::lanes::Sixteen;
use crate::occlusion::Cell;
use crate::occlusion::eight::WIDTH;

/// Contents of a group.
pub(super) const GROUP: usize = 16;

/// Sixteen things that voxels hold: grids, and eights of triangles.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Group {
    /// By axis: the lower and the upper planes of the boxes, in the cube.
    bounds: [[[f32; GROUP]; 2]; 3],
    /// The numbers of the grids and eights.
    inside: [u32; GROUP],
    /// Triangles of each eight.
    counts: [u8; GROUP],
    /// Which voxels they are in.
    voxels: [u8; GROUP],
}

impl Group {
    /// Nothing: boxes that no ray meets.
    pub const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; GROUP], [f32::NEG_INFINITY; GROUP]]; 3],
        inside: [0; GROUP],
        counts: [0; GROUP],
        voxels: [0; GROUP],
    };

    /// Sets the number of a grid, without triangles of its own, or of an eight.
    pub fn set(&mut self, slot: usize, voxel: u32, bounds: Extent, inside: u32, count: u32) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = bounds.low[axis];
            self.bounds[axis][1][slot] = bounds.high[axis];
        }
        self.inside[slot] = inside;
        self.counts[slot] = count as u8;
        self.voxels[slot] = voxel as u8;
    }

    /// The number of a grid or an eight.
    #[inline(always)]
    pub fn inside(&self, slot: usize) -> usize {
        self.inside[slot] as usize
    }

    /// The triangles of an eight.
    #[inline(always)]
    pub fn cell(&self, slot: usize) -> Cell {
        let start = WIDTH as u32 * self.inside[slot];
        Cell { start, end: start + u32::from(self.counts[slot]) }
    }

    /// Whether a point is in the box of something.
    pub fn holds(&self, slot: usize, point: Vec3A) -> bool {
        let within = |axis: usize| {
            let [low, high] = &self.bounds[axis];
            (low[slot]..=high[slot]).contains(&point[axis])
        };
        within(0) && within(1) && within(2)
    }

    /// The number of a voxel.
    #[inline(always)]
    pub fn voxel(&self, slot: usize) -> u32 {
        u32::from(self.voxels[slot])
    }

    /// A bit for each box that the line meets before `end`.
    #[inline(always)]
    pub fn met<S: Sixteen>(&self, line: &LineLanes<S>, end: S) -> u16 {
        let [x, y, z] = line.down;
        let enter = line.at(0, &self.bounds[0][x & 1]).max(line.start);
        let enter = enter.max(line.at(1, &self.bounds[1][y & 1]));
        let enter = enter.max(line.at(2, &self.bounds[2][z & 1]));
        let leave = line.at(0, &self.bounds[0][x & 1 ^ 1]).min(end);
        let leave = leave.min(line.at(1, &self.bounds[1][y & 1 ^ 1]));
        let leave = leave.min(line.at(2, &self.bounds[2][z & 1 ^ 1]));
        enter.less_equal(leave)
    }
}
