//! The charts of a report.

use super::{EnginePoint, Report, SamplesPoint, TessellationPoint, Timing};
use crate::measure::report::{
    Chart, Dimension, Hue, LogAxis, Look, Mark, Shape, bytes, document, tick_label,
};
use crate::measure::told;
use crate::occlusion::{Backend, Test};
use crate::shadow::Combination;

/// Width of the SVG document.
const WIDTH: f64 = 900.0;

/// Share of the height that belongs to contenders without wrong answers, for most of them have none; and where
/// all have none.
const LANE: f64 = 0.45;
const FAULTLESS_LANE: f64 = 0.75;

/// All charts of a report below one another, as an SVG document.
#[must_use]
pub fn plot(report: &Report) -> String {
    let mut charts = engine_charts(report).to_vec();
    charts.extend(tessellation_charts(report));
    charts.push(samples_chart(report));
    document(&charts, WIDTH)
}

/// A backend's hue.
fn hue_of(backend: Backend) -> Hue {
    match backend {
        Backend::Grid => Hue::Blue,
        Backend::Embree => Hue::Vermillion,
        Backend::Bvh2 => Hue::Green,
        Backend::Cwbvh => Hue::Purple,
        Backend::Brute => Hue::Orange,
    }
}

/// A test's shape.
fn shape_of(test: Test) -> Shape {
    match test {
        Test::Exact => Shape::Circle,
        Test::Pluecker => Shape::Square,
        Test::Moller => Shape::Triangle,
        Test::Watertight => Shape::Diamond,
    }
}

/// Whether nothing stands before the engine.
fn is_alone(point: &EnginePoint) -> bool {
    point.method == Combination::default()
}

/// How a contender looks in charts and tables.
pub(super) fn look_of(point: &EnginePoint) -> Look {
    Look { hue: hue_of(point.backend), shape: shape_of(point.test), filled: is_alone(point) }
}

/// What hues, shapes and filling mean, of those that occur.
fn legend(points: &[EnginePoint]) -> Vec<(Look, String)> {
    let look = |hue, shape, filled| Look { hue, shape, filled };
    let ink = |shape, filled| look(Hue::Ink, shape, filled);
    let occurs = |is_such: &dyn Fn(&EnginePoint) -> bool| points.iter().any(is_such);
    let backends = Backend::ALL.into_iter();
    let backends = backends.filter(|backend| occurs(&|point| point.backend == *backend));
    let tests = Test::ALL.into_iter().rev();
    let tests = tests.filter(|test| occurs(&|point| point.test == *test));
    let hues = backends.map(|one| (look(hue_of(one), Shape::Bar, true), one.to_string()));
    let shapes = tests.map(|one| (ink(shape_of(one), true), one.to_string()));
    let mut legend: Vec<_> = hues.chain(shapes).collect();
    if points.iter().any(|point| !is_alone(point)) {
        legend.push((ink(Shape::Bar, true), "filled: engine alone".to_owned()));
        legend.push((ink(Shape::Bar, false), "hollow: behind a shadow method".to_owned()));
    }
    legend
}

const SPEED: &str = "million shadow rays a second, faster →";
const WRONG: &str = "↓ fewer wrong answers, per million rays";

/// Speed against wrong answers, warm and with building; speed against memory.
pub(super) fn engine_charts(report: &Report) -> [Chart; 3] {
    let warm: fn(&EnginePoint) -> Timing = |point| point.mrays_per_second;
    let whole: fn(&EnginePoint) -> Timing = |point| point.mrays_per_second_with_build;
    let wrong: fn(&EnginePoint) -> f64 = |point| point.wrong_per_million.share;
    let fronts = &report.fronts;
    let accuracy = |title: &str, speed: fn(&EnginePoint) -> Timing, front: &[usize]| Chart {
        zeros: "no wrong answer".to_owned(),
        ..chart(report, title, speed, (WRONG, wrong, LANE), front)
    };
    [
        accuracy("Speed and accuracy, everything built", warm, &fronts.warm),
        accuracy("Speed and accuracy, building included", whole, &fronts.with_build),
        chart(
            report,
            "Speed and memory, everything built",
            warm,
            ("↓ fewer bytes besides the triangles", |point| point.memory_bytes as f64, 0.0),
            &fronts.memory,
        ),
    ]
}

