//! Which voxels does a triangle come near?
//!
//! The separating axis test of triangle and box (Akenine-Möller 2001) in f64, with every box widened
//! by the grid's padding: three axes of the box, the triangle's normal, nine products of edges.
//!
//! A large triangle touches about as many voxels as its box has rows, and a voxel at a time each row would be as long as the
//! box. So in a long row the ends of what is touched are found instead: a voxel's place on an axis, rounded as it is, never
//! turns back along a row, so that what each axis leaves of a row is without gaps.
//!
//! Akenine-Möller: Fast 3D Triangle-Box Overlap Testing. Journal of Graphics Tools 6(1), 2001.

use glam::DVec3;

use super::Level;
use crate::geometry::{Triangle, is_finite};

/// Rows from this length on are not gone through voxel by voxel.
const LONG: u32 = 8;

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
            let (row, middle) = ([low[0], high[0]], |x| middle(level, [x, y, z]));
            if high[0] - low[0] < LONG {
                let is_near = |x: &u32| axes.overlap(middle(*x));
                (row[0]..=row[1]).filter(is_near).for_each(|x| found(level.index([x, y, z])));
            } else if let Some([first, last]) = axes.overlapped_of(row, middle) {
                (first..=last).for_each(|x| found(level.index([x, y, z])));
            }
        }
    }
}

fn middle(level: &Level, voxel: [u32; 3]) -> DVec3 {
    level.corner(voxel) + 0.5 * level.side
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

    /// The first and the last box of a row that the triangle overlaps, if there are any: what [`overlap`](Self::overlap) says
    /// of each.
    fn overlapped_of(
        &self,
        [mut first, mut last]: [u32; 2],
        centre: impl Fn(u32) -> DVec3,
    ) -> Option<[u32; 2]> {
        for &(axis, low, high) in &self.axes {
            let place = |x: u32| axis.dot(centre(x));
            let (start, end) = (place(first), place(last));
            // Mirrored where places fall, so that they rise.
            let sign = if start <= end { 1.0 } else { -1.0 };
            let (low, high) = if sign < 0.0 { (-high, -low) } else { (low, high) };
            let (start, end) = (sign * start, sign * end);
            if end < low || high < start {
                return None;
            }
            let per_voxel = (end - start) / f64::from(last - first);
            let guess = |bound: f64| first + ((bound - start) / per_voxel) as u32;
            let (mut from, mut to) = (first, last);
            if start < low {
                from = guess(low).clamp(first, last);
                while sign * place(from) < low {
                    from += 1;
                }
                while sign * place(from - 1) >= low {
                    from -= 1;
                }
            }
            if end > high {
                to = guess(high).clamp(first, last);
                while sign * place(to) > high {
                    to -= 1;
                }
                while sign * place(to + 1) <= high {
                    to += 1;
                }
            }
            if from > to {
                return None;
            }
            (first, last) = (from, to);
        }
        Some([first, last])
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Bounds;
    use crate::geometry::random::SplitMix64;

    /// All of them, one by one.
    fn plainly_overlapped(level: &Level, triangle: &Triangle) -> Vec<usize> {
        let corners = triangle.map(|corner| corner.as_dvec3());
        let pad = DVec3::splat(level.pad);
        let low = level.voxel_of(corners[0].min(corners[1]).min(corners[2]) - pad);
        let high = level.voxel_of(corners[0].max(corners[1]).max(corners[2]) + pad);
        let axes = SeparatingAxes::new(&corners, 0.5 * level.side + pad);
        let mut found = Vec::new();
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    if low == high || axes.overlap(middle(level, [x, y, z])) {
                        found.push(level.index([x, y, z]));
                    }
                }
            }
        }
        found
    }

    #[test]
    fn voxels_of_a_row_are_those_that_are_found_one_by_one() {
        let mut random = SplitMix64::seeded(3);
        let mut any = || (2.0 * random.unit() - 1.0) as f32;
        let mut found_in_all = 0;
        for resolution in [[40, 30, 20], [200, 3, 2], [9, 9, 9], [1, 60, 60]] {
            for number in 0..1500 {
                let size =
                    4.0f32.powf(-number as f32 % 4.0) * if number % 7 == 0 { 1e-3 } else { 1.5 };
                let middle = Vec3::new(any(), any(), any());
                let mut triangle = [(); 3].map(|()| middle + size * Vec3::new(any(), any(), any()));
                match number % 5 {
                    // Square to axes, where places neither rise nor fall.
                    0 => triangle.iter_mut().for_each(|corner| corner.x = middle.x),
                    1 => triangle.iter_mut().for_each(|corner| corner.z = middle.z),
                    // A sliver, and a segment.
                    2 => triangle[2] = triangle[1] + 1e-6 * Vec3::new(any(), any(), any()),
                    3 if number % 3 == 0 => triangle[2] = triangle[1],
                    _ => {}
                }
                let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
                let level = Level::new(DVec3::NEG_ONE, DVec3::ONE, resolution, &scene);
                let mut found = Vec::new();
                overlapped(&level, &triangle, |voxel| found.push(voxel));
                assert_eq!(found, plainly_overlapped(&level, &triangle), "{triangle:?}");
                found_in_all += found.len();
            }
        }
        assert!(found_in_all > 100_000, "{found_in_all}");
    }
}
