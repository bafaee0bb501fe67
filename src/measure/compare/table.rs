//! The report as text.

use std::fmt;

use super::{Report, Row};
use crate::measure::wilson::PerMillion;
use crate::measure::{count, grouped, size, told};

/// Least widths of the columns after the name.
const WIDTHS: [usize; 6] = [12, 26, 26, 14, 16, 13];

/// Blanks before a cell that is wider than most.
const GAP: usize = 2;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, width, height, .. } = self;
        writeln!(
            f,
            "{scene}: {}, {width}x{height}; {}: {} blocked, {} clear, {}",
            size(self.triangles, self.lights),
            count(self.queries, "shadow query"),
            grouped(self.blocked),
            grouped(self.clear),
            count(self.ties, "tie")
        )?;
        writeln!(
            f,
            "the truth was checked by the oracle on {} of them and by brute force on {}: contradicted {}",
            grouped(self.checks.by_oracle),
            grouped(self.checks.by_brute_force),
            count(self.checks.contradicted, "time")
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
        let rows: Vec<[String; 6]> = self.contenders.iter().map(cells).collect();
        let widest = |column: usize| rows.iter().map(|cells| cells[column].len() + GAP).max();
        let widths: [usize; 6] =
            std::array::from_fn(|column| WIDTHS[column].max(widest(column).unwrap_or(0)));
        line(f, name, "", &headings.map(str::to_owned), &widths)?;
        for (row, cells) in self.contenders.iter().zip(&rows) {
            line(f, name, &row.name, cells, &widths)?;
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

fn line(
    f: &mut fmt::Formatter<'_>,
    name: usize,
    first: &str,
    cells: &[String; 6],
    widths: &[usize; 6],
) -> fmt::Result {
    write!(f, "  {first:name$}")?;
    for (cell, width) in cells.iter().zip(widths) {
        write!(f, "{cell:>width$}")?;
    }
    writeln!(f)
}

/// A share and its interval.
fn share(share: &PerMillion) -> String {
    format!("{} ({} to {})", told(share.share), told(share.low), told(share.high))
}
