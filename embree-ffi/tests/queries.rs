//! What single rays are told.

mod common;

use std::num::NonZeroU32;

use common::*;
use embree_ffi::{BuildQuality, Hit, Mesh, Ray, SceneBuilder, SceneOptions, Verdict};

#[test]
fn a_ray_through_a_square_is_occluded_and_one_beside_it_is_not() {
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    assert!(scene.occluded(&up(true)));
    assert!(!scene.occluded(&up(false)));
    let mut ray = up(true);
    scene.occluded1(&mut ray);
    assert!(ray.is_occluded());
    let mut ray = up(false);
    scene.occluded1(&mut ray);
    assert_eq!(ray, up(false));
}

#[test]
fn the_nearest_hit_is_told_with_its_place() {
    let scene = stack(&device(), &[2.0, 0.0, 1.0], SceneOptions::default());
    let hit = scene.intersect(&up(true)).unwrap();
    assert_eq!((hit.geometry, hit.primitive), (1, 0));
    assert!((hit.t - 1.0).abs() < 1e-6);
    assert!((hit.u - 0.125).abs() < 1e-6 && (hit.v - 0.625).abs() < 1e-6);
    assert_eq!(hit.normal, [0.0, 0.0, 4.0]);
    assert_eq!(scene.intersect(&up(false)), None);
}

#[test]
fn segments_end_where_they_end() {
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    let point = |z: f32| [0.5, 0.25, z];
    assert!(scene.occluded(&Ray::between(point(-1.0), point(1.0))));
    assert!(!scene.occluded(&Ray::between(point(-1.0), point(-0.01))));
    assert!(!scene.occluded(&up(true).with_interval(1.5, 9.0)));
    for (tnear, tfar) in
        [(2.0, 1.0), (0.0, -1.0), (0.0, f32::NEG_INFINITY), (0.0, f32::NAN), (f32::NAN, 9.0)]
    {
        let ray = up(true).with_interval(tnear, tfar);
        assert!(!scene.occluded(&ray), "{tnear} {tfar}");
        assert_eq!(scene.occluder(&ray), None, "{tnear} {tfar}");
        assert_eq!(scene.intersect(&ray), None, "{tnear} {tfar}");
    }
}

#[test]
fn occluder_names_a_triangle_that_blocks_exactly_when_occluded() {
    for options in every_option() {
        let scene = soup_scene(&device(), options);
        let mut blocked = 0;
        for ray in segments(2000) {
            let occluder = scene.occluder(&ray);
            assert_eq!(occluder.is_some(), scene.occluded(&ray), "{options:?}");
            assert_eq!(occluder.is_some(), scene.intersect(&ray).is_some(), "{options:?}");
            if let Some(Hit { primitive, t, .. }) = occluder {
                blocked += 1;
                // Only that triangle, and it is still there.
                assert!(scene.occluded_with(&ray, |hit| {
                    match hit.primitive == primitive && hit.t == t {
                        true => Verdict::Accept,
                        false => Verdict::Reject,
                    }
                }));
            }
        }
        assert!((200..1800).contains(&blocked), "{blocked}");
    }
}

fn every_option() -> Vec<SceneOptions> {
    let mut options = Vec::new();
    for quality in [BuildQuality::Low, BuildQuality::Medium, BuildQuality::High] {
        for (robust, compact) in [(false, false), (false, true), (true, false), (true, true)] {
            options.push(SceneOptions::default().quality(quality).robust(robust).compact(compact));
        }
    }
    options
}

#[test]
fn a_filter_that_rejects_gathers_every_transparent_occluder_and_blocks_nothing() {
    let scene = stack(&device(), &[0.0, 1.0, 2.0, 5.0], SceneOptions::default());
    let (mut gathered, mut light) = (Vec::new(), 1.0);
    let ray = up(true).with_interval(0.0, 4.0);
    let blocked = scene.occluded_with(&ray, |hit| {
        gathered.push((hit.geometry, hit.primitive, hit.t));
        light *= 0.5;
        Verdict::Reject
    });
    gathered.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert!(!blocked);
    assert_eq!(gathered, [(0, 0, 1.0), (1, 0, 2.0), (2, 0, 3.0)]);
    assert_eq!(light, 0.125);
}

#[test]
fn a_filter_that_accepts_one_mesh_blocks_only_there() {
    let scene = stack(&device(), &[0.0, 1.0], SceneOptions::default());
    let only = |wanted: u32| {
        move |hit: &Hit| if hit.geometry == wanted { Verdict::Accept } else { Verdict::Reject }
    };
    assert!(scene.occluded_with(&up(true), only(1)));
    assert!(!scene.occluded_with(&up(true), only(2)));
    assert_eq!(scene.intersect_with(&up(true), only(1)).map(|hit| hit.t), Some(2.0));
    assert_eq!(scene.intersect_with(&up(true), only(2)), None);
}

#[test]
fn a_ray_sees_the_meshes_that_share_a_bit_of_its_mask() {
    let bits = |bits| NonZeroU32::new(bits).unwrap();
    let mut builder = SceneBuilder::new(&device(), SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&square(0.0), &SQUARE).with_mask(bits(0b01))).unwrap();
    builder.add(Mesh::new(&square(1.0), &SQUARE).with_mask(bits(0b10))).unwrap();
    let scene = builder.commit().unwrap();
    let seen = |ray: Ray| scene.intersect(&ray).map(|hit| hit.geometry);
    assert_eq!(seen(up(true)), Some(0));
    assert_eq!(seen(up(true).with_mask(bits(0b01))), Some(0));
    assert_eq!(seen(up(true).with_mask(bits(0b10))), Some(1));
    assert_eq!(seen(up(true).with_mask(bits(0b100))), None);
    assert!(!scene.occluded(&up(true).with_mask(bits(0b100))));
}

#[test]
fn a_committed_scene_is_asked_by_many_threads_at_once() {
    let scene = soup_scene(&device(), SceneOptions::default().robust(true));
    let rays = segments(4000);
    let alone: Vec<bool> = rays.iter().map(|ray| scene.occluded(ray)).collect();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                assert!(rays.iter().zip(&alone).all(|(ray, &answer)| scene.occluded(ray) == answer))
            });
        }
    });
    scene.check().unwrap();
}

#[test]
fn a_scene_without_meshes_and_a_mesh_without_triangles_block_nothing() {
    let empty = SceneBuilder::new(&device(), SceneOptions::default()).unwrap().commit().unwrap();
    assert!(!empty.occluded(&up(true)));
    for (vertices, triangles) in [(&square(0.0)[..], &[][..]), (&[], &[])] {
        let mut builder = SceneBuilder::new(&device(), SceneOptions::default()).unwrap();
        assert_eq!(builder.add(Mesh::new(vertices, triangles)), Ok(0));
        assert_eq!(builder.add(Mesh::new(&square(1.0), &SQUARE)), Ok(1));
        let scene = builder.commit().unwrap();
        assert_eq!(scene.intersect(&up(true)).map(|hit| hit.geometry), Some(1));
    }
}
