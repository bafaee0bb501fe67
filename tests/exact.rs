//! Claims about exact decisions.

use std::sync::Arc;

use glam::Vec3;
use proptest::prelude::*;
use umbra::exact::adversary::{Class, query};
use umbra::exact::campaign::campaign;
use umbra::exact::certified::{verdict, verdict_by_expansions};
use umbra::exact::{Exact, Verdict, blocks, oracle};
use umbra::geometry::lanes::Arithmetic;
use umbra::geometry::{Ray, Triangle, TriangleId, Triangles};
use umbra::occlusion::{Backend, Brute, BuildOptions, Engine, Occlusion, Tally, Test, build};

/// Queries of each class that are held against the oracle.
const ORACLE_QUERIES: u64 = 4_000;

/// Queries of each class in the campaign; `umbra certify` makes as many as one likes.
const CAMPAIGN_QUERIES: u64 = 1_000_000;

fn any_class() -> impl Strategy<Value = Class> {
    prop::sample::select(Class::ALL)
}

/// A closed sphere: an icosahedron, every triangle divided in four as often as asked.
fn icosphere(subdivisions: usize, centre: Vec3, radius: f32) -> Vec<Triangle> {
    let g = f32::midpoint(1.0, 5.0_f32.sqrt());
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|corner| Vec3::from_array(corner).normalize());
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let mut triangles: Vec<_> = faces.iter().map(|face| face.map(|i| corners[i])).collect();
    for _ in 0..subdivisions {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    triangles.into_iter().map(|triangle| triangle.map(|corner| centre + radius * corner)).collect()
}

#[test]
fn certified_verdicts_are_the_oracles_on_every_class() {
    for &class in Class::ALL {
        for index in 0..ORACLE_QUERIES {
            let (ray, triangle) = query(class, index);
            let truth = oracle::verdict(&ray, &triangle);
            assert_eq!(verdict(&ray, &triangle), truth, "{class} {index}: {ray:?} {triangle:?}");
            assert_eq!(
                verdict_by_expansions(&ray, &triangle),
                truth,
                "{class} {index}, expansions alone"
            );
        }
    }
}

#[test]
fn no_stage_contradicts_another_on_any_class() {
    for &class in Class::ALL {
        let summary = campaign(class, 0..CAMPAIGN_QUERIES);
        println!("{class:20} {summary:?}");
        assert_eq!(summary.wrong, 0, "{class}: {summary:?}");
        assert_eq!(summary.blocked + summary.clear + summary.ties, CAMPAIGN_QUERIES);
        assert_eq!(summary.by_filter + summary.by_double + summary.by_expansion, CAMPAIGN_QUERIES);
    }
}

#[test]
fn every_instruction_set_gives_the_certified_answers() {
    // All triangles in one scene, so that the lanes of a vector hold very different ones.
    let queries: Vec<_> = Class::ALL
        .iter()
        .flat_map(|&class| (0..40).map(move |index| query(class, index)))
        .collect();
    let triangles = Arc::new(queries.iter().map(|query| query.1).collect::<Triangles>());
    for arithmetic in Arithmetic::available() {
        let brute = Brute::new(&triangles);
        let engine = Engine::<_, Exact>::new(triangles.clone(), brute, Some(arithmetic));
        for (ray, _) in &queries {
            for id in 0..triangles.len() as TriangleId {
                let expected = ray.is_valid() && blocks(ray, &triangles.get(id));
                let answer = ray.is_valid() && engine.meets(id, ray, &mut Tally::default());
                assert_eq!(answer, expected, "{arithmetic:?}: {ray:?} {:?}", triangles.get(id));
            }
            let expected = queries.iter().any(|(_, triangle)| blocks(ray, triangle));
            assert_eq!(engine.occluded(ray, &mut Tally::default()), expected, "{ray:?}");
        }
    }
}

