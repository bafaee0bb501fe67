//! The rays of a packet, for tests of one box by all of them: where a shaft is wider than a box.

use super::bundle::{Chosen, PACKET};
use super::frustum::{PAD, inverse};
use crate::geometry::lanes::Sixteen;
use crate::occlusion::Node;

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

    /// Takes over the rays of up to a packet of queries, from `first` on.
    #[inline(always)]
    pub fn set(&mut self, queries: &Chosen, first: usize, largest: f32) {
        self.pad = PAD * largest;
        self.end = queries.ray(first).end;
        for lane in 0..PACKET.min(queries.count() - first) {
            let ray = queries.ray(first + lane);
            for axis in 0..3 {
                self.origins[axis][lane] = ray.origin[axis];
                self.inverses[axis][lane] = ray.direction[axis];
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
