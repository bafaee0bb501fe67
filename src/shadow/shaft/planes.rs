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
//! **Rounding.** All in f32, unfused at worst, with u = 2⁻²⁴. Origins are relative to the centre C of the ground, p = fl(P − C), |p| ≤ h.
//! A plane's normal n is a cross product, of which X is the same of magnitudes; its inputs are differences, so it errs by at
//! most 4u X. Its value at C is n·g, where g is the way to C from a point on the plane: that errs by 4u X·|g| + 4u |n|·|g|.
//! Both are scaled, and evaluated at p or at the middle of a box: 7u |n|·h for the products (p or the middle 2u, the
//! normal 1, product and sums 4), 4u |n·g| for the value. With w = |g| + h, and u |n|·w for the direction of the ray (below), that is
//! less than 4u (X·w + 2 |n|·w + |n·g|) in all.
//! The rays' direction is fl(L − P), off by ρ with |ρ| ≤ u|q|: that moves an edge's volume by ρ·(a×b) and by q·((a−b)×ρ), and the
//! end of the ray by N·ρ. The first is at most u|n|·w, the second 2u E |q|₁ |q|∞ with E the longest coordinate of an edge.
//! What underflows is below [`LEAST`].
//!
//! Each plane is divided by its bound: beyond 1 it is certain, below −1 too, and what lies between is open and
//! left to the exact test.

use glam::Vec3;

use super::bundle::OriginBox;
use super::source::Source;
use crate::geometry::lanes::{self, Lanes, Vector, largest, magnitudes};
use crate::occlusion::{Cluster, WIDTH};

/// u.
const ROUNDING: f32 = 1.0 / (1u32 << 24) as f32;

/// 4u, and a little for what is of second order, and for the rounding of bounds themselves.
const FOUR: f32 = 4.2 * ROUNDING;

/// 8u of 4u: what the normal's own magnitude counts in a bound, for the products with an origin and the ray's direction.
const EIGHT_OF_FOUR: f32 = 2.0;

/// Added to all bounds: products underflow below 2⁻¹²⁶.
const LEAST: f32 = 1e-30;

/// Corners that are farther away are left to the exact test: products of four such coordinates overflow.
const FARTHEST: f32 = 1e12;

/// Of the first bundle, so much larger is the ground for those after it: planes are kept for all of them. Error bounds
/// grow by as much, and with them the few queries that are left to the exact test.
const ROOM: f32 = 4.0;

/// Half the box of a bundle counts as at least this part of the largest coordinate.
const LEAST_HALF: f32 = 1.0 / (1 << 24) as f32;

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
    pub fn around(source: &Source, bundle: &OriginBox, largest: f32) -> Self {
        let OriginBox { low, high } = *bundle;
        let half = ROOM * (0.5 * high - 0.5 * low);
        // Origins that coincide must not make planes that are divided by nothing.
        let half = half.max(Vec3::splat(LEAST_HALF * largest));
        Self { source: *source, centre: 0.5 * low + 0.5 * high, half }
    }

    /// Whether a box is on it.
    #[inline(always)]
    pub fn holds(&self, &OriginBox { low, high }: &OriginBox) -> bool {
        let reach = (low - self.centre).abs().max((high - self.centre).abs());
        reach.cmple(self.half).all()
    }
}

/// The cross product of magnitudes, all terms added.
#[inline(always)]
fn cross_of_magnitudes<L: Lanes>(a: Vector<L>, b: Vector<L>) -> Vector<L> {
    let (a, b) = (magnitudes(a), magnitudes(b));
    [
        a[1].mul_add(b[2], a[2].mul(b[1])),
        a[2].mul_add(b[0], a[0].mul(b[2])),
        a[0].mul_add(b[1], a[1].mul(b[0])),
    ]
}

/// A plane while its bound is sought.
#[derive(Clone, Copy)]
struct Plane<L> {
    normal: Vector<L>,
    /// X: the cross product of magnitudes.
    magnitudes: Vector<L>,
    /// At the centre.
    value: L,
    /// How far it may err.
    error: L,
}

