//! Words of notes and messages.

/// So many of something: `1 face`, `2 faces`.
pub(super) fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}
