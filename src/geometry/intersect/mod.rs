//! Triangle tests: whether a ray meets a triangle, one file a method.

mod embree;
mod moller;
mod pluecker;
pub(super) mod vicinity;
mod watertight;

pub use embree::{AtLeast, AtMost, BoxTest, FastBox, RobustBox};
pub(crate) use embree::{EMBREE_LARGEST, EMBREE_SMALLEST};
pub use moller::Moller;
pub use pluecker::Pluecker;
pub use watertight::{Shear, Watertight};

use super::lanes::{Lanes, Vector, splat};
use super::{Ray, Triangle};

/// What a test says of several triangles at once, a bit a lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Claims {
    /// The ray surely meets these.
    pub certain: u32,
    /// [`TriangleTest::settle`] must decide these.
    pub open: u32,
}

/// A ray, spread over all lanes.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes<L> {
    /// Origin.
    pub origin: Vector<L>,
    /// Direction.
    pub direction: Vector<L>,
    /// End of the interval.
    pub end: L,
    /// What [`Watertight`] needs; nothing where it is not asked for.
    pub shear: Shear<L>,
}

impl<L: Lanes> RayLanes<L> {
    /// The ray in every lane, for any test.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        Self { shear: Shear::new(ray), ..Self::without_shear(ray) }
    }

    /// The ray in every lane, with what one test needs.
    #[inline(always)]
    pub fn of<T: TriangleTest>(ray: &Ray) -> Self {
        if T::SHEARS { Self::new(ray) } else { Self::without_shear(ray) }
    }

    #[inline(always)]
    fn without_shear(ray: &Ray) -> Self {
        Self {
            origin: splat(ray.origin),
            direction: splat(ray.direction),
            end: L::splat(ray.end),
            shear: Shear::none(),
        }
    }
}

/// A way to decide whether a ray meets a triangle.
///
/// One source serves every instruction set: [`claims`](Self::claims) is generic over the lanes, and
/// rare lanes are left to the scalar [`settle`](Self::settle). A backend tests a triangle only by
/// these two, so any backend whose culling is conservative gives the same answers.
pub trait TriangleTest: Copy + Default + Send + Sync + 'static {
    /// Whether it needs the shear of [`RayLanes`].
    const SHEARS: bool = false;

    /// Whether what it says is true, and not what some arithmetic makes of it.
    const IS_EXACT: bool = false;

    /// Tests as many triangles as `L` has lanes. The ray is valid ([`Ray::is_valid`]).
    fn claims<L: Lanes>(ray: &RayLanes<L>, corners: &[Vector<L>; 3]) -> Claims;

    /// Decides a lane that [`claims`](Self::claims) left open. A test that rounds counts hits only where the
    /// ray comes within the slack of the triangle: see [`Triangles::slack`](super::Triangles::slack).
    fn settle(ray: &Ray, triangle: &Triangle, slack: f64) -> bool;
}

/// Whether the ray meets the triangle, by a test in the arithmetic of `L` (one lane is used).
#[must_use]
pub fn meets<T: TriangleTest, L: Lanes>(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
    let corners = [triangle.map(glam::Vec3A::from)];
    let claims = T::claims::<L>(&RayLanes::new(ray), &L::gather(&corners, &[0]));
    claims.certain & 1 != 0 || (claims.open & 1 != 0 && T::settle(ray, triangle, slack))
}
