//! Where origins lie as their light sees them: in which direction, and how far away.
//!
//! A box around origins that are spread in depth, as on scattered things, is far wider than the light sees them. So
//! directions are two ratios of coordinates (to a direction, two coordinates along it), and a rectangle around those, as far away
//! as the farthest origin, is the *base* of a pyramid (a prism) from the light, in which all rays are. As thin
//! pyramids are what counts, queries are also sorted by direction, not by place.
//!
//! **What a base proves.** A plane through the light and an edge says the same of an origin P as of P', where the ray goes on to the
//! base, at s times the distance: its value at P' is s times as large. What the ray's rounding moves the value by
//! (`planes`) is s² times as large at P'. So what is certain of all P' is certain of all P. It is not so for
//! the triangle's own plane: that is asked of the box.
//!
//! **Rounding.** A ratio errs by 3u of at most [`WIDEST`], and the corners of the base by some u of their distance from the
//! light and of the light's from the centre: [`PAD`] of both is added all around. That also covers what a shaft makes of the base
//! (`frustum`), which counts in the largest coordinate M, while a base is up to 5 M out: twice as far across as it is deep, which is up
//! to 2 M, from a light that is up to M out. Moving it and taking its sides are 5 roundings of its corners, 10 of both
//! distances at most.
//!
//! The octahedral map of directions, unfolded: Meyer, Süßmuth, Sußner, Stamminger, Greiner: On Floating-Point Normal Vectors.
//! Computer Graphics Forum 29(4), 2010.

use glam::Vec3;

use super::bundle::OriginBox;
use super::columns::Row;
use super::source::Source;
use crate::geometry::lanes::Sixteen;

/// Where ratios of coordinates are larger, a box serves better.
const WIDEST: f32 = 2.0;

/// 64 roundings of 1.
const PAD: f32 = 1.0 / (1 << 18) as f32;

/// Far below all distances: a light sees itself nowhere, not as NaN.
const NEAREST: f32 = 1e-30;

/// How a light sees what lies in a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Perspective {
    /// The light; for a direction, the middle of the box.
    eye: Vec3,
    /// Two axes across, and that along which the middle is farthest from the light.
    axes: [usize; 3],
    /// Which way depth grows along it.
    sign: f32,
    /// Towards a direction: how far rays go across on a unit of depth.
    slopes: Option<[f32; 2]>,
    /// The longest side of the box that it was made for.
    reach: f32,
}

/// A rectangle around what is seen, and the depth of what is farthest.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    low: [f32; 2],
    high: [f32; 2],
    far: f32,
}

impl View {
    /// Of no origins.
    pub const EMPTY: Self =
        Self { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2], far: f32::NEG_INFINITY };

    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        let mut both = Self { far: self.far.max(other.far), ..self };
        for side in 0..2 {
            both.low[side] = self.low[side].min(other.low[side]);
            both.high[side] = self.high[side].max(other.high[side]);
        }
        both
    }
}

impl Perspective {
    /// Of what lies in a box.
    pub fn new(source: &Source, around: &OriginBox) -> Self {
        let place = around.middle();
        let (eye, way) = match *source {
            Source::Point(light) => (light, place - light),
            Source::Direction(direction) => (place, -direction),
        };
        let depth = way.abs().max_position();
        let axes = [(depth + 1) % 3, (depth + 2) % 3, depth];
        let slope = |side: usize| way[axes[side]] / way[depth].abs();
        let is_parallel = matches!(source, Source::Direction(_));
        let slopes = is_parallel.then(|| [slope(0), slope(1)]);
        let reach = (around.high - around.low).max_element();
        Self { eye, axes, sign: 1f32.copysign(way[depth]), slopes, reach }
    }

    /// Of sixteen origins: across, and how deep.
    #[inline(always)]
    fn coordinates<S: Sixteen>(&self, origins: &[Row; 3]) -> [S; 3] {
        let mut seen = [S::splat(0.0); 3];
        for (seen, axis) in seen.iter_mut().zip(self.axes) {
            *seen = S::load(&origins[axis].0).sub(S::splat(self.eye[axis]));
        }
        let [x, y, depth] = seen;
        let depth = depth.mul(S::splat(self.sign));
        match self.slopes {
            None => [x, y, depth],
            Some([a, b]) => [x.sub(depth.mul(S::splat(a))), y.sub(depth.mul(S::splat(b))), depth],
        }
    }

