//! Build time and shadow-ray throughput of each backend, on one built-in and two real scenes.
//!
//! The shadow rays of a picture are recorded once and replayed to all engines. Engines take turns within
//! every iteration, and only the turn of the one that is measured counts; so a machine that slows
//! down slows all of them alike. Before anything is timed, all engines must agree on how many rays
//! are blocked.
//!
//! `cargo bench --bench backends`; the real scenes are looked for in `UMBRA_SCENES` or `../shared/scenes`.

mod common;

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::folder;
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use umbra::geometry::Ray;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};
use umbra::render::{Progress, Settings, render};
use umbra::scene::{Scene, load};
use umbra::shadow::Trace;

/// Rays replayed in one turn.
const RAYS: usize = 20_000;

/// What is compared: each engine with the test that is its own or ours.
const ENGINES: [(Backend, Test); 7] = [
    (Backend::Embree, Test::Moller),
    (Backend::Embree, Test::Pluecker),
    (Backend::Grid, Test::Pluecker),
    (Backend::Grid, Test::Exact),
    (Backend::Bvh2, Test::Exact),
    (Backend::Cwbvh, Test::Pluecker),
    (Backend::Cwbvh, Test::Exact),
];

fn scenes() -> Vec<Scene> {
    let folder = folder();
    let mut names = vec![PathBuf::from("jittered-dense")];
    for name in ["sponza.glb", "delft.obj"] {
        let path = folder.join(name);
        if path.is_file() {
            names.push(path);
        } else {
            eprintln!("*** NOT MEASURED: {} is absent; set UMBRA_SCENES ***", path.display());
        }
    }
    names
        .iter()
        .map(|name| load(name.to_str().expect("scene names are text")).expect("it loads"))
        .collect()
}

/// Shadow rays of a picture, as many as are replayed, light by light as the renderer asks them.
fn shadow_rays(scene: &Scene) -> Vec<Ray> {
    let backend = build(Backend::Bvh2, Test::Exact, &scene.triangles, &BuildOptions::default())
        .expect("bvh2");
    let settings = Settings { width: 160, height: 120, record: true, ..Settings::default() };
    let recorded =
        render(scene, &*backend, &Trace::new(&*backend), &settings, &Progress::default());
    let queries = recorded.expect("the settings are good").queries.concat();
    let step = (queries.len() / RAYS).max(1);
    // Whole tiles, spread over the picture: neighbours stay together.
    let tiles: Vec<_> = queries.chunks(256).step_by(step).flatten().collect();
    tiles.iter().map(|recorded| recorded.query.ray).take(RAYS).collect()
}

fn replay(engine: &dyn Occlusion, rays: &[Ray], blocked: &mut [bool]) -> Duration {
    let start = Instant::now();
    engine.occluded_many(black_box(rays), blocked, &mut Tally::default());
    start.elapsed()
}

fn throughput(criterion: &mut Criterion) {
    for scene in scenes() {
        let rays = shadow_rays(&scene);
        let mut blocked = vec![false; rays.len()];
        let engines: Vec<_> = ENGINES
            .iter()
            .filter_map(|&(backend, test)| {
                match build(backend, test, &scene.triangles, &BuildOptions::default()) {
                    Ok(engine) => Some((format!("{backend} {test}"), engine)),
                    Err(error) => {
                        eprintln!("*** NOT MEASURED: {error} ***");
                        None
                    }
                }
            })
            .collect();
        let counts: Vec<usize> = engines
            .iter()
            .map(|(_, engine)| {
                replay(&**engine, &rays, &mut blocked);
                blocked.iter().filter(|blocked| **blocked).count()
            })
            .collect();
        // The tests round differently, but a handful of rays at most.
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        assert!(
            most - least <= rays.len() / 1000,
            "{}: {counts:?} of {} blocked",
            scene.name,
            rays.len()
        );

        let mut group = criterion.benchmark_group(format!("shadow rays/{}", short(&scene)));
        group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(10);
        group.measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
        for (turn, (name, _)) in engines.iter().enumerate() {
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|iterations| {
                    let mut counted = Duration::ZERO;
                    for _ in 0..iterations {
                        for (other, (_, engine)) in engines.iter().enumerate() {
                            let time = replay(&**engine, &rays, &mut blocked);
                            counted += if other == turn { time } else { Duration::ZERO };
                        }
                    }
                    counted
                });
            });
        }
        group.finish();
    }
}

fn building(criterion: &mut Criterion) {
    for scene in scenes() {
        let mut group = criterion.benchmark_group(format!("build/{}", short(&scene)));
        group.throughput(Throughput::Elements(scene.triangles.len() as u64)).sample_size(10);
        group.warm_up_time(Duration::from_millis(500));
        for (backend, test) in [
            (Backend::Embree, Test::Pluecker),
            (Backend::Grid, Test::Exact),
            (Backend::Bvh2, Test::Exact),
            (Backend::Cwbvh, Test::Exact),
        ] {
            let options = BuildOptions::default();
            if build(backend, test, &scene.triangles, &options).is_err() {
                continue;
            }
            group.bench_function(backend.name(), |bencher| {
                bencher.iter_batched(
                    || (),
                    |()| {
                        build(backend, test, &scene.triangles, &options)
                            .expect("it was built before")
                    },
                    BatchSize::PerIteration,
                );
            });
        }
        group.finish();
    }
}

fn short(scene: &Scene) -> String {
    Path::new(&scene.name)
        .file_stem()
        .map_or_else(|| scene.name.clone(), |stem| stem.to_string_lossy().into_owned())
}

criterion_group!(benches, throughput, building);
criterion_main!(benches);
