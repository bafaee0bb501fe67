//! The walk through the voxels along a ray (Amanatides & Woo 1987).
//!
//! In f64, and each plane's `t` is computed afresh from its index, so that errors do not add up. An
//! error of `t` displaces the walk by a few 2⁻⁵² of the coordinates, against a padding of 2⁻¹⁰ of a
//! voxel's side: a factor of a million even for grids of 1024 voxels a side.

use super::super::brute::visit_all;
use super::super::clip::{Clip, clip};
use super::{Grid, Visit};
use crate::geometry::Ray;

#[inline(always)]
pub(super) fn walk<V: Visit + ?Sized>(grid: &Grid, ray: &Ray, visitor: &mut V) {
    let (enter, leave) = match clip(ray, grid.min, grid.max) {
        Clip::Outside => return,
        Clip::Everything => return visit_all(&grid.order, 8, visitor),
        Clip::Inside(enter, leave) => (enter, leave),
    };
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let inverse = direction.recip();
    let mut voxel = grid.voxel_of(ray.at(enter));
    let mut next = [f64::INFINITY; 3];
    let mut forward = [false; 3];
    // `t` at which the ray leaves the voxel along an axis.
    let crossing = |axis: usize, voxel: u32, forward: bool| {
        let plane = grid.min[axis] + f64::from(voxel + u32::from(forward)) * grid.side[axis];
        (plane - origin[axis]) * inverse[axis]
    };
    for axis in 0..3 {
        if direction[axis] != 0.0 {
            forward[axis] = direction[axis] > 0.0;
            next[axis] = crossing(axis, voxel[axis], forward[axis]);
        }
    }
    let [width, height, _] = grid.resolution.map(|n| n as isize);
    let stride = [1, width, width * height];
    let mut index = grid.index(voxel[0], voxel[1], voxel[2]);
    loop {
        let cell = grid.cell(index);
        if cell.start != cell.end {
            let run = &grid.order[cell.start as usize..cell.end as usize];
            if visitor.visit(cell, run).is_break() {
                return;
            }
        }
        let axis = match (next[0] < next[1], next[0] < next[2], next[1] < next[2]) {
            (true, true, _) => 0,
            (_, _, true) => 1,
            _ => 2,
        };
        if next[axis] > leave.min(f64::from(visitor.end())) {
            return;
        }
        if forward[axis] {
            voxel[axis] += 1;
            if voxel[axis] == grid.resolution[axis] {
                return;
            }
            index = index.wrapping_add_signed(stride[axis]);
        } else {
            if voxel[axis] == 0 {
                return;
            }
            voxel[axis] -= 1;
            index = index.wrapping_add_signed(-stride[axis]);
        }
        next[axis] = crossing(axis, voxel[axis], forward[axis]);
    }
}
