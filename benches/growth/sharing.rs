//! How evenly the work of a picture is shared among more threads than there are.

use std::time::Instant;

use umbra::occlusion::{Embree, EmbreeOptions, Occlusion};
use umbra::render::{Piecewise, Progress, Settings};
use umbra::scene::{Scene, builtin, load};
use umbra::shadow::{Combination, Prepared, prepare};

const SCENES: [&str; 2] = ["chair-room", "drum"];

const THREADS: [usize; 5] = [4, 8, 16, 32, 64];

/// Prints a table: of the time in which so many threads would be finished if all had as much to do, the share that it is of
/// the time that they take.
pub fn print(rounds: usize) {
    println!(
        "| scene | samples | units | the longest, of all | {} |",
        THREADS.map(|n| format!("{n} threads")).join(" | ")
    );
    println!("| --- | --- | --- | --- |{}", " --- |".repeat(THREADS.len()));
    for name in SCENES {
        let scene = load(name).expect("it is built in");
        let view = builtin::view(name).expect("it is built in");
        let embree = Embree::new(scene.triangles.clone(), true, EmbreeOptions::default())
            .expect("Embree is there");
        let method: Combination = "shaft".parse().expect("a method");
        let shadows = prepare(method, &scene, &embree).expect("a sound combination");
        for samples in [1, 3] {
            let settings =
                Settings { width: view.width, height: view.height, samples, ..Settings::default() };
            let units = times(&scene, &embree, &*shadows, &settings, rounds);
            let all: f64 = units.iter().sum();
            let longest = units.iter().copied().fold(0.0, f64::max);
            let shares = THREADS.map(|n| format!("{:.2}", all / n as f64 / together(&units, n)));
            println!(
                "| {name} | {} | {} | {:.3} | {} |",
                samples * samples,
                units.len(),
                longest / all,
                shares.join(" | ")
            );
        }
    }
}

/// Seconds of each unit in the order in which they are begun, the least of some rounds.
fn times(
    scene: &Scene,
    backend: &dyn Occlusion,
    shadows: &dyn Prepared,
    settings: &Settings,
    rounds: usize,
) -> Vec<f64> {
    let mut least = Vec::new();
    for _ in 0..rounds {
        let mut picture =
            Piecewise::new(scene, backend, shadows, settings, 1).expect("the settings are good");
        least.resize(picture.count(), f64::INFINITY);
        for least in &mut least {
            let start = Instant::now();
            picture.advance(&Progress::default());
            *least = start.elapsed().as_secs_f64().min(*least);
        }
    }
    least
}

/// Seconds until all units are done, if each is begun by the thread that is free first.
fn together(units: &[f64], threads: usize) -> f64 {
    let mut busy_until = vec![0.0f64; threads];
    for unit in units {
        let first = busy_until.iter_mut().min_by(|a, b| a.total_cmp(b)).expect("a thread");
        *first += unit;
    }
    busy_until.into_iter().fold(0.0, f64::max)
}
