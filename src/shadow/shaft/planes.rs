//! Four planes a triangle, on the far sides of which lies its shadow.
//!
//! All rays of a bundle go to one light, so the plane through the light and an edge is the same for all of them:
//! an origin is in the triangle's shadow iff it lies on the inner side of three such planes, and beyond the
//! triangle's own. A triangle is decided for sixteen rays by 12 multiplications and additions each.
//!
//! **Signs.** With the light L, corners a, b, c relative to it, N = (b−a)×(c−a) and q = P − L: the volume of an
//! edge is q·(a×b), that of the plane N·(P − A), and L is on the side of N·a. The triangle blocks iff all four
//! have the sign of N·a (their sum with N·a says that the volumes agree: a×b + b×c + c×a = N). For a direction
//! d the edges are (P − A)·((a−b)×d), the plane −N·(P − A), and the sign is that of N·d.
//!
//! **Rounding.** Constants are computed in f64, at the centre C of the ground, and origins are relative to C, p =
//! fl(P − C). With u = 2⁻²⁴, h the ground's half box, and n the plane's normal, evaluation in f32 errs by at
//! most 8u (|n|·h + |n·C + c|): six roundings of each product (that of p, of n, and four of the sum, unfused),
//! five of the constant. The rays' direction is fl(L − P), off by ρ with |ρ| ≤ u|q|: that moves an
//! edge's volume by q·((a−b)×ρ), at most 2u E |q|₁ |q|∞ with E the longest coordinate of an edge, and the end of the ray
//! by N·ρ. What f64 itself loses is below 2⁻⁴⁶ of the terms.
//!
//! Each plane is divided by its bound: beyond 1 it is certain, below −1 too, and what lies between is open and
//! left to the exact test.

use glam::{DVec3, Vec3};

use super::bundle::{OriginBox, Source};
use crate::geometry::lanes::{self, Lanes};
use crate::occlusion::{Cluster, WIDTH};

/// u.
const ROUNDING: f64 = 1.0 / (1u64 << 24) as f64;

/// What sums of products in f64 lose, generously.
const DOUBLE: f64 = 1.0 / (1u64 << 46) as f64;

/// Nothing that is computed in f32 vanishes beside this: products underflow below 2⁻¹²⁶.
const LEAST: f64 = 1e-30;

/// Of the first bundle, so much larger is the ground for those after it: planes are kept for all of them. Error bounds
/// grow by as much, and with them the few queries that are left to the exact test.
const ROOM: f32 = 8.0;

/// Half the box of a bundle counts as at least this part of the largest coordinate.
const LEAST_HALF: f32 = 1.0 / (1 << 24) as f32;

/// A value of each of eight triangles.
type Eight = [f64; WIDTH];

/// Planes of edges, and the triangle's own.
pub(super) const OWN: usize = 3;

/// Four planes of each of eight triangles, divided by their error bounds.
pub(super) struct Planes {
    /// Normal by plane, axis, triangle.
    pub normals: [[[f32; WIDTH]; 3]; 4],
    /// Value at the ground's centre.
    pub values: [[f32; WIDTH]; 4],
    /// Triangles of which it is not certain on which side the light is: a bit each.
    pub unsided: u32,
}

/// What planes need to know of the bundles that they serve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ground {
    pub source: Source,
    /// Origins are relative to this.
    pub centre: Vec3,
    /// Half the box that all origins are in.
    pub half: Vec3,
}

impl Ground {
    /// Ground for a bundle in this box, with room around it for the next ones.
    pub fn around(source: &Source, low: Vec3, high: Vec3, largest: f32) -> Self {
        let half = ROOM * (0.5 * high - 0.5 * low);
        // Origins that coincide must not make planes that are divided by nothing.
        let half = half.max(Vec3::splat(LEAST_HALF * largest));
        Self { source: *source, centre: 0.5 * low + 0.5 * high, half }
    }

    /// Whether a box of origins is on it.
    #[inline(always)]
    pub fn holds(&self, low: Vec3, high: Vec3) -> bool {
        let reach = (low - self.centre).abs().max((high - self.centre).abs());
        reach.cmple(self.half).all()
    }
}

#[inline(always)]
fn minus(a: &Eight, b: &Eight) -> Eight {
    let mut result = [0.0; WIDTH];
    for lane in 0..WIDTH {
        result[lane] = a[lane] - b[lane];
    }
    result
}

