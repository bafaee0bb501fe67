//! `umbra paper` as its users see it: the table, the variants, and instructions that Callgrind counts.

mod common;

use std::process::Command;

use common::command::{assert_refusal, refused, run, said, umbra};
use serde_json::Value;

/// Runs `umbra paper` on a small picture of the drum; gives what it printed and its JSON.
fn paper(options: &str) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let size = if options.contains("--size") { "" } else { "--size 32x24" };
    let line = format!("paper --quick {size} --scene drum --stats table.json {options}");
    let output = run(folder.path(), &line);
    assert!(output.status.success(), "umbra {line}: {}", said(&output));
    let json = std::fs::read(folder.path().join("table.json")).unwrap();
    (String::from_utf8(output.stdout).unwrap(), serde_json::from_slice(&json).unwrap())
}

fn has_valgrind() -> bool {
    Command::new("valgrind").arg("--version").output().is_ok_and(|output| output.status.success())
}

#[test]
fn the_table_stands_beside_the_papers() {
    let (text, json) = paper("--backends grid,bvh2,cwbvh");
    for row in ["2,230,193", "47.8 %", "76.9 %", "5.53 %", "2.7 %", "error: none over none"] {
        assert!(text.contains(row), "{row} is not in:\n{text}");
    }
    let columns = json["scenes"][0]["columns"].as_array().unwrap();
    assert_eq!(columns.len(), 3);
    for column in columns {
        assert_eq!(column["agree"], true);
        assert_eq!(column["rays"], columns[0]["rays"], "all engines see the same rays");
        assert_eq!(column["methods"].as_array().unwrap().len(), 5);
    }
}

#[test]
fn every_variant_makes_the_same_picture() {
    let (text, json) = paper("--backends grid --variants");
    assert_eq!(json["scenes"][0]["agree"], true);
    for variant in json["scenes"][0]["variants"].as_array().unwrap() {
        assert!(text.contains(variant["name"].as_str().unwrap()), "{variant} is not in:\n{text}");
    }
}

#[test]
fn variants_are_not_compared_with_pictures_of_no_tile() {
    let folder = tempfile::tempdir().unwrap();
    // Of 80x60 pixels there are 20 tiles, and 60 scanlines.
    let line = |every: u32| format!("paper --quick --scene drum --backends grid --every {every}");
    for every in [21, 48, 60] {
        refused(
            folder.path(),
            &format!("{} --variants", line(every)),
            &[&format!("every {every}"), "1 to 20", "tiles"],
        );
    }
    let told = ["every 61", "1 to 60", "scanlines"];
    refused(folder.path(), &format!("{} --variants", line(61)), &told);
    let (_, json) = paper("--size 80x60 --backends grid --every 20 --variants");
    for variant in json["scenes"][0]["variants"].as_array().unwrap() {
        assert!(variant["rays"].as_u64().unwrap() > 0, "{variant}");
    }
    // The table is made of scanlines alone.
    assert!(run(folder.path(), &line(60)).status.success());
}

#[test]
fn variants_are_compared_without_verdicts() {
    let folder = tempfile::tempdir().unwrap();
    let line = "paper --quick --verdicts shaft --variants";
    assert_refusal(&run(folder.path(), line), &["--variants", "cannot be used", "--verdicts"]);
}

#[test]
fn a_coarser_grid_has_more_success_with_its_voxels() {
    let rate = |options: &str| {
        let (_, json) = paper(&format!("--backends grid {options}"));
        json["scenes"][0]["columns"][0]["voxel_rate"].as_f64().unwrap()
    };
    assert!(rate("--uniform --grid 8,8,8") > rate(""));
}

#[test]
fn quick_leaves_what_is_asked_for() {
    let (text, _) = paper("--backends grid --tessellation 0.1 --repetitions 2 --every 24");
    assert!(text.contains("one scanline in 24"), "{text}");
    assert!(text.contains('±'), "two repetitions have a spread: {text}");
    let triangles = text.lines().find(|line| line.contains("triangles")).unwrap();
    let ours: u64 = triangles.split_whitespace().last().unwrap().replace(',', "").parse().unwrap();
    assert!((4_000..9_000).contains(&ours), "a tenth of 59,692 is not {ours}");
}

#[test]
fn callgrind_counts_the_same_every_time() {
    let line = "--backends grid,bvh2 --instructions";
    if !has_valgrind() {
        let folder = tempfile::tempdir().unwrap();
        let output = run(folder.path(), &format!("paper --quick {line}"));
        return assert_refusal(&output, &["Valgrind is not installed"]);
    }
    let counts = || {
        let (_, json) = paper(line);
        let scene = &json["scenes"][0];
        assert_eq!(scene["unit"], "callgrind-instructions");
        let columns = scene["columns"].as_array().unwrap().iter();
        let methods = columns.flat_map(|column| {
            let error = column["error"]["percent"].as_f64().unwrap();
            assert!(error.abs() < 0.01, "none over none: {error} %");
            column["methods"].as_array().unwrap().iter()
        });
        methods.map(|method| method["render"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    let (first, second) = (counts(), counts());
    assert_eq!(first, second);
    assert!(first.iter().all(|&count| count > 1_000_000), "{first:?}");
}

#[test]
fn without_valgrind_nothing_counts() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = umbra(folder.path());
    command.args(["paper", "--quick", "--instructions"]).env("PATH", folder.path());
    let told = ["Valgrind is not installed", "apt install valgrind"];
    assert_refusal(&command.output().unwrap(), &told);
    // Given by hand, outside Valgrind.
    let line = "paper --quick --instructions --callgrind-folder .";
    assert_refusal(&run(folder.path(), line), &["Valgrind"]);
    let line = "paper --quick --instructions --repetitions 2";
    assert_refusal(&run(folder.path(), line), &["--instructions", "--repetitions"]);
    assert!(folder.path().read_dir().unwrap().next().is_none(), "nothing is left behind");
}
