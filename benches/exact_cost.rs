//! What exactness costs: the exact test against `pluecker`, in the same engine, on the same shadow rays.
//!
//! The shadow rays of a picture of each of the ten real scenes are recorded once. Both tests then take turns
//! on them, so that a machine that slows down slows both; of each scene the median over the rounds counts,
//! and in the end the median over the scenes.
//!
//! `cargo bench --bench exact_cost`; the scenes are looked for in `UMBRA_SCENES` or `../shared/scenes`.

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use umbra::geometry::Ray;
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};
use umbra::render::{Progress, Settings};
use umbra::scene::{Scene, load};

/// Rays replayed in one turn.
const RAYS: usize = 20_000;

/// Turns that each test takes.
const ROUNDS: usize = 25;

const BACKENDS: [Backend; 3] = [Backend::Grid, Backend::Bvh2, Backend::Cwbvh];

const SCENES: [&str; 10] = [
    "CornellBox-Original.obj",
    "bunny.obj",
    "office.obj",
    "staircase.glb",
    "sponza.glb",
    "satellite.glb",
    "jungle.glb",
    "delft.obj",
    "tower_bridge.glb",
    "bigtujunga.glb",
];

fn folder() -> PathBuf {
    std::env::var_os("UMBRA_SCENES").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"),
        PathBuf::from,
    )
}

/// Shadow rays of a picture: whole tiles, spread over it.
fn shadow_rays(scene: &Scene) -> Vec<Ray> {
    let settings = Settings { width: 160, height: 120, ..Settings::default() };
    let recording =
        Recording::of(scene, &settings, &Progress::default()).expect("the settings are good");
    let rays: Vec<Ray> = recording.rays().copied().collect();
    let step = (rays.len() / RAYS).max(1);
    rays.chunks(256).step_by(step).flatten().take(RAYS).copied().collect()
}

fn replay(engine: &dyn Occlusion, rays: &[Ray], blocked: &mut [bool]) -> Duration {
    let start = Instant::now();
    engine.occluded_many(black_box(rays), blocked, &mut Tally::default());
    start.elapsed()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Nanoseconds a ray of `pluecker` and of `exact`, and how many times as long `exact` takes.
fn cost(scene: &Scene, backend: Backend, rays: &[Ray]) -> (f64, f64, f64) {
    let engine = |test| {
        build(backend, test, &scene.triangles, &BuildOptions::default()).expect("it is ours")
    };
    let (pluecker, exact) = (engine(Test::Pluecker), engine(Test::Exact));
    let mut blocked = vec![false; rays.len()];
    let mut rounds = Vec::new();
    for _ in 0..=ROUNDS {
        let times = [&pluecker, &exact].map(|engine| replay(&**engine, rays, &mut blocked));
        rounds.push(times.map(|time| time.as_secs_f64() * 1e9 / rays.len() as f64));
    }
    // The first round fills the caches.
    let rounds = &rounds[1..];
    (
        median(rounds.iter().map(|round| round[0]).collect()),
        median(rounds.iter().map(|round| round[1]).collect()),
        median(rounds.iter().map(|round| round[1] / round[0]).collect()),
    )
}

fn main() {
    let folder = folder();
    println!("{:26}{:>9}{:>14}{:>14}{:>9}", "scene", "engine", "pluecker", "exact", "ratio");
    let mut ratios = vec![Vec::new(); BACKENDS.len()];
    for name in SCENES {
        let path = folder.join(name);
        if !path.is_file() {
            eprintln!("*** NOT MEASURED: {} is absent; set UMBRA_SCENES ***", path.display());
            continue;
        }
        let scene = load(path.to_str().expect("scene names are text")).expect("it loads");
        let rays = shadow_rays(&scene);
        for (backend, ratios) in BACKENDS.into_iter().zip(&mut ratios) {
            let (pluecker, exact, ratio) = cost(&scene, backend, &rays);
            println!("{name:26}{backend:>9}{pluecker:>11.0} ns{exact:>11.0} ns{ratio:>9.3}");
            ratios.push(ratio);
        }
    }
    for (backend, ratios) in BACKENDS.into_iter().zip(ratios) {
        if !ratios.is_empty() {
            let count = ratios.len();
            println!("{backend}: median over {count} scenes {:.3}", median(ratios));
        }
    }
}
