//! The rays of a packet, for tests of one box by all of them, where a shaft is wider than a box; and for those that go on alone.

use glam::Vec3;

use super::bundle::PACKET;
use super::columns::Row;
use super::frustum::{PAD, STEEPEST, Shaft};
use super::planes::Ground;
use super::source::Source;
use crate::geometry::lanes::Sixteen;
use crate::occlusion::Node;

/// An origin that is moved to the centre of the ground and back has been rounded twice, and with it the ray. All that errs, with what does
/// in `frustum`, is less than 18 roundings of the largest coordinate; twice the pad of a shaft is 32.
const PADS: f32 = 2.0;

/// The rays of a packet.
#[derive(Clone, Copy)]
pub(super) struct PacketRays {
    origins: [[f32; PACKET]; 3],
    inverses: [[f32; PACKET]; 3],
    pad: f32,
    end: f32,
}

impl PacketRays {
    pub const EMPTY: Self =
        Self { origins: [[0.0; PACKET]; 3], inverses: [[0.0; PACKET]; 3], pad: 0.0, end: 0.0 };

    /// Takes over the rays to a light from origins that are relative to a centre. Those that are not asked are rays too.
    #[inline(always)]
    pub fn set<S: Sixteen>(&mut self, ground: &Ground, origins: &[Row; 3], largest: f32) {
        self.pad = PADS * PAD * largest;
        self.end = ground.source.end();
        for (axis, Row(row)) in origins.iter().enumerate() {
            let origin = S::load(row).add(S::splat(ground.centre[axis]));
            origin.store(&mut self.origins[axis]);
            let slope = match ground.source {
                Source::Point(light) => S::splat(light[axis]).sub(origin),
                Source::Direction(direction) => S::splat(direction[axis]),
            };
            // Not one by one: the compiler put a coordinate of the three axes into a vector, with gathering and scattering, sixteen times.
            let inverse = S::splat(1.0).div(slope);
            let inverse = inverse.max(S::splat(-STEEPEST)).min(S::splat(STEEPEST));
            inverse.store(&mut self.inverses[axis]);
        }
    }

    /// The shaft of one of them.
    #[inline(always)]
    pub fn shaft(&self, lane: usize) -> Shaft {
        let [x, y, z] = &self.origins;
        let origin = Vec3::new(x[lane], y[lane], z[lane]);
        let [x, y, z] = &self.inverses;
        Shaft::of_ray(origin, [x[lane], y[lane], z[lane]], self.end, self.pad)
    }

