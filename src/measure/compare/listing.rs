//! Every disagreement, a line each: for eyes, and as CSV.

use std::fmt::Write;

use super::report::{bits, name_of};
use super::{Disagreement, Report};

/// The first line of the CSV.
const COLUMNS: &str = "contender,pixel_x,pixel_y,light,kind,said,exact,triangle,explained,origin_x,origin_y,origin_z,direction_x,direction_y,direction_z,end,bits";

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
                said(found),
                name_of(found.exact),
                if found.explained { "yes" } else { "no" },
                found.ray.end,
                bits(&found.ray)
            );
        }
        text
    }

    /// The first disagreements in words, those that nothing explains before the others; and how many there are.
    #[must_use]
    pub fn listing(&self, most: usize) -> String {
        let mut sorted: Vec<&Disagreement> = self.disagreements.iter().collect();
        sorted.sort_by_key(|found| found.explained);
        let mut text = String::new();
        for found in sorted.iter().take(most) {
            let (x, y) = found.pixel;
            let triangle = found.triangle.map_or("none".to_owned(), |id| id.to_string());
            let _ = writeln!(
                text,
                "  {}: pixel {x},{y} light {}: said {}, exact {}, triangle {triangle}, {}, ray {}",
                self.contenders[found.contender].name,
                found.light,
                said(found),
                name_of(found.exact),
                if found.explained { "explained" } else { "UNEXPLAINED" },
                bits(&found.ray)
            );
        }
        let more = sorted.len().saturating_sub(most);
        if more > 0 {
            let _ = writeln!(text, "  and {more} more; --list FILE.csv or --stats FILE has all");
        }
        text
    }
}

fn said(found: &Disagreement) -> &'static str {
    if found.blocked { "blocked" } else { "clear" }
}

/// A field of CSV.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
