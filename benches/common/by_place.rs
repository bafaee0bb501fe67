//! An engine that is asked rays in the order of where they start: along a Morton curve of 32 cells a side over what one light
//! is asked within a tile, by two passes of a radix sort. `shaft` sorted so too before it sorted rows of origins, in one pass
//! (`src/shadow/shaft/order.rs`), which an engine that takes rays could not use as they are.

use glam::Vec3;
use umbra::geometry::Ray;
use umbra::occlusion::{Occlusion, Tally};

use super::runs::Run;

/// Bits of a cell's place by axis.
const BITS: u32 = 5;

/// Values of half a key, by which is sorted at once.
const DIGITS: usize = 1 << (3 * BITS).div_ceil(2);

/// Rays that are looked at together, to find whether neighbours stay together.
const PACKET: usize = 16;

/// Packets that are on average larger than this part of their run do not.
const APART: f32 = 0.25;

/// Which rays are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sorted {
    /// All of them.
    All,
    /// Those of runs whose neighbours are apart.
    Apart,
}

/// Sorts rays, asks them, and puts the answers where they belong; what it allocates is kept.
#[derive(Default)]
pub struct ByPlace {
    keyed: Vec<u64>,
    halfway: Vec<u64>,
    rays: Vec<Ray>,
    found: Vec<bool>,
    answers: Vec<bool>,
}

impl ByPlace {
    /// How many queries an engine calls blocked.
    pub fn blocked(&mut self, engine: &dyn Occlusion, sorted: Sorted, runs: &[Run]) -> usize {
        let mut blocked = 0;
        for Run { rays, .. } in runs {
            self.answers.clear();
            self.answers.resize(rays.len(), false);
            if sorted == Sorted::All || are_apart(rays) {
                self.answer(engine, rays);
            } else {
                engine.occluded_many(rays, &mut self.answers, &mut Tally::default());
            }
            blocked += self.answers.iter().filter(|blocked| **blocked).count();
        }
        blocked
    }

    fn answer(&mut self, engine: &dyn Occlusion, rays: &[Ray]) {
        self.sort(rays);
        self.rays.clear();
        self.rays.extend(self.keyed.iter().map(|&keyed| rays[keyed as u32 as usize]));
        self.found.clear();
        self.found.resize(rays.len(), false);
        engine.occluded_many(&self.rays, &mut self.found, &mut Tally::default());
        for (&keyed, &found) in self.keyed.iter().zip(&self.found) {
            self.answers[keyed as u32 as usize] = found;
        }
    }

    /// Leaves the places of the rays in the lower halves of `keyed`, in their order.
    fn sort(&mut self, rays: &[Ray]) {
        let (low, high) = bounds(rays);
        let longest = (high - low).max_element();
        let cells = (1 << BITS) as f32;
        let scale = if longest > 0.0 { cells / longest } else { 0.0 };
        let mut counts = [[0u32; DIGITS]; 2];
        self.keyed.clear();
        self.keyed.extend((0u64..).zip(rays).map(|(place, ray)| {
            let along = ((ray.origin - low) * scale).min(Vec3::splat(cells - 1.0));
            let [x, y, z] = along.to_array().map(|value| spread(value as u32));
            let key = x | y << 1 | z << 2;
            counts[0][key as usize % DIGITS] += 1;
            counts[1][key as usize / DIGITS] += 1;
            u64::from(key) << 32 | place
        }));
        self.halfway.resize(rays.len(), 0);
        for (digit, counts) in counts.iter_mut().enumerate() {
            let mut sum = 0;
            for count in counts.iter_mut() {
                sum += std::mem::replace(count, sum);
            }
            for &keyed in &self.keyed {
                let key = (keyed >> 32) as usize;
                let next = &mut counts[if digit == 0 { key % DIGITS } else { key / DIGITS }];
                self.halfway[*next as usize] = keyed;
                *next += 1;
            }
            std::mem::swap(&mut self.keyed, &mut self.halfway);
        }
    }
}

fn bounds(rays: &[Ray]) -> (Vec3, Vec3) {
    rays.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), ray| {
        (low.min(ray.origin), high.max(ray.origin))
    })
}

fn are_apart(rays: &[Ray]) -> bool {
    let extent = |rays: &[Ray]| {
        let (low, high) = bounds(rays);
        (high - low).max_element()
    };
    let packets = rays.chunks(PACKET);
    let count = packets.len() as f32;
    packets.map(extent).sum::<f32>() > APART * count * extent(rays)
}

/// Bit `i` to bit `3 i`, of five bits.
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 8) & 0x0000_100f;
    let bits = (bits | bits << 4) & 0x0000_10c3;
    (bits | bits << 2) & 0x0000_1249
}
