//! A bundle and a tree of clusters, walked together.
//!
//! Each step takes a part of the bundle and a node, and goes on to the node's boxes that the part's shaft
//! meets. A part that is wider than a box is halved before it goes there; a packet that is still wider is taken
//! apart, and its rays go on one by one. So rays that stay together share every step, and those that do not cost
//! what they cost alone.

use super::alone::GoAlone;
use super::bundle::{Bundle, Chosen, PACKETS};
use super::cluster::{TestFew, TestPacket, TestPart, Tests};
use super::columns::Columns;
use super::frustum::{Met, Shaft};
use super::kept::Kept;
use super::nearest::Toward;
use super::order::Order;
use super::planes::Ground;
use super::rays::PacketRays;
use super::source::Source;
use crate::geometry::Triangles;
use crate::geometry::lanes::{Lanes, Sixteen, apart};
use crate::occlusion::{Child, Clusters, Node, Tally};

/// What is still to be visited: a node, by a part of the bundle.
#[derive(Clone, Copy)]
struct Step {
    part: u8,
    /// Of a packet, the queries whose rays meet the node's box: a bit each.
    met: u16,
    node: u32,
}

/// Fewer rays of a packet than this go on one by one.
const COMPANY: u32 = 8;

/// What one worker needs for a bundle.
pub(super) struct Walker {
    pub bundle: Bundle,
    shafts: [Shaft; 2 * PACKETS],
    rays: [PacketRays; PACKETS],
    /// Parts whose shaft is known: a bit each.
    known: u64,
    /// Packets whose rays are.
    rays_known: u32,
    kept: Kept,
    /// Which nodes the bundle visits first.
    toward: Toward,
    steps: Vec<Step>,
    /// The same for a ray that goes on alone.
    rest: Vec<u32>,
    /// Lent to whoever hands out bundles.
    pub columns: Columns,
    pub order: Order,
}

/// What stays the same for a bundle.
pub(super) struct Around<'a> {
    pub clusters: &'a Clusters,
    pub triangles: &'a Triangles,
    pub queries: Chosen<'a>,
    /// Whether a bundle that does not stay together is passed on.
    pub leaves_spread: bool,
}

impl Walker {
    pub fn new() -> Self {
        Self {
            bundle: Bundle::empty(),
            shafts: [Shaft::EMPTY; 2 * PACKETS],
            rays: [PacketRays::EMPTY; PACKETS],
            known: 0,
            rays_known: 0,
            kept: Kept::none(),
            toward: Toward::NOWHERE,
            steps: Vec::new(),
            rest: Vec::new(),
            columns: Columns::default(),
            order: Order::default(),
        }
    }

    /// From now on, bundles may be to another light.
    pub fn begin(&mut self) {
        self.bundle.forget();
    }

    /// Settles all queries to this light: those that stay open are lit, or with `ALL`, all that they meet is noted. `false` if none
    /// is settled. `ALL` is no field, lest every test of what is opaque looks at it.
    #[inline(always)]
    pub fn walk<L: Lanes, const ALL: bool>(
        &mut self,
        source: &Source,
        around: &Around,
        tally: &mut Tally,
    ) -> bool {
        let Around { triangles, queries, .. } = around;
        // As the bundle before fared, which is a neighbour mostly, this one will.
        let is_dark = self.bundle.is_dark();
        let Some(ground) = &self.bundle.fill::<L>(source, queries, triangles) else { return false };
        self.toward = if is_dark {
            Toward::light(source, ground.centre + self.bundle.boxes[1].middle())
        } else {
            Toward::NOWHERE
        };
        if around.leaves_spread && self.bundle.is_spread(around.clusters.typical_extent()) {
            return false;
        }
        self.kept.stand_on(ground);
        self.known = 0;
        self.rays_known = 0;
        self.steps.clear();
        if around.clusters.nodes().is_empty() {
            return true;
        }
        if around.queries.count() < COMPANY as usize {
            let asked = self.bundle.open[0];
            self.go_alone::<L, ALL>(0, asked, 0, ground, around, tally);
            return true;
        }
        self.steps.push(Step { part: 1, met: u16::MAX, node: 0 });
        while let Some(step) = self.steps.pop() {
            let index = usize::from(step.part);
            if !self.bundle.is_open(index) {
                continue;
            }
            tally.cells += 1;
            let node = &around.clusters.nodes()[step.node as usize];
            self.know(index, ground);
            let found = self.shafts[index].meets::<L>(node);
            if index < PACKETS {
                self.send_part::<L, ALL>(step, &found, node, ground, around, tally);
            } else {
                self.send_packet::<L, ALL>(step, &found, node, ground, around, tally);
            }
        }
        true
    }

