//! What the voxels of a grid hold, sixteen at a time, and the boxes of it.
//!
//! Half of the lists in voxels that a ray passes are in a corner that it does not pass, and half of the grids. So it is not the
//! voxels that are tested but the boxes of what they hold, sixteen at once: six multiplications say which of them the ray
//! meets (Kay & Kajiya 1986), and nothing branches.
//!
//! Kay, Kajiya: Ray Tracing Complex Scenes. SIGGRAPH 1986.

use super::sort::Extent;
use super::walk::LineLanes;
use crate::geometry::lanes::Sixteen;
use crate::occlusion::Cell;

/// Voxels of a group.
pub(super) const GROUP: usize = 16;

/// What sixteen voxels hold.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Group {
    /// By axis: the lower and the upper planes of the boxes, in the cube.
    bounds: [[[f32; GROUP]; 2]; 3],
    /// Where each list starts in the order, and where the last one ends. One of a voxel that holds a grid is empty.
    starts: [u32; GROUP],
    end: u32,
    /// Which voxels they are.
    voxels: [u8; GROUP],
}

impl Group {
    /// No voxels: boxes that nothing meets.
    pub const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; GROUP], [f32::NEG_INFINITY; GROUP]]; 3],
        starts: [0; GROUP],
        end: 0,
        voxels: [0; GROUP],
    };

    /// Sets what the next voxel holds: triangles from where the last list ends on, none for a grid.
    pub fn set(&mut self, slot: usize, voxel: u32, bounds: Extent, list: Cell) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = bounds.low[axis];
            self.bounds[axis][1][slot] = bounds.high[axis];
        }
        self.voxels[slot] = voxel as u8;
        self.starts[slot] = list.start;
        self.starts[slot + 1..].fill(list.end);
        self.end = list.end;
    }

    /// The list of a voxel.
    #[inline(always)]
    pub fn list(&self, slot: usize) -> Cell {
        let end = if slot + 1 < GROUP { self.starts[slot + 1] } else { self.end };
        Cell { start: self.starts[slot], end }
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
