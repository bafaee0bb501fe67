//! The report as text.

use std::fmt;

use super::{Report, Row};
use crate::measure::wilson::PerMillion;
use crate::measure::{grouped, told};

/// Widths of the columns after the name.
const WIDTHS: [usize; 6] = [12, 26, 26, 14, 16, 13];

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, width, height, .. } = self;
        writeln!(
            f,
            "{scene}: {} triangles, {} lights, {width}x{height}; {} shadow queries: {} blocked, {} clear, {} ties",
            grouped(self.triangles as u64),
            self.lights,
            grouped(self.queries),
            grouped(self.blocked),
            grouped(self.clear),
            grouped(self.ties)
        )?;
        writeln!(
            f,
            "the truth was checked by the oracle on {} of them and by brute force on {}: contradicted {} times",
            grouped(self.checks.by_oracle),
            grouped(self.checks.by_brute_force),
            self.checks.contradicted
        )?;
        let name = self.contenders.iter().map(|row| row.name.len()).max().unwrap_or(0);
        let headings = [
            "agree",
            "false blocked a million",
            "false clear a million",
            "ties blocked",
            "must be within",
            "unexplained",
        ];
        line(f, name, "", &headings.map(str::to_owned))?;
        for row in &self.contenders {
            line(f, name, &row.name, &cells(row))?;
        }
        Ok(())
    }
}

fn cells(row: &Row) -> [String; 6] {
    [
        grouped(row.agree),
        share(&row.false_blocked_per_million),
        share(&row.false_clear_per_million),
        grouped(row.ties_blocked),
        row.claim.to_owned(),
        grouped(row.unexplained),
    ]
}

fn line(f: &mut fmt::Formatter<'_>, name: usize, first: &str, cells: &[String; 6]) -> fmt::Result {
    write!(f, "  {first:name$}")?;
    for (cell, width) in cells.iter().zip(WIDTHS) {
        write!(f, "{cell:>width$}")?;
    }
    writeln!(f)
}

/// A share and its interval.
fn share(share: &PerMillion) -> String {
    format!("{} ({} to {})", told(share.share), told(share.low), told(share.high))
}
