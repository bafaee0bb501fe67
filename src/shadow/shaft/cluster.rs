//! What a bundle comes to: the triangles of a cluster, tested for a part of the bundle, for a packet, or for few of its rays.

use std::ops::ControlFlow::{self, Break, Continue};

use glam::Vec3;

use super::bundle::{Bundle, PACKET, PACKETS, PACKETS_OF, packets_of};
use super::cast::{Cast, Judged, Shadow};
use super::kept::Kept;
use super::planes::{Ground, Planes};
use super::walk::Around;
use crate::exact::{Exact, certified};
use crate::geometry::intersect::RayLanes;
use crate::geometry::lanes::{Lanes, Sixteen};
use crate::geometry::{Ray, TriangleId};
use crate::occlusion::{Cluster, Tally, WIDTH};

/// Of fewer packets, boxes are not looked at before a triangle is cast.
const WORTH_JUDGING: usize = 4;

/// Tests for a bundle.
pub(super) struct Tests<'a, 'b> {
    pub bundle: &'a mut Bundle,
    pub kept: &'a mut Kept,
    pub ground: &'a Ground,
    pub around: &'a Around<'b>,
    pub tally: &'a mut Tally,
}

impl Tests<'_, '_> {
    /// Tests the triangles of a cluster for a part of the bundle that has several packets.
    #[inline(always)]
    pub fn part<L: Lanes, const ALL: bool>(self, part: usize, number: u32) {
        let Self { bundle, kept, ground, around, tally } = self;
        let mut shadows = Shadows::on::<L>(bundle, part, kept, ground, around, number);
        while let Some(shadow) = shadows.next::<L::Sixteen>() {
            cast::<_, ALL>(bundle, part, &shadow, ground, around, tally);
        }
    }

    /// Tests them for some rays of a packet.
    #[inline(always)]
    pub fn packet<L: Lanes, const ALL: bool>(self, packet: usize, rays: u16, number: u32) {
        let Self { bundle, kept, ground, around, tally } = self;
        let part = PACKETS + packet;
        let mut shadows = Shadows::on::<L>(bundle, part, kept, ground, around, number);
        while let Some(shadow) = shadows.next::<L::Sixteen>() {
            cast_on::<_, ALL>(bundle, packet, rays, &shadow, around, tally);
        }
    }

    /// Tests them for few rays of a packet, one by one: by their planes if these are there; to make them for so few takes longer
    /// than a test.
    #[inline(always)]
    pub fn few<L: Lanes, const ALL: bool>(self, packet: usize, mut rays: u16, number: u32) {
        let Self { bundle, kept, around, tally, .. } = self;
        tally.triangle_tests += WIDTH as u64 * u64::from(rays.count_ones());
        let cluster = &around.clusters.all()[number as usize];
        let Some(planes) = kept.known(number) else {
            while rays != 0 {
                let lane = rays.trailing_zeros() as usize;
                rays &= rays - 1;
                let ray = around.queries.ray(packet * PACKET + lane);
                let lanes = RayLanes::<L>::of::<Exact>(ray);
                let alone = Alone { packet, lane, ray, lanes: &lanes };
                let _ = alone.test::<ALL>(bundle, cluster, around);
            }
            return;
        };
        let mut blocked = 0;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let [x, y, z] = &bundle.origins[packet];
            let origin = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
            let (mut certain, mut doubtful) = planes.cast_on_one::<L>(origin);
            // Any will do, unless all are wanted.
            while doubtful != 0 && (ALL || certain == 0) {
                let place = doubtful.trailing_zeros();
                doubtful &= doubtful - 1;
                let meets = settle(packet * PACKET + lane, cluster.ids()[place as usize], around);
                certain |= u32::from(meets) << place;
            }
            blocked |= u16::from(certain != 0) << lane;
            while ALL && certain != 0 {
                let triangle = cluster.ids()[certain.trailing_zeros() as usize];
                certain &= certain - 1;
                bundle.meet::<ALL>(packet, 1 << lane, triangle);
            }
        }
        if !ALL {
            bundle.block(packet, blocked);
        }
    }
}

