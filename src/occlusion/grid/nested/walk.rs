//! The walk: which voxels of a grid does the ray meet, all at once; then, voxel by voxel, what is inside.
//!
//! Along each axis five planes bound four slabs of voxels, and a voxel is met where the ray is in its three slabs at
//! one time (Kay & Kajiya 1986). Planes are numbered in the ray's direction, so the voxels' bits, mirrored likewise, are in
//! an order in which the ray comes to them: the lowest bit is always next.
//!
//! Rays that start near the scene's cube go as they are. Others, and those so long or short that
//! f32 might over- or underflow, are first clipped and mapped to it in f64.
//!
//! Kay, Kajiya: Ray Tracing Complex Scenes. SIGGRAPH 1986.

use glam::{BVec3A, DVec3, Vec3A};

use super::{Content, MOST, NestedGrid, Node};
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use crate::occlusion::Visit;
use crate::occlusion::brute::visit_all;
use crate::occlusion::clip::Clip;

/// Grids within grids at most: each has at most half of the side of the one around it along some axis, and voxels are
/// larger than the padding, 2⁻¹⁹; so there are fewer.
pub(super) const MOST_DEPTH: usize = 24;

/// Components of a direction smaller than this part of the largest are replaced by it: over the
/// length of the cube that displaces the ray by nothing, and no inverse overflows.
const SMALLEST_COMPONENT: f32 = 1.0 / (1u64 << 40) as f32;

/// Largest components of directions, in sides of the cube, with which nothing below over- or underflows.
const LENGTHS: std::ops::Range<f32> = 1e-18..1e18;

/// Numbers of the near plane of each slab, for the 16 pairs of slabs across x and y; the far one is the next.
const NEAR_X: [f32; 16] =
    [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0];
const FAR_X: [f32; 16] =
    [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0];
const NEAR_Y: [f32; 16] =
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];
const FAR_Y: [f32; 16] =
    [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0, 4.0, 4.0, 4.0, 4.0];

/// A ray in the cube.
struct Line {
    origin: Vec3A,
    inverse: Vec3A,
    /// Magnitudes of the inverse.
    pace: Vec3A,
    /// The number of the first plane that the ray comes to along each axis: 0, or 4 if it runs down.
    first: Vec3A,
    /// What must be flipped of a mirrored voxel's number to get its own.
    mirror: u32,
    /// Where along the ray the line starts, and how fast it goes: `t` of the line is (t − start)·rate.
    start: f64,
    rate: f64,
}

/// How a ray comes to the cube.
enum Approach {
    Never,
    /// Along a line, and no farther than this `t` of the line.
    Along(Line, f32),
    /// From so far away that f64 cannot say.
    Anyhow,
}

impl Line {
    #[inline(always)]
    fn new(origin: Vec3A, direction: Vec3A, start: f64, rate: f64) -> Self {
        let magnitudes = direction.abs();
        let smallest = Vec3A::splat(SMALLEST_COMPONENT * magnitudes.max_element());
        let direction = Vec3A::select(magnitudes.cmplt(smallest), smallest, direction);
        let inverse = direction.recip();
        let down: BVec3A = inverse.cmplt(Vec3A::ZERO);
        let signs = down.bitmask();
        Self {
            origin,
            inverse,
            pace: inverse.abs(),
            first: Vec3A::select(down, Vec3A::splat(MOST as f32), Vec3A::ZERO),
            // Each coordinate of a voxel has two bits of its number.
            mirror: 3 * ((signs & 1) | (signs & 2) << 1 | (signs & 4) << 2),
            start,
            rate,
        }
    }

    #[inline(always)]
    fn approach(grid: &NestedGrid, ray: &Ray) -> Approach {
        /// Farthest from the middle of the cube, in its sides.
        const NEAR: f32 = 1.0;
        let cube = &grid.cube;
        let origin = (Vec3A::from(ray.origin) - cube.corner) * cube.factor;
        let direction = Vec3A::from(ray.direction) * cube.factor;
        let near = (origin - 0.5).abs().cmple(Vec3A::splat(NEAR)).all();
        // Not where something is NaN.
        if near && LENGTHS.contains(&direction.abs().max_element()) {
            Approach::Along(Self::new(origin, direction, 0.0, 1.0), ray.end)
        } else {
            Self::from_afar(grid, ray)
        }
    }

    #[cold]
    fn from_afar(grid: &NestedGrid, ray: &Ray) -> Approach {
        let (enter, leave) = match grid.clip(ray) {
            Clip::Outside => return Approach::Never,
            Clip::Everything => return Approach::Anyhow,
            Clip::Inside(enter, leave) => (enter, leave),
        };
        let length = leave - enter;
        let direction = ray.direction.as_dvec3() * (grid.cube.scale * length);
        // A ray that only touches the cube has no length in it; nor has one that f64 cannot measure.
        let direction = if direction.abs().max_element() >= f64::from(LENGTHS.start) {
            direction
        } else {
            DVec3::splat(f64::from(LENGTHS.start))
        };
        let origin = grid.cube.place(ray.at(enter)).as_vec3a();
        let rate = length.recip();
        Approach::Along(Self::new(origin, direction.as_vec3a(), enter, rate), 1.0)
    }

