//! What exactness costs: the exact test against `pluecker`, in the same engine, on the same shadow rays.
//!
//! The shadow rays of a picture of each of the ten real scenes are recorded once. Both tests then take turns
//! on short pieces of them, again and again, and of each piece the least time of each test counts: so neither a
//! machine that slows down nor one that is shared favours either. In the end, the median over the scenes.
//!
//! `cargo bench --bench exact_cost`; the scenes are looked for in `UMBRA_SCENES` or `../shared/scenes`.

mod common;

use std::hint::black_box;
use std::time::{Duration, Instant};

use common::{REAL_SCENES, folder, median};
use umbra::geometry::Ray;
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};
use umbra::render::{Progress, Settings};
use umbra::scene::{Scene, load};

/// Rays of each scene.
const RAYS: usize = 20_000;

/// Rays in a piece: some 100 µs, in which a thread is seldom interrupted.
const PIECE: usize = 200;

/// Turns that each test takes on each piece.
const ROUNDS: usize = 20;

const BACKENDS: [Backend; 3] = [Backend::Grid, Backend::Bvh2, Backend::Cwbvh];

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

/// Nanoseconds a ray of `pluecker` and of `exact`.
fn cost(scene: &Scene, backend: Backend, rays: &[Ray]) -> [f64; 2] {
    let engines = [Test::Pluecker, Test::Exact].map(|test| {
        build(backend, test, &scene.triangles, &BuildOptions::default()).expect("it is ours")
    });
    let mut blocked = [false; PIECE];
    let mut sums = [Duration::ZERO; 2];
    for piece in rays.chunks(PIECE) {
        let mut least = [Duration::MAX; 2];
        for round in 0..ROUNDS {
            // Who comes first changes, as the second finds the caches filled.
            for turn in [round % 2, 1 - round % 2] {
                let time = replay(&*engines[turn], piece, &mut blocked[..piece.len()]);
                least[turn] = least[turn].min(time);
            }
        }
        sums = [sums[0] + least[0], sums[1] + least[1]];
    }
    sums.map(|sum| sum.as_secs_f64() * 1e9 / rays.len() as f64)
}

fn main() {
    let folder = folder();
    println!("{:26}{:>9}{:>14}{:>14}{:>9}", "scene", "engine", "pluecker", "exact", "ratio");
    let mut ratios = vec![Vec::new(); BACKENDS.len()];
    for name in REAL_SCENES {
        let path = folder.join(name);
        if !path.is_file() {
            eprintln!("*** NOT MEASURED: {} is absent; set UMBRA_SCENES ***", path.display());
            continue;
        }
        let scene = load(path.to_str().expect("scene names are text")).expect("it loads");
        let rays = shadow_rays(&scene);
        for (backend, ratios) in BACKENDS.into_iter().zip(&mut ratios) {
            let [pluecker, exact] = cost(&scene, backend, &rays);
            let ratio = exact / pluecker;
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
