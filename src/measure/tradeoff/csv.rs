//! The points of a report as rows: those of all three trades under one head, so that a column means the same
//! everywhere and is empty where it means nothing.

use super::{Report, Timing};

const COLUMNS: [&str; 28] = [
    "trade",
    "name",
    "backend",
    "test",
    "method",
    "mrays_per_second",
    "mrays_per_second_least",
    "mrays_per_second_greatest",
    "mrays_per_second_with_build",
    "build_seconds",
    "cold_seconds",
    "warm_seconds",
    "wrong_per_million",
    "wrong_per_million_low",
    "wrong_per_million_high",
    "false_blocked",
    "false_clear",
    "ties",
    "memory_bytes",
    "on_front",
    "tessellation",
    "triangles",
    "samples_per_pixel",
    "seconds",
    "seconds_least",
    "seconds_greatest",
    "picture_error_levels",
    "deviation_diagonals",
];

/// A row, filled by the names of columns.
struct Row([String; COLUMNS.len()]);

impl Row {
    fn new(trade: &str, name: &str) -> Self {
        let mut row = Self(std::array::from_fn(|_| String::new()));
        row.set("trade", trade);
        row.set("name", name);
        row
    }

    fn set(&mut self, column: &str, value: impl ToString) {
        let place = COLUMNS.iter().position(|&name| name == column).expect("a column of the table");
        self.0[place] = value.to_string();
    }

    fn set_seconds(&mut self, seconds: Timing) {
        self.set("seconds", seconds.median);
        self.set("seconds_least", seconds.least);
        self.set("seconds_greatest", seconds.greatest);
    }
}

/// The report as CSV: a head, then a row a point. No value holds a comma.
#[must_use]
pub fn csv(report: &Report) -> String {
    let mut rows = Vec::new();
    for (place, point) in report.engines.iter().enumerate() {
        let mut row = Row::new("engines", &point.name);
        row.set("backend", point.backend);
        row.set("test", point.test);
        row.set("method", point.method);
        row.set("mrays_per_second", point.mrays_per_second.median);
        row.set("mrays_per_second_least", point.mrays_per_second.least);
        row.set("mrays_per_second_greatest", point.mrays_per_second.greatest);
        row.set("mrays_per_second_with_build", point.mrays_per_second_with_build.median);
        row.set("build_seconds", point.build_seconds.median);
        row.set("cold_seconds", point.cold_seconds.median);
        row.set("warm_seconds", point.warm_seconds.median);
        row.set("wrong_per_million", point.wrong_per_million.share);
        row.set("wrong_per_million_low", point.wrong_per_million.low);
        row.set("wrong_per_million_high", point.wrong_per_million.high);
        row.set("false_blocked", point.false_blocked);
        row.set("false_clear", point.false_clear);
        row.set("ties", point.ties);
        row.set("memory_bytes", point.memory_bytes);
        row.set("on_front", report.fronts.warm.contains(&place));
        rows.push(row);
    }
    for point in &report.tessellations {
        let mut row = Row::new("tessellation", &format!("{} x triangles", point.factor));
        row.set("tessellation", point.factor);
        row.set("triangles", point.triangles);
        row.set_seconds(point.seconds);
        row.set("picture_error_levels", point.picture_error.levels);
        row.set("deviation_diagonals", point.deviation);
        rows.push(row);
    }
    for point in &report.samples {
        let mut row = Row::new("samples", &format!("{} samples", point.samples_per_pixel));
        row.set("samples_per_pixel", point.samples_per_pixel);
        row.set_seconds(point.seconds);
        row.set("picture_error_levels", point.picture_error.levels);
        rows.push(row);
    }
    let lines = rows.iter().map(|row| row.0.join(","));
    let mut text = COLUMNS.join(",");
    for line in lines {
        text.push('\n');
        text += &line;
    }
    text.push('\n');
    text
}
