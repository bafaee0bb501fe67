//! Rays that do not stay together, and go on one by one.

use std::ops::ControlFlow::{self, Break, Continue};

use super::bundle::{Bundle, PACKET};
use super::rays::PacketRays;
use super::walk::Around;
use crate::exact::Exact;
use crate::geometry::Ray;
use crate::geometry::intersect::RayLanes;
use crate::geometry::lanes::{Lanes, LanesJob};
use crate::occlusion::{Cluster, Node, Tally, WIDTH};

/// A ray of a packet by itself.
pub(super) struct Alone<'a, L: Lanes> {
    packet: usize,
    lane: usize,
    ray: &'a Ray,
    lanes: RayLanes<L>,
}

impl<'a, L: Lanes> Alone<'a, L> {
    #[inline(always)]
    pub fn new(around: &Around<'a>, packet: usize, lane: usize) -> Self {
        let ray = around.queries.ray(packet * PACKET + lane);
        Self { packet, lane, ray, lanes: RayLanes::<L>::of::<Exact>(ray) }
    }

    /// Tests the triangles of a cluster by the exact test. Breaks at the first that blocks, unless `ALL` are wanted.
    #[inline(always)]
    pub fn test<const ALL: bool>(
        &self,
        bundle: &mut Bundle,
        cluster: &Cluster,
        around: &Around,
    ) -> ControlFlow<()> {
        let hit = |triangle| {
            bundle.meet::<ALL>(self.packet, 1 << self.lane, triangle);
            if ALL { Continue(()) } else { Break(()) }
        };
        cluster.test_each::<Exact, L>(self.ray, &self.lanes, around.triangles, hit)
    }

    /// Tests the triangles of some clusters of a node, a bit each, likewise.
    #[inline(always)]
    fn test_some<const ALL: bool>(
        &self,
        bundle: &mut Bundle,
        node: &Node,
        mut clusters: u32,
        around: &Around,
        tally: &mut Tally,
    ) -> ControlFlow<()> {
        while clusters != 0 {
            let slot = clusters.trailing_zeros() as usize;
            clusters &= clusters - 1;
            tally.triangle_tests += WIDTH as u64;
            let cluster = &around.clusters.all()[node.number(slot) as usize];
            self.test::<ALL>(bundle, cluster, around)?;
        }
        Continue(())
    }
}

/// Some rays of a packet visit a node, and what is below it, one by one.
pub(super) struct GoAlone<'a, 'b, const ALL: bool> {
    pub packet: usize,
    /// A bit each.
    pub rays: u16,
    pub packet_rays: &'a PacketRays,
    pub node: u32,
    pub bundle: &'a mut Bundle,
    /// What is still to be visited.
    pub rest: &'a mut Vec<u32>,
    pub around: &'a Around<'b>,
    pub tally: &'a mut Tally,
}

impl<const ALL: bool> LanesJob for GoAlone<'_, '_, ALL> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { packet, mut rays, packet_rays, node, bundle, rest, around, tally } = self;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let shaft = packet_rays.shaft(lane % PACKET);
            rest.clear();
            rest.push(node);
            while let Some(node) = rest.pop() {
                tally.cells += 1;
                let node = &around.clusters.nodes()[node as usize];
                let met = shaft.meets::<L>(node).met;
                let clusters = met & node.clusters();
                let mut nodes = met & !clusters;
                if clusters != 0 {
                    // Not before: many rays come to no cluster, and this reads the query.
                    let alone = Alone::<L>::new(around, packet, lane);
                    if alone.test_some::<ALL>(bundle, node, clusters, around, tally).is_break() {
                        break;
                    }
                }
                while nodes != 0 {
                    let slot = nodes.trailing_zeros() as usize;
                    nodes &= nodes - 1;
                    rest.push(node.number(slot));
                }
            }
        }
    }
}
