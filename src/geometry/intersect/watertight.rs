//! Woop, Benthin and Wald 2013: watertight in f32.
//!
//! Corners are moved to the ray's origin and sheared so that the ray runs along one axis; the edges are
//! then decided in two dimensions by values that both neighbours compute alike, and again in f64 where
//! such a value is zero. No ray slips between neighbours. That is not accuracy: on which side of a
//! silhouette a ray passes is decided as badly as by the other f32 tests.
//!
//! Woop, Benthin, Wald: Watertight Ray/Triangle Intersection. Journal of Computer Graphics Techniques
//! 2(1), 2013.

use super::{Claims, RayLanes, TriangleTest, vicinity};
use crate::geometry::lanes::{Lanes, Scalar, Vector, sub};
use crate::geometry::{Ray, Triangle};

/// The watertight test.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watertight;

/// The shear that turns the ray into the z axis. Computed once a ray, rounded once a value.
#[derive(Clone, Copy, Debug)]
pub struct Shear<L> {
    /// Axes of the scene that become x, y and z.
    axes: [usize; 3],
    x: L,
    y: L,
    z: L,
}

impl<L: Lanes> Shear<L> {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let magnitude = ray.direction.abs();
        let z = if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
            0
        } else if magnitude.y > magnitude.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // Keep the winding where the ray runs down the axis.
        let (x, y) = if ray.direction[z] < 0.0 { (y, x) } else { (x, y) };
        let direction = ray.direction;
        Self {
            axes: [x, y, z],
            x: L::splat(direction[x] / direction[z]),
            y: L::splat(direction[y] / direction[z]),
            z: L::splat(1.0 / direction[z]),
        }
    }

    /// For tests that do without.
    #[inline(always)]
    pub(super) fn none() -> Self {
        Self { axes: [0, 1, 2], x: L::splat(0.0), y: L::splat(0.0), z: L::splat(0.0) }
    }

    /// A corner, moved to the origin and sheared; z is not yet scaled.
    #[inline(always)]
    fn apply(&self, ray: &RayLanes<L>, corner: Vector<L>) -> Vector<L> {
        let moved = sub(corner, ray.origin);
        let [x, y, z] = self.axes;
        [moved[x].sub(self.x.mul(moved[z])), moved[y].sub(self.y.mul(moved[z])), moved[z]]
    }
}

/// The plane of a triangle in sheared space, seen along the ray.
struct Sheared<L> {
    corners: [Vector<L>; 3],
    edges: [L; 3],
}

impl<L: Lanes> Sheared<L> {
    #[inline(always)]
    fn new(ray: &RayLanes<L>, corners: &[Vector<L>; 3]) -> Self {
        let shear = &ray.shear;
        let a = shear.apply(ray, corners[0]);
        let b = shear.apply(ray, corners[1]);
        let c = shear.apply(ray, corners[2]);
        // Two rounded products: symmetric, so that a neighbour gets the negative of the same value.
        let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
        let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
        let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
        Self { corners: [a, b, c], edges: [u, v, w] }
    }
}

impl TriangleTest for Watertight {
    const SHEARS: bool = true;

    /// Opens every lane whose edges are not surely on both sides of the ray.
    #[inline(always)]
    fn claims<L: Lanes>(ray: &RayLanes<L>, corners: &[Vector<L>; 3]) -> Claims {
        let [u, v, w] = Sheared::new(ray, corners).edges;
        let zero = L::splat(0.0);
        let inside = L::or(zero.less_equal(u.min(v).min(w)), u.max(v).max(w).less_equal(zero));
        Claims { certain: 0, open: L::bits(inside) }
    }

    fn settle(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
        let lanes = RayLanes::<Scalar<false, false>>::new(ray);
        let corners = triangle.map(|corner| corner.to_array().map(Scalar));
        let Sheared { corners: [a, b, c], edges } = Sheared::new(&lanes, &corners);
        let mut edges = edges.map(|edge| edge.0);
        if edges.contains(&0.0) {
            let product = |a: Scalar<_, _>, b: Scalar<_, _>| f64::from(a.0) * f64::from(b.0);
            edges = [
                (product(c[0], b[1]) - product(c[1], b[0])) as f32,
                (product(a[0], c[1]) - product(a[1], c[0])) as f32,
                (product(b[0], a[1]) - product(b[1], a[0])) as f32,
            ];
        }
        let [u, v, w] = edges;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return false;
        }
        let determinant = u + v + w;
        let scaled = |corner: Vector<Scalar<false, false>>| lanes.shear.z.0 * corner[2].0;
        let distance = u * scaled(a) + v * scaled(b) + w * scaled(c);
        let (distance, determinant) =
            if determinant < 0.0 { (-distance, -determinant) } else { (distance, determinant) };
        determinant > 0.0
            && distance > 0.0
            && distance < ray.end * determinant
            && vicinity::meets(ray, triangle, slack)
    }
}
