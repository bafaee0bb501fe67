//! Planes of clusters, kept: parts of a bundle come to the same clusters, and so do bundles in a row.

use super::planes::{Ground, Planes};
use crate::geometry::lanes::Lanes;
use crate::occlusion::Cluster;

/// Clusters whose planes are kept. 130 KiB.
const KEPT: usize = 256;

/// No cluster has this number.
const NO_CLUSTER: u32 = u32::MAX;

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

    /// The planes of the cluster with this number, if they are there.
    #[inline(always)]
    pub fn known(&self, number: u32) -> Option<&Planes> {
        let place = number as usize % KEPT;
        (self.clusters[place] == number).then(|| &self.planes[place])
    }

    /// The planes of a cluster, which has this number; they are made if they are not there.
    #[inline(always)]
    pub fn of<L: Lanes>(&mut self, ground: &Ground, number: u32, cluster: &Cluster) -> &Planes {
        let place = number as usize % KEPT;
        if self.clusters[place] != number {
            self.clusters[place] = number;
            self.planes[place].set::<L>(ground, cluster);
        }
        &self.planes[place]
    }
}
