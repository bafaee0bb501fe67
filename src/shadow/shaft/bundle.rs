//! Up to 256 queries to one light, side by side, and boxes around them and their parts.

use glam::Vec3;

use super::cast::Boxes;
use super::columns::{Columns, Row, around};
use super::planes::Ground;
use super::source::Source;
use super::view::{Perspective, View};
use crate::geometry::lanes::{Lanes, Sixteen};
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::shadow::{Panes, ShadowQuery};

/// A bundle whose packets are on average larger than this part of it is not kept together by halving it.
const SPREAD_WHOLE: f32 = 0.4;

/// A bundle is spread too if its packets are this many times larger than a cluster: such shafts meet too many clusters.
const SPREAD_CLUSTERS: f32 = 16.0;

/// A bundle is dark if more than this part of its queries is blocked.
const DARK: f32 = 0.25;

/// Largest coordinates of bundles that are answered here: products of four of them stay within f32.
const MAGNITUDES: std::ops::Range<f32> = 1e-6..1e9;

/// Queries of a packet.
pub(super) const PACKET: usize = 16;

/// Packets of a bundle.
pub(super) const PACKETS: usize = 16;

// Boxes of packets are looked at as queries of a packet are.
const _: () = assert!(PACKETS == PACKET);

/// Queries of a bundle.
pub(super) const BUNDLE: usize = PACKET * PACKETS;

/// Up to a bundle of queries, in an order.
#[derive(Clone, Copy)]
pub(super) struct Chosen<'a> {
    queries: &'a [ShadowQuery],
    columns: &'a Columns,
    places: Places<'a>,
}

/// Which queries.
#[derive(Clone, Copy)]
pub(super) enum Places<'a> {
    /// So many in a row, from one that begins a packet on.
    Row { first: usize, count: usize },
    /// These, in this order.
    These(&'a [u32]),
}

impl<'a> Chosen<'a> {
    pub fn new(queries: &'a [ShadowQuery], columns: &'a Columns, places: Places<'a>) -> Self {
        Self { queries, columns, places }
    }

    #[inline(always)]
    pub fn count(&self) -> usize {
        match self.places {
            Places::Row { count, .. } => count,
            Places::These(places) => places.len(),
        }
    }

    /// The ray of one of them.
    #[inline(always)]
    pub fn ray(&self, index: usize) -> &'a Ray {
        let place = match self.places {
            Places::Row { first, .. } => first + index,
            Places::These(places) => places[index] as usize,
        };
        &self.queries[place].ray
    }
}

/// A half, and sixteen roundings of it.
const HALF: f32 = 0.5 + 1.0 / (1 << 20) as f32;

/// A box of origins.
#[derive(Clone, Copy, Debug)]
pub(super) struct OriginBox {
    pub low: Vec3,
    pub high: Vec3,
}