#[inline(always)]
fn cross(a: &[Eight; 3], b: &[Eight; 3]) -> [Eight; 3] {
    let mut result = [[0.0; WIDTH]; 3];
    for (axis, result) in result.iter_mut().enumerate() {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        for lane in 0..WIDTH {
            result[lane] = a[i][lane] * b[j][lane] - a[j][lane] * b[i][lane];
        }
    }
    result
}

/// Of each, the product with one vector; and that of the magnitudes.
#[inline(always)]
fn dot(a: &[Eight; 3], b: DVec3) -> Eight {
    let mut result = [0.0; WIDTH];
    for lane in 0..WIDTH {
        result[lane] = a[0][lane] * b.x + a[1][lane] * b.y + a[2][lane] * b.z;
    }
    result
}

#[inline(always)]
fn dot_each(a: &[Eight; 3], b: &[Eight; 3]) -> Eight {
    let mut result = [0.0; WIDTH];
    for lane in 0..WIDTH {
        result[lane] = a[0][lane] * b[0][lane] + a[1][lane] * b[1][lane] + a[2][lane] * b[2][lane];
    }
    result
}

#[inline(always)]
fn dot_of_magnitudes(a: &[Eight; 3], b: DVec3) -> Eight {
    let mut result = [0.0; WIDTH];
    for lane in 0..WIDTH {
        result[lane] = a[0][lane].abs() * b.x + a[1][lane].abs() * b.y + a[2][lane].abs() * b.z;
    }
    result
}

#[inline(always)]
fn sum_of_magnitudes(a: &[Eight; 3]) -> Eight {
    let mut result = [0.0; WIDTH];
    for lane in 0..WIDTH {
        result[lane] = a[0][lane].abs() + a[1][lane].abs() + a[2][lane].abs();
    }
    result
}

/// Corners relative to a point.
#[inline(always)]
fn relative(cluster: &Cluster, corner: usize, point: DVec3) -> [Eight; 3] {
    let mut result = [[0.0; WIDTH]; 3];
    let point = point.to_array();
    for (axis, result) in result.iter_mut().enumerate() {
        let values = &cluster.corner(corner)[axis];
        for lane in 0..WIDTH {
            result[lane] = f64::from(values[lane]) - point[axis];
        }
    }
    result
}

#[inline(always)]
fn between(a: &[Eight; 3], b: &[Eight; 3]) -> [Eight; 3] {
    [minus(&b[0], &a[0]), minus(&b[1], &a[1]), minus(&b[2], &a[2])]
}

impl Planes {
    pub const EMPTY: Self =
        Self { normals: [[[0.0; WIDTH]; 3]; 4], values: [[0.0; WIDTH]; 4], unsided: 0 };

