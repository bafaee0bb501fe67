//! A few words in a picture.

use glam::Vec3;

use super::Film;
use super::order::Place;

/// Pixels to a dot of the font.
const SCALE: u32 = 2;

/// Pixels from line to line: five dots, and one and a half above and below.
pub(super) const LINE_HEIGHT: u32 = 8 * SCALE;

/// Pixels that a text takes, the gap after it included.
pub(super) fn text_width(text: &str) -> u32 {
    (text.chars().count() as u32 + 1) * 4 * SCALE
}

/// Writes lower-case letters and digits into a line that begins at `(x, y)`; what does not fit is cut.
pub(super) fn write_text(film: &mut Film, (x, y): Place, text: &str, ink: Vec3) {
    for (number, character) in (0..).zip(text.chars()) {
        let rows = glyph(character);
        for dot in (0..15).filter(|dot| rows & (1 << (14 - dot)) != 0) {
            let (column, row) = (dot % 3 + 4 * number, dot / 3);
            for (dx, dy) in (0..SCALE).flat_map(|dy| (0..SCALE).map(move |dx| (dx, dy))) {
                let place = (x + column * SCALE + dx, y + 3 + row * SCALE + dy);
                if place.0 < film.width() && place.1 < film.height() {
                    film.set(place, ink);
                }
            }
        }
    }
}

/// Five rows of three dots, an octal digit a row from the top.
fn glyph(character: char) -> u16 {
    const LETTERS: [u16; 26] = [
        0o25755, 0o65656, 0o34443, 0o65556, 0o74647, 0o74644, 0o34553, 0o55755, 0o72227, 0o11152,
        0o55655, 0o44447, 0o57755, 0o65555, 0o25552, 0o65644, 0o25573, 0o65655, 0o34216, 0o72222,
        0o55557, 0o55552, 0o55775, 0o55255, 0o55222, 0o71247,
    ];
    const DIGITS: [u16; 10] =
        [0o75557, 0o26227, 0o71747, 0o71717, 0o55711, 0o74717, 0o74757, 0o71111, 0o75757, 0o75717];
    match character {
        'a'..='z' => LETTERS[character as usize - 'a' as usize],
        '0'..='9' => DIGITS[character as usize - '0' as usize],
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_written_where_it_belongs_and_cut_at_the_edge() {
        let mut film = Film::new(20, LINE_HEIGHT);
        write_text(&mut film, (0, 0), "l1", Vec3::ONE);
        let inked = |x: u32, y: u32| film.pixels()[(y * 20 + x) as usize] == Vec3::ONE;
        // The upright and the foot of the l, the flag of the 1.
        assert!(inked(0, 3) && inked(5, 12) && !inked(4, 3) && inked(10, 4) && inked(8, 5));
        write_text(&mut film, (18, 10), "www", Vec3::ONE);
        write_text(&mut film, (500, 500), "outside", Vec3::ONE);
    }
}
