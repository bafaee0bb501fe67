//! The rays of a packet, for tests of one box by all of them, where a shaft is wider than a box; and for those that go on alone.

use glam::Vec3;

use super::bundle::PACKET;
use super::columns::Row;
use super::frustum::{PAD, STEEPEST, Shaft};
use super::planes::Ground;
use super::source::Source;
use crate::geometry::lanes::Sixteen;
use crate::occlusion::Node;

/// An origin that is moved to the centre of the ground and back has been rounded twice, and with it the ray: that takes as much room
/// again as all else.
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
