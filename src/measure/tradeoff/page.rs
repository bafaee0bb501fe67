//! The report as an HTML page.

use std::path::Path;

use super::charts::{engine_charts, look_of, samples_chart, tessellation_charts};
use super::{Disagreement, EnginePoint, Report, Timing};
use crate::measure::report::{Cell, Page, Shown, bytes};
use crate::measure::{count, grouped, size, told};
use crate::occlusion::Test;

/// The report as a page that is one file; `command` is what made it.
#[must_use]
pub fn page(report: &Report, command: &str) -> String {
    let about = &report.circumstances;
    let lead = format!(
        "{}; {}×{} pixels, samples each: {}; {}, {:.1} % of them blocked.",
        size(about.triangles, about.lights),
        about.width,
        about.height,
        about.samples_per_pixel,
        count(about.queries as u64, "shadow ray"),
        100.0 * about.blocked as f64 / about.queries as f64
    );
    let file = Path::new(&about.scene).file_name();
    let short = file.map_or_else(|| about.scene.clone().into(), |name| name.to_string_lossy());
    let mut page = Page::new(&format!("Speed against accuracy: {short}"), &lead);
    page.list(&findings(report));
    engines(&mut page, report);
    shadows(&mut page, report);
    disagreements(&mut page, report);
    tessellation(&mut page, report);
    samples(&mut page, report);
    method(&mut page, report, command);
    page.finish()
}

/// What most look for.
fn findings(report: &Report) -> Vec<String> {
    let speed = |point: &&EnginePoint| point.mrays_per_second.median;
    let by_speed = |a: &&EnginePoint, b: &&EnginePoint| speed(a).total_cmp(&speed(b));
    let faultless = report.engines.iter().filter(|point| point.wrong() == 0);
    let count = faultless.clone().count();
    let describe = |point: &EnginePoint| {
        format!(
            "{}, {:.2} million rays a second ({:.2} with building)",
            point.name, point.mrays_per_second.median, point.mrays_per_second_with_build.median
        )
    };
    let mut findings = Vec::new();
    if let Some(best) = faultless.max_by(by_speed) {
        findings.push(format!("Fastest without a wrong answer: {}.", describe(best)));
    }
    let certain = report.engines.iter().filter(|point| point.test == Test::Exact);
    if let Some(best) = certain.max_by(by_speed) {
        findings.push(format!("Fastest that cannot be wrong: {}.", describe(best)));
    }
    if let Some(best) = report.engines.iter().max_by(by_speed) {
        let wrong = &best.wrong_per_million;
        findings.push(format!(
            "Fastest of all: {}; {} wrong answers per million (95 %: {} to {}).",
            describe(best),
            told(wrong.share),
            told(wrong.low),
            told(wrong.high)
        ));
    }
    findings.push(format!(
        "{count} of {} contenders gave no wrong answer here; {} rays were answered otherwise than exactly by \
         some contender, ties included.",
        report.engines.len(),
        report.differing_queries
    ));
    findings.extend(
        report
            .engines
            .iter()
            .filter(|point| point.breaks_its_promise())
            .map(|point| format!("A defect: {} breaks its promise.", point.name)),
    );
    findings
}

fn engines(page: &mut Page, report: &Report) {
    page.heading("Engines, tests and shadow methods");
    page.paragraph("Colour says the engine, shape the triangle test. The dashed line joins those that no other \
        beats in both; they are ringed. In the shaded lane no answer was wrong; height means nothing there. \
        Thin lines: least to greatest of the repetitions, and the 95 % interval of wrong answers.");
    for chart in engine_charts(report) {
        page.chart(&chart);
    }
    let columns = [
        "engine",
        "Mrays/s",
        "spread",
        "with building",
        "wrong/million",
        "95 % interval",
        "false blocked",
        "false clear",
        "ties",
        "build s",
        "memory",
    ];
    let mut order: Vec<usize> = (0..report.engines.len()).collect();
    let speed = |place: usize| report.engines[place].mrays_per_second.median;
    order.sort_by(|&a, &b| speed(b).total_cmp(&speed(a)));
    let rows: Vec<_> = order
        .into_iter()
        .map(|place| (report.fronts.warm.contains(&place), row(&report.engines[place])))
        .collect();
    page.table(&columns, &rows, Some("Show only engines with"));
}