impl<L: Lanes> Plane<L> {
    /// Through a point, with the cross product of two vectors as its normal. `way` goes from the point to the centre.
    #[inline(always)]
    fn new(a: Vector<L>, b: Vector<L>, way: Vector<L>, half: Vector<L>) -> Self {
        let normal = lanes::cross(a, b);
        let value = lanes::dot(normal, way);
        let reach = lanes::add(magnitudes(way), half);
        let crossed = cross_of_magnitudes(a, b);
        let mut terms = crossed;
        for (terms, normal) in terms.iter_mut().zip(magnitudes(normal)) {
            *terms = L::splat(EIGHT_OF_FOUR).mul_add(normal, *terms);
        }
        let error = L::splat(FOUR).mul(lanes::dot(terms, reach).add(value.abs()));
        Self { normal, magnitudes: crossed, value, error: error.add(L::splat(LEAST)) }
    }

    /// How far the product of the normal and a vector may err.
    #[inline(always)]
    fn error_along(&self, vector: Vector<L>) -> L {
        let terms = lanes::add(self.magnitudes, magnitudes(self.normal));
        L::splat(FOUR).mul(lanes::dot(terms, magnitudes(vector)))
    }
}

impl Planes {
    pub const EMPTY: Self =
        Self { normals: [[[0.0; WIDTH]; 3]; 4], values: [[0.0; WIDTH]; 4], unsided: 0 };

    /// The planes of the cluster's triangles.
    #[inline(always)]
    pub fn set<L: Lanes>(&mut self, ground: &Ground, cluster: &Cluster) {
        self.unsided = 0;
        let mut first = 0;
        while first < WIDTH {
            self.set_some::<L>(ground, cluster, first);
            first += L::COUNT;
        }
    }

    /// Those of some triangles.
    #[inline(always)]
    fn set_some<L: Lanes>(&mut self, ground: &Ground, cluster: &Cluster, first: usize) {
        let mut corners = [[L::splat(0.0); 3]; 3];
        for (number, corner) in corners.iter_mut().enumerate() {
            let [x, y, z] = cluster.corner(number);
            *corner = [L::load(x, first), L::load(y, first), L::load(z, first)];
        }
        let [a, b, c] = corners;
        let (ab, bc, ca) = (lanes::sub(b, a), lanes::sub(c, b), lanes::sub(a, c));
        let size = largest(ab).max(largest(bc)).max(largest(ca));
        let (centre, half) = (lanes::splat::<L>(ground.centre), lanes::splat::<L>(ground.half));
        let own = Plane::new(ca, ab, lanes::sub(centre, a), half);

        let (edges, side, mut side_error, farthest);
        // Which way the triangle's own plane counts.
        let turn;
        match ground.source {
            Source::Point(light) => {
                let to_centre = ground.centre - light;
                let light = lanes::splat::<L>(light);
                let (a, b, c) = (lanes::sub(a, light), lanes::sub(b, light), lanes::sub(c, light));
                let way = lanes::splat::<L>(to_centre);
                let span = to_centre.abs() + ground.half;
                let ray = 3.0 * ROUNDING * span.element_sum() * span.max_element();
                let mut planes = [
                    Plane::new(a, ab, way, half),
                    Plane::new(b, bc, way, half),
                    Plane::new(c, ca, way, half),
                ];
                for plane in &mut planes {
                    plane.error = L::splat(ray).mul_add(size, plane.error);
                }
                edges = planes;
                side = lanes::dot(own.normal, a);
                let [x, y, z] = magnitudes(own.normal);
                let end = L::splat(2.2 * ROUNDING * span.max_element());
                side_error = end.mul(x.add(y).add(z));
                side_error = side_error.add(own.error_along(a));
                farthest = largest(a).max(size);
                turn = L::splat(1.0);
            }
            Source::Direction(direction) => {
                let along = lanes::splat::<L>(direction);
                edges = [
                    Plane::new(along, ab, lanes::sub(centre, a), half),
                    Plane::new(along, bc, lanes::sub(centre, b), half),
                    Plane::new(along, ca, lanes::sub(centre, c), half),
                ];
                side = lanes::dot(own.normal, along);
                side_error = own.error_along(along);
                farthest = largest(lanes::sub(a, centre)).max(size);
                turn = L::splat(-1.0);
            }
        }
        side_error = side_error.add(L::splat(LEAST));
        let sided = side_error.less(side.abs());
        self.unsided |= (!L::bits(sided) & lanes::all::<L>()) << first;
        let zero = L::splat(0.0);
        let own_factor = L::select(sided, turn, zero);
        for (number, plane) in [edges[0], edges[1], edges[2], own].into_iter().enumerate() {
            // Without a side the own plane says nothing, and the edges no more than their signs.
            let one = if number == OWN { own_factor } else { L::splat(1.0) };
            let factor = one.div(plane.error).flip_sign(side);
            plane.value.mul(factor).store_to(&mut self.values[number], first);
            for (scaled, normal) in self.normals[number].iter_mut().zip(plane.normal) {
                normal.mul(factor).store_to(scaled, first);
            }
        }
        let sound = L::bits(farthest.less(L::splat(FARTHEST)));
        let unsound = !sound & lanes::all::<L>();
        if unsound != 0 {
            self.leave_open(unsound << first);
        }
    }

