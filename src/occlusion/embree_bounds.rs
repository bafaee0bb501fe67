//! The bounds between which the answer of `rtcOccluded1` lies, as engines.
//!
//! They need no Embree; what they say of it is argued in `geometry::intersect::embree`.

use std::sync::Arc;

use super::{Engine, Occlusion, Walk};
use crate::geometry::Triangles;
use crate::geometry::intersect::{AtLeast, AtMost, FastBox, Moller, Pluecker, RobustBox};
use crate::geometry::lanes::Arithmetic;

/// Says "blocked" only where Embree does, in robust scenes or default ones, by kernels of this arithmetic.
///
/// Of default scenes of high quality it is no bound: there boxes are clipped.
///
/// # Panics
/// If this CPU lacks the arithmetic.
#[must_use]
pub fn at_least<W: Walk>(
    triangles: &Arc<Triangles>,
    walk: W,
    robust: bool,
    arithmetic: Arithmetic,
) -> Box<dyn Occlusion> {
    let triangles = triangles.clone();
    macro_rules! engine {
        ($test:ty) => {
            Box::new(Engine::<W, $test>::new(triangles, walk, Some(arithmetic)))
        };
    }
    match (robust, arithmetic) {
        (true, _) => engine!(AtLeast<Pluecker, RobustBox>),
        (false, Arithmetic::Sse) => engine!(AtLeast<Moller, FastBox<false, false>>),
        (false, Arithmetic::Avx2) => engine!(AtLeast<Moller, FastBox<true, false>>),
        (false, Arithmetic::Avx512) => engine!(AtLeast<Moller, FastBox<true, true>>),
    }
}

/// Says "blocked" wherever Embree does. That is so of [`Brute`](super::Brute) only: other cullers may pass
/// over a triangle that the test reports far from where it is.
///
/// # Panics
/// If this CPU lacks the arithmetic.
#[must_use]
pub fn at_most<W: Walk>(
    triangles: &Arc<Triangles>,
    walk: W,
    robust: bool,
    arithmetic: Arithmetic,
) -> Box<dyn Occlusion> {
    let triangles = triangles.clone();
    if robust {
        Box::new(Engine::<W, AtMost<Pluecker>>::new(triangles, walk, Some(arithmetic)))
    } else {
        Box::new(Engine::<W, AtMost<Moller>>::new(triangles, walk, Some(arithmetic)))
    }
}
