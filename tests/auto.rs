//! `auto` may ask whomever it likes: the answers are the same bits.

mod common;
#[path = "common/rooms.rs"]
mod rooms;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use common::{BACKENDS, Random, engine};
use rooms::glass_room;
use umbra::occlusion::{Backend, Occlusion, Test};
use umbra::render::{Order, Progress, Rendered, Settings, render};
use umbra::scene::{Light, Scene, builtin};
use umbra::shadow::{
    Answer, Auto, Method, Path, Plan, Prepared, Retest, SelfShadow, ShadowQuery, prepare,
};

/// A clock that says what it is told, whatever time it is.
fn clock(kind: &'static str) -> impl Fn() -> u64 + Send + Sync {
    let (ticks, now) = (AtomicU64::new(0), AtomicU64::new(0));
    move || {
        let tick = ticks.fetch_add(1, Relaxed);
        let bits = Random(tick).bits();
        match kind {
            "stands still" => 0,
            "ticks" => 1_000 * tick,
            // Every batch costs something else, from a nanosecond to half a millisecond; so everybody leads by turns.
            "leaps" => now.fetch_add(1 << (bits % 20), Relaxed),
            // Forward and backward.
            "is mad" => bits,
            _ => unreachable!("no such clock"),
        }
    }
}

const CLOCKS: [&str; 4] = ["stands still", "ticks", "leaps", "is mad"];

fn settings(order: Order) -> Settings {
    Settings { width: 160, height: 120, depth: 3, mask: true, order, ..Settings::default() }
}

fn picture(scene: &Scene, backend: &dyn Occlusion, by: &dyn Prepared, order: Order) -> Rendered {
    render(scene, backend, by, &settings(order), &Progress::default()).unwrap()
}

/// Renders with `auto` by each clock; all must give the picture of `trace`. How many queries each candidate
/// answered by the clock that leaps: in one thread, so that it is the same in every run.
fn check(scene: &Scene, backend: Backend, test: Test, order: Order) -> BTreeMap<String, u64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| check_here(scene, backend, test, order))
}

fn check_here(scene: &Scene, backend: Backend, test: Test, order: Order) -> BTreeMap<String, u64> {
    let mut answered = BTreeMap::new();
    let engine = engine(backend, test, &scene.triangles);
    let traced = prepare(Method::Trace, scene, &*engine).unwrap();
    let expected = picture(scene, &*engine, &*traced, order);
    // With room for light buffers.
    let plan = Plan { budget: Some(1 << 30), ..Method::Trace.into() };
    for kind in CLOCKS {
        let auto = Auto::with_clock(plan, test, scene, &*engine, clock(kind)).unwrap();
        let rendered = picture(scene, &*engine, &auto, order);
        let context = format!("{backend} {test} {order:?}, a clock that {kind}");
        assert!(rendered.film == expected.film, "{context}: the picture");
        assert!(rendered.mask == expected.mask, "{context}: the mask");
        let shadows = |rendered: &Rendered| {
            (rendered.statistics.shadows.queries, rendered.statistics.shadows.blocked)
        };
        assert_eq!(shadows(&rendered), shadows(&expected), "{context}");
        let choices = auto.choices();
        let queries: u64 = choices.iter().map(|light| light.queries).sum();
        assert_eq!(
            queries, expected.statistics.shadows.queries,
            "{context}: all are accounted for"
        );
        if kind == "leaps" {
            for share in choices.iter().flat_map(|light| &light.candidates) {
                assert!(!share.reason.is_empty(), "{context}: {share:?}");
                *answered.entry(share.method.clone()).or_default() += share.queries;
            }
        }
    }
    answered
}

#[test]
fn the_picture_is_the_same_whoever_is_asked_over_every_backend_with_the_exact_test() {
    let scene = glass_room();
    let mut answered: BTreeMap<String, u64> = BTreeMap::new();
    for backend in [Backend::Grid, Backend::Bvh2, Backend::Cwbvh, Backend::Brute] {
        for order in [Order::Tiles, Order::Scanline] {
            for (method, queries) in check(&scene, backend, Test::Exact, order) {
                *answered.entry(method).or_default() += queries;
            }
        }
    }
    let wanted = ["trace", "shaft", "shaft+light-buffer", "light-buffer", "cache-tree"];
    for method in wanted {
        assert!(answered[method] > 1_000, "{method} was hardly asked: {answered:?}");
    }
}

