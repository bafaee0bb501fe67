//! Lists on the command line: names with commas between, and blanks around them if one likes.

use std::ffi::OsStr;

use clap::builder::{EnumValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command, Error, ValueEnum};

/// A parser of a name, without the blanks around it.
#[derive(Clone)]
pub(super) struct Trimmed<P>(P);

/// Names of what there is.
pub(super) fn known<T: ValueEnum + Clone + Send + Sync + 'static>() -> Trimmed<EnumValueParser<T>> {
    Trimmed(EnumValueParser::new())
}

/// Names out of these.
pub(super) fn among(
    names: impl IntoIterator<Item = &'static str>,
) -> Trimmed<PossibleValuesParser> {
    Trimmed(PossibleValuesParser::new(names))
}

/// Any names.
#[cfg(feature = "embree")]
pub(super) fn any() -> Trimmed<clap::builder::StringValueParser> {
    Trimmed(clap::builder::StringValueParser::new())
}

impl<P: TypedValueParser> TypedValueParser for Trimmed<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<P::Value, Error> {
        let name = value.to_str().map_or(value, |text| OsStr::new(text.trim()));
        self.0.parse_ref(command, arg, name)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        self.0.possible_values()
    }
}
