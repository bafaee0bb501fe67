//! Pixel-exact agreement with Embree: every shadow query of a render, through every engine.
#![cfg(feature = "embree")]

mod common;

use std::sync::Arc;

use common::{Aim, REAL_SCENES, Random, real_scenes, soup, sphere};
use glam::Vec3;
use umbra::geometry::lanes::Arithmetic;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::occlusion::embree_bounds::{at_least, at_most};
use umbra::occlusion::{
    Backend, Brute, BuildOptions, Embree, EmbreeOptions, Isa, Occlusion, Quality, Tally, Test,
    build,
};
use umbra::render::{Progress, RecordedQuery, Settings, render};
use umbra::scene::{Scene, builtin, load};
use umbra::shadow::{Answer, Method, Path, Plan, SelfShadow, ShadowQuery, Trace, prepare};

/// Brute force is asked too where the scene has at most this many triangles.
const SMALL: usize = 70_000;

/// Of larger pictures, brute force answers this many queries.
const BRUTE_QUERIES: usize = 400;

/// Every shadow query of a small picture.
fn shadow_queries(scene: &Scene) -> Vec<RecordedQuery> {
    let backend =
        build(Backend::Bvh2, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap();
    let settings =
        Settings { width: 96, height: 72, depth: 3, record: true, ..Settings::default() };
    render(scene, &*backend, &Trace::new(&*backend), &settings, &Progress::default())
        .unwrap()
        .queries
        .concat()
}

fn embree(triangles: &Arc<Triangles>, robust: bool, options: EmbreeOptions) -> Embree {
    Embree::new(triangles.clone(), robust, options).unwrap_or_else(|error| panic!("{error}"))
}

fn answers(backend: &dyn Occlusion, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    backend.occluded_many(rays, &mut blocked, &mut Tally::default());
    blocked
}

/// Every query on which two lists of answers differ, in words.
fn differences(rays: &[RecordedQuery], ours: &[bool], theirs: &[bool]) -> Vec<String> {
    let all = rays.iter().zip(ours).zip(theirs);
    let different = all.filter(|((_, ours), theirs)| ours != theirs);
    different.map(|((query, ours), _)| format!("ours {ours}: {query:?}")).collect()
}

fn agrees_with_embree(scene: &Scene) {
    let queries = shadow_queries(scene);
    let rays: Vec<Ray> = queries.iter().map(|recorded| recorded.query.ray).collect();
    assert!(!rays.is_empty(), "{}: the picture asks no shadow query", scene.name);
    for (test, robust) in [(Test::Pluecker, true), (Test::Moller, false)] {
        let theirs = answers(&embree(&scene.triangles, robust, EmbreeOptions::default()), &rays);
        for backend in [Backend::Grid, Backend::Bvh2, Backend::Cwbvh] {
            let ours = build(backend, test, &scene.triangles, &BuildOptions::default()).unwrap();
            let ours = answers(&*ours, &rays);
            let different = differences(&queries, &ours, &theirs);
            assert!(different.is_empty(), "{} {backend} {test}: {different:#?}", scene.name);
        }
        if scene.triangles.len() <= SMALL {
            let brute =
                build(Backend::Brute, test, &scene.triangles, &BuildOptions::default()).unwrap();
            let step = rays.len().div_ceil(BRUTE_QUERIES);
            for (ray, theirs) in rays.iter().zip(&theirs).step_by(step) {
                assert_eq!(
                    brute.occluded(ray, &mut Tally::default()),
                    *theirs,
                    "{} {test} {ray:?}",
                    scene.name
                );
            }
        }
    }
}

#[test]
fn every_engine_agrees_with_embree_on_every_pixel_and_light_of_the_builtin_scenes() {
    for name in builtin::NAMES {
        agrees_with_embree(&load(name).unwrap());
    }
}

#[test]
fn every_engine_agrees_with_embree_on_every_pixel_and_light_of_the_real_scenes() {
    let Some(folder) = real_scenes() else { return };
    for name in REAL_SCENES {
        agrees_with_embree(&load(folder.join(name).to_str().unwrap()).unwrap());
    }
}

/// Kernels that this CPU has, with their arithmetic.
fn kernels() -> impl Iterator<Item = (Isa, Arithmetic)> {
    let arithmetic = |isa| match isa {
        Isa::Avx512 => Arithmetic::Avx512,
        Isa::Avx2 => Arithmetic::Avx2,
        _ => Arithmetic::Sse,
    };
    Isa::ALL.into_iter().filter(|isa| isa.is_available()).map(move |isa| (isa, arithmetic(isa)))
}

/// Brute force with the lower and the upper bound of Embree's answer.
fn bounds(
    triangles: &Arc<Triangles>,
    robust: bool,
    arithmetic: Arithmetic,
) -> [Box<dyn Occlusion>; 2] {
    let brute = || Brute::new(triangles);
    [
        at_least(triangles, brute(), robust, arithmetic),
        at_most(triangles, brute(), robust, arithmetic),
    ]
}

#[test]
fn embree_answers_within_its_bounds_on_every_instruction_set_and_quality() {
    let far = Vec3::new(148_376.0, 1234.0, -223_423.0);
    let meshes: [(&str, Vec<Triangle>); 4] = [
        ("soup", soup(1500, 0.15, 21)),
        ("sphere", sphere(Vec3::ZERO, 1.0, 20)),
        ("far sphere", sphere(far, 2.0, 20)),
        ("one triangle", soup(1, 0.8, 22)),
    ];
    for (name, mesh) in meshes {
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        let middle = if name == "far sphere" { far } else { Vec3::ZERO };
        let mut random = Random(23);
        let rays: Vec<Ray> = Aim::ALL
            .into_iter()
            .flat_map(|aim| (0..250).map(|_| aim).collect::<Vec<_>>())
            .map(|aim| {
                let ray = aim.ray(&mesh, &mut random);
                // Rays that are not aimed at a part of the mesh start at its middle.
                if name == "far sphere" && aim == Aim::Random {
                    Ray::towards(middle, ray.direction)
                } else {
                    ray
                }
            })
            .collect();
        for (isa, arithmetic) in kernels() {
            for robust in [false, true] {
                let [lower, upper] = bounds(&triangles, robust, arithmetic);
                let (lower, upper) = (answers(&*lower, &rays), answers(&*upper, &rays));
                for quality in [Quality::Low, Quality::Medium, Quality::High] {
                    let options =
                        EmbreeOptions { quality, isa: Some(isa), ..EmbreeOptions::default() };
                    let theirs = answers(&embree(&triangles, robust, options), &rays);
                    for (i, ray) in rays.iter().enumerate() {
                        let what = format!("{name} {isa} robust {robust} {quality:?}: {ray:?}");
                        assert!(theirs[i] <= upper[i], "above the upper bound: {what}");
                        // Spatial splits clip boxes: there the lower bound is not Embree's promise.
                        let splits = quality == Quality::High && !robust;
                        assert!(splits || lower[i] <= theirs[i], "below the lower bound: {what}");
                    }
                }
                let decided =
                    lower.iter().zip(&upper).filter(|(lower, upper)| lower == upper).count();
                assert!(
                    decided * 10 > rays.len() * 8,
                    "{name} {isa}: the bounds agree on most rays"
                );
            }
        }
    }
}

#[test]
fn a_triangle_whose_volumes_overflow_is_decided_as_embree_decides_it() {
    // One volume is −∞ and one ∞, their sum is no number, and Embree's `>=` is true of that.
    let mesh = [[
        Vec3::new(-2.679_826_8e17, -0.277_504_92, -4.192_926e-22),
        Vec3::new(-3.204_253_3e-18, -1.384_686_8e-36, 2.207_024_7e-20),
        Vec3::new(-3.519_515e13, 2.275_337e-30, -0.001_661_128),
    ]];
    let ray = Ray {
        origin: Vec3::new(-1.277_144_95e-17, 1.849_084_9e-20, -0.178_874_88),
        direction: Vec3::new(-1.129_685e-17, 1.757_868_3e22, 4.209_194e-15),
        end: 4.511_72e14,
    };
    let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    for (isa, arithmetic) in kernels() {
        let options = EmbreeOptions { isa: Some(isa), ..EmbreeOptions::default() };
        let [_, upper] = bounds(&triangles, true, arithmetic);
        let tally = &mut Tally::default();
        let theirs = embree(&triangles, true, options).occluded(&ray, tally);
        assert_eq!(upper.occluded(&ray, tally), theirs, "{isa}");
        assert!(theirs, "{isa}: or this shows nothing");
    }
}

#[test]
fn our_tests_in_each_arithmetic_lie_within_the_bounds_too() {
    let mesh = soup(800, 0.2, 24);
    let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    let mut random = Random(25);
    let rays: Vec<Ray> =
        (0..3000).map(|i| Aim::ALL[i % Aim::ALL.len()].ray(&mesh, &mut random)).collect();
    for arithmetic in Arithmetic::available() {
        for (test, robust) in [(Test::Pluecker, true), (Test::Moller, false)] {
            let [lower, upper] = bounds(&triangles, robust, arithmetic);
            let options = BuildOptions { arithmetic: Some(arithmetic), ..BuildOptions::default() };
            let ours = build(Backend::Grid, test, &triangles, &options).unwrap();
            for ray in &rays {
                let tally = &mut Tally::default();
                let ours = ours.occluded(ray, tally);
                assert!(lower.occluded(ray, tally) <= ours, "{test} {arithmetic:?} {ray:?}");
                assert!(ours <= upper.occluded(ray, tally), "{test} {arithmetic:?} {ray:?}");
            }
        }
    }
}

#[test]
fn a_memory_in_front_of_embree_never_says_more_than_embree() {
    let mesh = soup(300, 0.3, 26);
    let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    for robust in [false, true] {
        let embree = embree(&triangles, robust, EmbreeOptions::default());
        assert!(!embree.order().is_empty(), "whoever wants cells asks for them first");
        let mut random = Random(27);
        for i in 0..6000 {
            let ray = Aim::ALL[i % Aim::ALL.len()].ray(&mesh, &mut random);
            let tally = &mut Tally::default();
            let blocked = embree.occluded(&ray, tally);
            let occluder = embree.occluder(&ray, tally);
            assert_eq!(occluder.is_some(), blocked);
            let triangle = random.below(mesh.len()) as u32;
            assert!(!embree.meets(triangle, &ray, tally) || blocked, "{ray:?}");
            if let Some(occluder) = occluder {
                let run = &embree.order()[occluder.cell.start as usize..occluder.cell.end as usize];
                assert!(run.contains(&occluder.triangle), "the cell holds its occluder");
                assert!(embree.occluder_in(occluder.cell, &ray, tally).is_none() || blocked);
            }
        }
    }
}

#[test]
fn cells_beside_embree_are_made_when_a_memory_needs_them_and_not_otherwise() {
    let scene = umbra::scene::builtin::draft_at("jittered-dense", 0.05).unwrap().finish().unwrap();
    let embree = embree(&scene.triangles, true, EmbreeOptions::default());
    let bytes = embree.memory();
    let queries: Vec<ShadowQuery> = {
        let mut random = Random(28);
        let bounds = scene.bounds();
        let mut origin = || {
            let half = 0.5 * (bounds.max - bounds.min);
            bounds.min + half + half * random.in_cube(1.0)
        };
        let query = |_| {
            let ray = scene.lights[0].shadow_ray(origin());
            ShadowQuery { ray, path: Path::EYE, spawner: 0 }
        };
        (0..1000).map(query).collect()
    };
    let mut expected = vec![Answer::default(); queries.len()];
    prepare(Method::Trace, &scene, &embree).unwrap().worker().answer(0, &queries, &mut expected);
    let exclude = SelfShadow::Exclude;
    let plans = [
        (Plan { self_shadow: exclude, ..Method::Trace.into() }, false),
        (Method::ObjectCache.into(), false),
        (Plan { self_shadow: exclude, ..Method::ObjectCache.into() }, false),
        (Method::VoxelCache.into(), true),
        (Method::Woo.into(), true),
    ];
    for (plan, needs_cells) in plans {
        let prepared = prepare(plan, &scene, &embree).unwrap();
        let mut answers = vec![Answer::default(); queries.len()];
        prepared.worker().answer(0, &queries, &mut answers);
        assert_eq!(embree.has_cells(), needs_cells, "{plan:?}");
        assert_eq!(embree.memory() > bytes, needs_cells, "{plan:?}");
        let differ = |(answer, expected): (&Answer, &Answer)| answer.blocked != expected.blocked;
        let different = answers.iter().zip(&expected).filter(|&pair| differ(pair)).count();
        let leaves_out = plan.self_shadow == exclude;
        assert!(different == 0 || leaves_out && different < 9, "{plan:?}: {different}");
    }
}