    /// The rays that meet a box of a node: a bit each.
    #[inline(always)]
    pub fn meet<S: Sixteen>(&self, node: &Node, slot: usize) -> u16 {
        let (mut enter, mut leave) = (S::splat(0.0), S::splat(self.end));
        for axis in 0..3 {
            let origin = S::load(&self.origins[axis]);
            let inverse = S::load(&self.inverses[axis]);
            let low = S::splat(node.low[axis][slot] - self.pad).sub(origin).mul(inverse);
            let high = S::splat(node.high[axis][slot] + self.pad).sub(origin).mul(inverse);
            enter = enter.max(low.min(high));
            leave = leave.min(low.max(high));
        }
        enter.less_equal(leave)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::strategies::point;
    use super::*;
    use crate::geometry::Bounds;
    use crate::geometry::lanes::{Available, Lanes, LanesJob};
    use crate::occlusion::{Child, WIDTH};

    /// Rays of a packet to a light, and how far along each to look.
    #[derive(Clone, Debug)]
    struct Case {
        source: Source,
        centre: Vec3,
        origins: Vec<Vec3>,
        ways: Vec<f32>,
    }

    impl Case {
        /// Of each ray, the place on it, as exact as f64 goes, of the ray that is asked.
        fn places(&self) -> Vec<DVec3> {
            let place = |(&origin, &way): (&Vec3, &f32)| {
                let direction = match self.source {
                    Source::Point(light) => light - origin,
                    Source::Direction(direction) => direction,
                };
                origin.as_dvec3() + f64::from(way) * direction.as_dvec3()
            };
            self.origins.iter().zip(&self.ways).map(place).collect()
        }

        /// As a bundle has it: all that enters.
        fn largest(&self) -> f32 {
            let light = match self.source {
                Source::Point(light) => light,
                Source::Direction(_) => Vec3::ZERO,
            };
            let places = self.places().into_iter().map(|place| place.as_vec3());
            let all = self.origins.iter().copied().chain(places).chain([light, self.centre]);
            all.fold(0.0, |largest, place| largest.max(place.abs().max_element()))
        }
    }

    /// Boxes of which this place is a corner, one in each direction.
    fn boxes_at(place: DVec3, size: f32) -> Node {
        let mut node = Node::EMPTY;
        for slot in 0..WIDTH {
            let (mut min, mut max) = (Vec3::ZERO, Vec3::ZERO);
            for axis in 0..3 {
                let nearest = place[axis] as f32;
                let below =
                    if f64::from(nearest) > place[axis] { nearest.next_down() } else { nearest };
                let above =
                    if f64::from(nearest) < place[axis] { nearest.next_up() } else { nearest };
                let is_upper = slot & (1 << axis) != 0;
                min[axis] = if is_upper { below } else { above - size };
                max[axis] = if is_upper { below + size } else { above };
            }
            node.set(slot, &Bounds { min, max }, Child::Cluster(0));
        }
        node
    }

    impl LanesJob for &Case {
        /// Of each ray, the boxes at its place that its shaft meets, and those that it meets among all of its packet.
        type Answer = Vec<(u32, u32)>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Answer {
            let mut rows = [Row::ZERO; 3];
            for (lane, origin) in self.origins.iter().enumerate() {
                for axis in 0..3 {
                    rows[axis].0[lane] = origin[axis] - self.centre[axis];
                }
            }
            let Case { source, centre, .. } = *self;
            let largest = self.largest();
            let mut rays = PacketRays::EMPTY;
            rays.set::<L::Sixteen>(&Ground { source, centre, half: Vec3::ONE }, &rows, largest);
            let mut all = Vec::new();
            for (lane, place) in self.places().into_iter().enumerate() {
                let node = boxes_at(place, 0.1 * largest);
                let mut together = 0;
                for slot in 0..WIDTH {
                    let met = rays.meet::<L::Sixteen>(&node, slot);
                    together |= u32::from(met >> lane & 1) << slot;
                }
                all.push((rays.shaft(lane).meets::<L>(&node).met, together));
            }
            all
        }
    }

    /// Far or near, and many coordinates like those of the light.
    fn case() -> impl Strategy<Value = Case> {
        let near = || {
            (point(1.0), 0u8..8).prop_map(|(offset, axes)| {
                Vec3::from(
                    [0, 1, 2].map(|axis| if axes & (1 << axis) != 0 { offset[axis] } else { 0.0 }),
                )
            })
        };
        let origins = prop::collection::vec(near(), PACKET);
        let ways = prop::collection::vec(0f32..=1.0, PACKET);
        (point(1.0), point(1.0), -2..7i32, -3..3i32, origins, ways, near(), any::<bool>()).prop_map(
            |(place, centre, far, size, origins, ways, direction, is_point)| {
                let (far, size) = (10f32.powi(far), 10f32.powi(size));
                let origins = origins.into_iter().map(|offset| place + size * offset).collect();
                let source = if is_point || direction == Vec3::ZERO {
                    Source::Point(place)
                } else {
                    Source::Direction(direction.normalize())
                };
                Case { source, centre: far * centre, origins, ways }
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn a_ray_meets_every_box_that_has_a_place_on_it_alone_and_in_its_packet(case in case()) {
            for arithmetic in Available::all() {
                for (alone, together) in arithmetic.run(&case) {
                    prop_assert_eq!((alone, together), (0xff, 0xff), "{:?}", arithmetic);
                }
            }
        }
    }
}
