//! The shadow of one triangle, cast on packets of queries.
//!
//! First on the boxes of sixteen packets at once: most triangles that may shade a part of a bundle touch two or three of its
//! packets. Then on the queries of those, sixteen at once again.

use super::bundle::OriginBox;
use super::columns::Row;
use super::planes::{OWN, Planes};
use crate::geometry::TriangleId;
use crate::geometry::lanes::Sixteen;

/// Beyond this a plane is certain for a whole box; a little more than 1, for the rounding of sums.
const CERTAIN: f32 = 1.001;

/// Four planes of a triangle, each coefficient sixteen times.
pub(super) struct Shadow<S> {
    pub triangle: TriangleId,
    /// Normal and value of each.
    planes: [[S; 4]; 4],
    /// Whether it is not certain on which side of the triangle the light is: then planes say nothing.
    pub unsided: bool,
}

/// Boxes of sixteen packets, side by side.
#[derive(Clone, Copy)]
pub(super) struct Boxes {
    middles: [Row; 3],
    halves: [Row; 3],
}

impl Boxes {
    pub const NONE: Self = Self { middles: [Row::ZERO; 3], halves: [Row::ZERO; 3] };

    /// Takes over up to sixteen.
    #[inline(always)]
    pub fn set(&mut self, boxes: &[OriginBox]) {
        for (place, around) in boxes.iter().enumerate() {
            let (middle, half) = (around.middle(), around.half());
            for axis in 0..3 {
                self.middles[axis].0[place] = middle[axis];
                self.halves[axis].0[place] = half[axis];
            }
        }
    }
}

/// Of sixteen packets, a bit each.
pub(super) struct Judged {
    /// Those that the shadow may fall on.
    pub touched: u16,
    /// Those that are in it.
    pub covered: u16,
}

/// Of the queries of a packet, a bit each.
pub(super) struct Cast {
    /// Those that are in the shadow.
    pub blocked: u16,
    /// Those that the exact test must decide.
    pub doubtful: u16,
}

impl<S: Sixteen> Shadow<S> {
    /// That of one of eight triangles.
    #[inline(always)]
    pub fn of(known: &Planes, lane: usize, triangle: TriangleId) -> Self {
        let mut planes = [[S::splat(0.0); 4]; 4];
        for (number, plane) in planes.iter_mut().enumerate() {
            let [x, y, z] = &known.normals[number];
            let value = &known.values[number];
            *plane =
                [S::splat(x[lane]), S::splat(y[lane]), S::splat(z[lane]), S::splat(value[lane])];
        }
        Self { triangle, planes, unsided: known.unsided & (1 << lane) != 0 }
    }

    /// On which of sixteen boxes it falls. Not for those without a side.
    ///
    /// A plane's value in a box is that in the middle, and half of the box times the normal's magnitudes more or less. What
    /// rounding there errs by is within the bound that the plane was divided by, as it is for an origin.
    #[inline(always)]
    pub fn judge(&self, [bases, boxes]: &[Boxes; 2]) -> Judged {
        let (mut lowest, mut highest) = (S::splat(f32::INFINITY), S::splat(f32::INFINITY));
        for (plane, [nx, ny, nz, value]) in self.planes.into_iter().enumerate() {
            let boxes = if plane == OWN { boxes } else { bases };
            let [x, y, z] = load::<S>(&boxes.middles);
            let [half_x, half_y, half_z] = load::<S>(&boxes.halves);
            let middle = nx.mul_add(x, ny.mul_add(y, nz.mul_add(z, value)));
            let reach = nx.abs().mul_add(half_x, ny.abs().mul_add(half_y, nz.abs().mul(half_z)));
            lowest = lowest.min(middle.sub(reach));
            highest = highest.min(middle.add(reach));
        }
        Judged {
            touched: !highest.less(S::splat(-CERTAIN)),
            covered: S::splat(CERTAIN).less(lowest),
        }
    }

    /// On which of a packet's open queries it falls.
    #[inline(always)]
    pub fn cast(&self, origins: &[Row; 3], open: u16) -> Cast {
        if self.unsided {
            return Cast { blocked: 0, doubtful: open };
        }
        let [x, y, z] = load::<S>(origins);
        let mut least = S::splat(f32::INFINITY);
        for [nx, ny, nz, value] in self.planes {
            least = least.min(nx.mul_add(x, ny.mul_add(y, nz.mul_add(z, value))));
        }
        let (certain, missed) = (S::splat(1.0).less(least), least.less(S::splat(-1.0)));
        Cast { blocked: open & certain, doubtful: open & !(certain | missed) }
    }
}

