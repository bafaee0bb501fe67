//! Queries to one light, read once: origins side by side, by packets, with boxes around them.
//!
//! Everything after it reads these rows, a third of the bytes of queries, in whole vectors.

use glam::Vec3;

use super::bundle::{BUNDLE, OriginBox, PACKET, PACKETS, mean_extent};
use super::source::Source;
use crate::geometry::Ray;
use crate::geometry::lanes::{Lanes, LanesJob, Sixteen};
use crate::occlusion::WIDTH;
use crate::shadow::ShadowQuery;

/// All queries of a packet.
const ALL: u16 = u16::MAX;

/// A coordinate of each query of a packet: a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Row(pub [f32; PACKET]);

impl Row {
    pub const ZERO: Self = Self([0.0; PACKET]);
}

/// Queries in their order, sixteen a packet.
#[derive(Default)]
pub(super) struct Columns {
    /// Of each packet, the coordinates of origins by axis; places not asked repeat one that is.
    pub origins: Vec<[Row; 3]>,
    /// A bit a query that is a ray to the light.
    pub asked: Vec<u16>,
    /// Around the origins of each packet; empty if none is asked.
    pub boxes: Vec<OriginBox>,
}

impl Columns {
    /// The mean of the longest sides of boxes of these packets.
    pub fn typical_extent(&self, packets: std::ops::Range<usize>) -> f32 {
        mean_extent(&self.boxes[packets.clone()], &self.asked[packets])
    }

    /// How large packets would be if all were sorted: if origins lay all over the largest side of their box.
    pub fn extent_if_sorted(&self) -> f32 {
        let all = self.boxes.iter().copied().fold(OriginBox::EMPTY, OriginBox::union);
        let Vec3 { x, y, z } = (all.high - all.low).max(Vec3::ZERO);
        ((x * y).max(y * z).max(z * x) / self.boxes.len() as f32).sqrt()
    }

    /// An origin.
    #[inline(always)]
    pub fn origin(&self, place: u32) -> [f32; 3] {
        let place = place as usize;
        let [x, y, z] = &self.origins[place / PACKET];
        [x.0[place % PACKET], y.0[place % PACKET], z.0[place % PACKET]]
    }
}

/// Reads queries into columns.
pub(super) struct Read<'a> {
    pub columns: &'a mut Columns,
    pub source: &'a Source,
    pub queries: &'a [ShadowQuery],
}

impl LanesJob for Read<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Columns { origins, asked, boxes } = self.columns;
        let packets = self.queries.len().div_ceil(PACKET);
        origins.resize(packets, [Row::ZERO; 3]);
        asked.resize(packets, 0);
        boxes.resize(packets, OriginBox::EMPTY);
        for (bundle, queries) in self.queries.chunks(BUNDLE).enumerate() {
            let first = bundle * PACKETS;
            let packets = first..first + queries.len().div_ceil(PACKET);
            for (packet, queries) in packets.clone().zip(queries.chunks(PACKET)) {
                asked[packet] = match queries.try_into() {
                    Ok(whole) => read::<L>(whole, ALL, self.source, &mut origins[packet]),
                    Err(_) => read_some::<L>(queries, self.source, &mut origins[packet]),
                };
            }
            // Not in the loop before: whole vectors of what was just written in parts would be waited for.
            for packet in packets {
                boxes[packet] = around::<L>(&origins[packet], asked[packet]);
            }
        }
    }
}

/// Reads fewer queries than a packet has.
#[inline(always)]
fn read_some<L: Lanes>(queries: &[ShadowQuery], source: &Source, origins: &mut [Row; 3]) -> u16 {
    let mut whole = [queries[0]; PACKET];
    whole[..queries.len()].copy_from_slice(queries);
    read::<L>(&whole, (1 << queries.len()) - 1, source, origins)
}

/// Reads a packet; gives those that are present and rays to the light.
#[inline(always)]
fn read<L: Lanes>(
    queries: &[ShadowQuery; PACKET],
    present: u16,
    source: &Source,
    origins: &mut [Row; 3],
) -> u16 {
    let mut asked = 0;
    let mut first = 0;
    while first < PACKET {
        let mut rays: [&Ray; WIDTH] = [&queries[first].ray; WIDTH];
        for lane in 1..WIDTH {
            rays[lane] = &queries[first + lane].ray;
        }
        let mut lane = 0;
        while lane < WIDTH {
            let values = L::rays(&rays, lane);
            asked |= source.sends::<L>(&values) << (first + lane);
            for (row, coordinates) in origins.iter_mut().zip(values) {
                coordinates.store_to(&mut row.0, first + lane);
            }
            lane += L::COUNT;
        }
        first += WIDTH;
    }
    let asked = asked as u16 & present;
    if asked != ALL {
        repeat(origins, asked);
    }
    asked
}

/// Puts the first of those asked where others are.
#[cold]
fn repeat(origins: &mut [Row; 3], asked: u16) {
    for row in origins {
        let value = if asked == 0 { 0.0 } else { row.0[asked.trailing_zeros() as usize] };
        for (lane, other) in row.0.iter_mut().enumerate() {
            if asked & (1 << lane) == 0 {
                *other = value;
            }
        }
    }
}

/// The box around a packet.
#[inline(always)]
pub(super) fn around<L: Lanes>(origins: &[Row; 3], asked: u16) -> OriginBox {
    if asked == 0 {
        return OriginBox::EMPTY;
    }
    let (mut low, mut high) = (Vec3::ZERO, Vec3::ZERO);
    for (axis, row) in origins.iter().enumerate() {
        let values = L::Sixteen::load(&row.0);
        (low[axis], high[axis]) = (values.least(), values.greatest());
    }
    OriginBox { low, high }
}
