//! Numbers on the command line: of anything else it is said what to give instead.

use std::fmt::Display;
use std::num::{IntErrorKind, ParseIntError};
use std::ops::{Bound, RangeBounds};
use std::str::FromStr;

/// A parser of whole numbers in a range.
pub(super) fn whole<T: FromStr<Err = ParseIntError> + PartialOrd + Display>(
    range: impl RangeBounds<T> + Clone,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let parsed: Result<T, ParseIntError> = text.parse();
        let is_too_large =
            parsed.as_ref().is_err_and(|error| *error.kind() == IntErrorKind::PosOverflow);
        let number = parsed.ok().filter(|number| range.contains(number));
        number.ok_or_else(|| match (range.start_bound(), range.end_bound()) {
            (Bound::Included(least), Bound::Included(most)) => {
                format!("give a whole number from {least} to {most}")
            }
            _ if is_too_large => "this is too large; give a smaller whole number".to_owned(),
            (Bound::Included(least), _) => format!("give a whole number of at least {least}"),
            _ => "give a whole number".to_owned(),
        })
    }
}

/// A finite number above 0.
pub(super) fn positive(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "give a finite number above 0".to_owned())
}

/// Any finite number.
pub(super) fn finite<T: FromStr + Into<f64> + Copy>(text: &str) -> Result<T, String> {
    let number = text.parse().ok().filter(|&number: &T| number.into().is_finite());
    number.ok_or_else(|| "give a number, like 0.5".to_owned())
}
