//! `umbra tradeoff`: what it writes is well formed, and its numbers are those of `umbra compare`.

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use common::command::{refused, run, said};
use serde_json::Value;
use tempfile::TempDir;

/// A floor below needles so thin that f32 hardly knows where they are, and a light above.
const NEEDLES: &str = "
[camera]
position = [0, 6, 9]
target = [0, 0, 0]
field_of_view = 40

[materials.grey]
diffuse = [0.6, 0.6, 0.6]

[[mesh]]
quads = [[[-5, 0, 5], [5, 0, 5], [5, 0, -5], [-5, 0, -5]]]
material = \"grey\"

[[mesh]]
file = \"needles.obj\"
material = \"grey\"

[[light]]
kind = \"point\"
position = [0.3, 8, 0.2]
intensity = [40, 40, 40]
";

/// A folder with a scene on which every f32 test errs.
fn workplace() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    // Across both axes, so that what is rounded at the far ends matters in the middle.
    let (length, width) = (3e4, 0.02);
    let mut needles = String::new();
    for number in 0..300 {
        let z = -7.0 + f64::from(number) * 14.0 / 300.0;
        let (y, near, far) =
            (2.0 + 0.01 * f64::from(number % 7), z - 0.7 * length, z + 0.7 * length);
        needles += &format!("v {} {y} {near}\nv {length} {y} {far}\n", -length);
        needles += &format!("v {length} {y} {}\nf -3 -2 -1\n", far + width);
    }
    fs::write(folder.path().join("needles.obj"), needles).unwrap();
    fs::write(folder.path().join("needles.toml"), NEEDLES).unwrap();
    folder
}

/// Runs a command line that must succeed.
fn succeeded(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    assert!(output.status.success(), "umbra {line}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_str(&read(folder, name)).unwrap()
}

const ALL_FILES: &str = "--html out.html --svg out.svg --csv out.csv --stats out.json";

/// Elements that have no end in HTML, and are closed where they begin here.
fn assert_balanced(document: &str) {
    let mut open = Vec::new();
    let mut rest = document;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        if rest.starts_with("!DOCTYPE") {
            continue;
        }
        let end = rest.find('>').expect("a tag ends");
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "</{name}> closes something else");
        } else if !tag.ends_with('/') {
            let name = tag.split_whitespace().next().expect("a tag has a name");
            assert_eq!(tag.matches('"').count() % 2, 0, "<{tag}>");
            open.push(name);
            // What is in a script or a style sheet is no markup.
            if ["script", "style"].contains(&name) {
                rest = &rest[rest.find("</").expect("it ends")..];
            }
        }
    }
    assert_eq!(open, [""; 0], "left open");
}

#[test]
fn all_four_files_are_well_formed_and_agree() {
    let folder = workplace();
    let folder = folder.path();
    let table = succeeded(
        folder,
        &format!("tradeoff needles.toml --quick --size 64x48 --repetitions 2 {ALL_FILES}"),
    );
    let (html, svg) = (read(folder, "out.html"), read(folder, "out.svg"));
    assert_balanced(&svg);
    assert_balanced(&html);
    let report = json(folder, "out.json");
    let engines = report["engines"].as_array().unwrap();
    assert!(engines.len() >= 24, "{}", engines.len());

    let csv = read(folder, "out.csv");
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<BTreeMap<&str, &str>> = lines
        .map(|line| {
            assert_eq!(line.split(',').count(), head.len(), "{line}");
            head.iter().copied().zip(line.split(',')).collect()
        })
        .collect();
    let samples = report["samples"].as_array().unwrap();
    assert_eq!(rows.len(), engines.len() + samples.len(), "no tessellation of a file");
    assert!(table.contains("picture error: root") && !table.contains("surface error"), "{table}");
    for (row, point) in rows.iter().zip(engines) {
        assert_eq!((row["trade"], row["name"]), ("engines", point["name"].as_str().unwrap()));
        let agree = |column: &str, value: &Value| {
            let (in_csv, in_json) = (row[column].parse::<f64>().unwrap(), value.as_f64().unwrap());
            // Both are written so that they can be read back, but readers may err in the last bit.
            assert!((in_csv - in_json).abs() <= 1e-12 * in_json, "{column} of {row:?}");
        };
        agree("mrays_per_second", &point["mrays_per_second"]["median"]);
        agree("mrays_per_second_with_build", &point["mrays_per_second_with_build"]["median"]);
        agree("wrong_per_million", &point["wrong_per_million"]["share"]);
        agree("memory_bytes", &point["memory_bytes"]);
        // Every contender has its row in the table and on the page, and its mark in the charts.
        assert!(table.contains(row["name"]) && html.contains(row["name"]), "{}", row["name"]);
        assert!(svg.contains(&format!("<title>{}: ", row["name"])), "{}", row["name"]);
    }
}

#[test]
fn the_page_needs_no_network_and_no_other_file() {
    let folder = workplace();
    let folder = folder.path();
    succeeded(
        folder,
        &format!("tradeoff needles.toml --quick --size 40x30 --backends grid,bvh2 {ALL_FILES}"),
    );
    let html = read(folder, "out.html");
    let plain = html.replace("http://www.w3.org/2000/svg", "");
    for reference in ["http:", "https:", "//", "href=", "url(", "@import", "<link", "fetch("] {
        let found: Vec<&str> = plain
            .lines()
            .filter(|line| !line.trim_start().starts_with("//") && !line.contains(";base64,"))
            .filter(|line| line.contains(reference))
            .collect();
        assert!(found.is_empty(), "{reference}: {found:?}");
    }
    let sources = html.matches(" src=\"").count();
    assert_eq!(sources, html.matches(" src=\"data:image/png;base64,iVBOR").count());
    assert!(sources >= 6, "picture, exact shadows, differences, samples: {sources}");
    assert!(html.contains("umbra tradeoff needles.toml --quick"), "the command that made it");
    assert!(html.contains("width=device-width") && html.contains("prefers-color-scheme: dark"));
}