/// A ray of a packet that is tested by itself.
pub(super) struct Alone<'a, L: Lanes> {
    pub packet: usize,
    pub lane: usize,
    pub ray: &'a Ray,
    pub lanes: &'a RayLanes<L>,
}

impl<L: Lanes> Alone<'_, L> {
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
        cluster.test_each::<Exact, L>(self.ray, self.lanes, around.triangles, hit)
    }
}

/// The shadows of those triangles of a cluster that may fall on a part of the bundle, each once.
struct Shadows<'a> {
    planes: &'a Planes,
    cluster: &'a Cluster,
    /// Those that are left: a bit each.
    candidates: u32,
}

impl<'a> Shadows<'a> {
    #[inline(always)]
    fn on<L: Lanes>(
        bundle: &Bundle,
        part: usize,
        kept: &'a mut Kept,
        ground: &Ground,
        around: &'a Around<'_>,
        number: u32,
    ) -> Self {
        let cluster = &around.clusters.all()[number as usize];
        let planes = kept.of::<L>(ground, number, cluster);
        let candidates = planes.candidates::<L>(&bundle.bases[part], &bundle.boxes[part]);
        Self { planes, cluster, candidates }
    }

    #[inline(always)]
    fn next<S: Sixteen>(&mut self) -> Option<Shadow<S>> {
        while self.candidates != 0 {
            let lane = self.candidates.trailing_zeros() as usize;
            self.candidates &= self.candidates - 1;
            if !self.cluster.repeats(lane) {
                return Some(Shadow::of(self.planes, lane, self.cluster.ids()[lane]));
            }
        }
        None
    }
}

/// Casts the shadow of one triangle on a part of the bundle.
#[inline(always)]
fn cast<S: Sixteen, const ALL: bool>(
    bundle: &mut Bundle,
    part: usize,
    shadow: &Shadow<S>,
    ground: &Ground,
    around: &Around,
    tally: &mut Tally,
) {
    let (first, last) = packets_of(part);
    // Without a side the signs of planes say nothing by themselves.
    if shadow.unsided || last - first < WORTH_JUDGING {
        for packet in first..last {
            cast_on::<S, ALL>(bundle, packet, u16::MAX, shadow, around, tally);
        }
        return;
    }
    let Judged { touched, covered } = shadow.judge(bundle.beside(ground.centre));
    let mut touched = touched & PACKETS_OF[part];
    while touched != 0 {
        let packet = touched.trailing_zeros() as usize;
        touched &= touched - 1;
        if covered & (1 << packet) != 0 {
            bundle.meet::<ALL>(packet, u16::MAX, shadow.triangle);
        } else {
            cast_on::<S, ALL>(bundle, packet, u16::MAX, shadow, around, tally);
        }
    }
}

/// Casts it on some queries of a packet.
#[inline(always)]
fn cast_on<S: Sixteen, const ALL: bool>(
    bundle: &mut Bundle,
    packet: usize,
    rays: u16,
    shadow: &Shadow<S>,
    around: &Around,
    tally: &mut Tally,
) {
    let open = bundle.open[packet] & rays;
    if open == 0 {
        return;
    }
    tally.triangle_tests += u64::from(open.count_ones());
    let Cast { mut blocked, mut doubtful } = shadow.cast(&bundle.origins[packet], open);
    while doubtful != 0 {
        let query = doubtful.trailing_zeros();
        doubtful &= doubtful - 1;
        if settle(packet * PACKET + query as usize, shadow.triangle, around) {
            blocked |= 1 << query;
        }
    }
    bundle.meet::<ALL>(packet, blocked, shadow.triangle);
}

/// Decides one triangle for one query.
#[cold]
fn settle(query: usize, id: TriangleId, around: &Around) -> bool {
    certified::blocks(around.queries.ray(query), &around.triangles.get(id))
}
