//! The rays of a packet, for tests of one box by all of them: where a shaft is wider than a box.

use super::bundle::PACKET;
use super::frustum::{PAD, inverse};
use crate::geometry::lanes::Lanes;
use crate::occlusion::Node;
use crate::shadow::ShadowQuery;

/// The rays of a packet, for tests of one box.
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

    /// Takes over the rays of up to a packet of queries.
    #[inline(always)]
    pub fn set(&mut self, queries: &[ShadowQuery], largest: f32) {
        self.pad = PAD * largest;
        self.end = queries[0].ray.end;
        for (lane, query) in queries.iter().enumerate() {
            for axis in 0..3 {
                self.origins[axis][lane] = query.ray.origin[axis];
                self.inverses[axis][lane] = query.ray.direction[axis];
            }
        }
        for inverses in &mut self.inverses {
            for value in inverses {
                *value = inverse(*value);
            }
        }
    }

    /// The rays that meet a box of a node: a bit each.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, node: &Node, slot: usize) -> u32 {
        let mut met = 0;
        let mut first = 0;
        while first < PACKET {
            let (mut enter, mut leave) = (L::splat(0.0), L::splat(self.end));
            for axis in 0..3 {
                let origin = L::load_from(&self.origins[axis], first);
                let inverse = L::load_from(&self.inverses[axis], first);
                let low = L::splat(node.low[axis][slot] - self.pad).sub(origin).mul(inverse);
                let high = L::splat(node.high[axis][slot] + self.pad).sub(origin).mul(inverse);
                enter = enter.max(low.min(high));
                leave = leave.min(low.max(high));
            }
            met |= L::bits(enter.less_equal(leave)) << first;
            first += L::COUNT;
        }
        met
    }
}