impl OriginBox {
    pub const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    #[inline(always)]
    pub fn middle(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    /// Half of each side, and a little more for the rounding of all that it enters.
    #[inline(always)]
    pub fn half(&self) -> Vec3 {
        HALF * (self.high - self.low)
    }
}

/// Queries side by side. Boxes are a heap: 1 is around all, the parts of `i` are `2 i` and `2 i + 1`, and
/// `PACKETS + p` is that of packet `p`.
pub(super) struct Bundle {
    /// Of each packet, origins relative to the centre by axis; places not asked repeat one that is.
    pub origins: [[Row; 3]; PACKETS],
    /// Where the centre is, and what planes are made for; it may serve several bundles to one light.
    pub ground: Option<Ground>,
    /// Relative to the centre too.
    pub boxes: [OriginBox; 2 * PACKETS],
    /// Of queries that are sorted: how their light sees them.
    sorted: Option<Perspective>,
    /// How it sees the parts.
    views: [View; 2 * PACKETS],
    /// The bases of the parts' rays: of queries that are sorted, as far as they are known; of others, the boxes.
    pub bases: [OriginBox; 2 * PACKETS],
    /// Bases and boxes of the packets, side by side.
    beside: [Boxes; 2],
    is_beside_known: bool,
    /// A bit a query that is a ray to the light.
    pub asked: [u16; PACKETS],
    /// A bit a query of these that nothing blocks so far.
    pub open: [u16; PACKETS],
    /// A bit a packet that has such.
    open_packets: u16,
    /// If all that queries meet is wanted: queries, and the triangle.
    met: Vec<(u16, TriangleId)>,
    /// Largest coordinate of origins and light or, towards a direction, of all that is there, and of the centre: in magnitude.
    pub largest: f32,
}

impl Bundle {
    pub const fn empty() -> Self {
        Self {
            origins: [[Row::ZERO; 3]; PACKETS],
            ground: None,
            boxes: [OriginBox::EMPTY; 2 * PACKETS],
            sorted: None,
            views: [View::EMPTY; 2 * PACKETS],
            bases: [OriginBox::EMPTY; 2 * PACKETS],
            beside: [Boxes::NONE; 2],
            is_beside_known: false,
            asked: [0; PACKETS],
            open: [0; PACKETS],
            open_packets: 0,
            met: Vec::new(),
            largest: 0.0,
        }
    }

    /// Nothing is known of a bundle before the next one, which may be to another light.
    pub fn forget(&mut self) {
        self.ground = None;
        self.asked = [0; PACKETS];
    }

    /// Whether what was asked last is dark. Not where all that is met is noted, nor what was passed on, as all of that stays open.
    #[inline(always)]
    pub fn is_dark(&self) -> bool {
        let (mut asked, mut open) = (0, 0);
        for (packet, of_packet) in self.asked.iter().enumerate() {
            asked += of_packet.count_ones();
            open += (self.open[packet] & of_packet).count_ones();
        }
        (asked - open) as f32 > DARK * asked as f32
    }

    /// Takes over queries; those that are not rays to this light are not asked. Gives the ground that they are on; `None`
    /// if none is asked, or if coordinates are so large or small that products of them could over- or underflow.
    #[inline(always)]
    pub fn fill<L: Lanes>(
        &mut self,
        source: &Source,
        queries: &Chosen<'_>,
        triangles: &Triangles,
    ) -> Option<Ground> {
        let packets = queries.count().div_ceil(PACKET);
        self.met.clear();
        self.asked = [0; PACKETS];
        self.boxes = [OriginBox::EMPTY; 2 * PACKETS];
        let columns = queries.columns;
        match queries.places {
            Places::Row { first, .. } => {
                let these = first / PACKET..first / PACKET + packets;
                self.origins[..packets].copy_from_slice(&columns.origins[these.clone()]);
                self.asked[..packets].copy_from_slice(&columns.asked[these.clone()]);
                self.boxes[PACKETS..][..packets].copy_from_slice(&columns.boxes[these]);
            }
            Places::These(places) => {
                for (packet, places) in places.chunks(PACKET).enumerate() {
                    let rows = &mut self.origins[packet];
                    for lane in 0..PACKET {
                        let place = *places.get(lane).unwrap_or(&places[0]);
                        let origin = columns.origin(place);
                        for (row, coordinate) in rows.iter_mut().zip(origin) {
                            row.0[lane] = coordinate;
                        }
                    }
                    self.asked[packet] = u16::MAX >> (PACKET - places.len());
                }
                // Not in the loop before: whole vectors of what was just written in parts would be waited for.
                for packet in 0..packets {
                    let asked = self.asked[packet];
                    self.boxes[PACKETS + packet] = around::<L>(&self.origins[packet], asked);
                }
            }
        }
        self.open = self.asked;
        self.open_packets = 0;
        for (packet, &open) in self.open.iter().enumerate() {
            self.open_packets |= u16::from(open != 0) << packet;
        }
        for parent in (1..PACKETS).rev() {
            self.boxes[parent] = self.boxes[2 * parent].union(self.boxes[2 * parent + 1]);
        }
        let OriginBox { low, high } = self.boxes[1];
        if low.x > high.x {
            return None;
        }
        let light = match *source {
            Source::Point(light) => light,
            Source::Direction(_) => Vec3::ZERO,
        };
        self.largest = low.abs().max(high.abs()).max(light.abs()).max_element();
        if !MAGNITUDES.contains(&self.largest) {
            return None;
        }
        let all = match queries.places {
            Places::Row { .. } => {
                self.sorted = None;
                self.boxes[1]
            }
            Places::These(_) => self.look::<L>(source, packets),
        };
        let known = self.ground.filter(|ground| ground.holds(&all));
        let ground = known.unwrap_or_else(|| Ground::around(source, &all, self.largest));
        self.ground = Some(ground);
        let centre = ground.centre;
        // The middle of ground that was made for a larger bundle may be farther away than all of this one; and rays that have no
        // end may come to boxes that are.
        self.largest = self.largest.max(centre.abs().max_element());
        if let Source::Direction(_) = source {
            let all = triangles.bounds().unwrap_or_default();
            self.largest = self.largest.max(all.largest_coordinate());
        }
        for rows in &mut self.origins[..packets] {
            for (row, centre) in rows.iter_mut().zip(centre.to_array()) {
                L::Sixteen::load(&row.0).sub(L::Sixteen::splat(centre)).store(&mut row.0);
            }
        }
        for around in &mut self.boxes {
            around.low -= centre;
            around.high -= centre;
        }
        self.is_beside_known = false;
        if self.sorted.is_none() {
            self.bases = self.boxes;
        }
        Some(ground)
    }