fn chart(
    report: &Report,
    title: &str,
    speed: fn(&EnginePoint) -> Timing,
    (cost_title, cost, lane): (&str, fn(&EnginePoint) -> f64, f64),
    front: &[usize],
) -> Chart {
    let points = &report.engines;
    let is_wrongness = lane > 0.0;
    let exact = (0..points.len()).filter(|&place| points[place].test == Test::Exact);
    let fastest_exact =
        exact.max_by(|&a, &b| speed(&points[a]).median.total_cmp(&speed(&points[b]).median));
    let marks = points.iter().enumerate().map(|(place, point)| Mark {
        x: speed(point).median,
        y: cost(point),
        x_spread: Some([speed(point).least, speed(point).greatest]),
        y_spread: is_wrongness
            .then_some([point.wrong_per_million.low, point.wrong_per_million.high]),
        look: look_of(point),
        label: match front.contains(&place) || fastest_exact == Some(place) {
            true => point.name.clone(),
            false => String::new(),
        },
        tooltip: tooltip(point),
    });
    // Where nobody is wrong, the axis shows how wrong they might be all the same.
    let is_faultless = is_wrongness && points.iter().all(|point| cost(point) <= 0.0);
    let lane = if is_faultless { FAULTLESS_LANE } else { lane };
    let costs = points
        .iter()
        .map(|point| if is_faultless { point.wrong_per_million.high } else { cost(point) });
    let speeds = points.iter().flat_map(|point| [speed(point).least, speed(point).greatest]);
    Chart {
        title: title.to_owned(),
        x: Dimension { title: SPEED.to_owned(), axis: LogAxis::over(speeds), label: tick_label },
        y: Dimension {
            title: cost_title.to_owned(),
            axis: LogAxis::over(costs).with_lane(lane),
            label: if is_wrongness { tick_label } else { bytes },
        },
        zeros: String::new(),
        marks: marks.collect(),
        front: front.to_vec(),
        curves: Vec::new(),
        legend: legend(points),
    }
}

/// What a pointer on a contender's mark shows.
fn tooltip(point: &EnginePoint) -> String {
    format!(
        "{}: {:.2} million rays/s ({:.2} with building), {} wrong per million (95 %: {} to {}), {}",
        point.name,
        point.mrays_per_second.median,
        point.mrays_per_second_with_build.median,
        told(point.wrong_per_million.share),
        told(point.wrong_per_million.low),
        told(point.wrong_per_million.high),
        bytes(point.memory_bytes as f64),
    )
}

/// One line of points, each labelled, of a trade that shows in the picture.
struct Line<'a> {
    title: &'a str,
    x: &'a str,
    y: &'a str,
    hue: Hue,
}

impl Line<'_> {
    fn chart(&self, points: impl Iterator<Item = (Timing, f64, String)>) -> Chart {
        let look = Look { hue: self.hue, shape: Shape::Circle, filled: true };
        let marks: Vec<Mark> = points
            .map(|(seconds, y, label)| Mark {
                x: seconds.median,
                y,
                x_spread: Some([seconds.least, seconds.greatest]),
                y_spread: None,
                look,
                tooltip: format!("{label}: {:.3} s, {y:.3e}", seconds.median),
                label,
            })
            .collect();
        let seconds = marks.iter().flat_map(|mark| mark.x_spread.unwrap_or_default());
        let lane = if marks.iter().any(|mark| mark.y <= 0.0) { 0.2 } else { 0.0 };
        let beaten: Vec<_> = marks.iter().map(|mark| (-mark.x, mark.y)).collect();
        let mut front = super::front(&beaten);
        front.reverse();
        Chart {
            title: self.title.to_owned(),
            x: Dimension {
                title: self.x.to_owned(),
                axis: LogAxis::over(seconds),
                label: tick_label,
            },
            y: Dimension {
                title: self.y.to_owned(),
                axis: LogAxis::over(marks.iter().map(|mark| mark.y)).with_lane(lane),
                label: tick_label,
            },
            zeros: "no difference".to_owned(),
            marks,
            front,
            curves: Vec::new(),
            legend: Vec::new(),
        }
    }
}

/// Time of the whole against the error of the picture, and against that of the surfaces.
pub(super) fn tessellation_charts(report: &Report) -> Vec<Chart> {
    let points = &report.tessellations;
    if points.is_empty() {
        return Vec::new();
    }
    let label = |point: &TessellationPoint| format!("{} × triangles", point.factor);
    let picture = Line {
        title: "Tessellation and the picture",
        x: "← faster, seconds to make, build and render",
        y: "↓ nearer to the reference, levels of 255",
        hue: Hue::Blue,
    };
    let surface = Line {
        title: "Tessellation and the true surfaces",
        y: "↓ nearer to the surfaces, scene diagonals",
        hue: Hue::Green,
        ..picture
    };
    vec![
        picture.chart(points.iter().map(|p| (p.seconds, p.picture_error.levels, label(p)))),
        surface.chart(points.iter().map(|p| (p.seconds, p.deviation, label(p)))),
    ]
}

/// Time of rendering against the error of the picture.
pub(super) fn samples_chart(report: &Report) -> Chart {
    let label = |point: &SamplesPoint| match point.samples_per_pixel {
        1 => "1 sample".to_owned(),
        samples => format!("{samples} samples"),
    };
    let line = Line {
        title: "Samples and the picture",
        x: "← faster, seconds to render",
        y: "↓ nearer to the reference, levels of 255",
        hue: Hue::Purple,
    };
    line.chart(report.samples.iter().map(|p| (p.seconds, p.picture_error.levels, label(p))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_backends_share_a_hue_and_no_two_tests_a_shape() {
        let hues: std::collections::HashSet<_> = Backend::ALL.map(hue_of).into_iter().collect();
        let shapes: std::collections::HashSet<_> = Test::ALL.map(shape_of).into_iter().collect();
        assert_eq!((hues.len(), shapes.len()), (Backend::ALL.len(), Test::ALL.len()));
        assert!(!hues.contains(&Hue::Ink) && !shapes.contains(&Shape::Bar));
    }
}
