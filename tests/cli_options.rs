//! Options on the command line: numbers that are none, and options that would change nothing.

mod common;

use std::fs;

use common::command::{TRIANGLE, refused, run, said, umbra};
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), TRIANGLE).unwrap();
    fs::write(folder.path().join("rays.csv"), "1,1,1,1,1,-1\n").unwrap();
    folder
}

#[test]
fn a_negative_number_is_a_value_of_its_option() {
    let folder = folder();
    for (line, told) in [
        ("render triangle.obj -o new.png --samples -1", ["--samples", "1 to 64"]),
        ("render triangle.obj -o new.png --exposure -0.5", ["--exposure", "above 0"]),
        ("compare triangle.obj --show -1", ["--show", "at least 0"]),
        ("tradeoff triangle.obj --repetitions -2", ["--repetitions", "at least 1"]),
        ("paper --every -9", ["--every", "at least 1"]),
        ("certify --queries -5", ["--queries", "at least 1"]),
        ("certify --seconds inf", ["--seconds", "a whole number of at least 1"]),
        ("scene drum -o new.obj --tessellation -1", ["-1", "0.01 and 100"]),
    ] {
        refused(folder.path(), line, &told);
        assert!(!said(&run(folder.path(), line)).contains("tip:"), "{line}");
    }
}

#[test]
fn options_that_would_change_nothing_are_refused() {
    for (arguments, told) in [
        ("--backend bvh2 --grid 8,8,8", ["--grid", "grid"]),
        ("--backend cwbvh --uniform", ["--uniform", "grid"]),
        ("--backend brute --lazy", ["--lazy", "grid"]),
        ("--backend embree --shadows woo --retest not-cell", ["--retest", "another engine"]),
        ("--reset-scanlines", ["--reset-scanlines", "--order scanline or serpentine"]),
        ("--reset-scanlines --order tiles", ["--reset-scanlines", "tiles"]),
        ("--shadows trace --retest not-triangles", ["--retest", "--shadows trace"]),
        ("--shadows shaft --retest not-cell", ["--retest", "--shadows shaft"]),
        ("--shadows object-cache --retest not-cell", ["--retest", "give voxel-cache"]),
        ("--shadows trace --tolerance 0.5", ["--tolerance", "give cache-tree-tolerance"]),
        ("--shadows object-cache --tolerance 0.5", ["--tolerance", "--shadows object-cache"]),
        ("--tolerance 0.5", ["--tolerance", "--shadows auto"]),
        ("--shadows trace --tree-depth 31", ["--tree-depth", "give cache-tree"]),
        ("--shadows voxel-cache --tree-depth 0", ["--tree-depth", "--shadows voxel-cache"]),
        (
            "--order scanline --reset-scanlines --shadows shaft",
            ["--reset-scanlines", "--shadows shaft"],
        ),
    ] {
        refused(folder().path(), &format!("render triangle.obj -o out.png {arguments}"), &told);
    }
    let folder = folder();
    for option in ["--bits 16", "--exposure 50"] {
        let line = format!("render triangle.obj -o out.exr {option}");
        let name = option.split(' ').next().unwrap();
        refused(folder.path(), &line, &[name, "EXR", "name a .png"]);
    }
    let line = "query triangle.obj --rays rays.csv -o out.csv --backend bvh2 --uniform";
    refused(folder.path(), line, &["--uniform", "grid"]);
    let line = "paper --quick --backends bvh2,cwbvh --uniform";
    refused(folder.path(), line, &["--uniform", "grid"]);
    if cfg!(feature = "embree") {
        let line = "compare drum --size 8x6 --backends grid --embree-variants all";
        refused(folder.path(), line, &["--embree-variants", "embree"]);
        let line = "paper --quick --backends embree --retest not-cell";
        refused(folder.path(), line, &["--retest", "another engine"]);
        let line = "render drum -o out.png --backend embree --tree-depth 2";
        refused(folder.path(), line, &["--tree-depth", "--shadows auto"]);
    }
}

#[test]
fn options_that_may_change_something_are_taken() {
    let folder = folder();
    for arguments in [
        "--order scanline --reset-scanlines",
        "--tree-depth 2 --retest not-cell",
        "--shadows trace --self-shadow exclude --retest not-triangles",
        "--shadows object-cache --retest not-triangles",
        "--shadows cache-tree-tolerance --tree-depth 2 --tolerance 0.5",
        "--shadows trace --tolerance 0.05 --retest again",
    ] {
        let line = format!("render triangle.obj -o out.png --size 8x6 {arguments}");
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{arguments}: {}", said(&output));
    }
}

#[test]
fn parts_of_a_message_about_arguments_do_not_run_together() {
    let folder = folder();
    for (line, told) in [
        ("frobnicate", "unrecognized subcommand 'frobnicate'; usage: umbra <COMMAND> (try --help)"),
        (
            "render triangle.obj",
            "were not provided: --output <FILE>; usage: umbra render --output <FILE> <SCENE> (try",
        ),
        ("render triangle.obj -o a.png --backend embre", "brute]; tip: a similar value exists"),
    ] {
        refused(folder.path(), line, &[told]);
    }
}

#[test]
fn the_help_has_an_example_of_every_command() {
    let help = String::from_utf8(run(folder().path(), "--help").stdout).unwrap();
    let (commands, examples) = help.split_once("Examples:").unwrap();
    let (_, commands) = commands.split_once("Commands:\n").unwrap();
    let names = commands.lines().map_while(|line| line.strip_prefix("  ")?.split(' ').next());
    let names: Vec<&str> = names.filter(|name| *name != "help").collect();
    assert!(names.len() >= 8, "{names:?}");
    for name in names {
        assert!(examples.contains(&format!("  umbra {name} ")), "{name}");
    }
}

#[test]
fn a_number_that_is_too_large_is_not_called_too_small() {
    let line = "certify --queries 99999999999999999999";
    refused(folder().path(), line, &["--queries", "too large", "a smaller"]);
}

#[test]
fn names_in_a_list_may_have_blanks_around_them() {
    let folder = folder();
    for arguments in [
        &["compare", "drum", "--size", "8x6", "--backends", "grid, bvh2 ", "--tests", "exact"][..],
        &["extremes", "--queries", "9", "--cases", "slivers, grazing", "--backends", "grid , bvh2"],
        &["certify", "--queries", "9", "--classes", "sliver, grazing"],
    ] {
        let output = umbra(folder.path()).args(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", said(&output));
    }
}
