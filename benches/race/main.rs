//! The shadow stage, preparation included, against the best Embree, in one thread.
//!
//! `cargo bench --bench race -- all` runs the whole comparison (the paper's four scenes with nine samples a pixel and with
//! one, and the ten real scenes with four lights and nine) and ends with its tables in Markdown. `-- SAMPLES SCENE…` runs
//! some scenes with SAMPLES×SAMPLES samples a pixel. Options:
//!
//! - `--lights N`: N lights in every scene; `common::lights` says which, and where those stand that are added.
//! - `--every N`: only every Nth tile of each picture is answered. Preparation is still charged by the number of queries of
//!   the whole picture; but what is built while queries are answered (by `light-buffer` and `auto`) is charged to those that
//!   are answered, so those look dearer than they are.
//!
//! The queries of each part of the picture go to all racers in turn, as the renderer asks them: tile by tile, and light by light
//! within. Embree runs in every way that was ever the fastest: single rays and packets, coherent or
//! not, default and robust, low, medium and high quality, and packets over rays that were sorted by place; the best one is the
//! measure. It has what is opaque only, and reads triangles where they lie. Times are of this process's CPU, so what else the machine
//! does disturbs little; the ratio to the best Embree is given for the whole, and its quartiles over the parts without
//! preparation. Ours stand before a grid that is there already, for rays that see; the tables also have `auto` with the grid's
//! building.

#[path = "../common/mod.rs"]
mod common;

mod bounds;
mod racers;
mod table;

use std::path::Path;

use common::runs::Run;
use common::{REAL_SCENES, lights, path_of};
use racers::{Built, Racer, Ready, least};
use table::{Figures, Outcome};
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Test, build};
use umbra::render::{Settings, record};
use umbra::scene::{Scene, builtin, load};
use umbra::shadow::Trace;

/// Queries of a part, at least: what a tile asks to all lights, for a renderer asks while that is in the nearer caches.
const PART: usize = 20_000;

const PAPER_SCENES: [&str; 4] = ["chair-room", "drum", "jittered-dense", "jittered-sparse"];

const USAGE: &str = "cargo bench --bench race -- all, or -- [--lights N] [--every N] SAMPLES SCENE…, like 3 drum chair-room";

/// Scenes that are raced alike, and make a table.
struct Group {
    title: String,
    /// Along a pixel's side.
    samples: u32,
    /// In each scene; those it has, if not given.
    lights: Option<usize>,
    scenes: Vec<String>,
}

fn main() {
    let (mut lights, mut every, mut words) = (None, 1, Vec::new());
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(argument) = arguments.next() {
        let mut number =
            || arguments.next().and_then(|text| text.parse::<usize>().ok()).expect(USAGE);
        match &*argument {
            "--lights" => lights = Some(number()),
            "--every" => every = number().max(1),
            _ => words.push(argument),
        }
    }
    // What is built, too, is built by one thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let bounds = bounds::measure();
    println!("{bounds}\n");
    for group in groups(words, lights) {
        let mut outcomes = Vec::new();
        for name in &group.scenes {
            match load(path_of(name)) {
                Ok(mut scene) => {
                    if let Some(count) = group.lights {
                        lights::give(&mut scene, count);
                    }
                    let name = Path::new(name)
                        .file_stem()
                        .map_or(&**name, |stem| stem.to_str().unwrap_or(name));
                    let outcome = pool.install(|| race(&scene, group.samples, every));
                    let outcome = Outcome { scene: name.to_owned(), ..outcome };
                    println!("{outcome}");
                    outcomes.push(outcome);
                }
                Err(error) => eprintln!("*** NOT MEASURED: {error} ***"),
            }
        }
        if !outcomes.is_empty() {
            println!("{}\n\n{}", group.title, table::markdown(&outcomes, &bounds));
        }
    }
}

/// What is asked for; among all benches, a look at the smallest scene.
fn groups(words: Vec<String>, lights: Option<usize>) -> Vec<Group> {
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let group = |samples: u32, lights: Option<usize>, scenes: Vec<String>| {
        let all = samples * samples;
        let samples_said = format!("{all} {} a pixel", if all == 1 { "sample" } else { "samples" });
        let title = match lights {
            Some(count) => format!("{samples_said}, {count} lights:"),
            None => format!("{samples_said}:"),
        };
        Group { title, samples, lights, scenes }
    };
    match words.split_first() {
        None => vec![group(1, lights, names(&["chair-room"]))],
        Some((all, [])) if all == "all" => vec![
            group(3, lights, names(&PAPER_SCENES)),
            group(1, lights, names(&PAPER_SCENES)),
            group(3, lights.or(Some(4)), names(&REAL_SCENES)),
        ],
        Some((samples, scenes)) => {
            vec![group(samples.parse().expect(USAGE), lights, scenes.to_vec())]
        }
    }
}

/// Lets all racers answer a picture, or every so many tiles of it.
fn race(scene: &Scene, samples: u32, every: usize) -> Outcome {
    let defaults = Settings::default();
    let (width, height) = builtin::view(&scene.name)
        .map_or((defaults.width, defaults.height), |view| (view.width, view.height));
    let settings = Settings { width, height, samples, ..defaults };
    let options = BuildOptions::default();
    let (grid, grid_nanoseconds) =
        least(|| build(Backend::Grid, Test::Exact, &scene.triangles, &options).expect("the grid"));
    let embrees = racers::embrees(scene);
    let ours = racers::ours(scene, &*grid, &settings, every);
    let mut racers: Vec<Racer> = embrees.iter().flat_map(Built::racers).collect();
    racers.extend(ours.iter().map(Ready::racer));

    let mut part: Vec<Run> = Vec::new();
    let count_of = |runs: &[Run]| runs.iter().map(|run| run.queries.len()).sum::<usize>();
    let (mut tile, mut all, mut asked, mut turn) = (0, 0, 0, 0);
    let mut run = |part: &mut Vec<Run>| {
        let count = racers.len();
        for place in 0..count {
            racers[(place + turn) % count].run(part);
        }
        asked += count_of(part);
        turn += 1;
        part.clear();
    };
    // The default mode is the fastest that sees.
    let embree = build(Backend::Embree, Test::Moller, &scene.triangles, &options);
    let seeing: &dyn Occlusion = embree.as_ref().map_or(&*grid, |embree| &**embree);
    let recorded = record(scene, seeing, &Trace::new(seeing), &settings, |unit| {
        all += unit.len();
        tile += 1;
        if tile % every == 0 {
            part.extend(Run::all(&unit));
        }
        if count_of(&part) >= PART {
            run(&mut part);
        }
    });
    recorded.expect("the settings are good");
    if !part.is_empty() {
        run(&mut part);
    }
    let figures: Vec<Figures> = racers.into_iter().map(Racer::figures).collect();
    let mut ours = figures.iter().filter(|figures| !figures.embree).map(|figures| figures.blocked);
    let first = ours.next();
    assert!(ours.all(|blocked| Some(blocked) == first), "ours are exact, and agree");
    Outcome {
        scene: scene.name.clone(),
        triangles: scene.triangles.len(),
        lights: scene.lights.len(),
        settings,
        asked,
        all,
        grid_nanoseconds,
        figures,
    }
}
