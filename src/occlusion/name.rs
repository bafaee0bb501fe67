//! From names, as the command line has them, to what they name.

use std::fmt;

/// A name that nothing of its kind has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {kind} '{name}'; give one of {known}")]
pub struct UnknownName {
    kind: &'static str,
    name: String,
    known: String,
}

/// The one of all that is written so.
pub(crate) fn named<T: Copy + fmt::Display>(
    kind: &'static str,
    name: &str,
    all: &[T],
) -> Result<T, UnknownName> {
    all.iter().copied().find(|one| one.to_string() == name).ok_or_else(|| {
        let known: Vec<String> = all.iter().map(T::to_string).collect();
        UnknownName { kind, name: name.to_owned(), known: known.join(", ") }
    })
}