#[test]
fn the_picture_is_the_same_over_every_backend_with_an_f32_test() {
    let scene = glass_room();
    for &backend in BACKENDS {
        let answered = check(&scene, backend, Test::Pluecker, Order::Tiles);
        assert!(answered["trace"] > 0, "{backend}: {answered:?}");
        assert!(answered.keys().all(|name| !name.contains("shaft") && !name.contains("buffer")));
    }
}

#[test]
fn the_picture_is_the_same_in_every_builtin_scene() {
    for name in builtin::NAMES {
        let scene = builtin::draft_at(name, 0.1).unwrap().finish().unwrap();
        let answered = check(&scene, Backend::Grid, Test::Exact, Order::Tiles);
        assert!(answered["trace"] > 0 && answered.len() > 1, "{name}: {answered:?}");
    }
}

#[test]
fn the_picture_is_the_same_on_four_threads_that_get_in_each_others_way() {
    let scene = glass_room();
    let engine = engine(Backend::Grid, Test::Exact, &scene.triangles);
    let traced = prepare(Method::Trace, &scene, &*engine).unwrap();
    let expected = picture(&scene, &*engine, &*traced, Order::Tiles);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
    for kind in CLOCKS {
        let auto =
            Auto::with_clock(Method::Trace, Test::Exact, &scene, &*engine, clock(kind)).unwrap();
        let rendered = pool.install(|| picture(&scene, &*engine, &auto, Order::Tiles));
        assert!(rendered.film == expected.film && rendered.mask == expected.mask, "{kind}");
        let queries: u64 = auto.choices().iter().map(|light| light.queries).sum();
        assert_eq!(queries, expected.statistics.shadows.queries);
    }
}

#[test]
fn options_are_kept_to_and_nonsense_is_refused() {
    let scene = glass_room();
    let engine = engine(Backend::Grid, Test::Exact, &scene.triangles);
    let exclude = Plan {
        self_shadow: SelfShadow::Exclude,
        retest: Retest::NotTriangles,
        budget: Some(0),
        ..Method::Trace.into()
    };
    let auto = Auto::with_clock(exclude, Test::Exact, &scene, &*engine, clock("leaps")).unwrap();
    let traced = prepare(Plan { retest: Retest::Again, ..exclude }, &scene, &*engine).unwrap();
    assert!(auto.leaves_out_spawner());
    let expected = picture(&scene, &*engine, &*traced, Order::Tiles);
    assert!(picture(&scene, &*engine, &auto, Order::Tiles).film == expected.film);
    let deep = Plan { tree_depth: 32, ..Method::Trace.into() };
    assert!(Auto::new(deep, Test::Exact, &scene, &*engine).is_err());
}

#[test]
fn without_memory_nothing_is_prepared_and_that_is_said() {
    let scene = glass_room();
    let engine = engine(Backend::Grid, Test::Exact, &scene.triangles);
    let plan = Plan { budget: Some(0), ..Method::Trace.into() };
    let auto = Auto::with_clock(plan, Test::Exact, &scene, &*engine, clock("leaps")).unwrap();
    let traced = prepare(Method::Trace, &scene, &*engine).unwrap();
    let expected = picture(&scene, &*engine, &*traced, Order::Tiles);
    assert!(picture(&scene, &*engine, &auto, Order::Tiles).film == expected.film);
    assert_eq!(auto.memory(), 0);
    let notes: Vec<String> = auto.verdicts().into_iter().flat_map(|report| report.notes).collect();
    assert!(notes.iter().any(|note| note.contains("steps aside")), "{notes:?}");
    let choices = auto.choices();
    let shares = choices.iter().flat_map(|light| &light.candidates);
    let shafts = shares.filter(|share| share.method.contains("shaft") && share.queries > 0);
    let reasons: Vec<&str> = shafts.map(|share| &*share.reason).collect();
    let is_aside = |reason: &&str| reason.starts_with("steps aside");
    assert!(!reasons.is_empty() && reasons.iter().all(is_aside), "{reasons:?}");
}

/// A floor with lights above it, and many below, where it does not face.
fn floor(above: usize, below: usize) -> Scene {
    let mut scene = builtin::draft_at("jittered-dense", 0.02).unwrap();
    let light = |number: usize, height: f64| {
        let turn = number as f64 * 2.4;
        let position = glam::DVec3::new(3.0 * turn.cos(), height, 3.0 * turn.sin());
        Light::Point { position, intensity: glam::Vec3::ONE }
    };
    scene.lights = (0..above).map(|number| light(number, 4.0)).collect();
    scene.lights.extend((0..below).map(|number| light(number, -40.0)));
    scene.finish().unwrap()
}

