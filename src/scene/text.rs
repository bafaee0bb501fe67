//! Text as other programs write it: lines, comments, numbers.

use std::borrow::Cow;

/// Takes away the byte order mark that some editors put before UTF-8 text: it is no part of the first
/// statement.
pub(super) fn without_mark(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    bytes
}

/// What is said of text of two bytes for a character.
pub(crate) const UTF_16: &str = "this is UTF-16; save it as UTF-8";

/// Whether bytes begin as UTF-16 does: with a mark, or with every other byte zero.
pub(crate) fn is_utf_16(bytes: &[u8]) -> bool {
    matches!(
        bytes,
        [0xff, 0xfe, ..]
            | [0xfe, 0xff, ..]
            | [1..=255, 0, 1..=255, 0, ..]
            | [0, 1..=255, 0, 1..=255, ..]
    )
}

/// The text of a file.
pub(super) fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    with_line_feeds(String::from_utf8_lossy(bytes))
}

/// The text with a line feed wherever a carriage return alone ends a line, as on old Macintoshes.
pub(crate) fn with_line_feeds(text: Cow<'_, str>) -> Cow<'_, str> {
    if text.split('\r').skip(1).all(|rest| rest.starts_with('\n')) {
        return text;
    }
    Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n"))
}

/// What stands before a `#` that follows white space: all but a comment, unless the `#` is part of a
/// name, as in `Material #25`.
pub(crate) fn before_comment(names: &str) -> &str {
    let begins =
        |&(at, _): &(usize, &str)| names[..at].chars().next_back().is_none_or(char::is_whitespace);
    let end = names.match_indices('#').find(begins).map_or(names.len(), |(at, _)| at);
    names[..end].trim_end()
}

/// The words that follow a keyword that numbers follow. A comment ends them, even without white space before it; but a
/// `#` after `1.` is part of what older C libraries of Microsoft write for what is no number.
pub(super) fn number_words(rest: &str) -> impl Iterator<Item = &str> {
    let is_in_number = |at: usize| {
        rest[..at].ends_with("1.") && rest[at + 1..].starts_with(|next: char| next.is_alphabetic())
    };
    let begins = |&(at, _): &(usize, &str)| !is_in_number(at);
    let end = rest.match_indices('#').find(begins).map_or(rest.len(), |(at, _)| at);
    rest[..end].split_whitespace()
}

/// Reads a number, and NaN and infinity as any C library writes them: `nan(ind)`, `-1.#IND`, `1.#QNAN0`, `1.#INF`.
pub(crate) fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| {
        let bare = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
        match bare.strip_prefix("1.#") {
            Some(kind) if kind.starts_with("inf") => Some(sign * f64::INFINITY),
            Some(kind) if ["ind", "qnan", "snan"].iter().any(|nan| kind.starts_with(nan)) => {
                Some(f64::NAN)
            }
            None if bare.starts_with("nan(") => Some(f64::NAN),
            _ => None,
        }
    })
}