    /// Makes sure that the shaft of a part is known.
    #[inline(always)]
    fn know(&mut self, part: usize, ground: &Ground) {
        if self.known & (1 << part) != 0 {
            return;
        }
        self.known |= 1 << part;
        self.bundle.know_base(part, ground.centre);
        let Bundle { bases, largest, .. } = &self.bundle;
        self.shafts[part].set(&ground.source, ground.centre, &bases[part], *largest);
    }

    /// The rays of a packet.
    #[inline(always)]
    fn rays_of<S: Sixteen>(&mut self, packet: usize, ground: &Ground) -> &PacketRays {
        if self.rays_known & (1 << packet) == 0 {
            self.rays_known |= 1 << packet;
            let Bundle { origins, largest, .. } = &self.bundle;
            self.rays[packet].set::<S>(ground, &origins[packet], *largest);
        }
        &self.rays[packet]
    }

    /// Tests at a cluster.
    #[inline(always)]
    fn tests<'a, 'b>(
        &'a mut self,
        ground: &'a Ground,
        around: &'a Around<'b>,
        tally: &'a mut Tally,
    ) -> Tests<'a, 'b> {
        Tests { bundle: &mut self.bundle, kept: &mut self.kept, ground, around, tally }
    }

    /// Sends a part to the boxes of a node that its shaft meets, or its halves back to the node, if the part
    /// is wider than most of them.
    #[inline(always)]
    fn send_part<L: Lanes, const ALL: bool>(
        &mut self,
        step: Step,
        found: &Met,
        node: &Node,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        if 2 * found.narrower.count_ones() > found.met.count_ones() {
            self.steps.push(Step { part: step.part * 2 + 1, ..step });
            self.steps.push(Step { part: step.part * 2, ..step });
            return;
        }
        let mut clusters = found.met & node.clusters();
        self.toward.nearest_last(node, found.met & !clusters, |slot| {
            self.steps.push(Step { node: node.number(slot), ..step });
        });
        while clusters != 0 {
            let slot = clusters.trailing_zeros() as usize;
            clusters &= clusters - 1;
            let (part, cluster) = (step.part.into(), node.number(slot));
            let tests = self.tests(ground, around, tally);
            apart::<L, _>(TestPart::<ALL> { tests, part, cluster });
        }
    }

    /// Sends the rays of a packet to the boxes of a node that they meet; alone where they are few.
    #[inline(always)]
    fn send_packet<L: Lanes, const ALL: bool>(
        &mut self,
        step: Step,
        found: &Met,
        node: &Node,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        let packet = usize::from(step.part) - PACKETS;
        let mut boxes = found.met;
        while boxes != 0 {
            let slot = boxes.trailing_zeros() as usize;
            boxes &= boxes - 1;
            let open = step.met & self.bundle.open[packet];
            let child = node.child(slot);
            // A shaft that is no wider than the box meets it with most of its rays.
            let rays = if found.narrower & (1 << slot) != 0 {
                open & self.rays_of::<L::Sixteen>(packet, ground).meet::<L::Sixteen>(node, slot)
            } else {
                open
            };
            match (child, rays.count_ones()) {
                (_, 0) => {}
                (Child::Cluster(cluster), COMPANY..) => {
                    let tests = self.tests(ground, around, tally);
                    apart::<L, _>(TestPacket::<ALL> { tests, packet, rays, cluster });
                }
                (Child::Cluster(cluster), _) => {
                    let tests = self.tests(ground, around, tally);
                    apart::<L, _>(TestFew::<ALL> { tests, packet, rays, cluster });
                }
                (Child::Node(node), COMPANY..) => {
                    self.steps.push(Step { met: rays, node, ..step });
                }
                (Child::Node(node), _) => {
                    self.go_alone::<L, ALL>(packet, rays, node, ground, around, tally)
                }
            }
        }
    }

    /// Has rays of a packet visit a node one by one.
    #[inline(always)]
    fn go_alone<L: Lanes, const ALL: bool>(
        &mut self,
        packet: usize,
        rays: u16,
        node: u32,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        self.rays_of::<L::Sixteen>(packet, ground);
        let Self { bundle, rest, rays: all_rays, .. } = self;
        let packet_rays = &all_rays[packet];
        apart::<L, _>(GoAlone::<ALL> {
            packet,
            rays,
            packet_rays,
            node,
            bundle,
            rest,
            around,
            tally,
        });
    }
}