#[inline(always)]
fn load<S: Sixteen>(rows: &[Row; 3]) -> [S; 3] {
    [S::load(&rows[0].0), S::load(&rows[1].0), S::load(&rows[2].0)]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::super::bundle::PACKET;
    use super::super::columns::around;
    use super::super::planes::Ground;
    use super::super::source::Source;
    use super::super::strategies::point;
    use super::*;
    use crate::geometry::Triangles;
    use crate::geometry::lanes::{Available, Lanes, LanesJob};
    use crate::occlusion::Clusters;

    /// A triangle, a light, and sixteen packets of origins, each around a place.
    struct Case {
        triangle: [Vec3; 3],
        light: Vec3,
        packets: Vec<[Row; 3]>,
    }

    impl LanesJob for Case {
        type Answer = (Judged, Vec<Cast>);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Answer {
            let clusters = Clusters::new(&Triangles::new([self.triangle], []));
            let mut packets = self.packets;
            let mut all = OriginBox::EMPTY;
            for packet in &packets {
                all = all.union(around::<L>(packet, u16::MAX));
            }
            let source = Source::Point(self.light);
            let ground = Ground::around(&source, &all, 10.0);
            let mut planes = Planes::EMPTY;
            planes.set::<L>(&ground, &clusters.all()[0]);
            let mut around_each = Vec::new();
            for packet in &mut packets {
                for (row, centre) in packet.iter_mut().zip(ground.centre.to_array()) {
                    for value in &mut row.0 {
                        *value -= centre;
                    }
                }
                around_each.push(around::<L>(packet, u16::MAX));
            }
            let mut boxes = Boxes::NONE;
            boxes.set(&around_each);
            let shadow = Shadow::<L::Sixteen>::of(&planes, 0, 0);
            let mut casts = Vec::new();
            for packet in &packets {
                casts.push(shadow.cast(packet, u16::MAX));
            }
            let judged = if shadow.unsided {
                Judged { touched: u16::MAX, covered: 0 }
            } else {
                shadow.judge(&[boxes, boxes])
            };
            (judged, casts)
        }
    }

    /// Packets of origins on the floor, each on a square by itself.
    fn floor() -> Vec<[Row; 3]> {
        let mut packets = vec![[Row::ZERO; 3]; PACKET];
        for (number, [x, _, z]) in packets.iter_mut().enumerate() {
            for lane in 0..PACKET {
                x.0[lane] = (number % 4 * 4 + lane % 4) as f32 - 8.0;
                z.0[lane] = (number / 4 * 4 + lane / 4) as f32 - 8.0;
            }
        }
        packets
    }

    #[test]
    fn packets_under_a_canopy_are_covered_and_those_beside_it_untouched() {
        let light = Vec3::new(0.1, 100.0, 0.2);
        let corner = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        let canopy = [corner(-100.0, -100.0), corner(100.0, -100.0), corner(0.0, 200.0)];
        // Over most of the first square, and a little of two beside it.
        let parasol = [corner(-9.0, -9.0), corner(-2.0, -9.0), corner(-9.0, -2.0)];
        for arithmetic in Available::all() {
            let (under, _) = arithmetic.run(Case { triangle: canopy, light, packets: floor() });
            assert_eq!((under.touched, under.covered), (u16::MAX, u16::MAX), "{arithmetic:?}");
            let (some, _) = arithmetic.run(Case { triangle: parasol, light, packets: floor() });
            assert_eq!((some.touched, some.covered), (0b1_0011, 0), "{arithmetic:?}");
        }
    }

    proptest! {
        #[test]
        fn what_is_judged_of_a_box_holds_for_every_query_in_it(
            triangle in prop::array::uniform3(point(2.0)),
            light in point(4.0).prop_map(|place| place + Vec3::new(0.0, 6.0, 0.0)),
            places in prop::collection::vec(point(3.0), PACKET),
            offsets in prop::collection::vec(point(0.3), PACKET),
        ) {
            let packet = |place: &Vec3| {
                let mut rows = [Row::ZERO; 3];
                for (lane, offset) in offsets.iter().enumerate() {
                    let origin = *place - Vec3::new(0.0, 3.0, 0.0) + *offset;
                    for (row, coordinate) in rows.iter_mut().zip(origin.to_array()) {
                        row.0[lane] = coordinate;
                    }
                }
                rows
            };
            for arithmetic in Available::all() {
                let packets = places.iter().map(packet).collect();
                let (judged, casts) = arithmetic.run(Case { triangle, light, packets });
                for (place, cast) in casts.iter().enumerate() {
                    let bit = 1 << place;
                    let Cast { blocked, doubtful } = *cast;
                    prop_assert!(judged.touched & bit != 0 || blocked | doubtful == 0);
                    prop_assert!(judged.covered & bit == 0 || blocked == u16::MAX);
                }
            }
        }
    }
}
