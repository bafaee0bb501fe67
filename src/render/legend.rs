//! A picture that tells something by colours, and below it what they mean.

use glam::Vec3;

use super::Film;
use super::label::{LINE_HEIGHT, text_width, write_text};

const INK: Vec3 = Vec3::splat(0.8);

/// Of the frame round each colour, which may be as dark as what is round it.
const FRAME: Vec3 = Vec3::splat(0.2);

/// The colour of pixels about which nothing was asked.
pub const UNASKED: Vec3 = Vec3::new(0.02, 0.03, 0.1);

/// A colour of the film from its sRGB bytes.
#[must_use]
pub fn from_srgb(bytes: [u8; 3]) -> Vec3 {
    let decode = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::from(bytes.map(decode))
}

/// A picture of that size, each pixel (column and row) in its colour, and a legend below: as many lines as the width
/// asks for. The words are of lower-case letters and digits.
#[must_use]
pub fn with_legend(
    (width, height): (u32, u32),
    entries: &[(Vec3, String)],
    colour: impl Fn((u32, u32)) -> Vec3,
) -> Film {
    let (mut x, mut line) = (0, 0);
    let mut places = Vec::new();
    for (_, text) in entries {
        let needed = LINE_HEIGHT + text_width(text);
        if x > 0 && x + needed > width {
            (x, line) = (0, line + 1);
        }
        places.push((x, height + line * LINE_HEIGHT));
        x += needed;
    }
    let mut film = Film::new(width, height + (line + 1) * LINE_HEIGHT);
    for place in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        film.set(place, colour(place));
    }
    for ((colour, text), (x, y)) in entries.iter().zip(places) {
        let (left, right, top, bottom) =
            (x + 1, width.min(x + LINE_HEIGHT - 2), y + 2, y + LINE_HEIGHT - 1);
        for place in (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))) {
            let is_within = (left + 1..right - 1).contains(&place.0)
                && (top + 1..bottom - 1).contains(&place.1);
            film.set(place, if is_within { *colour } else { FRAME });
        }
        write_text(&mut film, (x + LINE_HEIGHT, y), text, INK);
    }
    film
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_as_dark_as_what_is_round_it_has_a_frame() {
        let film = with_legend((40, 1), &[(Vec3::ZERO, "0".to_owned())], |_| Vec3::ZERO);
        let at = |x: u32, y: u32| film.pixels()[(y * 40 + x) as usize];
        let (right, bottom) = (LINE_HEIGHT - 3, LINE_HEIGHT - 1);
        for corner in [at(1, 3), at(right, 3), at(1, bottom), at(right, bottom)] {
            assert_eq!(corner, FRAME);
        }
        assert_eq!(
            [at(0, 3), at(2, 4), at(right - 1, bottom - 1), at(right + 1, 3)],
            [Vec3::ZERO; 4]
        );
    }
}
