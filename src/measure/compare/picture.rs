//! Where contenders err: a picture.

use std::collections::HashMap;

use glam::Vec3;

use super::{Disagreement, Kind, Report};
use crate::measure::recording::Recording;
use crate::render::{Film, UNASKED, from_srgb, palette, with_legend};

/// What is told by colours; of several in one pixel, the first is shown.
const MARKS: [(&str, palette::Srgb); 3] = [
    ("unexplained", palette::YELLOW),
    ("false clear", palette::SKY_BLUE),
    ("false blocked", palette::VERMILLION),
];

/// Pixels across that the picture has at least, so that single ones are seen: each becomes a square.
const WIDTH: u32 = 640;

/// The brightest grey of the shadows below the marks.
const LIT: f32 = 0.3;

/// Place in [`MARKS`].
fn mark(found: &Disagreement) -> usize {
    match found.kind {
        _ if !found.explained => 0,
        Kind::OutOfBounds => 0,
        Kind::FalseClear => 1,
        Kind::FalseBlocked => 2,
    }
}

impl Report {
    /// The shadows of the picture in grey, on them the pixels of all disagreements, and a legend below.
    ///
    /// # Panics
    /// If the recording is not the one that was compared.
    #[must_use]
    pub fn difference_picture(&self, recording: &Recording) -> Film {
        let mut asked: HashMap<(u32, u32), [u32; 2]> = HashMap::new();
        for recorded in recording.queries() {
            let [all, lit] = asked.entry(recorded.pixel).or_default();
            *all += 1;
            *lit += u32::from(!recorded.blocked);
        }
        let mut marked: HashMap<(u32, u32), usize> = HashMap::new();
        for found in &self.disagreements {
            let first = marked.entry(found.pixel).or_insert(MARKS.len());
            *first = mark(found).min(*first);
        }
        let colours = MARKS.map(|(_, bytes)| from_srgb(bytes));
        let count = |place| self.disagreements.iter().filter(|f| mark(f) == place).count();
        let entries: Vec<(Vec3, String)> = (0..MARKS.len())
            .map(|place| (colours[place], format!("{} {}", MARKS[place].0, count(place))))
            .collect();
        let side = WIDTH.div_ceil(self.width);
        with_legend((side * self.width, side * self.height), &entries, |(x, y)| {
            let pixel = (x / side, y / side);
            match (marked.get(&pixel), asked.get(&pixel)) {
                (Some(&place), _) => colours[place],
                (None, Some([all, lit])) => Vec3::splat(LIT * *lit as f32 / *all as f32),
                (None, None) => UNASKED,
            }
        })
    }
}
