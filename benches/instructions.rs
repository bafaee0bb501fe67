//! Instructions a query of the inner loops, counted by Callgrind: the same in every run, on any machine.
//!
//! `cargo bench --bench instructions` runs itself again under Valgrind, and prints a table. Each loop answers the
//! shadow queries of a small picture, once before counting, so that what is built lazily is there. Valgrind's
//! processor has AVX2 and no AVX-512. Without Valgrind this fails; among all benches it says so and lets the others go on.
//! The last row is a test of eight triangles that a ray misses, exact.

mod common;

use std::path::Path;
use std::process::{Command, ExitCode};

use common::roomy;
use common::runs::{Run, blocked_by_engine, blocked_by_worker};
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::measure::paper::{Callgrind, Meter, callgrind};
use umbra::occlusion::{
    Backend, BuildOptions, Embree, EmbreeOptions, Occlusion, Tally, Test, WIDTH, build,
};
use umbra::render::{Settings, record};
use umbra::scene::{Scene, builtin};
use umbra::shadow::{Combination, Trace, prepare};

/// Scenes, and their multiple of the paper's triangles: building is slow under Valgrind.
const SCENES: [(&str, f64); 3] = [("chair-room", 1.0), ("drum", 1.0), ("jittered-dense", 0.1)];

/// Methods whose loops are counted, over the grid.
const METHODS: [&str; 3] = ["shaft", "light-buffer", "shaft+light-buffer"];

/// Says to whom runs under Valgrind where it writes.
const FOLDER: &str = "UMBRA_CALLGRIND_FOLDER";

fn main() -> ExitCode {
    match std::env::var_os(FOLDER) {
        Some(folder) => count(Path::new(&folder)),
        None => run_under_callgrind(),
    }
}

/// Runs this program again, under Valgrind.
fn run_under_callgrind() -> ExitCode {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = std::env::current_exe().expect("this program has a name");
    let [valgrind, options @ ..] = callgrind(folder.path());
    let command =
        Command::new(valgrind).args(options).arg(program).env(FOLDER, folder.path()).status();
    match command {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(status) => {
            eprintln!("instructions: Valgrind ended early: {status}");
            ExitCode::FAILURE
        }
        Err(_) => {
            eprintln!(
                "*** NOT MEASURED: Valgrind is not installed; install it (Debian, Ubuntu: apt install valgrind) ***"
            );
            if among_all_benches() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
    }
}

/// Whether Cargo runs this among all benches, and not because it was asked for by name. Cargo does not tell its children;
/// its own command line does. Where that cannot be read, this was asked for.
fn among_all_benches() -> bool {
    let parent = format!("/proc/{}/cmdline", std::os::unix::process::parent_id());
    let line = std::fs::read(parent).unwrap_or_default();
    let words: Vec<&[u8]> = line.split(|&byte| byte == 0).collect();
    let named = |word: &&[u8]| word.ends_with(env!("CARGO_CRATE_NAME").as_bytes());
    words.contains(&&b"bench"[..]) && !words.iter().any(named)
}

fn count(folder: &Path) -> ExitCode {
    let Some(callgrind) = Callgrind::start(folder) else {
        eprintln!("instructions: {FOLDER} is set, but this does not run under Valgrind");
        return ExitCode::FAILURE;
    };
    let meter = Meter::Callgrind(callgrind);
    println!("| scene | queries | loop | instructions a query |");
    println!("| --- | --- | --- | --- |");
    for (name, tessellation) in SCENES {
        let draft = builtin::draft_at(name, tessellation).expect("it is built in");
        count_scene(&meter, &draft.finish().expect("it is whole"));
    }
    count_test(&meter);
    ExitCode::SUCCESS
}

/// Instructions of some work.
fn instructions(meter: &Meter, work: impl FnOnce()) -> u64 {
    let before = meter.read().expect("Callgrind counts");
    work();
    meter.read().expect("Callgrind counts") - before
}

fn count_scene(meter: &Meter, scene: &Scene) {
    let settings = Settings { width: 96, height: 72, ..Settings::default() };
    let grid = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default());
    let grid = grid.expect("the grid");
    let embree = Embree::new(scene.triangles.clone(), false, EmbreeOptions::default());
    let embree = embree.expect("Embree");
    let mut runs: Vec<Run> = Vec::new();
    record(scene, &embree, &Trace::new(&embree), &settings, |unit| runs.extend(Run::all(&unit)))
        .expect("the settings make a picture");
    let queries: usize = runs.iter().map(|run| run.queries.len()).sum();
    let row = |name: &str, all: u64| {
        println!("| {} | {queries} | {name} | {} |", scene.name, all / queries as u64);
    };
    let engines: [(&str, &dyn Occlusion); 2] =
        [("grid walk, exact", &*grid), ("Embree, single, default mode", &embree)];
    for (name, engine) in engines {
        let ask = || {
            blocked_by_engine(engine, &runs);
        };
        ask();
        row(name, instructions(meter, ask));
    }
    for name in METHODS {
        let combination: Combination = name.parse().expect("a method");
        let prepared = prepare(roomy(combination), scene, &*grid).expect("it goes with the grid");
        let mut worker = prepared.worker();
        let mut ask = || {
            blocked_by_worker(&mut *worker, &runs);
        };
        ask();
        row(name, instructions(meter, ask));
    }
}

/// A ray among triangles that it misses, by brute force: what is left are tests of eight.
fn count_test(meter: &Meter) {
    const EIGHTS: usize = 1000;
    const RAYS: usize = 100;
    let fan = (0..EIGHTS * WIDTH).map(|number| {
        let turn = number as f32 * 0.01;
        let [x, y] = [2.0 + turn.cos(), 2.0 + turn.sin()];
        let [a, b] = [[x, y, 1.0], [x + 0.1, y, 1.0]];
        [a, b, [x, y + 0.1, 1.0]].map(glam::Vec3::from_array) as Triangle
    });
    let triangles = std::sync::Arc::new(fan.collect::<Triangles>());
    let brute = build(Backend::Brute, Test::Exact, &triangles, &BuildOptions::default());
    let brute = brute.expect("brute force");
    let rays: Vec<Ray> = (0..RAYS)
        .map(|number| {
            let origin = glam::Vec3::new(0.001 * number as f32, 0.0, 0.0);
            Ray::between(origin, glam::Vec3::new(0.0, 0.1, 2.0))
        })
        .collect();
    let mut blocked = vec![false; RAYS];
    let all = instructions(meter, || {
        brute.occluded_many(&rays, &mut blocked, &mut Tally::default());
    });
    assert!(blocked.iter().all(|blocked| !blocked), "all are missed");
    println!(
        "| eights | {RAYS} | test of eight triangles, exact | {} |",
        all / (EIGHTS * RAYS) as u64
    );
}
