//! How the shadow queries of each pixel were answered, and what that cost: pictures of the method at
//! work.

use glam::Vec3;

use super::film::index;
use super::legend::{UNASKED, from_srgb, with_legend};
use super::order::Place;
use super::{Film, palette};
use crate::shadow::Outcome;

/// The light whose queries are shown; those of all together if none is named.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Index of the light.
    pub light: Option<u32>,
}

impl Shown {
    /// Whether the queries of a light are.
    #[must_use]
    pub fn includes(self, light: usize) -> bool {
        self.light.is_none_or(|shown| shown as usize == light)
    }
}

/// The shadow queries of one pixel, those of reflected and refracted rays included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answered {
    /// Queries by outcome, in the order of [`Outcome::ALL`].
    pub outcomes: [u32; Outcome::ALL.len()],
    /// Cells visited and triangles tested for them, attenuation included.
    pub cost: u64,
}

/// For every pixel, how its shadow queries were answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerMap {
    width: u32,
    height: u32,
    pixels: Vec<Answered>,
}

/// The colour of an outcome. What had to be traced and is lit, the most of most pictures, is dark, so
/// that the shadows stand out, and how they were found.
fn colour_of(outcome: Outcome) -> Vec3 {
    from_srgb(match outcome {
        Outcome::TraversalLit => [52, 52, 56],
        Outcome::TraversalBlocked => palette::VERMILLION,
        Outcome::Object => palette::BLUISH_GREEN,
        Outcome::Voxel => palette::SKY_BLUE,
        Outcome::VerdictLit => [240, 240, 240],
        Outcome::VerdictBlocked => palette::REDDISH_PURPLE,
    })
}

/// Black, blue, red, yellow, white.
fn heat(share: f32) -> Vec3 {
    let stops = [
        Vec3::ZERO,
        Vec3::new(0.0, 0.05, 0.5),
        Vec3::new(0.7, 0.02, 0.02),
        Vec3::new(1.0, 0.8, 0.0),
        Vec3::ONE,
    ];
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let below = (place as usize).min(stops.len() - 2);
    stops[below].lerp(stops[below + 1], place - below as f32)
}

impl AnswerMap {
    pub(super) fn new(width: u32, height: u32) -> Self {
        let pixels = vec![Answered::default(); width as usize * height as usize];
        Self { width, height, pixels }
    }

    pub(super) fn set(&mut self, place: Place, answered: Answered) {
        self.pixels[index([self.width, self.height], place)] = answered;
    }

    /// What happened at a pixel.
    ///
    /// # Panics
    /// Outside the picture.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> &Answered {
        &self.pixels[index([self.width, self.height], (x, y))]
    }

    /// Each pixel in the mixture of its outcomes' colours, and below them what each colour means.
    #[must_use]
    pub fn outcome_picture(&self) -> Film {
        let colours = Outcome::ALL.map(colour_of);
        let occurs = |outcome: usize| self.pixels.iter().any(|pixel| pixel.outcomes[outcome] > 0);
        let mut entries: Vec<(Vec3, String)> = (0..colours.len())
            .filter(|&outcome| occurs(outcome))
            .map(|outcome| (colours[outcome], Outcome::ALL[outcome].name().replace('-', " ")))
            .collect();
        entries.push((UNASKED, "not asked".to_owned()));
        self.picture(&entries, |pixel| {
            let asked: u32 = pixel.outcomes.iter().sum();
            let mixture: Vec3 =
                pixel.outcomes.iter().zip(colours).map(|(&n, colour)| n as f32 * colour).sum();
            if asked == 0 { UNASKED } else { mixture / asked as f32 }
        })
    }

    /// Each pixel by its cost, on a scale of squares, and below them what each colour means.
    #[must_use]
    pub fn cost_picture(&self) -> Film {
        let most = self.pixels.iter().map(|pixel| pixel.cost).max().unwrap_or(0).max(1);
        let entries: Vec<(Vec3, String)> = (0..=4)
            .map(|quarter| {
                let share = quarter as f32 / 4.0;
                let cost = (most as f32 * share * share).round() as u64;
                let unit = if quarter == 4 { " cells and tests" } else { "" };
                (heat(share), format!("{cost}{unit}"))
            })
            .collect();
        self.picture(&entries, |pixel| heat((pixel.cost as f32 / most as f32).sqrt()))
    }

    fn picture(&self, entries: &[(Vec3, String)], colour: impl Fn(&Answered) -> Vec3) -> Film {
        with_legend((self.width, self.height), entries, |(x, y)| colour(self.at(x, y)))
    }
}
