//! Up to 256 queries to one light, side by side, and boxes around them and their parts.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;
use crate::scene::Light;
use crate::shadow::ShadowQuery;

/// A bundle whose packets are on average larger than this part of it is not kept together by halving it.
const SPREAD_WHOLE: f32 = 0.4;

/// And one whose packets are so many times larger than clusters: shafts that wide are full of them.
const SPREAD_CLUSTERS: f32 = 16.0;

/// Largest coordinates of bundles that are answered here: products of four of them stay within f32.
const MAGNITUDES: std::ops::Range<f32> = 1e-6..1e9;

/// Queries of a packet.
pub(super) const PACKET: usize = 16;

/// Packets of a bundle.
pub(super) const PACKETS: usize = 16;

/// Queries of a bundle.
pub(super) const BUNDLE: usize = PACKET * PACKETS;

/// Where a light is, in the bits that shadow rays have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    Point(Vec3),
    Direction(Vec3),
}

impl Source {
    pub fn new(light: &Light) -> Self {
        match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                Self::Point(position.as_vec3())
            }
            Light::Directional { direction, .. } => Self::Direction(direction.as_vec3()),
        }
    }

    /// Whether this is a ray to the light, bit for bit.
    #[inline(always)]
    fn sends(&self, ray: &Ray) -> bool {
        match *self {
            Self::Point(light) => {
                light - ray.origin == ray.direction && ray.end == 1.0 && ray.direction.is_finite()
            }
            Self::Direction(direction) => {
                ray.direction == direction && ray.end == f32::INFINITY && ray.origin.is_finite()
            }
        }
    }
}

/// A box of origins, relative to the bundle's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct OriginBox {
    pub low: Vec3,
    pub high: Vec3,
}

impl OriginBox {
    const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };
}

/// Queries side by side. Boxes are a heap: 1 is around all, the parts of `i` are `2 i` and `2 i + 1`, and
/// `PACKETS + p` is that of packet `p`.
pub(super) struct Bundle {
    /// Origins relative to the centre, by axis; places not used repeat the first.
    pub origins: [[f32; BUNDLE]; 3],
    pub centre: Vec3,
    pub boxes: [OriginBox; 2 * PACKETS],
    /// A bit a query that is a ray to the light.
    pub asked: [u16; PACKETS],
    /// A bit a query of these that nothing blocks so far.
    pub open: [u16; PACKETS],
    /// Largest coordinate of origins and light, in magnitude.
    pub largest: f32,
}

impl Bundle {
    pub const fn empty() -> Self {
        Self {
            origins: [[0.0; BUNDLE]; 3],
            centre: Vec3::ZERO,
            boxes: [OriginBox::EMPTY; 2 * PACKETS],
            asked: [0; PACKETS],
            open: [0; PACKETS],
            largest: 0.0,
        }
    }

    /// Takes over queries; those that are not rays to this light are not asked. `false` if none is, or if
    /// coordinates are so large or small that products of them could over- or underflow.
    #[inline(always)]
    pub fn fill(&mut self, source: &Source, queries: &[ShadowQuery]) -> bool {
        self.open = [0; PACKETS];
        let Some(first) = queries.iter().position(|query| source.sends(&query.ray)) else {
            return false;
        };
        let packets = queries.len().div_ceil(PACKET);
        let mut origin = queries[first].ray.origin;
        for place in 0..packets * PACKET {
            if place < queries.len() && source.sends(&queries[place].ray) {
                origin = queries[place].ray.origin;
                self.open[place / PACKET] |= 1 << (place % PACKET);
            }
            for axis in 0..3 {
                self.origins[axis][place] = origin[axis];
            }
        }
        self.boxes = [OriginBox::EMPTY; 2 * PACKETS];
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for packet in 0..packets {
            let mut around = OriginBox::EMPTY;
            for axis in 0..3 {
                let values = &self.origins[axis][packet * PACKET..(packet + 1) * PACKET];
                (around.low[axis], around.high[axis]) = range(values);
            }
            low = low.min(around.low);
            high = high.max(around.high);
            self.boxes[PACKETS + packet] = around;
        }
        self.centre = 0.5 * low + 0.5 * high;
        let light = match *source {
            Source::Point(light) => light,
            Source::Direction(_) => Vec3::ZERO,
        };
        self.largest = low.abs().max(high.abs()).max(light.abs()).max_element();
        if !MAGNITUDES.contains(&self.largest) {
            return false;
        }
        for axis in 0..3 {
            for value in &mut self.origins[axis][..packets * PACKET] {
                *value -= self.centre[axis];
            }
        }
        for packet in 0..packets {
            let around = &mut self.boxes[PACKETS + packet];
            around.low -= self.centre;
            around.high -= self.centre;
        }
        self.asked = self.open;
        for parent in (1..PACKETS).rev() {
            let [a, b] = [self.boxes[2 * parent], self.boxes[2 * parent + 1]];
            self.boxes[parent] = OriginBox { low: a.low.min(b.low), high: a.high.max(b.high) };
        }
        true
    }

    /// Whether the origins do not stay together: packets are hardly smaller than the bundle, and far larger
    /// than clusters are.
    #[inline(always)]
    pub fn is_spread(&self, cluster: f32) -> bool {
        let (mut sum, mut count) = (0.0, 0.0);
        for (around, &asked) in self.boxes[PACKETS..].iter().zip(&self.asked) {
            if asked != 0 {
                sum += (around.high - around.low).max_element();
                count += 1.0;
            }
        }
        let whole = (self.boxes[1].high - self.boxes[1].low).max_element();
        let packet = sum / count;
        packet > SPREAD_WHOLE * whole && packet > SPREAD_CLUSTERS * cluster
    }

    /// Whether anything in a part is open.
    #[inline(always)]
    pub fn is_open(&self, part: usize) -> bool {
        let (first, last) = packets_of(part);
        self.open[first..last].iter().any(|&open| open != 0)
    }

    /// The centre, exactly.
    pub fn centre(&self) -> DVec3 {
        self.centre.as_dvec3()
    }
}

/// The least and the greatest of a packet's values. Halved again and again, so that it is done in vectors.
#[inline(always)]
fn range(values: &[f32]) -> (f32, f32) {
    let mut low = [0.0; PACKET];
    let mut high = [0.0; PACKET];
    low.copy_from_slice(values);
    high.copy_from_slice(values);
    let mut half = PACKET / 2;
    while half > 0 {
        for lane in 0..half {
            let (a, b) = (low[lane], low[lane + half]);
            low[lane] = if a < b { a } else { b };
            let (a, b) = (high[lane], high[lane + half]);
            high[lane] = if a > b { a } else { b };
        }
        half /= 2;
    }
    (low[0], high[0])
}

/// The packets of a part of the heap.
#[inline(always)]
pub(super) fn packets_of(part: usize) -> (usize, usize) {
    let level = part.ilog2();
    let span = PACKETS >> level;
    let first = (part - (1 << level)) * span;
    (first, first + span)
}
