//! A bundle and a tree of clusters, walked together.
//!
//! Each step takes a part of the bundle and a node, and goes on to the node's boxes that the part's shaft
//! meets. A part that is wider than a box is halved before it goes there; a packet that is still wider is taken
//! apart, and its rays go on one by one. So rays that stay together share every step, and those that do not cost
//! what they cost alone.

use glam::Vec3;

use super::bundle::{Bundle, Chosen, PACKET, PACKETS, Source, packets_of};
use super::cast::{Cast, Judged, Shadow};
use super::columns::Columns;
use super::frustum::{Met, Shaft};
use super::order::Order;
use super::planes::{Ground, Planes};
use super::rays::PacketRays;
use crate::exact::{Exact, certified};
use crate::geometry::intersect::RayLanes;
use crate::geometry::lanes::{Lanes, Sixteen};
use crate::geometry::{TriangleId, Triangles};
use crate::occlusion::{Child, Cluster, Clusters, Node, Tally, WIDTH};

/// What is still to be visited: a part of the bundle, and a child.
#[derive(Clone, Copy)]
struct Step {
    part: u8,
    /// Of a packet, the queries whose rays meet the child's box: a bit each.
    met: u16,
    child: Child,
}

/// Clusters whose planes are kept: parts of a bundle come to the same ones, and so do bundles in a row. 130 KiB.
const KEPT: usize = 256;

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
    /// Planes of clusters that were tested of late, and which clusters.
    planes: [Planes; KEPT],
    planes_of: [u32; KEPT],
    /// The ground that they are for.
    planes_for: Option<Ground>,
    steps: Vec<Step>,
    /// The same for a ray that goes on alone.
    rest: Vec<Child>,
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

/// Of fewer packets, boxes are not looked at before a triangle is cast.
const WORTH_JUDGING: usize = 4;

const NOBODY: u32 = u32::MAX;

impl Walker {
    pub fn new() -> Self {
        Self {
            bundle: Bundle::empty(),
            shafts: [Shaft::EMPTY; 2 * PACKETS],
            rays: [PacketRays::EMPTY; PACKETS],
            known: 0,
            rays_known: 0,
            planes: [const { Planes::EMPTY }; KEPT],
            planes_of: [NOBODY; KEPT],
            planes_for: None,
            steps: Vec::new(),
            rest: Vec::new(),
            columns: Columns::default(),
            order: Order::default(),
        }
    }

    /// From now on, bundles may be to another light.
    pub fn begin(&mut self) {
        self.bundle.ground = None;
    }