fn row(point: &EnginePoint) -> Vec<Cell> {
    let wrong = &point.wrong_per_million;
    let count = |count: u64| Cell::number(&grouped(count), count as f64);
    let decimals = |value: f64| Cell::number(&format!("{value:.2}"), value);
    vec![
        Cell::marked(look_of(point), &point.name),
        decimals(point.mrays_per_second.median),
        spread(point.mrays_per_second),
        decimals(point.mrays_per_second_with_build.median),
        Cell::number(&told(wrong.share), wrong.share),
        Cell::number(&format!("{} to {}", told(wrong.low), told(wrong.high)), wrong.high),
        count(point.false_blocked),
        count(point.false_clear),
        count(point.ties),
        Cell::number(&format!("{:.3}", point.build_seconds.median), point.build_seconds.median),
        Cell::number(&bytes(point.memory_bytes as f64), point.memory_bytes as f64),
    ]
}

fn spread(timing: Timing) -> Cell {
    Cell::number(&timing.spread_text(), timing.spread())
}

fn shadows(page: &mut Page, report: &Report) {
    let pictures = &report.pictures;
    page.heading("What the shadow rays see");
    page.paragraph("Press a name to flip; hold the picture to see the first one again. Differences are drawn \
        over the exact shadows: blue where light leaks in, orange-red where there is a shadow that is none, \
        yellow where a ray only touches a triangle at its end. Lone pixels are framed.");
    let about = &report.circumstances;
    let differences: Vec<(String, String)> = pictures
        .masks
        .differences
        .iter()
        .map(|(names, _)| {
            let name = match names.len() {
                1 => names[0].clone(),
                more => format!("{} and {} more", names[0], more - 1),
            };
            (name, format!("Answers that are not the exact ones, of: {}.", names.join(", ")))
        })
        .collect();
    let caption = format!("{}, by the grid with the exact test.", about.scene);
    let mut shown = vec![
        Shown {
            name: "picture",
            caption: &caption,
            film: &pictures.film,
            exposure: pictures.exposure,
        },
        Shown {
            name: "exact shadows",
            caption: "White where every light that is asked about reaches the pixel, black where none does; \
                reflections included.",
            film: &pictures.masks.exact,
            exposure: 1.0,
        },
    ];
    for ((name, caption), (_, film)) in differences.iter().zip(&pictures.masks.differences) {
        shown.push(Shown { name, caption, film, exposure: 1.0 });
    }
    page.gallery(&shown);
    if differences.is_empty() {
        page.paragraph("No contender differs from the exact shadows on any ray of this picture.");
    }
}

fn disagreements(page: &mut Page, report: &Report) {
    page.heading("The worst disagreements");
    if report.disagreements.is_empty() {
        page.paragraph("There are none: all contenders gave the exact answer to every ray.");
        return;
    }
    page.paragraph(&format!(
        "{} of {} rays on which some contender differs from exact arithmetic, those that most get wrong first; \
         the JSON file has them too. Bits: origin, direction and end of the ray as f32.",
        report.disagreements.len(),
        grouped(report.differing_queries as u64)
    ));
    let columns =
        ["pixel", "light", "truth", "differing", "who", "origin", "direction", "end", "bits"];
    let rows: Vec<_> =
        report.disagreements.iter().map(|disagreement| (false, disputed(disagreement))).collect();
    page.table(&columns, &rows, None);
}

fn disputed(disagreement: &Disagreement) -> Vec<Cell> {
    let (x, y) = disagreement.pixel;
    let vector = |[x, y, z]: [f32; 3]| format!("{x} {y} {z}");
    let end = disagreement.end.map_or_else(|| "infinite".to_owned(), |end| end.to_string());
    vec![
        Cell::text(&format!("{x}, {y}")),
        Cell::number(&disagreement.light.to_string(), f64::from(disagreement.light)),
        Cell::text(disagreement.verdict),
        Cell::number(&disagreement.by.len().to_string(), disagreement.by.len() as f64),
        Cell::wrapped(&few(&disagreement.by)),
        Cell::code(&vector(disagreement.origin)),
        Cell::code(&vector(disagreement.direction)),
        Cell::code(&end),
        Cell::code(&disagreement.bits),
    ]
}

/// Names, at most so many.
fn few(names: &[String]) -> String {
    const MOST: usize = 4;
    match names.len().checked_sub(MOST) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..MOST].join(", ")),
    }
}