    /// Directions of sixteen origins: neighbours are near each other, all around the light. That in the middle is 0, its
    /// opposite is the square |x| + |y| = 2.
    #[inline(always)]
    pub fn unfold<S: Sixteen>(&self, origins: &[Row; 3]) -> [S; 2] {
        let [x, y, depth] = self.coordinates::<S>(origins);
        if self.slopes.is_some() {
            return [x, y];
        }
        let across = x.abs().add(y.abs());
        let distance = across.add(depth.abs());
        let scale = distance.sub(depth).div(distance.mul_add(across, S::splat(NEAREST)));
        [x.mul(scale), y.mul(scale)]
    }

    /// What is seen of a packet.
    #[inline(always)]
    pub fn view<S: Sixteen>(&self, origins: &[Row; 3]) -> View {
        let [mut x, mut y, depth] = self.coordinates::<S>(origins);
        if self.slopes.is_none() {
            if depth.least() <= 0.0 {
                let (low, high) = ([f32::NEG_INFINITY; 2], [f32::INFINITY; 2]);
                return View { low, high, far: f32::INFINITY };
            }
            (x, y) = (x.div(depth), y.div(depth));
        }
        View {
            low: [x.least(), y.least()],
            high: [x.greatest(), y.greatest()],
            far: depth.greatest(),
        }
    }

    /// The base of all rays of what is seen, relative to a centre; `None` if the light sees it too widely.
    #[inline(always)]
    pub fn base(&self, view: &View, centre: Vec3) -> Option<OriginBox> {
        let View { low, high, far } = *view;
        let to_eye = self.eye - centre;
        let away = to_eye.abs().max_element();
        let [x, y, depth] = self.axes;
        let (scale, shift, pad) = match self.slopes {
            None => {
                let widest = high[0].max(high[1]).max(-low[0]).max(-low[1]);
                if widest >= WIDEST {
                    return None;
                }
                let pad = PAD * (far + away);
                (far + pad, [0.0; 2], pad)
            }
            Some([a, b]) => {
                let pad = PAD * (self.reach + away);
                (1.0, [(far + pad) * a, (far + pad) * b], pad)
            }
        };
        let (mut least, mut greatest) = (Vec3::ZERO, Vec3::ZERO);
        for (side, axis) in [x, y].into_iter().enumerate() {
            let shift = to_eye[axis] + shift[side];
            least[axis] = shift + scale * low[side] - pad;
            greatest[axis] = shift + scale * high[side] + pad;
        }
        least[depth] = to_eye[depth] + self.sign * (far + pad);
        greatest[depth] = least[depth];
        Some(OriginBox { low: least, high: greatest })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::bundle::PACKET;
    use super::super::strategies::point;
    use super::*;
    use crate::geometry::lanes::{Available, Lanes, LanesJob};

    struct Seen<'a>(&'a Perspective, &'a [Row; 3]);

    impl LanesJob for Seen<'_> {
        type Answer = (View, [Row; 2]);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Answer {
            let Self(perspective, origins) = self;
            let mut directions = [Row::ZERO; 2];
            let [x, y] = perspective.unfold::<L::Sixteen>(origins);
            x.store(&mut directions[0].0);
            y.store(&mut directions[1].0);
            (perspective.view::<L::Sixteen>(origins), directions)
        }
    }

    fn rows(origins: &[Vec3; PACKET]) -> [Row; 3] {
        let mut rows = [Row::ZERO; 3];
        for (lane, origin) in origins.iter().enumerate() {
            for (row, coordinate) in rows.iter_mut().zip(origin.to_array()) {
                row.0[lane] = coordinate;
            }
        }
        rows
    }

    fn place(size: f32) -> impl Strategy<Value = (Vec3, Vec<Vec3>, Vec3)> {
        let origins = prop::collection::vec(point(size), PACKET);
        (point(1000.0), origins, point(3.0)).prop_map(move |(place, origins, centre)| {
            let origins = origins.into_iter().map(|origin| place + origin).collect();
            (place, origins, place + size * centre)
        })
    }