/// Queries from one small place to each of the first lights; none to the others.
fn ask_some(scene: &Scene, by: &dyn Prepared, lights: usize, turns: usize) {
    let mut worker = by.worker();
    let mut random = Random(5);
    for _ in 0..turns {
        for (number, light) in scene.lights.iter().enumerate() {
            let asked = if number < lights { 256 } else { 0 };
            let queries: Vec<ShadowQuery> = (0..asked)
                .map(|_| {
                    let ray = light.shadow_ray(random.in_cube(0.1));
                    ShadowQuery { ray, path: Path::EYE, spawner: 0 }
                })
                .collect();
            worker.answer(number, &queries, &mut vec![Answer::default(); queries.len()]);
        }
    }
}

#[test]
fn of_256_lights_of_which_3_are_asked_about_3_are_paid_for() {
    let (few, many) = (floor(3, 0), floor(3, 253));
    let bytes = |scene: &Scene, method: &str| {
        let engine = engine(Backend::Grid, Test::Exact, &scene.triangles);
        let combination = method.parse::<umbra::shadow::Combination>().unwrap();
        let prepared = prepare(combination, scene, &*engine).unwrap();
        ask_some(scene, &*prepared, 3, 4);
        prepared.memory()
    };
    for method in ["shaft", "light-buffer", "shaft+light-buffer"] {
        assert_eq!(bytes(&few, method), bytes(&many, method), "{method}");
    }
    // It is the lights that take them: with all asked, they take many times more.
    let engine = engine(Backend::Grid, Test::Exact, &many.triangles);
    let light_buffer = umbra::shadow::VerdictKind::LightBuffer;
    let roomy = Plan { budget: Some(1 << 30), ..light_buffer.into() };
    let all = prepare(roomy, &many, &*engine).unwrap();
    ask_some(&many, &*all, 256, 1);
    let clusters = bytes(&few, "shaft");
    assert!(all.memory() - clusters > 30 * (bytes(&few, "light-buffer") - clusters));
}

#[test]
fn unless_more_is_allowed_nothing_takes_more_than_embree_would() {
    let many = floor(3, 253);
    let engine = engine(Backend::Grid, Test::Exact, &many.triangles);
    let usual = (64 * many.triangles.len()).max(1 << 20);
    for kind in umbra::shadow::VerdictKind::ALL {
        let taken = |budget: Option<u64>| {
            let plan = Plan { budget, ..kind.into() };
            let prepared = prepare(plan, &many, &*engine).unwrap();
            ask_some(&many, &*prepared, 256, 1);
            let notes = prepared.verdicts().into_iter().flat_map(|report| report.notes);
            (prepared.memory(), notes.collect::<Vec<String>>())
        };
        let ((bytes, notes), (roomy, _)) = (taken(None), taken(Some(1 << 30)));
        assert!(bytes <= usual, "{kind}: {bytes} of {usual}");
        if roomy > usual {
            let advised = notes.iter().any(|note| note.contains("--memory"));
            assert!(advised, "{kind} would take {roomy}, and says {notes:?}");
        }
    }
}

#[test]
fn auto_prepares_nothing_for_lights_that_are_not_asked_about() {
    // With room for light buffers, which are what takes room for a light.
    let plan = Plan { budget: Some(1 << 30), ..Method::Trace.into() };
    let [(few, buffers_of_few), (many, buffers_of_many)] = [0, 253].map(|below| {
        let scene = floor(3, below);
        let engine = engine(Backend::Grid, Test::Exact, &scene.triangles);
        // By this clock everybody leads by turns.
        let auto = Auto::with_clock(plan, Test::Exact, &scene, &*engine, clock("leaps")).unwrap();
        ask_some(&scene, &auto, 3, 2_000);
        let choices = auto.choices();
        let lights: Vec<usize> = choices.iter().map(|light| light.light).collect();
        assert_eq!(lights, [0, 1, 2]);
        let shares = choices.iter().flat_map(|light| &light.candidates);
        let by_buffers = shares.filter(|share| share.method.contains("light-buffer"));
        (auto.memory(), by_buffers.map(|share| share.queries).sum::<u64>())
    });
    assert_eq!(few, many);
    assert!(buffers_of_few > 0 && buffers_of_few == buffers_of_many, "{buffers_of_few}");
}
