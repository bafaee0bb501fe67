//! Planes of clusters, kept: parts of a bundle come to the same clusters, and so do bundles in a row.

use super::planes::{Ground, Planes};
use crate::geometry::lanes::Lanes;
use crate::occlusion::Cluster;

/// Clusters whose planes are kept. 130 KiB.
const KEPT: usize = 1 << KEPT_BITS;
const KEPT_BITS: u32 = 8;

/// No cluster has this number.
const NO_CLUSTER: u32 = u32::MAX;

/// Where the planes of a cluster are kept. Numbers are in runs, a treelet's each, with gaps between: by the golden ratio those of a run
/// have places of their own, and other runs mostly others (Knuth, The Art of Computer Programming 3, 6.4).
#[inline(always)]
fn place_of(number: u32) -> usize {
    const GOLDEN: u32 = 0x9e37_79b1;
    (number.wrapping_mul(GOLDEN) >> (u32::BITS - KEPT_BITS)) as usize
}

/// Planes of clusters that were tested of late.
pub(super) struct Kept {
    planes: [Planes; KEPT],
    /// Whose they are.
    clusters: [u32; KEPT],
    /// The ground that they are for.
    ground: Option<Ground>,
}

impl Kept {
    pub const fn none() -> Self {
        Self { planes: [const { Planes::EMPTY }; KEPT], clusters: [NO_CLUSTER; KEPT], ground: None }
    }

    /// From now on, planes are for this ground.
    pub fn stand_on(&mut self, ground: &Ground) {
        if self.ground != Some(*ground) {
            self.ground = Some(*ground);
            self.clusters = [NO_CLUSTER; KEPT];
        }
    }

    /// The planes of a cluster, which has this number.
    #[inline(always)]
    pub fn of<L: Lanes>(&mut self, ground: &Ground, number: u32, cluster: &Cluster) -> &Planes {
        let place = place_of(number);
        if self.clusters[place] != number {
            self.clusters[place] = number;
            self.planes[place].set::<L>(ground, cluster);
        }
        &self.planes[place]
    }
}
