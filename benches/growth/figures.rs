//! The curves as CSV, SVG and Markdown.

use std::fmt::Write;
use std::io;
use std::path::Path;

use umbra::measure::report::{
    Chart, Dimension, Hue, LogAxis, Look, Mark, Shape, document, tick_label,
};
use umbra::whole_file::write_whole;

use super::curves::{CONTENDERS, Curve, Point};
use crate::common::contest::Costs;
use crate::common::short;

/// What a chart shows of a contender's costs.
type Part = fn(&Costs) -> f64;

/// Width of the charts.
const WIDTH: f64 = 900.0;

/// Hue and shape of a contender; Embree's are hollow.
fn look(name: &str) -> Look {
    let (hue, shape, filled) = match name {
        "grid trace" => (Hue::Blue, Shape::Circle, true),
        "shaft" => (Hue::Green, Shape::Square, true),
        "light-buffer" => (Hue::Purple, Shape::Triangle, true),
        "auto" => (Hue::Ink, Shape::Diamond, true),
        "embree single" => (Hue::Vermillion, Shape::Circle, false),
        _ => (Hue::Orange, Shape::Square, false),
    };
    Look { hue, shape, filled }
}

/// A curve as a table in Markdown: nanoseconds a query with everything built, and in brackets with all building.
pub fn markdown(curve: &Curve, points: &[Point]) -> String {
    let mut text = format!("| {} | {} |\n", curve.name, CONTENDERS.join(" | "));
    let _ = writeln!(text, "|{}", " --- |".repeat(1 + CONTENDERS.len()));
    let mut scene = "";
    for point in points {
        let named = if point.scene == scene { "" } else { &*format!("{}, ", point.scene) };
        let _ = write!(text, "| {named}{} |", point.x);
        for name in CONTENDERS {
            match point.costs.iter().find(|costs| costs.name == name) {
                Some(costs) => {
                    let each = |nanoseconds: f64| nanoseconds / point.queries as f64;
                    let _ = write!(
                        text,
                        " {} ({}) |",
                        short(each(costs.then)),
                        short(each(costs.whole()))
                    );
                }
                None => text.push_str("  |"),
            }
        }
        text.push('\n');
        scene = &point.scene;
    }
    text
}

/// Writes a curve's points and charts.
pub fn write(folder: &Path, curve: &Curve, points: &[Point]) -> io::Result<()> {
    let file = |ending: &str| folder.join(format!("growth-{}.{ending}", curve.name));
    write_whole(&file("csv"), csv(curve, points).as_bytes())?;
    let kinds: [(&str, &str, Part); 2] = [
        ("svg", "everything built", |costs| costs.then),
        ("with-building.svg", "building included", Costs::whole),
    ];
    for (ending, what, cost) in kinds {
        let scenes = points.chunk_by(|a, b| a.scene == b.scene);
        let charts: Vec<Chart> = scenes.map(|same| chart(curve, same, what, cost)).collect();
        write_whole(&file(ending), document(&charts, WIDTH).as_bytes())?;
    }
    Ok(())
}

fn csv(curve: &Curve, points: &[Point]) -> String {
    let mut text = format!(
        "scene,{},queries,contender,prepare_ns,first_pass_ns,later_pass_ns,ns_a_query,ns_a_query_with_building,bytes,blocked\n",
        curve.name
    );
    for Point { scene, x, queries, costs } in points {
        for cost in costs {
            let Costs { name, preparing, first, then, bytes, blocked } = cost;
            let each = |nanoseconds: f64| nanoseconds / *queries as f64;
            let _ = writeln!(
                text,
                "{scene},{x},{queries},{name},{preparing:.0},{first:.0},{then:.0},{:.2},{:.2},{bytes},{blocked}",
                each(*then),
                each(cost.whole())
            );
        }
    }
    text
}

fn chart(curve: &Curve, points: &[Point], what: &str, cost: Part) -> Chart {
    let mut marks = Vec::new();
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    for name in CONTENDERS {
        let first = marks.len();
        for Point { x, queries, costs, .. } in points {
            let Some(costs) = costs.iter().find(|costs| costs.name == name) else { continue };
            let nanoseconds = cost(costs) / *queries as f64;
            marks.push(Mark {
                x: *x as f64,
                y: nanoseconds,
                x_spread: None,
                y_spread: None,
                look: look(name),
                label: String::new(),
                tooltip: format!("{name}, {x} {}: {nanoseconds:.1} ns a query", curve.name),
            });
        }
        if marks.len() > first {
            curves.push((first..marks.len()).collect());
            legend.push((look(name), name.to_owned()));
        }
    }
    let scene = points.first().map_or("", |point| &point.scene);
    let axis = |values: fn(&Mark) -> f64| LogAxis::over(marks.iter().map(values));
    Chart {
        title: format!("{scene}: a shadow ray, {what}"),
        x: Dimension { title: curve.axis.to_owned(), axis: axis(|mark| mark.x), label: tick_label },
        y: Dimension {
            title: "↓ nanoseconds a shadow ray".to_owned(),
            axis: axis(|mark| mark.y),
            label: tick_label,
        },
        zeros: String::new(),
        front: Vec::new(),
        curves,
        legend,
        marks,
    }
}
