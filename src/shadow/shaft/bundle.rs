//! Up to 256 queries to one light, side by side, and boxes around them and their parts.

use glam::Vec3;

use super::planes::Ground;
use crate::geometry::Ray;
use crate::geometry::lanes::{Lanes, Sixteen, splat, sub};
use crate::occlusion::WIDTH;
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

    /// Which of the rays are rays to the light, bit for bit: a bit each. Rays as [`Lanes::rays`] gives them.
    #[inline(always)]
    fn sends<L: Lanes>(&self, rays: &[L; 7]) -> u32 {
        let [ox, oy, oz, dx, dy, dz, end] = *rays;
        // What is compared with the direction, what must be finite, and the end.
        let (expected, finite, last) = match *self {
            Self::Point(light) => {
                let light = splat::<L>(light);
                (sub(light, [ox, oy, oz]), [dx, dy, dz], 1.0)
            }
            Self::Direction(direction) => (splat::<L>(direction), [ox, oy, oz], f32::INFINITY),
        };
        let mut others = L::not_equal(end, L::splat(last));
        let mut sound = L::less_equal(end, end);
        for (axis, direction) in [dx, dy, dz].into_iter().enumerate() {
            others = L::or(others, L::not_equal(direction, expected[axis]));
            sound = L::and(sound, L::less_equal(finite[axis].abs(), L::splat(f32::MAX)));
        }
        L::bits(sound) & !L::bits(others)
    }
}

/// Up to a bundle of queries, in an order.
#[derive(Clone, Copy)]
pub(super) struct Chosen<'a> {
    queries: &'a [ShadowQuery],
    /// Which of them.
    places: &'a [u32],
}

impl<'a> Chosen<'a> {
    pub fn new(queries: &'a [ShadowQuery], places: &'a [u32]) -> Self {
        Self { queries, places }
    }

    #[inline(always)]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The ray of one of them.
    #[inline(always)]
    pub fn ray(&self, index: usize) -> &'a Ray {
        &self.queries[self.places[index] as usize].ray
    }

    /// Eight rays from `first` on; the last one is repeated.
    #[inline(always)]
    fn rays(&self, first: usize) -> [&'a Ray; WIDTH] {
        let Some(eight) = self.places.get(first..first + WIDTH) else {
            let last = self.places.len() - 1;
            let mut rays = [self.ray(last); WIDTH];
            for (lane, ray) in rays.iter_mut().enumerate() {
                *ray = self.ray((first + lane).min(last));
            }
            return rays;
        };
        let mut rays = [&self.queries[eight[0] as usize].ray; WIDTH];
        for lane in 1..WIDTH {
            rays[lane] = &self.queries[eight[lane] as usize].ray;
        }
        rays
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
    pub origins: [[[f32; PACKET]; PACKETS]; 3],
    /// Where the centre is, and what planes are made for; it may serve several bundles to one light.
    pub ground: Option<Ground>,
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
            origins: [[[0.0; PACKET]; PACKETS]; 3],
            ground: None,
            boxes: [OriginBox::EMPTY; 2 * PACKETS],
            asked: [0; PACKETS],
            open: [0; PACKETS],
            largest: 0.0,
        }
    }

    /// Takes over queries; those that are not rays to this light are not asked. Gives the ground that they are on; `None`
    /// if none is asked, or if coordinates are so large or small that products of them could over- or underflow.
    #[inline(always)]
    pub fn fill<L: Lanes>(&mut self, source: &Source, queries: &Chosen<'_>) -> Option<Ground> {
        self.open = [0; PACKETS];
        let packets = queries.count().div_ceil(PACKET);
        let (mut first, mut stray) = (None, 0u16);
        for packet in 0..packets {
            let mut asked = 0;
            for start in [0, WIDTH] {
                let place = packet * PACKET + start;
                let rays = queries.rays(place);
                let mut lane = 0;
                while lane < WIDTH {
                    let eight = L::rays(&rays, lane);
                    asked |= source.sends::<L>(&eight) << (start + lane);
                    for (origins, coordinates) in self.origins.iter_mut().zip(eight) {
                        coordinates.store_to(&mut origins[packet], start + lane);
                    }
                    lane += L::COUNT;
                }
            }
            let present = queries.count() - packet * PACKET;
            if present < PACKET {
                asked &= (1 << present) - 1;
            }
            self.open[packet] = asked as u16;
            if asked != u32::from(u16::MAX) {
                stray |= 1 << packet;
            }
            if asked != 0 && first.is_none() {
                first = Some((packet, asked.trailing_zeros() as usize));
            }
        }
        let first = first?;
        let mut origin = [0.0; 3];
        for (axis, origin) in origin.iter_mut().enumerate() {
            *origin = self.origins[axis][first.0][first.1];
        }
        for packet in 0..packets {
            if stray & (1 << packet) == 0 {
                continue;
            }
            for lane in 0..PACKET {
                for (axis, origin) in origin.iter_mut().enumerate() {
                    let value = &mut self.origins[axis][packet][lane];
                    if self.open[packet] & (1 << lane) != 0 {
                        *origin = *value;
                    } else {
                        *value = *origin;
                    }
                }
            }
        }
        self.boxes = [OriginBox::EMPTY; 2 * PACKETS];
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for packet in 0..packets {
            let mut around = OriginBox::EMPTY;
            for axis in 0..3 {
                let values = L::Sixteen::load(&self.origins[axis][packet]);
                (around.low[axis], around.high[axis]) = (values.least(), values.greatest());
            }
            low = low.min(around.low);
            high = high.max(around.high);
            self.boxes[PACKETS + packet] = around;
        }
        let light = match *source {
            Source::Point(light) => light,
            Source::Direction(_) => Vec3::ZERO,
        };
        self.largest = low.abs().max(high.abs()).max(light.abs()).max_element();
        if !MAGNITUDES.contains(&self.largest) {
            return None;
        }
        let known = self.ground.filter(|ground| ground.holds(low, high));
        let ground = known.unwrap_or_else(|| Ground::around(source, low, high, self.largest));
        self.ground = Some(ground);
        for axis in 0..3 {
            for values in &mut self.origins[axis][..packets] {
                for value in values {
                    *value -= ground.centre[axis];
                }
            }
        }
        for packet in 0..packets {
            let around = &mut self.boxes[PACKETS + packet];
            around.low -= ground.centre;
            around.high -= ground.centre;
        }
        self.asked = self.open;
        for parent in (1..PACKETS).rev() {
            let [a, b] = [self.boxes[2 * parent], self.boxes[2 * parent + 1]];
            self.boxes[parent] = OriginBox { low: a.low.min(b.low), high: a.high.max(b.high) };
        }
        Some(ground)
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

    /// Notes what is settled, at the places of the queries.
    pub fn tell(&self, places: &[u32], settled: &mut [Option<bool>]) {
        for (index, &place) in places.iter().enumerate() {
            let (packet, bit) = (index / PACKET, 1 << (index % PACKET));
            if self.asked[packet] & bit != 0 {
                settled[place as usize] = Some(self.open[packet] & bit == 0);
            }
        }
    }
}

/// The packets of a part of the heap.
#[inline(always)]
pub(super) fn packets_of(part: usize) -> (usize, usize) {
    let level = part.ilog2();
    let span = PACKETS >> level;
    let first = (part - (1 << level)) * span;
    (first, first + span)
}