    /// Planes of these triangles say nothing.
    #[cold]
    fn leave_open(&mut self, triangles: u32) {
        self.unsided |= triangles;
        for lane in (0..WIDTH).filter(|lane| triangles & (1 << lane) != 0) {
            for plane in 0..4 {
                self.values[plane][lane] = 0.0;
                self.normals[plane].iter_mut().for_each(|axis| axis[lane] = 0.0);
            }
        }
    }

    /// Of the triangles, those that certainly block the ray from an origin, and those that the exact test must decide.
    #[inline(always)]
    pub fn cast_on_one<L: Lanes>(&self, origin: Vec3) -> (u32, u32) {
        let origin = lanes::splat::<L>(origin);
        let (mut certain, mut missed) = (0, 0);
        let mut first = 0;
        while first < WIDTH {
            let mut least = L::splat(f32::INFINITY);
            for plane in 0..4 {
                let [x, y, z] = &self.normals[plane];
                let mut value = L::load(&self.values[plane], first);
                value = L::load(z, first).mul_add(origin[2], value);
                value = L::load(y, first).mul_add(origin[1], value);
                value = L::load(x, first).mul_add(origin[0], value);
                least = least.min(value);
            }
            certain |= L::bits(L::splat(1.0).less(least)) << first;
            missed |= L::bits(least.less(L::splat(-1.0))) << first;
            first += L::COUNT;
        }
        let (certain, missed) = (certain & !self.unsided, missed & !self.unsided);
        (certain, !(certain | missed) & ((1 << WIDTH) - 1))
    }

    /// Triangles that may block a ray from the box: a bit each.
    #[inline(always)]
    pub fn candidates<L: Lanes>(&self, base: &OriginBox, origins: &OriginBox) -> u32 {
        let middles = [lanes::splat::<L>(base.middle()), lanes::splat::<L>(origins.middle())];
        let halves = [
            lanes::splat::<L>(0.5 * (base.high - base.low)),
            lanes::splat::<L>(0.5 * (origins.high - origins.low)),
        ];
        let (least, slope) = (L::splat(1.001), L::splat(1e-5));
        let (mut beyond, mut before) = (0, 0);
        let mut first = 0;
        while first < WIDTH {
            for plane in 0..4 {
                let which = usize::from(plane == OWN);
                let (middle, half) = (middles[which], halves[which]);
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

#[cfg(test)]
mod tests;
