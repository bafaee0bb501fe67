//! Shadow methods side by side: what each takes to prepare, and a ray, cold and warm.
//!
//! The shadow queries of a picture are recorded once and asked of every method, over the grid with the exact
//! test, in one thread. The first pass prepares what is prepared when it is first asked for; afterwards
//! all methods take turns, and of each the median counts. Work is counted as for the paper's table, in
//! instructions or CPU time of the one thread, so that other programs disturb little. All must give the
//! same answers. *Pays after* is the number of rays a light beyond which build and first pass are won
//! back, compared with `trace`.
//!
//! `cargo bench --bench methods`, and `-- NAME WxH` for scenes whose names hold NAME, and another size than 320 by 240; the
//! real scenes are looked for in `UMBRA_SCENES` or `../shared/scenes`. It ends with a table of all scenes.

mod common;

use std::path::{Path, PathBuf};

use common::{folder, median, roomy, short};
use umbra::measure::paper::Meter;
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, BuildOptions, Test, build};
use umbra::render::{Order, Progress, Settings};
use umbra::scene::{Scene, load};
use umbra::shadow::{Answer, Combination, Method, Prepared, ShadowTally, VerdictKind, prepare};

/// Passes over all rays of each method, the first apart.
const PASSES: usize = 5;

const SCENES: [&str; 8] = [
    "jittered-sparse",
    "jittered-dense",
    "drum",
    "chair-room",
    "scenes/stadium.toml",
    "sponza.glb",
    "delft.obj",
    "bigtujunga.glb",
];

/// Every memory alone, every verdict alone, and every verdict before the paper's best memory.
fn combinations() -> Vec<Combination> {
    let mut all: Vec<Combination> = Method::ALL.map(Combination::from).to_vec();
    all.extend(VerdictKind::ALL.map(Combination::from));
    let before_a_memory =
        |kind| Combination { method: Method::CacheTree, ..Combination::from(kind) };
    all.extend(VerdictKind::ALL.map(before_a_memory));
    all
}

/// A built-in scene, one of this repository, or a real one.
fn find(name: &str) -> Option<PathBuf> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    match name.rsplit_once('.') {
        None => Some(PathBuf::from(name)),
        Some(_) => [here.join(name), folder().join(name)].into_iter().find(|path| path.is_file()),
    }
}

struct Row<'a> {
    name: Combination,
    prepared: Box<dyn Prepared + 'a>,
    build: u64,
    first: u64,
    passes: Vec<u64>,
}

impl Row<'_> {
    fn median(&self) -> f64 {
        median(self.passes.iter().map(|&pass| pass as f64).collect())
    }
}

fn metered<T>(meter: &Meter, work: impl FnOnce() -> T) -> (T, u64) {
    let before = meter.read().expect("the count goes on");
    let done = work();
    (done, meter.read().expect("the count goes on") - before)
}

/// Prints the table of a scene; what a ray costs by each method once all is built, in the order of [`combinations`].
fn measure(scene: &Scene, settings: &Settings) -> Vec<f64> {
    let recording =
        Recording::of(scene, settings, &Progress::default()).expect("settings are good");
    let rays = recording.queries().len();
    let engine = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default());
    let engine = engine.expect("the grid is always there");
    let meter = Meter::start();
    let mut expected = None;
    let mut rows: Vec<Row<'_>> = combinations()
        .into_iter()
        .map(|name| {
            let (prepared, build) = metered(&meter, || {
                prepare(roomy(name), scene, &*engine).expect("the combination makes sense")
            });
            let (answers, first) = metered(&meter, || recording.answers(&*prepared));
            assert!(*expected.get_or_insert_with(|| answers.clone()) == answers, "{name} differs");
            Row { name, prepared, build, first, passes: Vec::new() }
        })
        .collect();
    for pass in 0..PASSES {
        for turn in 0..rows.len() {
            let which = (turn + pass) % rows.len();
            let row = &mut rows[which];
            row.passes.push(metered(&meter, || recording.answers(&*row.prepared)).1);
        }
    }
    let blocked = expected.iter().flatten().filter(|blocked| **blocked).count();
    println!(
        "\n{}: {} triangles, {} lights, {rays} rays, {:.1} % blocked; in {}\n",
        scene.name,
        scene.triangles.len(),
        scene.lights.len(),
        100.0 * blocked as f64 / rays as f64,
        meter.unit().name(),
    );
    println!(
        "| method | build, million | first pass, a ray | then, a ray | of trace | lit | blocked | pays after, rays a light | MiB |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let trace = rows[0].median();
    for row in &rows {
        let saved = trace - row.median();
        let invested = row.build as f64 + (row.first as f64 - row.median()).max(0.0);
        let pays = match saved > 0.0 {
            _ if row.name == Combination::default() => String::new(),
            false => "never".to_owned(),
            true => format!("{:.0}", invested / saved * rays as f64 / scene.lights.len() as f64),
        };
        let tally = settled(&recording, &*row.prepared);
        println!(
            "| `{}` | {:.0} | {:.0} | {:.0} | {:.2} | {:.0} % | {:.0} % | {pays} | {:.1} |",
            row.name,
            row.build as f64 / 1e6,
            row.first as f64 / rays as f64,
            row.median() / rays as f64,
            row.median() / trace,
            100.0 * tally.verdict_lit as f64 / rays as f64,
            100.0 * tally.verdict_blocked as f64 / rays as f64,
            row.prepared.memory() as f64 / f64::from(1 << 20),
        );
    }
    rows.iter().map(|row| row.median() / rays as f64).collect()
}

/// What verdicts settle of the recorded queries.
fn settled(recording: &Recording, prepared: &dyn Prepared) -> ShadowTally {
    let mut worker = prepared.worker();
    let (mut asked, mut answers) = (Vec::new(), Vec::new());
    for (light, run) in recording.runs() {
        asked.clear();
        asked.extend(recording.queries()[run].iter().map(|recorded| recorded.query));
        answers.resize(asked.len(), Answer::default());
        worker.answer(light, &asked, &mut answers);
    }
    worker.tally()
}

fn parse_size(word: &str) -> Option<(u32, u32)> {
    let (width, height) = word.split_once('x')?;
    Some((width.parse().ok()?, height.parse().ok()?))
}

fn main() {
    let words: Vec<String> =
        std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let mut sizes = words.iter().filter_map(|word| parse_size(word));
    let names: Vec<&String> = words.iter().filter(|word| parse_size(word).is_none()).collect();
    let (width, height) = sizes.next().unwrap_or((320, 240));
    let settings = Settings { width, height, order: Order::Tiles, ..Settings::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut summary = Vec::new();
    for name in SCENES {
        if !names.is_empty() && !names.iter().any(|wanted| name.contains(*wanted)) {
            continue;
        }
        let Some(path) = find(name) else {
            eprintln!("*** NOT MEASURED: {name} is absent; set UMBRA_SCENES ***");
            continue;
        };
        let scene = load(path.to_str().expect("scene names are text")).expect("it loads");
        summary.push((scene.name.clone(), pool.install(|| measure(&scene, &settings))));
    }
    let heads: Vec<String> = combinations().iter().map(|name| format!("`{name}`")).collect();
    println!("\nA ray, once all is built:\n\n| scene | {} |", heads.join(" | "));
    println!("|{}", " --- |".repeat(1 + heads.len()));
    for (scene, rays) in summary {
        let rays: Vec<String> = rays.into_iter().map(short).collect();
        println!("| {scene} | {} |", rays.join(" | "));
    }
}