    /// Settles all queries to this light: those that stay open are lit. `false` if none is settled.
    #[inline(always)]
    pub fn walk<L: Lanes>(&mut self, source: &Source, around: &Around, tally: &mut Tally) -> bool {
        let Some(ground) = &self.bundle.fill::<L>(source, &around.queries) else { return false };
        if around.leaves_spread && self.bundle.is_spread(around.clusters.typical_extent()) {
            return false;
        }
        if self.planes_for != Some(*ground) {
            self.planes_for = Some(*ground);
            self.planes_of = [NOBODY; KEPT];
        }
        self.known = 0;
        self.rays_known = 0;
        self.steps.clear();
        if around.clusters.nodes().is_empty() {
            return true;
        }
        if around.queries.count() < COMPANY as usize {
            let asked = self.bundle.open[0];
            self.go_alone::<L>(0, asked, Child::Node(0), around, tally);
            return true;
        }
        self.steps.push(Step { part: 1, met: u16::MAX, child: Child::Node(0) });
        while let Some(step) = self.steps.pop() {
            let index = usize::from(step.part);
            if !self.bundle.is_open(index) {
                continue;
            }
            match step.child {
                Child::Node(number) => {
                    tally.cells += 1;
                    let node = &around.clusters.nodes()[number as usize];
                    self.know(index, ground);
                    let found = self.shafts[index].meets::<L>(node);
                    if index < PACKETS {
                        self.share(step, &found, node);
                    } else {
                        self.part::<L>(step, &found, node, ground, around, tally);
                    }
                }
                Child::Cluster(cluster) => {
                    self.test::<L>(step, cluster, ground, around, tally);
                }
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
        self.shafts[part] = Shaft::new(&ground.source, ground.centre, &bases[part], *largest);
    }

    /// The rays of a packet.
    #[inline(always)]
    fn rays_of(&mut self, packet: usize, around: &Around) -> &PacketRays {
        if self.rays_known & (1 << packet) == 0 {
            self.rays_known |= 1 << packet;
            self.rays[packet].set(&around.queries, packet * PACKET, self.bundle.largest);
        }
        &self.rays[packet]
    }

    /// Sends a part to the boxes of a node that its shaft meets, or its halves back to the node, if the part
    /// is wider than most of them.
    #[inline(always)]
    fn share(&mut self, step: Step, found: &Met, node: &Node) {
        if 2 * found.narrower.count_ones() > found.met.count_ones() {
            self.steps.push(Step { part: step.part * 2 + 1, ..step });
            self.steps.push(Step { part: step.part * 2, ..step });
            return;
        }
        let mut boxes = found.met;
        while boxes != 0 {
            let slot = boxes.trailing_zeros() as usize;
            boxes &= boxes - 1;
            self.steps.push(Step { child: node.child(slot), ..step });
        }
    }

    /// Sends the rays of a packet to the boxes of a node that they meet; alone where they are few.
    #[inline(always)]
    fn part<L: Lanes>(
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
                open & self.rays_of(packet, around).meet::<L::Sixteen>(node, slot)
            } else {
                open
            };
            if rays.count_ones() >= COMPANY {
                self.steps.push(Step { met: rays, child, ..step });
            } else if rays != 0 {
                match child {
                    Child::Cluster(number) => {
                        self.test_few::<L>(packet, rays, number, ground, around, tally);
                    }
                    Child::Node(_) => self.go_alone::<L>(packet, rays, child, around, tally),
                }
            }
        }
    }

