//! What a bundle comes to: the triangles of a cluster, tested for a part of the bundle, for a packet, or for few of its rays.

use glam::Vec3;

use super::alone::Alone;
use super::bundle::{Bundle, PACKET, PACKETS, PACKETS_OF, packets_of};
use super::cast::{Judged, Shadow};
use super::kept::Kept;
use super::planes::{Ground, Planes};
use super::walk::Around;
use crate::exact::certified;
use crate::geometry::TriangleId;
use crate::geometry::lanes::{Lanes, LanesJob, Sixteen};
use crate::occlusion::{Cluster, Tally, WIDTH};

/// Of fewer packets, boxes are not looked at before a triangle is cast.
const WORTH_JUDGING: usize = 4;

/// What tests for a bundle need.
pub(super) struct Tests<'a, 'b> {
    pub bundle: &'a mut Bundle,
    pub kept: &'a mut Kept,
    pub ground: &'a Ground,
    pub around: &'a Around<'b>,
    pub tally: &'a mut Tally,
}

/// Tests the triangles of a cluster for a part of the bundle that has several packets.
pub(super) struct TestPart<'a, 'b, const ALL: bool> {
    pub tests: Tests<'a, 'b>,
    pub part: usize,
    pub cluster: u32,
}

impl<const ALL: bool> LanesJob for TestPart<'_, '_, ALL> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { tests: Tests { bundle, kept, ground, around, tally }, part, cluster } = self;
        if is_worth_judging(part) {
            bundle.know_beside(ground.centre);
        }
        let mut shadows = Shadows::on::<L>(bundle, part, kept, ground, around, cluster);
        while let Some(shadow) = shadows.next::<L::Sixteen>() {
            cast::<_, ALL>(bundle, part, &shadow, around, tally);
        }
    }
}

/// Tests them for some rays of a packet.
pub(super) struct TestPacket<'a, 'b, const ALL: bool> {
    pub tests: Tests<'a, 'b>,
    pub packet: usize,
    pub rays: u16,
    pub cluster: u32,
}

impl<const ALL: bool> LanesJob for TestPacket<'_, '_, ALL> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { tests, packet, rays, cluster } = self;
        let Tests { bundle, kept, ground, around, tally } = tests;
        let part = PACKETS + packet;
        let mut shadows = Shadows::on::<L>(bundle, part, kept, ground, around, cluster);
        while let Some(shadow) = shadows.next::<L::Sixteen>() {
            let mut doubtful = Doubtful::NONE;
            cast_on::<_, ALL>(bundle, packet, rays, &shadow, &mut doubtful, tally);
            doubtful.settle::<ALL>(bundle, shadow.triangle, around);
        }
    }
}

/// Tests them for few rays of a packet, one by one: by their planes if these are there; to make them for so few takes longer
/// than a test.
pub(super) struct TestFew<'a, 'b, const ALL: bool> {
    pub tests: Tests<'a, 'b>,
    pub packet: usize,
    pub rays: u16,
    pub cluster: u32,
}

impl<const ALL: bool> LanesJob for TestFew<'_, '_, ALL> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { tests: Tests { bundle, kept, around, tally, .. }, packet, mut rays, cluster } =
            self;
        tally.triangle_tests += WIDTH as u64 * u64::from(rays.count_ones());
        let known = kept.known(cluster);
        let cluster = &around.clusters.all()[cluster as usize];
        let Some(planes) = known else {
            while rays != 0 {
                let alone = Alone::<L>::new(around, packet, rays.trailing_zeros() as usize);
                rays &= rays - 1;
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

/// Whether boxes of a part's packets are looked at before a triangle is cast on them.
#[inline(always)]
fn is_worth_judging(part: usize) -> bool {
    PACKETS_OF[part].count_ones() as usize >= WORTH_JUDGING
}

/// Casts the shadow of one triangle on a part of the bundle.
#[inline(always)]
fn cast<S: Sixteen, const ALL: bool>(
    bundle: &mut Bundle,
    part: usize,
    shadow: &Shadow<S>,
    around: &Around,
    tally: &mut Tally,
) {
    let mut doubtful = Doubtful::NONE;
    // Without a side the signs of planes say nothing by themselves.
    if shadow.unsided || !is_worth_judging(part) {
        let (first, last) = packets_of(part);
        for packet in first..last {
            cast_on::<S, ALL>(bundle, packet, u16::MAX, shadow, &mut doubtful, tally);
        }
    } else {
        let Judged { touched, covered } = shadow.judge(bundle.beside());
        let mut touched = touched & PACKETS_OF[part];
        while touched != 0 {
            let packet = touched.trailing_zeros() as usize;
            touched &= touched - 1;
            if covered & (1 << packet) != 0 {
                bundle.meet::<ALL>(packet, u16::MAX, shadow.triangle);
            } else {
                cast_on::<S, ALL>(bundle, packet, u16::MAX, shadow, &mut doubtful, tally);
            }
        }
    }
    doubtful.settle::<ALL>(bundle, shadow.triangle, around);
}

/// Casts it on some queries of a packet.
#[inline(always)]
fn cast_on<S: Sixteen, const ALL: bool>(
    bundle: &mut Bundle,
    packet: usize,
    rays: u16,
    shadow: &Shadow<S>,
    doubtful: &mut Doubtful,
    tally: &mut Tally,
) {
    let open = bundle.open[packet] & rays;
    if open == 0 {
        return;
    }
    tally.triangle_tests += u64::from(open.count_ones());
    let cast = shadow.cast(&bundle.origins[packet], open);
    if cast.doubtful != 0 {
        doubtful.packets |= 1 << packet;
        doubtful.queries[packet] |= cast.doubtful;
    }
    bundle.meet::<ALL>(packet, cast.blocked, shadow.triangle);
}

/// Queries that the exact test must decide about a triangle, once it has been cast on all: a call where it is
/// cast would have its planes, sixteen vectors, written to memory and read again, for all triangles.
struct Doubtful {
    /// A bit a packet that has any.
    packets: u16,
    queries: [u16; PACKETS],
}

impl Doubtful {
    const NONE: Self = Self { packets: 0, queries: [0; PACKETS] };

    #[inline(always)]
    fn settle<const ALL: bool>(&self, bundle: &mut Bundle, triangle: TriangleId, around: &Around) {
        if self.packets != 0 {
            self.settle_some::<ALL>(bundle, triangle, around);
        }
    }

    #[cold]
    fn settle_some<const ALL: bool>(
        &self,
        bundle: &mut Bundle,
        triangle: TriangleId,
        around: &Around,
    ) {
        let mut packets = self.packets;
        while packets != 0 {
            let packet = packets.trailing_zeros() as usize;
            packets &= packets - 1;
            let mut doubtful = self.queries[packet];
            while doubtful != 0 {
                let query = doubtful.trailing_zeros();
                doubtful &= doubtful - 1;
                if settle(packet * PACKET + query as usize, triangle, around) {
                    bundle.meet::<ALL>(packet, 1 << query, triangle);
                }
            }
        }
    }
}

/// Decides one triangle for one query.
#[cold]
fn settle(query: usize, id: TriangleId, around: &Around) -> bool {
    certified::blocks(around.queries.ray(query), &around.triangles.get(id))
}