    /// Where the line ends if nothing beyond `end` of the ray is of interest.
    #[inline(always)]
    fn end(&self, end: f32) -> f32 {
        /// Room for rounding; it is no more than a place is misplaced by.
        const ROOM: f64 = 1e-7;
        if self.rate == 1.0 && self.start == 0.0 {
            end
        } else {
            (((f64::from(end) - self.start) * self.rate).min(1.0) + ROOM) as f32
        }
    }
}

impl Node {
    /// The mirrored bits of the voxels that hold anything and that the line meets before `end`.
    #[inline(always)]
    fn met<L: Lanes>(&self, line: &Line, end: f32) -> u64 {
        let near = (self.side * line.first + self.min - line.origin) * line.inverse;
        let step = self.side * line.pace;
        let near = [L::splat(near.x), L::splat(near.y), L::splat(near.z)];
        let step = [L::splat(step.x), L::splat(step.y), L::splat(step.z)];
        let planes_z = [
            near[2],
            step[2].add(near[2]),
            step[2].mul_add(L::splat(2.0), near[2]),
            step[2].mul_add(L::splat(3.0), near[2]),
            step[2].mul_add(L::splat(4.0), near[2]),
        ];
        let (start, end) = (L::splat(0.0), L::splat(end));
        let mut met = 0;
        let mut first = 0;
        while first < 16 {
            let near_x = step[0].mul_add(L::load_from(&NEAR_X, first), near[0]);
            let near_y = step[1].mul_add(L::load_from(&NEAR_Y, first), near[1]);
            let far_x = step[0].mul_add(L::load_from(&FAR_X, first), near[0]);
            let far_y = step[1].mul_add(L::load_from(&FAR_Y, first), near[1]);
            let enter = near_x.max(start).max(near_y);
            let leave = far_x.min(end).min(far_y);
            let mut z = 0;
            while z < 4 {
                let inside = enter.max(planes_z[z]).less_equal(leave.min(planes_z[z + 1]));
                met |= u64::from(L::bits(inside)) << (16 * z + first);
                z += 1;
            }
            first += L::COUNT;
        }
        met & mirrored(self.occupied, line.mirror)
    }
}

/// The bits of voxels, of which those axes are mirrored whose bits of a voxel's number are set.
#[inline(always)]
fn mirrored(mut bits: u64, mirror: u32) -> u64 {
    if mirror & 0b11 != 0 {
        bits = exchanged(exchanged(bits, 0x5555_5555_5555_5555, 1), 0x3333_3333_3333_3333, 2);
    }
    if mirror & 0b1100 != 0 {
        bits = exchanged(exchanged(bits, 0x0f0f_0f0f_0f0f_0f0f, 4), 0x00ff_00ff_00ff_00ff, 8);
    }
    if mirror & 0b11_0000 != 0 {
        bits = exchanged(bits, 0x0000_ffff_0000_ffff, 16).rotate_left(32);
    }
    bits
}

/// Exchanges the bits of `low` with those `shift` above them.
#[inline(always)]
fn exchanged(bits: u64, low: u64, shift: u32) -> u64 {
    (bits >> shift & low) | (bits & low) << shift
}

#[inline(always)]
pub(super) fn walk<L: Lanes, V: Visit + ?Sized>(grid: &NestedGrid, ray: &Ray, visitor: &mut V) {
    let (line, mut end) = match Line::approach(grid, ray) {
        Approach::Never => return,
        Approach::Anyhow => return visit_all(&grid.order, 8, visitor),
        Approach::Along(line, end) => (line, end),
    };
    let Some(mut node) = grid.nodes.first() else { return };
    let mut met = node.met::<L>(&line, end);
    // Grids around the present one in which voxels are left: their places, and those voxels.
    let mut around = [[0u64; 2]; MOST_DEPTH];
    let (mut depth, mut place) = (0, 0);
    loop {
        if met == 0 {
            if depth == 0 {
                return;
            }
            depth -= 1;
            [place, met] = around[depth];
            node = &grid.nodes[place as usize];
        }
        let voxel = met.trailing_zeros() ^ line.mirror;
        met &= met - 1;
        match node.content(voxel) {
            Content::Grid(inside) => {
                if met != 0 {
                    around[depth] = [place, met];
                    depth += 1;
                }
                place = inside as u64;
                node = &grid.nodes[inside];
                met = node.met::<L>(&line, end);
            }
            Content::List(list) => {
                let cell = grid.cell(list);
                let run = &grid.order[cell.start as usize..cell.end as usize];
                if visitor.visit(cell, run).is_break() {
                    return;
                }
                let nearer = line.end(visitor.end());
                if nearer < end {
                    end = nearer;
                    met &= node.met::<L>(&line, end);
                }
            }
            Content::Nothing => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_are_mirrored_along_the_axes_that_the_ray_runs_down() {
        for voxel in 0..64 {
            for mirror in [0, 3, 12, 15, 48, 51, 60, 63] {
                assert_eq!(mirrored(1 << voxel, mirror), 1 << (voxel ^ mirror), "{voxel} {mirror}");
            }
        }
    }
}