    /// The planes of the cluster's triangles.
    #[inline(always)]
    pub fn set(&mut self, ground: &Ground, cluster: &Cluster) {
        let Ground { source, centre, half } = *ground;
        let (centre, half) = (centre.as_dvec3(), half.as_dvec3());
        let (light, to_centre, span) = match source {
            Source::Point(light) => {
                let light = light.as_dvec3();
                let to_centre = centre - light;
                (light, to_centre, to_centre.abs() + half)
            }
            // Everything is relative to the centre then.
            Source::Direction(_) => (centre, DVec3::ZERO, half),
        };
        let a = relative(cluster, 0, light);
        let b = relative(cluster, 1, light);
        let c = relative(cluster, 2, light);
        let (ab, bc, ca) = (between(&a, &b), between(&b, &c), between(&c, &a));
        let mut own = cross(&ca, &ab);
        let mut size = [0f64; WIDTH];
        for axis in 0..3 {
            for lane in 0..WIDTH {
                let longest =
                    ab[axis][lane].abs().max(bc[axis][lane].abs()).max(ca[axis][lane].abs());
                size[lane] = size[lane].max(longest);
            }
        }
        let own_size = sum_of_magnitudes(&own);
        let [farness, _, _] = [sum_of_magnitudes(&a), sum_of_magnitudes(&b), sum_of_magnitudes(&c)];

        // Normals and values of the edges; on which side the light is, and how certainly.
        let edges;
        let mut values = [[0.0; WIDTH]; 4];
        let side;
        let mut side_bound = [0.0; WIDTH];
        // What an edge errs by besides rounding in f32.
        let mut edge_error = [0.0; WIDTH];
        let (total, most) = (span.element_sum(), span.max_element());
        match source {
            Source::Point(_) => {
                edges = [cross(&a, &ab), cross(&b, &bc), cross(&c, &ca)];
                for edge in 0..3 {
                    values[edge] = dot(&edges[edge], to_centre);
                }
                side = dot_each(&own, &a);
                for lane in 0..WIDTH {
                    edge_error[lane] = 3.0 * ROUNDING * size[lane] * total * most
                        + DOUBLE * size[lane] * (farness[lane] + 3.0 * size[lane]) * total;
                    side_bound[lane] = 2.0 * ROUNDING * own_size[lane] * most
                        + 2.0 * DOUBLE * size[lane] * size[lane] * farness[lane];
                }
            }
            Source::Direction(direction) => {
                let direction = direction.as_dvec3();
                let along = [[direction.x; WIDTH], [direction.y; WIDTH], [direction.z; WIDTH]];
                edges = [
                    cross(&between(&b, &a), &along),
                    cross(&between(&c, &b), &along),
                    cross(&between(&a, &c), &along),
                ];
                let length = direction.abs().element_sum();
                for (edge, corner) in [&a, &b, &c].into_iter().enumerate() {
                    let value = dot_each(&edges[edge], corner);
                    for lane in 0..WIDTH {
                        values[edge][lane] = -value[lane];
                    }
                }
                side = dot(&own, direction);
                for lane in 0..WIDTH {
                    edge_error[lane] =
                        DOUBLE * size[lane] * length * (farness[lane] + 3.0 * size[lane] + total);
                    side_bound[lane] = 2.0 * DOUBLE * size[lane] * size[lane] * length;
                    for axis in &mut own {
                        axis[lane] = -axis[lane];
                    }
                }
            }
        }
        // The own plane's value at the centre: N·(C − A).
        let height = dot_each(&own, &a);
        let at_light = dot(&own, to_centre);
        let mut own_error = [0.0; WIDTH];
        self.unsided = 0;
        for lane in 0..WIDTH {
            values[OWN][lane] = at_light[lane] - height[lane];
            own_error[lane] = 2.0 * DOUBLE * size[lane] * size[lane] * (farness[lane] + total);
            let sided = side[lane].abs() > side_bound[lane] + LEAST;
            self.unsided |= u32::from(!sided) << lane;
        }
        for (plane, normal) in [&edges[0], &edges[1], &edges[2], &own].into_iter().enumerate() {
            let reach = dot_of_magnitudes(normal, half);
            let error = if plane == OWN { &own_error } else { &edge_error };
            for lane in 0..WIDTH {
                let value = values[plane][lane];
                let bound = 8.0 * ROUNDING * (reach[lane] + value.abs()) + error[lane] + LEAST;
                let factor = if side[lane] < 0.0 { -1.0 } else { 1.0 } / bound;
                // Without a side the own plane says nothing, and the edges no more than their signs.
                let sided = side[lane].abs() > side_bound[lane] + LEAST;
                let factor = if sided || plane != OWN { factor } else { 0.0 };
                self.values[plane][lane] = (value * factor) as f32;
                for (scaled, normal) in self.normals[plane].iter_mut().zip(normal) {
                    scaled[lane] = (normal[lane] * factor) as f32;
                }
            }
        }
    }

    /// Triangles that may block a ray from the box: a bit each.
    #[inline(always)]
    pub fn candidates<L: Lanes>(&self, origins: &OriginBox) -> u32 {
        let middle = lanes::splat::<L>(0.5 * (origins.low + origins.high));
        let half = lanes::splat::<L>(0.5 * (origins.high - origins.low));
        let (least, slope) = (L::splat(1.001), L::splat(1e-5));
        let (mut beyond, mut before) = (0, 0);
        let mut first = 0;
        while first < WIDTH {
            for plane in 0..4 {
                let [x, y, z] = &self.normals[plane];
                let normal = [L::load(x, first), L::load(y, first), L::load(z, first)];
                let size = [normal[0].abs(), normal[1].abs(), normal[2].abs()];
                let value = L::load(&self.values[plane], first).add(lanes::dot(normal, middle));
                let reach = lanes::dot(size, half);
                // A little more than 1, for the rounding of these sums.
                let margin = slope.mul_add(reach.add(value.abs()), least);
                beyond |= L::bits(value.add(reach).add(margin).less(L::splat(0.0))) << first;
                before |= L::bits(margin.less(value.sub(reach))) << first;
            }
            first += L::COUNT;
        }
        // Without a side, signs that differ say that the line misses.
        let missed = beyond & (before | !self.unsided);
        !missed & ((1 << WIDTH) - 1)
    }
}
