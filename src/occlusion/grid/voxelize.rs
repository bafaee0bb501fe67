//! Which voxels does a triangle come near?
//!
//! The separating axis test of triangle and box (Akenine-Möller 2001) in f64, with every box widened
//! by the grid's padding: three axes of the box, the triangle's normal, nine products of edges.
//!
//! Akenine-Möller: Fast 3D Triangle-Box Overlap Testing. Journal of Graphics Tools 6(1), 2001.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use super::Grid;
use crate::geometry::{Triangle, TriangleId, Triangles};

/// Sorts triangles into voxels: where each voxel's list starts, and the lists, ids ascending.
pub(super) fn voxelize(grid: &Grid, triangles: &Triangles) -> (Vec<u32>, Vec<TriangleId>) {
    let [x, y, z] = grid.resolution.map(|n| n as usize);
    let counts: Vec<AtomicU32> = (0..x * y * z).map(|_| AtomicU32::new(0)).collect();
    let ids = 0..triangles.len() as u32;
    ids.clone().into_par_iter().for_each(|id| {
        overlapped(grid, &triangles.get(id), |voxel| {
            counts[voxel].fetch_add(1, Relaxed);
        });
    });
    let mut starts = Vec::with_capacity(counts.len() + 1);
    let mut total = 0u32;
    for count in &counts {
        starts.push(total);
        let next = total.checked_add(count.load(Relaxed));
        total = next.expect("fewer than 2^32 entries in voxels");
    }
    starts.push(total);
    let places: Vec<AtomicU32> = starts.iter().map(|&start| AtomicU32::new(start)).collect();
    let order: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
    ids.into_par_iter().for_each(|id| {
        overlapped(grid, &triangles.get(id), |voxel| {
            let place = places[voxel].fetch_add(1, Relaxed);
            order[place as usize].store(id, Relaxed);
        });
    });
    let mut order: Vec<TriangleId> = order.into_iter().map(AtomicU32::into_inner).collect();
    sort_runs(&starts, &mut order);
    (starts, order)
}

/// Sorts each voxel's list, so that the grid does not depend on which thread came first.
fn sort_runs(starts: &[u32], order: &mut [TriangleId]) {
    const VOXELS_A_JOB: usize = 4096;
    let mut rest = order;
    let mut jobs = Vec::new();
    for starts in starts.windows(2).collect::<Vec<_>>().chunks(VOXELS_A_JOB) {
        let length = starts[starts.len() - 1][1] - starts[0][0];
        let (lists, later) = rest.split_at_mut(length as usize);
        rest = later;
        jobs.push((starts.to_vec(), lists));
    }
    jobs.into_par_iter().for_each(|(starts, lists)| {
        let first = starts[0][0];
        for run in starts {
            lists[(run[0] - first) as usize..(run[1] - first) as usize].sort_unstable();
        }
    });
}

/// Calls `found` with every voxel that the triangle comes within the padding of.
fn overlapped(grid: &Grid, triangle: &Triangle, mut found: impl FnMut(usize)) {
    let corners = triangle.map(|corner| corner.as_dvec3());
    let pad = DVec3::splat(grid.pad);
    let low = corners[0].min(corners[1]).min(corners[2]) - pad;
    let high = corners[0].max(corners[1]).max(corners[2]) + pad;
    let (low, high) = (grid.voxel_of(low), grid.voxel_of(high));
    if low == high {
        return found(grid.index(low[0], low[1], low[2]));
    }
    let axes = SeparatingAxes::new(&corners, 0.5 * grid.side + pad);
    // Along one row of voxels the box test is exact already.
    let spread = (0..3).filter(|&axis| low[axis] != high[axis]).count();
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let place = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5;
                if spread == 1 || axes.overlap(grid.min + place * grid.side) {
                    found(grid.index(x, y, z));
                }
            }
        }
    }
}

/// The axes that may separate one triangle from boxes of one size.
struct SeparatingAxes {
    /// Each axis, with the interval that the triangle spans on it, widened by the box's radius.
    axes: [(DVec3, f64, f64); 10],
}

impl SeparatingAxes {
    fn new(corners: &[DVec3; 3], half: DVec3) -> Self {
        let [a, b, c] = *corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(edges[1]);
        let axes = std::array::from_fn(|i| {
            let axis = match i {
                0 => normal,
                i => DVec3::AXES[(i - 1) % 3].cross(edges[(i - 1) / 3]),
            };
            let [a, b, c] = corners.map(|corner| axis.dot(corner));
            let radius = axis.abs().dot(half);
            // The products err by a few roundings of the terms, which the padding in `half` exceeds.
            (axis, a.min(b).min(c) - radius, a.max(b).max(c) + radius)
        });
        Self { axes }
    }

    fn overlap(&self, centre: DVec3) -> bool {
        self.axes.iter().all(|&(axis, low, high)| {
            let place = axis.dot(centre);
            low <= place && place <= high
        })
    }
}
