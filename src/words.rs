//! Words of notes and messages.

/// So many of something: `1 face`, `2 faces`.
pub(crate) fn counted(number: u64, one: &str) -> String {
    format!("{number} {}", things(number, one))
}

/// What so many things are called, of which one is called `one`.
pub(crate) fn things(number: u64, one: &str) -> String {
    match one.strip_suffix("query") {
        _ if number == 1 => one.to_owned(),
        Some(before) => format!("{before}queries"),
        None => format!("{one}s"),
    }
}