    /// Looks at queries that are sorted as their light does. Gives a box around their origins and all bases.
    #[inline(always)]
    fn look<L: Lanes>(&mut self, source: &Source, packets: usize) -> OriginBox {
        let around = self.boxes[1];
        let perspective = Perspective::new(source, &around);
        self.views = [View::EMPTY; 2 * PACKETS];
        for packet in 0..packets {
            self.views[PACKETS + packet] = perspective.view::<L::Sixteen>(&self.origins[packet]);
        }
        for parent in (1..PACKETS).rev() {
            self.views[parent] = self.views[2 * parent].union(self.views[2 * parent + 1]);
        }
        // The base of a part is in the box of all and their base.
        let base = perspective.base(&self.views[1], Vec3::ZERO);
        self.sorted = base.map(|_| perspective);
        base.map_or(around, |base| base.union(around))
    }

    /// Makes sure that the base of a part's rays is known.
    #[inline(always)]
    pub fn know_base(&mut self, part: usize, centre: Vec3) {
        if let Some(perspective) = &self.sorted {
            let base = perspective.base(&self.views[part], centre);
            self.bases[part] = base.unwrap_or(self.boxes[part]);
        }
    }

    /// Makes sure that bases and boxes of the packets are side by side.
    #[inline(always)]
    pub fn know_beside(&mut self, centre: Vec3) {
        if !self.is_beside_known {
            self.put_beside(centre);
        }
    }

    /// The bases and boxes of the packets, side by side. They are known: a call here would stand among the uses of a triangle's planes.
    #[inline(always)]
    pub fn beside(&self) -> &[Boxes; 2] {
        debug_assert!(self.is_beside_known);
        &self.beside
    }

    // Not inline: what is once a bundle should not push what is once a triangle out of registers.
    #[inline(never)]
    fn put_beside(&mut self, centre: Vec3) {
        for part in PACKETS..2 * PACKETS {
            self.know_base(part, centre);
        }
        self.beside[0].set(&self.bases[PACKETS..]);
        self.beside[1].set(&self.boxes[PACKETS..]);
        self.is_beside_known = true;
    }

    /// Whether the origins do not stay together: packets are hardly smaller than the bundle, and far larger
    /// than clusters are.
    #[inline(always)]
    pub fn is_spread(&self, cluster: f32) -> bool {
        let packet = mean_extent(&self.boxes[PACKETS..], &self.asked);
        let whole = (self.boxes[1].high - self.boxes[1].low).max_element();
        packet > SPREAD_WHOLE * whole && packet > SPREAD_CLUSTERS * cluster
    }

