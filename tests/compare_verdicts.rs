//! Verdicts before Embree: they may be right where Embree cannot be, and `compare` does not hold that against them.

#![cfg(feature = "embree")]

mod common;

use std::f32::consts::TAU;
use std::sync::atomic::AtomicU64;

use common::Random;
use common::lit::{point, scene};
use glam::{DVec3, Vec3};
use umbra::geometry::Triangle;
use umbra::measure::compare::{Report, Row, compare};
use umbra::measure::contender::Choice;
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, Test};
use umbra::render::{Progress, Settings};
use umbra::scene::{Camera, Scene};
use umbra::shadow::{Combination, Method, VerdictKind};

/// A floor below slivers 10⁵ times as long as wide, seen from above, under a lamp that is far away: f32 errs on hundreds of
/// a million rays to it.
fn slivers() -> Scene {
    let corner = |x: f32, z: f32| Vec3::new(8.0 * x, 0.0, 8.0 * z);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut random = Random(71);
    let mut sliver = || {
        let tip = Vec3::new(random.between(-2.0, 2.0), random.unit(), random.between(-2.0, 2.0));
        let (angle, length) = (random.between(0.0, TAU), random.between(0.2, 4.0));
        let end = |angle: f32| tip + length * Vec3::new(angle.cos(), 0.0125, angle.sin());
        [tip, end(angle), end(angle + 1e-5)]
    };
    let floor = [[a, c, b], [a, d, c]];
    let mesh: Vec<Triangle> = floor.into_iter().chain((0..3000).map(|_| sliver())).collect();
    let mut scene = scene(&mesh, vec![point(Vec3::new(0.0, 2000.0, 0.0))]);
    scene.camera = Camera::look_at(DVec3::new(0.0, 40.0, 1e-3), DVec3::ZERO, DVec3::Y, 0.16);
    scene
}

fn row(report: &Report, method: Combination) -> &Row {
    let is_it = |row: &&Row| match method == Combination::default() {
        true => row.name == "embree moller",
        false => row.name == format!("embree moller {method}"),
    };
    report.contenders.iter().find(is_it).unwrap()
}

#[test]
fn a_verdict_that_is_right_where_embree_is_wrong_fails_no_comparison() {
    let scene = slivers();
    let settings = Settings { width: 200, height: 200, ..Settings::default() };
    let recording = Recording::of(&scene, &settings, &Progress::default()).unwrap();
    let verdicts = VerdictKind::ALL.map(Combination::from);
    let with_memory = verdicts.map(|verdict| Combination { method: Method::CacheTree, ..verdict });
    let choice = Choice {
        backends: vec![Backend::Embree],
        tests: vec![Test::Moller],
        methods: [&[Combination::default()], &verdicts[..], &with_memory].concat(),
        ..Choice::default()
    };
    let contenders = choice.select().contenders;
    let report = compare(&scene, &recording, &contenders, &AtomicU64::new(0)).unwrap();
    assert_eq!(report.failure(), None, "{report}{}", report.listing(5));
    let alone = row(&report, Combination::default());
    assert!(alone.false_blocked + alone.false_clear > 0, "the rays are not hard");
    assert_eq!(alone.claim, "L to U");
    for method in [verdicts, with_memory].concat() {
        let row = row(&report, method);
        assert!(row.agree > alone.agree, "{}: nothing was settled that is in doubt", row.name);
        assert_eq!(row.claim, "the truth, or L to U", "{}", row.name);
    }
}
