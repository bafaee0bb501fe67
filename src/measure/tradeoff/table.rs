//! The report as text for the terminal.

use std::fmt::{self, Write};

use super::{EnginePoint, Report, SamplesPoint, TessellationPoint};
use crate::measure::report::bytes;
use crate::measure::{count, grouped, size, told};

/// The tables of all trades: engines by speed, the front marked with a star.
#[must_use]
pub fn table(report: &Report) -> String {
    let mut text = String::new();
    write(&mut text, report).expect("a string grows");
    text
}

fn write(text: &mut String, report: &Report) -> fmt::Result {
    let about = &report.circumstances;
    writeln!(
        text,
        "{}: {}; {}x{}, {}, {:.1} % blocked; threads: {}, median of {}",
        about.scene,
        size(about.triangles, about.lights),
        about.width,
        about.height,
        count(about.queries as u64, "shadow ray"),
        100.0 * about.blocked as f64 / about.queries as f64,
        about.threads,
        about.repetitions
    )?;
    for note in &about.notes {
        writeln!(text, "  {note}")?;
    }
    let name_width = report.engines.iter().map(|point| point.name.len()).max().unwrap_or(0).max(8);
    writeln!(
        text,
        "\n  {:name_width$}  Mrays/s  spread  built too   wrong per million   (95 % interval)   ties      \
         memory",
        "engine"
    )?;
    let mut order: Vec<usize> = (0..report.engines.len()).collect();
    let speed = |place: usize| report.engines[place].mrays_per_second.median;
    order.sort_by(|&a, &b| speed(b).total_cmp(&speed(a)));
    for place in order {
        let point = &report.engines[place];
        let star = if report.fronts.warm.contains(&place) { '*' } else { ' ' };
        writeln!(text, "{star} {:name_width$}  {}", point.name, row(point))?;
    }
    writeln!(text, "  * no other is both faster and less often wrong")?;
    if !report.tessellations.is_empty() {
        writeln!(
            text,
            "\n  tessellation  triangles    seconds  spread  picture error  surface error"
        )?;
        report.tessellations.iter().try_for_each(|point| tessellation(text, point))?;
    }
    writeln!(text, "\n  samples    seconds  spread  picture error")?;
    report.samples.iter().try_for_each(|point| samples(text, point))?;
    let surface = match report.tessellations[..] {
        [] => "",
        _ => "; surface error: in diagonals of the scene",
    };
    writeln!(text, "  picture error: root mean square, in 255 levels of the screen{surface}")
}

fn row(point: &EnginePoint) -> String {
    let wrong = &point.wrong_per_million;
    let spread = point.mrays_per_second.spread_text();
    format!(
        "{:7.3} {spread:>7}    {:7.3}   {:>17}   {:>15}  {:5}  {:>10}",
        point.mrays_per_second.median,
        point.mrays_per_second_with_build.median,
        told(wrong.share),
        format!("{} to {}", told(wrong.low), told(wrong.high)),
        point.ties,
        bytes(point.memory_bytes as f64),
    )
}

fn tessellation(text: &mut String, point: &TessellationPoint) -> fmt::Result {
    writeln!(
        text,
        "  {:12} {:>10} {:10.4} {:>7} {:14.3} {:14.2e}",
        point.factor,
        grouped(point.triangles as u64),
        point.seconds.median,
        point.seconds.spread_text(),
        point.picture_error.levels,
        point.deviation
    )
}

fn samples(text: &mut String, point: &SamplesPoint) -> fmt::Result {
    writeln!(
        text,
        "  {:7} {:10.4} {:>7} {:14.3}",
        point.samples_per_pixel,
        point.seconds.median,
        point.seconds.spread_text(),
        point.picture_error.levels
    )
}
