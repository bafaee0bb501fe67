//! The walk through the voxels along a ray (Amanatides & Woo 1987), and through the grids inside them.
//!
//! In f64, and each plane's `t` is computed afresh from its index, so that errors do not add up. An
//! error of `t` displaces the walk by a few 2⁻⁵² of the coordinates, against a padding of 2⁻¹⁰ of a
//! voxel's side and at least 2⁻¹⁸ of the coordinates: a factor of billions.
//!
//! A divided voxel is walked from where the ray enters it to where it leaves it; a start that rounding
//! puts beside the voxel counts as inside, as the padding allows.

use glam::DVec3;

use super::build::MOST_LEVELS;
use super::level::Level;
use super::{Grid, Visit};
use crate::geometry::Ray;
use crate::occlusion::brute::visit_all;
use crate::occlusion::clip::{Clip, clip};

/// What stays the same along the ray.
struct Line {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
}

/// Where the walk is in one grid.
#[derive(Clone, Copy)]
struct Place<'g> {
    level: &'g Level,
    voxel: [u32; 3],
    /// The voxel among those of all grids.
    index: usize,
    /// `t` at which the ray leaves the voxel along each axis.
    next: [f64; 3],
    /// `t` at which the ray leaves this grid.
    leave: f64,
}

impl Line {
    /// `t` at which the ray leaves a voxel along an axis.
    #[inline(always)]
    fn crossing(&self, level: &Level, axis: usize, voxel: u32) -> f64 {
        let forward = u32::from(self.direction[axis] > 0.0);
        let plane = level.min[axis] + f64::from(voxel + forward) * level.side[axis];
        (plane - self.origin[axis]) * self.inverse[axis]
    }

    #[inline(always)]
    fn enter<'g>(&self, level: &'g Level, enter: f64, leave: f64) -> Place<'g> {
        let voxel = level.voxel_of(self.origin + enter * self.direction);
        let mut next = [f64::INFINITY; 3];
        for axis in 0..3 {
            if self.direction[axis] != 0.0 {
                next[axis] = self.crossing(level, axis, voxel[axis]);
            }
        }
        Place { level, voxel, index: level.index(voxel), next, leave }
    }
}

impl Place<'_> {
    /// The axis along which the ray leaves the voxel.
    #[inline(always)]
    fn exit(&self) -> usize {
        let [x, y, z] = self.next;
        if x < y && x < z {
            0
        } else if y < z {
            1
        } else {
            2
        }
    }

    /// Goes on to the next voxel; `false` where the grid ends.
    #[inline(always)]
    fn advance(&mut self, line: &Line, axis: usize) -> bool {
        let [width, height, _] = self.level.resolution.map(|n| n as usize);
        let stride = [1, width, width * height][axis];
        if line.direction[axis] > 0.0 {
            self.voxel[axis] += 1;
            if self.voxel[axis] == self.level.resolution[axis] {
                return false;
            }
            self.index += stride;
        } else {
            if self.voxel[axis] == 0 {
                return false;
            }
            self.voxel[axis] -= 1;
            self.index -= stride;
        }
        self.next[axis] = line.crossing(self.level, axis, self.voxel[axis]);
        true
    }
}

#[inline(always)]
pub(super) fn walk<V: Visit + ?Sized>(grid: &Grid, ray: &Ray, visitor: &mut V) {
    let (enter, leave) = match clip(ray, grid.min, grid.max) {
        Clip::Outside => return,
        Clip::Everything => return visit_all(&grid.order, 8, visitor),
        Clip::Inside(enter, leave) => (enter, leave),
    };
    let direction = ray.direction.as_dvec3();
    let line = Line { origin: ray.origin.as_dvec3(), direction, inverse: direction.recip() };
    let mut place = line.enter(&grid.levels[0], enter, leave);
    let mut entered = enter;
    // The voxels that are divided by the grid the walk is in, outermost first.
    let mut outer = [place; MOST_LEVELS];
    let mut depth = 0;
    loop {
        let content = grid.voxels[place.index];
        if let Some(nested) = content.nested() {
            let leave = place.next[place.exit()].min(place.leave);
            outer[depth] = place;
            depth += 1;
            place = line.enter(&grid.levels[nested], entered, leave);
            continue;
        }
        if !content.is_empty() {
            let cell = grid.cell(content);
            let run = &grid.order[cell.start as usize..cell.end as usize];
            if visitor.visit(cell, run).is_break() {
                return;
            }
        }
        // On to the next voxel, of this grid or of the nearest one around it that has one.
        loop {
            let axis = place.exit();
            let next = place.next[axis];
            if next <= place.leave && place.advance(&line, axis) {
                entered = next.max(entered);
                break;
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            place = outer[depth];
        }
        if entered > f64::from(visitor.end()) {
            return;
        }
    }
}
