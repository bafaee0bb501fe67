//! The grid against Embree's single ray: the time of a shadow ray and of a ray that sees, building, memory.
//!
//! `cargo bench --bench grid -- SCENE…` (built-in names, files, or names of real scenes; without any, all of both)
//! records the shadow queries of a picture, as the renderer asks them, and hands them, part by part, to all racers
//! in turn; then the rays of the eye. Times are of this thread's CPU; of each part the least of a few rounds counts,
//! so that neither a machine that is shared nor one that slows down favours anyone. Structures are built in turns by
//! two threads, and the median counts. *Ratio* is the time over that of Embree's single ray in its default mode at
//! medium quality: below 1 it is faster.

mod common;

use std::time::Instant;

use common::{REAL_SCENES, median, path_of, short};
use glam::DVec2;
use umbra::geometry::Ray;
use umbra::measure::paper::thread_time;
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, BuildOptions, GridOptions, Occlusion, Tally, Test, build};
use umbra::render::{Progress, Settings};
use umbra::scene::{Scene, builtin, load};

/// Rays of each kind and scene.
const RAYS: usize = 60_000;

/// Rays in a part: a millisecond or less, in which a thread is seldom interrupted.
const PART: usize = 2000;

/// Rounds over the parts.
const ROUNDS: usize = 5;

/// Times that everything is built.
const BUILDS: usize = 5;

/// Threads that build.
const THREADS: usize = 2;

/// Pixels across and down where the scene does not say.
const SIZE: (u32, u32) = (640, 486);

const BUILT_IN: [&str; 4] = ["jittered-sparse", "jittered-dense", "drum", "chair-room"];

/// Who runs; the first is the measure.
const RACERS: [(&str, Backend, Test, bool); 6] = [
    ("embree", Backend::Embree, Test::Moller, true),
    ("embree robust", Backend::Embree, Test::Pluecker, true),
    ("grid", Backend::Grid, Test::Exact, true),
    ("uniform grid", Backend::Grid, Test::Exact, false),
    ("bvh2", Backend::Bvh2, Test::Exact, true),
    ("cwbvh", Backend::Cwbvh, Test::Exact, true),
];

fn main() {
    let named: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let all = BUILT_IN.iter().chain(&REAL_SCENES).map(|&name| name.to_owned());
    let scenes: Vec<String> = if named.is_empty() { all.collect() } else { named };
    let mut outcomes = Vec::new();
    for name in &scenes {
        match load(path_of(name)) {
            Ok(scene) => outcomes.push(race(&scene, name)),
            Err(error) => eprintln!("*** NOT MEASURED: {error} ***"),
        }
    }
    if !outcomes.is_empty() {
        println!("\n{}", markdown(&outcomes));
    }
}

/// What came of a race over one scene.
struct Outcome {
    scene: String,
    triangles: usize,
    /// Nanoseconds of a shadow ray in Embree.
    embree: f64,
    /// Of each racer, over Embree's.
    ratios: Vec<[f64; MEASURES.len()]>,
}

/// What the table shows of whom: a place in `RACERS` and one in `MEASURES`.
const COLUMNS: [(usize, usize); 8] =
    [(2, 0), (2, 1), (2, 2), (2, 3), (1, 0), (3, 0), (4, 0), (5, 0)];

/// Ratios of all scenes, their medians and the largest of each.
fn markdown(outcomes: &[Outcome]) -> String {
    let heads = COLUMNS.map(|(who, what)| format!("{}: {}", RACERS[who].0, MEASURES[what]));
    let mut lines = vec![
        format!("| scene | triangles | embree, ns | {} |", heads.join(" | ")),
        format!("|{}", " --- |".repeat(3 + COLUMNS.len())),
    ];
    let row = |first: String, ratio: &dyn Fn(usize, usize) -> f64| {
        let ratios = COLUMNS.map(|(who, what)| format!("{:.2}", ratio(who, what)));
        format!("| {first} | {} |", ratios.join(" | "))
    };
    for Outcome { scene, triangles, embree, ratios } in outcomes {
        let first = format!("{scene} | {triangles} | {}", short(*embree));
        lines.push(row(first, &|who, what| ratios[who][what]));
    }
    let of_all = |who: usize, what: usize| outcomes.iter().map(move |one| one.ratios[who][what]);
    lines.push(row("median | |".to_owned(), &|who, what| median(of_all(who, what).collect())));
    lines.push(row("largest | |".to_owned(), &|who, what| of_all(who, what).fold(0.0, f64::max)));
    lines.join("\n")
}

/// What ratios are taken of.
const MEASURES: [&str; 4] = ["shadow", "nearest", "build", "memory"];

/// Every so many parts of all, so that about `RAYS` are left.
fn spread(rays: Vec<Ray>) -> Vec<Ray> {
    let step = (rays.len() / RAYS).max(1);
    rays.chunks(PART).step_by(step).flatten().copied().collect()
}

fn shadow_rays(scene: &Scene, settings: &Settings) -> Vec<Ray> {
    let recording =
        Recording::of(scene, settings, &Progress::default()).expect("the settings are good");
    spread(recording.rays().copied().collect())
}