    /// Has rays of a packet visit a child one by one.
    #[inline(always)]
    fn go_alone<L: Lanes>(
        &mut self,
        packet: usize,
        mut rays: u16,
        child: Child,
        around: &Around,
        tally: &mut Tally,
    ) {
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let ray = around.queries.ray(packet * PACKET + lane);
            let lanes = RayLanes::<L>::of::<Exact>(ray);
            let shaft = Shaft::of_ray(ray, self.bundle.largest);
            self.rest.clear();
            self.rest.push(child);
            while let Some(child) = self.rest.pop() {
                match child {
                    Child::Node(node) => {
                        tally.cells += 1;
                        let node = &around.clusters.nodes()[node as usize];
                        let mut met = shaft.meets::<L>(node).met;
                        while met != 0 {
                            let slot = met.trailing_zeros();
                            met &= met - 1;
                            self.rest.push(node.child(slot as usize));
                        }
                    }
                    Child::Cluster(cluster) => {
                        tally.triangle_tests += WIDTH as u64;
                        let cluster = &around.clusters.all()[cluster as usize];
                        let blocker = cluster.meets::<Exact, L>(ray, &lanes, around.triangles);
                        if blocker.is_some() {
                            self.bundle.block(packet, 1 << lane);
                            break;
                        }
                    }
                }
            }
        }
    }

    /// Tests the triangles of a cluster for few rays of a packet.
    #[inline(always)]
    fn test_few<L: Lanes>(
        &mut self,
        packet: usize,
        mut rays: u16,
        number: u32,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        tally.triangle_tests += WIDTH as u64 * u64::from(rays.count_ones());
        let cluster = &around.clusters.all()[number as usize];
        let kept = self.keep::<L>(number, cluster, ground);
        let mut blocked = 0;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let [x, y, z] = &self.bundle.origins[packet];
            let origin = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
            let (certain, mut doubtful) = self.planes[kept].cast_on_one::<L>(origin);
            let mut is_blocked = certain != 0;
            while !is_blocked && doubtful != 0 {
                let triangle = cluster.ids()[doubtful.trailing_zeros() as usize];
                doubtful &= doubtful - 1;
                is_blocked = self.settle(packet * PACKET + lane, triangle, around);
            }
            blocked |= u16::from(is_blocked) << lane;
        }
        self.bundle.block(packet, blocked);
    }

    /// Where the planes of a cluster are.
    #[inline(always)]
    fn keep<L: Lanes>(&mut self, number: u32, cluster: &Cluster, ground: &Ground) -> usize {
        let kept = number as usize % KEPT;
        if self.planes_of[kept] != number {
            self.planes_of[kept] = number;
            self.planes[kept].set::<L>(ground, cluster);
        }
        kept
    }

    /// Tests the triangles of a cluster for a part of the bundle.
    #[inline(always)]
    fn test<L: Lanes>(
        &mut self,
        step: Step,
        number: u32,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        let cluster = &around.clusters.all()[number as usize];
        let kept = self.keep::<L>(number, cluster, ground);
        let part = usize::from(step.part);
        let (base, origins) = (&self.bundle.bases[part], &self.bundle.boxes[part]);
        let mut candidates = self.planes[kept].candidates::<L>(base, origins);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            if lane > 0 && cluster.ids()[lane] == cluster.ids()[lane - 1] {
                continue;
            }
            let shadow = Shadow::<L::Sixteen>::of(&self.planes[kept], lane, cluster.ids()[lane]);
            self.cast(step, &shadow, ground, around, tally);
        }
    }

    /// Casts the shadow of one triangle on a part of the bundle.
    #[inline(always)]
    fn cast<S: Sixteen>(
        &mut self,
        step: Step,
        shadow: &Shadow<S>,
        ground: &Ground,
        around: &Around,
        tally: &mut Tally,
    ) {
        let (first, last) = packets_of(usize::from(step.part));
        // Without a side the signs of planes say nothing by themselves.
        if shadow.unsided || last - first < WORTH_JUDGING {
            for packet in first..last {
                self.cast_on(packet, step.met, shadow, around, tally);
            }
            return;
        }
        let Judged { touched, covered } = shadow.judge(self.bundle.beside(ground.centre));
        let mut touched = touched >> first & (u16::MAX >> (PACKETS - (last - first)));
        while touched != 0 {
            let packet = first + touched.trailing_zeros() as usize;
            touched &= touched - 1;
            if covered & (1 << packet) != 0 {
                self.bundle.block(packet, u16::MAX);
            } else {
                self.cast_on(packet, step.met, shadow, around, tally);
            }
        }
    }

    /// Casts it on a packet.
    #[inline(always)]
    fn cast_on<S: Sixteen>(
        &mut self,
        packet: usize,
        met: u16,
        shadow: &Shadow<S>,
        around: &Around,
        tally: &mut Tally,
    ) {
        let open = self.bundle.open[packet] & met;
        if open == 0 {
            return;
        }
        tally.triangle_tests += u64::from(open.count_ones());
        let Cast { mut blocked, mut doubtful } = shadow.cast(&self.bundle.origins[packet], open);
        while doubtful != 0 {
            let query = doubtful.trailing_zeros();
            doubtful &= doubtful - 1;
            if self.settle(packet * PACKET + query as usize, shadow.triangle, around) {
                blocked |= 1 << query;
            }
        }
        self.bundle.block(packet, blocked);
    }

    /// Decides one triangle for one query.
    #[cold]
    fn settle(&self, query: usize, id: TriangleId, around: &Around) -> bool {
        certified::blocks(around.queries.ray(query), &around.triangles.get(id))
    }
}