#[test]
fn wrong_answers_are_counted_as_compare_counts_them() {
    let folder = workplace();
    let folder = folder.path();
    let variants =
        if cfg!(feature = "embree") { "--embree-variants default,8" } else { "--samples 1" };
    let same = format!("needles.toml --size 160x120 --methods trace {variants}");
    succeeded(folder, &format!("tradeoff {same} --repetitions 1 --stats trade.json"));
    succeeded(folder, &format!("compare {same} --stats compare.json"));
    let (trade, compare) = (json(folder, "trade.json"), json(folder, "compare.json"));
    let rows = compare["contenders"].as_array().unwrap();
    let points = trade["engines"].as_array().unwrap();
    assert_eq!(points.len(), rows.len());
    let mut wrong = 0;
    for (point, row) in points.iter().zip(rows) {
        assert_eq!(point["name"], row["name"]);
        for kind in ["false_blocked", "false_clear"] {
            assert_eq!(point[kind], row[kind], "{kind} of {}", row["name"]);
            wrong += point[kind].as_u64().unwrap();
        }
        assert_eq!(point["ties"], row["ties_blocked"], "{}", row["name"]);
    }
    assert!(wrong > 1000, "the scene is hard for f32: {wrong}");
    let listed = trade["disagreements"].as_array().unwrap();
    assert!(!listed.is_empty());
    for disagreement in listed {
        assert_eq!(disagreement["bits"].as_str().unwrap().split(' ').count(), 7);
        assert!(["blocked", "clear", "tie"].contains(&disagreement["verdict"].as_str().unwrap()));
        for name in disagreement["by"].as_array().unwrap() {
            assert!(!name.as_str().unwrap().contains("exact"), "{disagreement}");
        }
    }
}

#[test]
fn exact_contenders_are_never_wrong_and_the_front_is_not_beaten() {
    let folder = workplace();
    let folder = folder.path();
    succeeded(folder, "tradeoff needles.toml --quick --size 160x120 --stats out.json");
    let report = json(folder, "out.json");
    let points: Vec<(f64, f64)> = report["engines"]
        .as_array()
        .unwrap()
        .iter()
        .map(|point| {
            let wrong = point["wrong_per_million"]["share"].as_f64().unwrap();
            assert!(point["test"] != "exact" || wrong == 0.0, "{point}");
            (point["mrays_per_second"]["median"].as_f64().unwrap(), wrong)
        })
        .collect();
    let front: Vec<usize> = report["fronts"]["warm"]
        .as_array()
        .unwrap()
        .iter()
        .map(|place| place.as_u64().unwrap() as usize)
        .collect();
    for (place, (speed, wrong)) in points.iter().enumerate() {
        let is_beaten =
            points.iter().any(|(s, w)| s >= speed && w <= wrong && (s > speed || w < wrong));
        assert_eq!(front.contains(&place), !is_beaten, "{}", report["engines"][place]["name"]);
    }
}

#[test]
fn more_triangles_and_more_samples_come_nearer_to_the_reference() {
    let folder = workplace();
    let folder = folder.path();
    succeeded(
        folder,
        &format!(
            "tradeoff chair-room --quick --size 64x48 --backends grid --tests exact --methods trace {ALL_FILES}"
        ),
    );
    let report = json(folder, "out.json");
    let errors = |trade: &str, error: &[&str]| -> Vec<f64> {
        let points = report[trade].as_array().unwrap().iter();
        points
            .map(|point| error.iter().fold(point, |value, part| &value[*part]).as_f64().unwrap())
            .collect()
    };
    for (trade, error) in [
        ("tessellations", &["picture_error", "levels"][..]),
        ("tessellations", &["deviation"]),
        ("tessellations", &["greatest_deviation"]),
        ("samples", &["picture_error", "levels"]),
    ] {
        let errors = errors(trade, error);
        assert!(errors.len() >= 3 && errors.is_sorted_by(|a, b| a > b), "{trade}: {errors:?}");
    }
    assert_balanced(&read(folder, "out.html"));
    let rows = read(folder, "out.csv").lines().count() - 1;
    assert_eq!(
        rows,
        1 + errors("tessellations", &["factor"]).len()
            + errors("samples", &["samples_per_pixel"]).len()
    );
}

#[test]
fn scenes_of_flat_surfaces_and_files_have_no_trade_of_tessellation_and_are_told_so() {
    let folder = workplace();
    let table = succeeded(
        folder.path(),
        "tradeoff needles.toml --quick --size 8x6 --backends bvh2 --tests exact",
    );
    assert!(table.contains("no trade of tessellation: a file has triangles only"), "{table}");
}

#[test]
fn bad_arguments_are_refused() {
    let folder = workplace();
    let refused = |arguments: &str, told: &[&str]| {
        refused(folder.path(), &format!("tradeoff needles.toml {arguments}"), told);
    };
    refused("--repetitions 0", &["--repetitions", "at least 1"]);
    refused("--threads 0", &["--threads", "1 to 1024"]);
    refused("--size 0x10", &["0x10", "at least 1"]);
    refused(
        "--backends embree --tests exact",
        &["nothing to measure", "embree has no test 'exact'"],
    );
    refused("--backends none", &["'none'", "--backends"]);
    refused("--html needles.toml", &["cannot write needles.toml"]);
    refused("--html out.html --svg out.html", &["cannot write out.html"]);
    refused("--csv missing/out.csv", &["there is no folder missing"]);
}