#[test]
fn every_engine_gives_the_certified_answers_on_every_instruction_set() {
    for &class in Class::ALL {
        let queries: Vec<_> = (0..60).map(|index| query(class, index)).collect();
        let triangles = Arc::new(queries.iter().map(|query| query.1).collect::<Triangles>());
        let truths: Vec<bool> = queries
            .iter()
            .map(|(ray, _)| queries.iter().any(|(_, triangle)| blocks(ray, triangle)))
            .collect();
        for arithmetic in Arithmetic::available() {
            let options = BuildOptions { arithmetic: Some(arithmetic), ..BuildOptions::default() };
            for backend in [Backend::Grid, Backend::Bvh2, Backend::Cwbvh, Backend::Brute] {
                let engine = build(backend, Test::Exact, &triangles, &options).unwrap();
                for ((ray, _), truth) in queries.iter().zip(&truths) {
                    let answer = engine.occluded(ray, &mut Tally::default());
                    assert_eq!(answer, *truth, "{backend} {arithmetic:?} {class}: {ray:?}");
                }
            }
        }
    }
}

#[test]
fn every_class_has_blocked_and_clear_queries() {
    for &class in Class::ALL {
        let verdicts = (0..ORACLE_QUERIES)
            .map(|index| query(class, index))
            .map(|(ray, triangle)| verdict(&ray, &triangle));
        let (mut blocked, mut clear) = (0, 0);
        for verdict in verdicts {
            match verdict {
                Verdict::Blocked => blocked += 1,
                Verdict::Clear => clear += 1,
                Verdict::Tie => {}
            }
        }
        assert!(
            blocked > ORACLE_QUERIES / 100 && clear > ORACLE_QUERIES / 10,
            "{class}: {blocked} blocked, {clear} clear"
        );
    }
}

#[test]
fn from_inside_a_closed_mesh_everything_is_blocked() {
    for (centre, radius) in
        [(Vec3::ZERO, 1.0), (Vec3::new(148_376.0, 1_234.0, -223_423.0), 2.0), (Vec3::ZERO, 1e-15)]
    {
        let sphere = icosphere(2, centre, radius);
        for (index, triangle) in sphere.iter().enumerate() {
            let origin =
                centre + radius * Vec3::new(0.1, -0.2, 0.05 * index as f32 / sphere.len() as f32);
            let [a, b, c] = *triangle;
            for target in [a, b, 0.5 * a + 0.5 * b, 0.25 * b + 0.75 * c, (a + b + c) / 3.0] {
                let ray = Ray::towards(origin, target - origin);
                assert!(
                    sphere.iter().any(|triangle| verdict(&ray, triangle) == Verdict::Blocked),
                    "{ray:?}"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_order_of_the_corners_does_not_matter(class in any_class(), index: u64) {
        let (ray, [a, b, c]) = query(class, index);
        let expected = verdict(&ray, &[a, b, c]);
        for triangle in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
            prop_assert_eq!(verdict(&ray, &triangle), expected);
        }
    }

    #[test]
    fn mirroring_and_turning_space_does_not_matter(class in any_class(), index: u64) {
        let (ray, triangle) = query(class, index);
        for image in [|v: Vec3| -v, |v: Vec3| Vec3::new(v.y, v.z, v.x), |v: Vec3| Vec3::new(v.z, v.y, v.x)] {
            let image_of_ray = Ray { origin: image(ray.origin), direction: image(ray.direction), ..ray };
            prop_assert_eq!(verdict(&image_of_ray, &triangle.map(image)), verdict(&ray, &triangle));
        }
    }

    #[test]
    fn a_longer_ray_is_blocked_by_all_that_blocks_a_shorter(class in any_class(), index: u64, factor in 1.0_f32..4.0) {
        let (ray, triangle) = query(class, index);
        let longer = Ray { end: ray.end * factor, ..ray };
        prop_assert!(verdict(&ray, &triangle) != Verdict::Blocked || verdict(&longer, &triangle) == Verdict::Blocked);
    }

    #[test]
    fn a_segment_whose_differences_are_exact_may_be_walked_from_either_end(index: u64) {
        let (ray, triangle) = query(Class::Lattice, index);
        let forwards = Ray { end: 1.0, ..ray };
        let backwards = Ray { origin: ray.origin + ray.direction, direction: -ray.direction, end: 1.0 };
        prop_assert_eq!(verdict(&forwards, &triangle), verdict(&backwards, &triangle));
    }
}