    fn check(source: &Source, origins: &[Vec3], centre: Vec3) -> Result<bool, TestCaseError> {
        let origins: [Vec3; PACKET] = origins.try_into().unwrap();
        let least = origins.iter().fold(Vec3::INFINITY, |least, origin| least.min(*origin));
        let greatest = origins.iter().fold(Vec3::NEG_INFINITY, |most, origin| most.max(*origin));
        let around = OriginBox { low: least, high: greatest };
        let perspective = Perspective::new(source, &around);
        let mut seen = false;
        for arithmetic in Available::all() {
            let (view, _) = arithmetic.run(Seen(&perspective, &rows(&origins)));
            let Some(base) = perspective.base(&view, centre) else { continue };
            seen = true;
            let centre = centre.as_dvec3();
            let (low, high) = (centre + base.low.as_dvec3(), centre + base.high.as_dvec3());
            let depth = perspective.axes[2];
            for origin in origins.map(Vec3::as_dvec3) {
                let (from, way) = match *source {
                    Source::Point(light) => (light.as_dvec3(), origin - light.as_dvec3()),
                    Source::Direction(direction) => (origin, -direction.as_dvec3()),
                };
                let steps = (low[depth] - from[depth]) / way[depth];
                let least = if matches!(source, Source::Point(_)) { 1.0 } else { 0.0 };
                prop_assert!(steps >= least, "the base is behind the origin: {steps}");
                let there: DVec3 = from + steps * way;
                for &axis in &perspective.axes[..2] {
                    prop_assert!(low[axis] <= there[axis] && there[axis] <= high[axis]);
                }
            }
        }
        Ok(seen)
    }

    proptest! {
        #[test]
        fn rays_to_a_point_pass_their_base(
            (light, away, size) in (point(50.0), point(100.0), -6..2i32),
            (place, origins, centre) in (-6..2i32).prop_flat_map(|size| place(10f32.powi(size))),
        ) {
            let light = place + light + away * 10f32.powi(size);
            check(&Source::Point(light), &origins, centre)?;
        }

        #[test]
        fn rays_to_a_direction_pass_their_base(
            direction in point(1.0),
            (_, origins, centre) in (-6..2i32).prop_flat_map(|size| place(10f32.powi(size))),
        ) {
            prop_assume!(direction.abs().max_element() > 0.01);
            prop_assert!(check(&Source::Direction(direction), &origins, centre)?);
        }
    }

    #[test]
    fn what_is_all_around_the_light_has_no_base_and_what_is_on_one_side_has() {
        let light = Source::Point(Vec3::new(1.0, 2.0, 3.0));
        let around = |x: f32| move |lane: usize| Vec3::new(x, lane as f32 - 5.0, 0.2 * lane as f32);
        let sees = |origins: [Vec3; PACKET]| check(&light, &origins, Vec3::ZERO).unwrap();
        assert!(!sees(std::array::from_fn(around(1.5))));
        assert!(sees(std::array::from_fn(around(-40.0))));
    }

    #[test]
    fn directions_all_around_are_numbers_and_keep_their_distance() {
        let light = Vec3::new(1.0, 2.0, 3.0);
        let ways = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::ONE];
        let origins = std::array::from_fn(|lane| light + 2.0 * *ways.get(lane).unwrap_or(&Vec3::X));
        let place = light + Vec3::new(0.3, 5.0, 0.1);
        let there = OriginBox { low: place, high: place };
        let perspective = Perspective::new(&Source::Point(light), &there);
        for arithmetic in Available::all() {
            let (_, [x, y]) = arithmetic.run(Seen(&perspective, &rows(&origins)));
            for (lane, way) in ways.iter().enumerate() {
                let radius = x.0[lane].abs() + y.0[lane].abs();
                let expected = if *way == Vec3::ONE { 2.0 / 3.0 } else { 1.0 - way.y };
                // The opposite is a whole square, of which any place will do.
                let is_opposite = *way == Vec3::NEG_Y;
                assert!(is_opposite || (radius - expected).abs() < 1e-6, "{way}: {radius}");
                assert!(x.0[lane].is_finite() && y.0[lane].is_finite());
            }
            for (lane, way) in ways.iter().enumerate().skip(1).take(5) {
                let apart = (x.0[lane] - x.0[0]).abs() + (y.0[lane] - y.0[0]).abs();
                assert!(apart > 0.9, "{way}: {apart}");
            }
        }
    }
}