/// Rays of the eye in tiles of 16 by 16.
fn seeing_rays(scene: &Scene, settings: &Settings) -> Vec<Ray> {
    const TILE: u32 = 16;
    let (width, height) = (settings.width, settings.height);
    let size = DVec2::new(f64::from(width), f64::from(height));
    let mut rays = Vec::new();
    for tile_y in (0..height).step_by(TILE as usize) {
        for tile_x in (0..width).step_by(TILE as usize) {
            for y in tile_y..(tile_y + TILE).min(height) {
                for x in tile_x..(tile_x + TILE).min(width) {
                    let place = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / size;
                    rays.push(scene.camera.ray(place, size.x / size.y));
                }
            }
        }
    }
    spread(rays)
}

struct Racer {
    engine: Box<dyn Occlusion>,
    build: f64,
    shadow: f64,
    nearest: f64,
    tally: Tally,
    blocked: usize,
}

fn race(scene: &Scene, name: &str) -> Outcome {
    let defaults = Settings { width: SIZE.0, height: SIZE.1, ..Settings::default() };
    let (width, height) =
        builtin::view(&scene.name).map_or(SIZE, |view| (view.width.min(SIZE.0), view.height));
    let settings = Settings { width, height, ..defaults };
    let (shadow, seeing) = (shadow_rays(scene, &settings), seeing_rays(scene, &settings));

    let mut racers = built(scene);
    for rays in shadow.chunks(PART) {
        let least = turns(&mut racers, |racer| {
            let mut blocked = vec![false; rays.len()];
            racer.tally = Tally::default();
            racer.engine.occluded_many(rays, &mut blocked, &mut racer.tally);
            racer.blocked = blocked.iter().filter(|blocked| **blocked).count();
        });
        racers.iter_mut().zip(least).for_each(|(racer, time)| racer.shadow += time);
    }
    for rays in seeing.chunks(PART) {
        let least = turns(&mut racers, |racer| {
            for ray in rays {
                std::hint::black_box(racer.engine.nearest(ray, &mut Tally::default()));
            }
        });
        racers.iter_mut().zip(least).for_each(|(racer, time)| racer.nearest += time);
    }

    println!("{name}: {} triangles, {} shadow rays", scene.triangles.len(), shadow.len());
    let measure = |racer: &Racer| {
        let (shadows, seen) = (shadow.len() as f64, seeing.len() as f64);
        let memory = racer.engine.memory() as f64;
        [racer.shadow / shadows, racer.nearest / seen, racer.build, memory]
    };
    let first = measure(&racers[0]);
    let mut all = Vec::new();
    for ((name, ..), racer) in RACERS.iter().zip(&racers) {
        let these = measure(racer);
        let ratios: [f64; MEASURES.len()] = std::array::from_fn(|i| these[i] / first[i]);
        // All of them, not of the last part alone.
        let mut tally = Tally::default();
        let mut blocked = vec![false; shadow.len()];
        racer.engine.occluded_many(&shadow, &mut blocked, &mut tally);
        let [shadow, nearest, build, memory] = these;
        let rays = blocked.len() as f64;
        println!(
            "  {name:14}{shadow:8.0} ns ({:5.2}){nearest:8.0} ns ({:5.2}){:9.1} ms ({:5.2}){:8.1} MB ({:5.2}){:7.1} cells{:7.1} tests{:7} blocked",
            ratios[0],
            ratios[1],
            build * 1e3,
            ratios[2],
            memory / 1e6,
            ratios[3],
            tally.cells as f64 / rays,
            tally.triangle_tests as f64 / rays,
            blocked.iter().filter(|blocked| **blocked).count(),
        );
        all.push(ratios);
    }
    let triangles = scene.triangles.len();
    Outcome { scene: scene.name.clone(), triangles, embree: first[0], ratios: all }
}

/// Everything, built in turns.
fn built(scene: &Scene) -> Vec<Racer> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().expect("two threads");
    let mut times = vec![Vec::new(); RACERS.len()];
    let mut engines = Vec::new();
    for _ in 0..BUILDS {
        engines.clear();
        for (&(_, backend, test, nested), times) in RACERS.iter().zip(&mut times) {
            let grid = GridOptions { nested, ..GridOptions::default() };
            let options = BuildOptions { grid, ..BuildOptions::default() };
            let start = Instant::now();
            let engine = pool.install(|| build(backend, test, &scene.triangles, &options));
            engines.push(engine.expect("Embree is there"));
            times.push(start.elapsed().as_secs_f64());
        }
    }
    let racer = |(engine, times)| Racer {
        engine,
        build: median(times),
        shadow: 0.0,
        nearest: 0.0,
        tally: Tally::default(),
        blocked: 0,
    };
    engines.into_iter().zip(times).map(racer).collect()
}

/// Nanoseconds of each racer: the least of some rounds.
fn turns(racers: &mut [Racer], mut run: impl FnMut(&mut Racer)) -> Vec<f64> {
    let mut least = vec![u64::MAX; racers.len()];
    for round in 0..ROUNDS {
        for place in 0..racers.len() {
            let turn = (place + round) % racers.len();
            let start = thread_time();
            run(&mut racers[turn]);
            least[turn] = least[turn].min(thread_time() - start);
        }
    }
    least.into_iter().map(|time| time as f64).collect()
}
