//! Which voxels of one grid does a triangle come near?
//!
//! The separating axis test of triangle and box (Akenine-Möller 2001), of all 64 voxels at once: the axes of the box are the
//! range of voxels that the triangle's box spans; where that is a row of voxels, the triangle goes through
//! all of them. Else the nine products of edges and axes decide in the three planes of two axes, of which each has 16
//! columns of voxels, and the triangle's normal decides voxel by voxel (Schwarz & Seidel 2010).
//!
//! In f32, and nothing is lost: any axis separates if it does, however its own coordinates were rounded, and the
//! projections, of places in the unit cube, err by less than 9 u per unit of the axis (its coordinates' sum), for which
//! voxels are widened by [`MISPLACED`], 32 u, besides the padding.
//!
//! Akenine-Möller: Fast 3D Triangle-Box Overlap Testing. Journal of Graphics Tools 6(1), 2001.
//! Schwarz, Seidel: Fast Parallel Surface and Solid Voxelization on GPUs. ACM Transactions on Graphics 29(6), 2010.

use glam::{UVec3, Vec3A, Vec4};

use super::{MISPLACED, MOST};

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
    padding: f32,
}

impl Lattice {
    /// About so many voxels over a box, as near to cubes as it allows.
    pub fn over(bounds: Extent, voxels: usize, padding: f32) -> Self {
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
        // So that the last plane is not within the box.
        let side = extent / resolution.as_vec3a() * (1.0 + 2.0 * f32::EPSILON);
        let last = (resolution - UVec3::ONE).as_vec3a();
        Self { min: bounds.low, side, inverse: side.recip(), last, padding }
    }

    /// The share of the rays through the grid that pass a certain voxel of it: by their surfaces.
    pub fn share(&self) -> f32 {
        half_area(self.side) / half_area(self.side * (self.last + 1.0))
    }

    #[inline(always)]
    fn voxel_of(&self, point: Vec3A) -> UVec3 {
        ((point - self.min) * self.inverse).max(Vec3A::ZERO).min(self.last).as_uvec3()
    }

    /// The box of a voxel, with its padding.
    fn extent(&self, voxel: u32) -> Extent {
        let place = UVec3::new(voxel % MOST, voxel / MOST % MOST, voxel / (MOST * MOST));
        let low = self.min + self.side * place.as_vec3a();
        Extent { low: low - self.padding, high: low + self.side + self.padding }
    }

    /// What of a box is in a voxel, with padding.
    pub fn within(&self, voxel: u32, bounds: Extent) -> Extent {
        bounds.within(self.extent(voxel), self.padding)
    }

    /// A bit for every voxel that the triangle comes within the padding of: x + 4 y + 16 z.
    #[inline(always)]
    pub fn overlapped(&self, triangle: &[Vec3A; 3]) -> u64 {
        let bounds = Extent::of(triangle);
        let low = self.voxel_of(bounds.low - self.padding);
        let high = self.voxel_of(bounds.high + self.padding);
        let range = |axis: usize| (2u64 << high[axis]) - (1 << low[axis]);
        let spanned = range(0) * rows(range(1)) * layers(range(2));
        let span = high - low;
        let is_row = span.element_sum() == span.max_element();
        if is_row { spanned } else { spanned & self.beside(triangle) }
    }

    /// A bit for every voxel that no axis separates from the triangle, apart from the axes of the box.
    fn beside(&self, corners: &[Vec3A; 3]) -> u64 {
        let half = 0.5 * self.side + (self.padding + MISPLACED);
        let [a, b, c] = *corners;
        let edges = [b - a, c - b, a - c];
        let numbers = Vec4::new(0.5, 1.5, 2.5, 3.5);
        let centres = [0, 1, 2].map(|axis| self.side[axis] * numbers + self.min[axis]);

        // Of the columns of voxels across a plane of two axes, a bit u + 4 v each.
        let columns = |u: usize, v: usize| {
            let mut columns = 0xffff;
            for edge in edges {
                let (across_u, across_v) = (-edge[v], edge[u]);
                let [a, b, c] = corners.map(|corner| across_u * corner[u] + across_v * corner[v]);
                let radius = across_u.abs() * half[u] + across_v.abs() * half[v];
                let low = Vec4::splat(a.min(b).min(c) - radius);
                let high = Vec4::splat(a.max(b).max(c) + radius);
                let places = across_u * centres[u];
                let mut inside = 0;
                for (row, centre) in centres[v].to_array().into_iter().enumerate() {
                    let places = places + across_v * centre;
                    let within = places.cmpge(low) & places.cmple(high);
                    inside |= u64::from(within.bitmask()) << (4 * row);
                }
                columns &= inside;
            }
            columns
        };
        let (xy, xz, yz) = (columns(0, 1), columns(0, 2), columns(1, 2));

        let normal = edges[0].cross(edges[1]);
        let radius = normal.abs().dot(half);
        let [a, b, c] = corners.map(|corner| normal.dot(corner));
        let low = Vec4::splat(a.min(b).min(c) - radius);
        let high = Vec4::splat(a.max(b).max(c) + radius);
        let mut beside = 0;
        for z in 0..4 {
            let row_of = |columns: u64| columns >> (4 * z) & 0xf;
            let layer = xy & (row_of(xz) * rows(0xf)) & (rows(row_of(yz)) * 0xf);
            if layer == 0 {
                continue;
            }
            let mut inside = 0;
            for y in 0..4 {
                let rest = normal.y * centres[1][y] + normal.z * centres[2][z];
                let places = normal.x * centres[0] + rest;
                let within = places.cmpge(low) & places.cmple(high);
                inside |= u64::from(within.bitmask()) << (4 * y);
            }
            beside |= (layer & inside) << (16 * z);
        }
        beside
    }
}

/// Four bits, each to the first voxel of a row.
#[inline(always)]
fn rows(bits: u64) -> u64 {
    (bits & 1) | (bits & 2) << 3 | (bits & 4) << 6 | (bits & 8) << 9
}

/// Four bits, each to the first voxel of a layer.
#[inline(always)]
fn layers(bits: u64) -> u64 {
    (bits & 1) | (bits & 2) << 15 | (bits & 4) << 30 | (bits & 8) << 45
}

fn half_area(sides: Vec3A) -> f32 {
    sides.x * sides.y + sides.y * sides.z + sides.z * sides.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::random::Random;

    #[test]
    fn a_triangle_is_in_every_voxel_that_one_of_its_points_is_in_and_in_few_others() {
        let mut random = Random::new(3, 0);
        let bounds = Extent { low: Vec3A::ZERO, high: Vec3A::new(1.0, 0.7, 0.9) };
        let mut weights = || Vec3A::from_array([0; 3].map(|_: u32| random.unit() as f32));
        let padding = 1e-4;
        let (mut met, mut found) = (0, 0);
        for _ in 0..2000 {
            let lattice = Lattice::over(bounds, 64, padding);
            let triangle = [0; 3].map(|_: u32| weights() * bounds.high);
            let bits = lattice.overlapped(&triangle);
            let mut touched = 0u64;
            for _ in 0..400 {
                let weights = weights();
                let weights = weights / weights.element_sum();
                let [a, b, c] = triangle;
                let inside = a * weights.x + b * weights.y + c * weights.z;
                let voxel = lattice.voxel_of(inside).dot(UVec3::new(1, MOST, MOST * MOST));
                touched |= 1 << voxel;
            }
            assert_eq!(touched & !bits, 0, "{triangle:?}");
            met += touched.count_ones();
            found += bits.count_ones();
        }
        assert!(f64::from(found) < 1.5 * f64::from(met), "{found} voxels for {met}");
    }
}
