//! Pictures of the shadows as they are, and of where contenders see others.

use std::collections::BTreeMap;

use glam::Vec3;

use super::EnginePoint;
use crate::exact::Verdict;
use crate::measure::recording::Recording;
use crate::render::{Film, UNASKED, from_srgb, palette};

/// Pixels from a wrong one to the frame around it; up to so many wrong ones get a frame.
const FRAME: u32 = 5;
const MOST_FRAMES: usize = 100;

/// Exact shadows fill this part of the scale, so that colours stand out.
const DARKEST: f32 = 0.01;
const BRIGHTEST: f32 = 0.25;

/// The exact shadows, and what differs from them.
#[derive(Clone, Debug)]
pub(super) struct Masks {
    /// White where all lights that are asked about reach a pixel, black where none does, blue where none
    /// is asked about.
    pub exact: Film,
    /// Contenders that differ on the same queries, and the picture of them; the most common set first.
    pub differences: Vec<(Vec<String>, Film)>,
}

impl Masks {
    pub fn new(recording: &Recording, points: &[EnginePoint], truth: &[Verdict]) -> Self {
        let lit = lit_shares(recording);
        let mut sets: BTreeMap<&[u32], Vec<String>> = BTreeMap::new();
        for point in points.iter().filter(|point| !point.differing.is_empty()) {
            sets.entry(&point.differing).or_default().push(point.name.clone());
        }
        let mut differences: Vec<_> = sets
            .into_iter()
            .map(|(differing, names)| (names, difference(recording, &lit, differing, truth)))
            .collect();
        differences.sort_by_key(|(names, _)| std::cmp::Reverse(names.len()));
        Self { exact: mask(recording, &lit, 0.0, 1.0), differences }
    }
}

/// Of each pixel, the share of its queries that are not blocked; none if it has none.
fn lit_shares(recording: &Recording) -> Vec<Option<f32>> {
    let mut counts = vec![(0u32, 0u32); recording.width as usize * recording.height as usize];
    for recorded in recording.queries() {
        let (asked, lit) = &mut counts[place(recording, recorded.pixel)];
        *asked += 1;
        *lit += u32::from(!recorded.blocked);
    }
    counts.iter().map(|&(asked, lit)| (asked > 0).then(|| lit as f32 / asked as f32)).collect()
}

fn place(recording: &Recording, (x, y): (u32, u32)) -> usize {
    y as usize * recording.width as usize + x as usize
}

fn mask(recording: &Recording, lit: &[Option<f32>], darkest: f32, brightest: f32) -> Film {
    let mut film = Film::new(recording.width, recording.height);
    for (place, share) in (0..).zip(lit) {
        let colour = match share {
            None => UNASKED * brightest,
            Some(share) => Vec3::splat(darkest + (brightest - darkest) * share),
        };
        film.set((place % recording.width, place / recording.width), colour);
    }
    film
}

/// The exact shadows, faint, and upon them what differs.
fn difference(
    recording: &Recording,
    lit: &[Option<f32>],
    differing: &[u32],
    truth: &[Verdict],
) -> Film {
    let mut film = mask(recording, lit, DARKEST, BRIGHTEST);
    let mut paint = |x: u32, y: u32, colour: Vec3| {
        if x < recording.width && y < recording.height {
            film.set((x, y), colour);
        }
    };
    for number in differing {
        let (x, y) = recording.queries()[*number as usize].pixel;
        let colour = colour_of(truth[*number as usize]);
        paint(x, y, colour);
        if differing.len() > MOST_FRAMES {
            continue;
        }
        // Beyond the left and upper edge, subtraction wraps to places outside of the picture.
        let (left, top) = (x.wrapping_sub(FRAME), y.wrapping_sub(FRAME));
        for step in 0..=2 * FRAME {
            let (across, down) = (left.wrapping_add(step), top.wrapping_add(step));
            paint(across, top, colour);
            paint(across, y + FRAME, colour);
            paint(left, down, colour);
            paint(x + FRAME, down, colour);
        }
    }
    film
}

/// What each verdict's false answer looks like: light that leaks in, shadow that is none, a tie.
fn colour_of(truth: Verdict) -> Vec3 {
    from_srgb(match truth {
        Verdict::Blocked => palette::SKY_BLUE,
        Verdict::Clear => palette::VERMILLION,
        Verdict::Tie => palette::YELLOW,
    })
}
