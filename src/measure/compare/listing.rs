//! Every disagreement, a line each: for eyes, and as CSV.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{Disagreement, Report};
use crate::exact::Verdict;
use crate::measure::{bits, count};

/// The first line of the CSV.
const COLUMNS: &str = "contender,pixel_x,pixel_y,light,kind,said,exact,triangle,explained,origin_x,origin_y,origin_z,direction_x,direction_y,direction_z,end,bits";

/// Contenders that are named for a query at most.
const NAMES: usize = 6;

impl Report {
    /// All disagreements as CSV (RFC 4180, with line feeds): the ray in decimals that read back to the same bits,
    /// and the bits themselves.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = format!("{COLUMNS}\n");
        for found in &self.disagreements {
            let ((x, y), [ox, oy, oz], [dx, dy, dz]) =
                (found.pixel, found.ray.origin.to_array(), found.ray.direction.to_array());
            let triangle = found.triangle.map_or(String::new(), |id| id.to_string());
            let _ = writeln!(
                text,
                "{},{x},{y},{},{},{},{},{triangle},{},{ox:?},{oy:?},{oz:?},{dx:?},{dy:?},{dz:?},{:?},{}",
                quoted(&self.contenders[found.contender].name),
                found.light,
                found.kind.name(),
                said(found.blocked),
                found.exact.name(),
                if found.explained { "yes" } else { "no" },
                found.ray.end,
                bits(&found.ray)
            );
        }
        text
    }

    /// The first disputed queries in words, those with an answer that nothing explains before the others, and how many
    /// are not listed.
    #[must_use]
    pub fn listing(&self, most: usize) -> String {
        let mut by_query: BTreeMap<usize, Vec<&Disagreement>> = BTreeMap::new();
        for found in &self.disagreements {
            by_query.entry(found.query).or_default().push(found);
        }
        let mut disputed: Vec<Vec<&Disagreement>> = by_query.into_values().collect();
        disputed.sort_by_key(|found| found.iter().all(|found| found.explained));
        let mut text = String::new();
        for found in disputed.iter().take(most) {
            self.describe(found, &mut text);
        }
        let unlisted = match (disputed.len().saturating_sub(most) as u64, most) {
            (0, _) => return text,
            (more, 0) => format!("{}, not listed", count(more, "disputed query")),
            (more, _) => format!("and {}", count(more, "more disputed query")),
        };
        let _ = writeln!(text, "{unlisted}; --list FILE and --stats FILE have all");
        text
    }

    /// All that is wrong about one query.
    fn describe(&self, found: &[&Disagreement], text: &mut String) {
        let Disagreement { pixel: (x, y), light, exact, ray, .. } = *found[0];
        let triangle = found.iter().find_map(|found| found.triangle);
        let triangle = match (triangle, exact) {
            (None, _) => String::new(),
            (Some(id), Verdict::Clear) => format!(", though triangle {id} is reported"),
            (Some(id), _) => format!(", by triangle {id}"),
        };
        let (exact, bits) = (exact.name(), bits(&ray));
        let _ = writeln!(text, "pixel {x},{y} light {light}: {exact}{triangle}; ray {bits}");
        for (blocked, explained) in [(false, false), (true, false), (false, true), (true, true)] {
            let names: Vec<&str> = found
                .iter()
                .filter(|found| (found.blocked, found.explained) == (blocked, explained))
                .map(|found| &self.contenders[found.contender].name[..])
                .collect();
            if let [first, rest @ ..] = &names[..] {
                let said = said(blocked);
                let explained = if explained { "" } else { ", UNEXPLAINED" };
                let shown = rest
                    .iter()
                    .take(NAMES - 1)
                    .fold((*first).to_owned(), |line, name| line + ", " + name);
                let more = names.len().saturating_sub(NAMES);
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                let _ = writeln!(text, "  said to be {said}{explained} by {shown}{more}");
            }
        }
    }
}

fn said(blocked: bool) -> &'static str {
    if blocked { "blocked" } else { "clear" }
}

/// A field of CSV.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
