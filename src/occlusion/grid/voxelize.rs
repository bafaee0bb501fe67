//! Which voxels does a triangle come near?
//!
//! The separating axis test of triangle and box (Akenine-Möller 2001) in f64, with every box widened
//! by the grid's padding: three axes of the box, the triangle's normal, nine products of edges.
//!
//! Akenine-Möller: Fast 3D Triangle-Box Overlap Testing. Journal of Graphics Tools 6(1), 2001.

use glam::DVec3;

use super::Level;
use crate::geometry::{Triangle, is_finite};

/// Calls `found` with the place of every voxel that the triangle comes within the
/// padding of; with none if the triangle is not finite.
pub(super) fn overlapped(level: &Level, triangle: &Triangle, mut found: impl FnMut(usize)) {
    if !is_finite(triangle) {
        return;
    }
    let corners = triangle.map(|corner| corner.as_dvec3());
    let pad = DVec3::splat(level.pad);
    let low = corners[0].min(corners[1]).min(corners[2]) - pad;
    let high = corners[0].max(corners[1]).max(corners[2]) + pad;
    let (low, high) = (level.voxel_of(low), level.voxel_of(high));
    if low == high {
        return found(level.index(low));
    }
    let axes = SeparatingAxes::new(&corners, 0.5 * level.side + pad);
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                if axes.overlap(level.corner([x, y, z]) + 0.5 * level.side) {
                    found(level.index([x, y, z]));
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