fn tessellation(page: &mut Page, report: &Report) {
    page.heading("Tessellation");
    let Some((reference_name, reference, exposure)) = &report.pictures.tessellation else {
        for note in &report.circumstances.notes {
            page.paragraph(note);
        }
        return;
    };
    page.paragraph(&format!(
        "Making the triangles of the curved surfaces, building the grid and rendering with the exact test, one \
         sample a pixel. The picture is held against that of {reference_name}; the triangles against the \
         surfaces themselves."
    ));
    for chart in tessellation_charts(report) {
        page.chart(&chart);
    }
    let columns = [
        "triangles ×",
        "triangles",
        "seconds",
        "spread",
        "picture error, levels",
        "pixels off, per million",
        "surface error, diagonals",
        "greatest",
    ];
    let rows: Vec<_> = report
        .tessellations
        .iter()
        .map(|point| {
            let error = point.picture_error;
            let cells = vec![
                Cell::number(&point.factor.to_string(), point.factor),
                Cell::number(&grouped(point.triangles as u64), point.triangles as f64),
                Cell::number(&format!("{:.3}", point.seconds.median), point.seconds.median),
                spread(point.seconds),
                Cell::number(&format!("{:.3}", error.levels), error.levels),
                Cell::number(
                    &format!("{:.0}", error.visible_per_million),
                    error.visible_per_million,
                ),
                Cell::number(&format!("{:.1e}", point.deviation), point.deviation),
                Cell::number(
                    &format!("{:.1e}", point.greatest_deviation),
                    point.greatest_deviation,
                ),
            ];
            (false, cells)
        })
        .collect();
    page.table(&columns, &rows, None);
    let names: Vec<_> =
        report.tessellations.iter().map(|point| format!("× {}", point.factor)).collect();
    let captions: Vec<_> = report
        .tessellations
        .iter()
        .map(|point| {
            format!("{} triangles, {:.3} s.", grouped(point.triangles as u64), point.seconds.median)
        })
        .collect();
    let mut shown = vec![Shown {
        name: "reference",
        caption: reference_name,
        film: reference,
        exposure: *exposure,
    }];
    for ((name, caption), point) in names.iter().zip(&captions).zip(&report.tessellations) {
        shown.push(Shown { name, caption, film: &point.film, exposure: *exposure });
    }
    page.gallery(&shown);
}

fn samples(page: &mut Page, report: &Report) {
    page.heading("Samples");
    let (reference_name, reference, exposure) = &report.pictures.samples;
    page.paragraph(&format!(
        "Rendering by the grid with the exact test; the picture is held against that of {reference_name}."
    ));
    page.chart(&samples_chart(report));
    let columns = [
        "samples a pixel",
        "seconds",
        "spread",
        "picture error, levels",
        "pixels off, per million",
    ];
    let rows: Vec<_> = report
        .samples
        .iter()
        .map(|point| {
            let error = point.picture_error;
            let samples = point.samples_per_pixel;
            let cells = vec![
                Cell::number(&samples.to_string(), f64::from(samples)),
                Cell::number(&format!("{:.3}", point.seconds.median), point.seconds.median),
                spread(point.seconds),
                Cell::number(&format!("{:.3}", error.levels), error.levels),
                Cell::number(
                    &format!("{:.0}", error.visible_per_million),
                    error.visible_per_million,
                ),
            ];
            (false, cells)
        })
        .collect();
    page.table(&columns, &rows, None);
    let names: Vec<_> =
        report.samples.iter().map(|point| point.samples_per_pixel.to_string()).collect();
    let captions: Vec<_> = report
        .samples
        .iter()
        .map(|point| {
            format!("Samples a pixel: {}, {:.3} s.", point.samples_per_pixel, point.seconds.median)
        })
        .collect();
    let mut shown = vec![Shown {
        name: "reference",
        caption: reference_name,
        film: reference,
        exposure: *exposure,
    }];
    for ((name, caption), point) in names.iter().zip(&captions).zip(&report.samples) {
        shown.push(Shown { name, caption, film: &point.film, exposure: *exposure });
    }
    page.gallery(&shown);
}

fn method(page: &mut Page, report: &Report, command: &str) {
    let about = &report.circumstances;
    page.heading("How this was measured");
    page.command("Made by", command);
    page.paragraph(&format!(
        "umbra {} on {}, threads: {}. Everything was measured in one run, repetitions: {}; all had their turn \
         in each, and each time another began. Figures are medians; the spread is half the distance from \
         the least to the greatest.",
        about.version, about.processor, about.threads, about.repetitions
    ));
    page.paragraph("Engines: in its turn each was built from nothing, answered all shadow rays of the picture, \
        answered them twice again, and was dropped. Speed is that of the faster of the last two passes; with \
        building it is that of building, preparing and the first pass together, so lazily built parts count \
        there.");
    page.paragraph("Truth is exact real arithmetic on the bits of each ray and triangle. A ray that touches a \
        triangle only at an end of its open interval is a tie, which is no error. Intervals of wrong answers \
        are Wilson's, at 95 %: none of a thousand leaves 3,800 per million possible.");
    page.paragraph("Errors of pictures are root mean squares of what a screen shows, in 255 levels; a pixel is \
        off if a channel differs by more than four. Errors of surfaces are root mean squares, and greatest, \
        of the distance from triangles to the surface at the same parameters, in diagonals of the scene.");
}
