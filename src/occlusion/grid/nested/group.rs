//! What the voxels of a grid hold, sixteen at a time, and the boxes of it.
//!
//! Most of the voxels that a ray passes hold their contents in a corner that it does not pass. So it is not the
//! voxels that are tested but the boxes of what they hold, sixteen at once: six multiplications say which of them the ray
//! meets (Kay & Kajiya 1986), and nothing branches.
//!
//! Kay, Kajiya: Ray Tracing Complex Scenes. SIGGRAPH 1986.

use std::ops::Range;

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
    /// The numbers of the eights, and of the first groups of the grids.
    inside: [u32; GROUP],
    /// Triangles of each eight, groups of each grid.
    counts: [u8; GROUP],
    /// Which are grids, a bit each.
    divided: u16,
}

impl Group {
    /// Nothing: boxes that no ray meets.
    pub const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; GROUP], [f32::NEG_INFINITY; GROUP]]; 3],
        inside: [0; GROUP],
        counts: [0; GROUP],
        divided: 0,
    };

    /// Sets an eight: its number, and how many triangles it has.
    pub fn set_eight(&mut self, slot: usize, bounds: Extent, number: usize, count: usize) {
        self.set(slot, bounds, number, count);
    }

    /// Sets a grid: where its groups are.
    pub fn set_grid(&mut self, slot: usize, bounds: Extent, groups: Range<usize>) {
        self.divided |= 1 << slot;
        self.set(slot, bounds, groups.start, groups.len());
    }

    fn set(&mut self, slot: usize, bounds: Extent, inside: usize, count: usize) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = bounds.low[axis];
            self.bounds[axis][1][slot] = bounds.high[axis];
        }
        self.inside[slot] = inside as u32;
        self.counts[slot] = count as u8;
    }

    /// Whether something is a grid.
    #[inline(always)]
    pub fn is_divided(&self, slot: usize) -> bool {
        self.divided & (1 << slot) != 0
    }

    /// The groups of a grid.
    #[inline(always)]
    pub fn groups(&self, slot: usize) -> Range<usize> {
        let first = self.inside[slot] as usize;
        first..first + usize::from(self.counts[slot])
    }

    /// The number of an eight.
    #[inline(always)]
    pub fn eight(&self, slot: usize) -> usize {
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

    /// Half of the surface of each box that is there.
    #[cfg(test)]
    pub fn half_areas(&self) -> impl Iterator<Item = f32> {
        let corner = |end: usize, slot: usize| {
            Vec3A::from([0, 1, 2].map(|axis| self.bounds[axis][end][slot]))
        };
        let extent = move |slot| Extent { low: corner(0, slot), high: corner(1, slot) };
        (0..GROUP).map(extent).filter(|extent| extent.low.x < extent.high.x).map(Extent::half_area)
    }

    /// A bit for each box that the line meets before `end`, and where it enters them.
    #[inline(always)]
    pub fn met<S: Sixteen>(&self, line: &LineLanes<S>, end: S) -> (u16, S) {
        let [x, y, z] = line.down;
        let enter = line.at(0, &self.bounds[0][x & 1]).max(line.start);
        let enter = enter.max(line.at(1, &self.bounds[1][y & 1]));
        let enter = enter.max(line.at(2, &self.bounds[2][z & 1]));
        let leave = line.at(0, &self.bounds[0][x & 1 ^ 1]).min(end);
        let leave = leave.min(line.at(1, &self.bounds[1][y & 1 ^ 1]));
        let leave = leave.min(line.at(2, &self.bounds[2][z & 1 ^ 1]));
        (enter.less_equal(leave), enter)
    }
}