    /// Whether anything in a part is open.
    #[inline(always)]
    pub fn is_open(&self, part: usize) -> bool {
        self.open_packets & PACKETS_OF[part] != 0
    }

    /// Notes that queries of a packet meet a triangle: they are blocked, or if all that they meet is wanted, stay open.
    #[inline(always)]
    pub fn meet<const ALL: bool>(&mut self, packet: usize, meet: u16, triangle: TriangleId) {
        if ALL {
            self.note(packet, meet & self.open[packet], triangle);
        } else {
            self.block(packet, meet);
        }
    }

    /// Notes that queries of a packet are blocked.
    #[inline(always)]
    pub fn block(&mut self, packet: usize, blocked: u16) {
        self.open[packet] &= !blocked;
        if self.open[packet] == 0 {
            self.open_packets &= !(1 << packet);
        }
    }

    /// Keeps it in mind that queries of a packet meet a triangle.
    #[inline(never)]
    fn note(&mut self, packet: usize, mut meet: u16, triangle: TriangleId) {
        while meet != 0 {
            let query = packet as u16 * PACKET as u16 + meet.trailing_zeros() as u16;
            meet &= meet - 1;
            self.met.push((query, triangle));
        }
    }

    /// Notes all that queries meet, at their places.
    pub fn tell_all(&self, places: Places<'_>, panes: &mut Panes) {
        let place = |query: usize| match places {
            Places::Row { first, .. } => first + query,
            Places::These(places) => places[query] as usize,
        };
        for (packet, &(mut asked)) in self.asked.iter().enumerate() {
            while asked != 0 {
                panes.answer(place(packet * PACKET + asked.trailing_zeros() as usize));
                asked &= asked - 1;
            }
        }
        for &(query, triangle) in &self.met {
            panes.add(place(query.into()), triangle);
        }
    }

    /// Notes what is settled, at the places of the queries.
    pub fn tell(&self, places: Places<'_>, settled: &mut [Option<bool>]) {
        match places {
            Places::Row { first, count } => {
                let packets = settled[first..first + count].chunks_mut(PACKET);
                for (packet, settled) in packets.enumerate() {
                    let (asked, open) = (self.asked[packet], self.open[packet]);
                    for (lane, settled) in settled.iter_mut().enumerate() {
                        let blocked = Some(open & (1 << lane) == 0);
                        *settled = if asked & (1 << lane) != 0 { blocked } else { *settled };
                    }
                }
            }
            Places::These(places) => {
                for (packet, places) in places.chunks(PACKET).enumerate() {
                    let open = self.open[packet];
                    for (lane, &place) in places.iter().enumerate() {
                        settled[place as usize] = Some(open & (1 << lane) == 0);
                    }
                }
            }
        }
    }
}

/// The mean of the longest sides of the boxes of packets, of those that are asked; 0 if none is.
#[inline(always)]
pub(super) fn mean_extent(boxes: &[OriginBox], asked: &[u16]) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (around, &asked) in boxes.iter().zip(asked) {
        if asked != 0 {
            sum += (around.high - around.low).max_element();
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The packets of each part of the heap, a bit each.
pub(super) const PACKETS_OF: [u16; 2 * PACKETS] = {
    let mut bits = [0; 2 * PACKETS];
    let mut part = 1;
    while part < 2 * PACKETS {
        let (first, last) = packets_of(part);
        bits[part] = u16::MAX >> (PACKETS - (last - first)) << first;
        part += 1;
    }
    bits
};

/// The packets of a part of the heap, from one on and before another.
pub(super) const fn packets_of(part: usize) -> (usize, usize) {
    let level = part.ilog2();
    let span = PACKETS >> level;
    let first = (part - (1 << level)) * span;
    (first, first + span)
}
