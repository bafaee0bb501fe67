//! Every backend answers like brute force, bit for bit, whatever the ray.

mod common;

use std::sync::Arc;

use common::{Aim, Random, soup, sphere};
use glam::Vec3;
use umbra::geometry::lanes::Arithmetic;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::occlusion::{
    Backend, BackendError, BuildOptions, GridOptions, Occlusion, Tally, Test, build,
};

const OWN: [Backend; 3] = [Backend::Grid, Backend::Bvh2, Backend::Cwbvh];

fn meshes() -> Vec<(&'static str, Vec<Triangle>)> {
    vec![
        ("small triangles", soup(2000, 0.05, 1)),
        ("large triangles", soup(300, 1.0, 2)),
        ("sphere", sphere(Vec3::ZERO, 0.9, 24)),
        ("one triangle", soup(1, 0.5, 3)),
        (
            "flat square",
            vec![[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::X + Vec3::Y, Vec3::X, Vec3::Y]],
        ),
    ]
}

fn backends(
    triangles: &Arc<Triangles>,
    test: Test,
    options: &BuildOptions,
) -> Vec<Box<dyn Occlusion>> {
    OWN.iter().map(|&backend| build(backend, test, triangles, options).unwrap()).collect()
}

#[test]
fn every_backend_equals_brute_force_for_every_kind_of_ray() {
    for (name, mesh) in meshes() {
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        for test in Test::ALL {
            let options = BuildOptions::default();
            let brute = build(Backend::Brute, test, &triangles, &options).unwrap();
            let others = backends(&triangles, test, &options);
            for aim in Aim::ALL {
                let mut random = Random(7);
                let mut blocked = 0;
                for i in 0..2000 {
                    let ray = aim.ray(&mesh, &mut random);
                    let tally = &mut Tally::default();
                    let expected = brute.occluded(&ray, tally);
                    blocked += u32::from(expected);
                    let nearest = brute.nearest(&ray, tally);
                    for (backend, other) in OWN.iter().zip(&others) {
                        let what = format!("{backend} {test} {aim:?} on {name}, ray {i}: {ray:?}");
                        assert_eq!(other.occluded(&ray, tally), expected, "{what}");
                        assert_eq!(other.nearest(&ray, tally), nearest, "{what}");
                    }
                }
                assert!(
                    blocked > 0 || name == "flat square" || name == "one triangle",
                    "{name} {aim:?}: nothing was blocked"
                );
            }
        }
    }
}

#[test]
fn the_grid_loses_nothing_at_any_resolution() {
    let mesh = soup(500, 0.2, 4);
    let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    let brute =
        build(Backend::Brute, Test::Pluecker, &triangles, &BuildOptions::default()).unwrap();
    let resolutions = [[1, 1, 1], [1, 1, 200], [3, 5, 7], [64, 64, 64], [128, 2, 128]];
    let kinds = [(false, false), (true, false), (true, true)];
    for (resolution, (nested, lazy)) in
        resolutions.into_iter().flat_map(|resolution| kinds.map(|kind| (resolution, kind)))
    {
        let grid = GridOptions { resolution: Some(resolution), nested, lazy, most_bytes: None };
        let options = BuildOptions { grid, ..Default::default() };
        let grid = build(Backend::Grid, Test::Pluecker, &triangles, &options).unwrap();
        for aim in Aim::ALL {
            let mut random = Random(11);
            for _ in 0..1000 {
                let ray = aim.ray(&mesh, &mut random);
                let tally = &mut Tally::default();
                assert_eq!(
                    grid.occluded(&ray, tally),
                    brute.occluded(&ray, tally),
                    "{resolution:?} {nested} {lazy} {ray:?}"
                );
            }
        }
    }
}

#[test]
fn scale_and_place_of_a_scene_do_not_matter() {
    for (scale, offset) in [(1e-15f32, 0.0f32), (1e-6, 0.0), (1e9, 0.0), (1.0, 1e4), (1.0, -1e6)] {
        let place = |point: Vec3| point * scale + Vec3::splat(offset);
        let mesh: Vec<Triangle> = soup(400, 0.2, 5).into_iter().map(|t| t.map(place)).collect();
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        let options = BuildOptions::default();
        let brute = build(Backend::Brute, Test::Pluecker, &triangles, &options).unwrap();
        let others = backends(&triangles, Test::Pluecker, &options);
        let mut random = Random(13);
        for _ in 0..2000 {
            let ray = Ray::between(place(random.in_cube(1.2)), place(random.in_cube(1.2)));
            let tally = &mut Tally::default();
            let expected = brute.occluded(&ray, tally);
            for (backend, other) in OWN.iter().zip(&others) {
                assert_eq!(
                    other.occluded(&ray, tally),
                    expected,
                    "{backend} at scale {scale}, offset {offset}: {ray:?}"
                );
            }
        }
    }
}

#[test]
fn wide_and_scalar_lanes_give_the_same_bits() {
    use umbra::geometry::intersect::{Moller, Pluecker, TriangleTest, meets};
    use umbra::geometry::lanes::Scalar;
    fn compare<T: TriangleTest>(test: Test) {
        let mesh = soup(64, 0.6, 6);
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        let slack = triangles.slack();
        for arithmetic in Arithmetic::available() {
            let options = BuildOptions { arithmetic: Some(arithmetic), ..Default::default() };
            let brute = build(Backend::Brute, test, &triangles, &options).unwrap();
            let mut random = Random(17);
            for aim in Aim::ALL {
                for _ in 0..200 {
                    let ray = aim.ray(&mesh, &mut random);
                    for (id, triangle) in mesh.iter().enumerate() {
                        let twin = match arithmetic {
                            Arithmetic::Sse => {
                                meets::<T, Scalar<false, false>>(&ray, triangle, slack)
                            }
                            Arithmetic::Avx2 => {
                                meets::<T, Scalar<true, false>>(&ray, triangle, slack)
                            }
                            Arithmetic::Avx512 => {
                                meets::<T, Scalar<true, true>>(&ray, triangle, slack)
                            }
                        };
                        let wide = brute.meets(id as u32, &ray, &mut Tally::default());
                        assert_eq!(wide, twin, "{test} {arithmetic:?} {ray:?} {triangle:?}");
                    }
                }
            }
        }
    }
    compare::<Moller>(Test::Moller);
    compare::<Pluecker>(Test::Pluecker);
}

#[test]
fn a_ray_that_is_not_finite_is_not_blocked_and_counted() {
    let mesh = sphere(Vec3::ZERO, 1.0, 8);
    let triangles = Arc::new(mesh.into_iter().collect::<Triangles>());
    let good = Ray::towards(Vec3::ZERO, Vec3::X);
    let bad = [
        Ray { origin: Vec3::NAN, ..good },
        Ray { direction: Vec3::new(f32::INFINITY, 0.0, 0.0), ..good },
        Ray { end: f32::NAN, ..good },
        Ray { end: 0.0, ..good },
        Ray { end: -1.0, ..good },
    ];
    for backend in [Backend::Brute, Backend::Grid, Backend::Bvh2, Backend::Cwbvh] {
        let occlusion =
            build(backend, Test::Pluecker, &triangles, &BuildOptions::default()).unwrap();
        let mut tally = Tally::default();
        assert!(occlusion.occluded(&good, &mut tally));
        assert!(bad.iter().all(|ray| !occlusion.occluded(ray, &mut tally)));
        assert_eq!(tally.invalid_rays, bad.len() as u64);
    }
}

#[test]
fn a_ray_without_direction_meets_nothing() {
    let triangles = Arc::new(soup(100, 1.0, 8).into_iter().collect::<Triangles>());
    let kinds = [(true, false), (false, false), (true, true)];
    let grids = kinds.map(|(nested, lazy)| GridOptions { nested, lazy, ..Default::default() });
    let options = grids.map(|grid| BuildOptions { grid, ..Default::default() });
    // In the middle of them, on a corner of each, and far away.
    let corners = (0..100).map(|id| triangles.get(id)[0]);
    let origins: Vec<Vec3> = corners.chain([Vec3::splat(0.1), Vec3::splat(1e30)]).collect();
    for backend in Backend::ALL.into_iter().filter(|backend| backend.is_built_in()) {
        for test in Test::ALL.into_iter().filter(|&test| backend.has(test)) {
            for options in &options[..if backend == Backend::Grid { 3 } else { 1 }] {
                let occlusion = build(backend, test, &triangles, options).unwrap();
                for &origin in &origins {
                    for ray in [Ray::between(origin, origin), Ray::towards(origin, Vec3::ZERO)] {
                        let (tally, what) = (&mut Tally::default(), format!("{backend} {test}"));
                        assert!(!occlusion.occluded(&ray, tally), "{what}: {ray:?}");
                        assert_eq!(occlusion.nearest(&ray, tally), None, "{what}: {ray:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn an_arithmetic_is_used_where_this_cpu_has_it_and_refused_elsewhere() {
    let triangles = Arc::new(soup(100, 1.0, 8).into_iter().collect::<Triangles>());
    for arithmetic in Arithmetic::ALL {
        let options = BuildOptions { arithmetic: Some(arithmetic), ..Default::default() };
        for backend in [Backend::Brute, Backend::Grid, Backend::Bvh2, Backend::Cwbvh] {
            match build(backend, Test::Exact, &triangles, &options) {
                Ok(_) => assert!(arithmetic.is_available(), "{backend} {arithmetic:?}"),
                Err(BackendError::Arithmetic(refused)) => {
                    assert!(refused == arithmetic && !arithmetic.is_available(), "{backend}");
                }
                Err(other) => panic!("{backend} {arithmetic:?}: {other}"),
            }
        }
    }
}

#[test]
fn transparent_triangles_are_found_once_each_and_block_nothing() {
    let mesh = soup(600, 0.4, 9);
    let mut random = Random(19);
    // Mostly transparent, and mostly opaque: then they are looked for in a structure of their own.
    for (opaque, enough) in [(100, 5), (301, 3), (550, 1), (599, 0)] {
        let (opaque, transparent) = mesh.split_at(opaque);
        let triangles = Arc::new(Triangles::new(opaque.to_vec(), transparent.to_vec()));
        let only_opaque = Arc::new(Triangles::new(opaque.to_vec(), []));
        let options = BuildOptions::default();
        let brute = build(Backend::Brute, Test::Pluecker, &triangles, &options).unwrap();
        let reference = build(Backend::Brute, Test::Pluecker, &only_opaque, &options).unwrap();
        let others = backends(&triangles, Test::Pluecker, &options);
        let mut most = 0;
        for _ in 0..1000 {
            let ray = Aim::Random.ray(&mesh, &mut random);
            let tally = &mut Tally::default();
            let (mut expected, mut found) = (Vec::new(), Vec::new());
            brute.transparent(&ray, &mut expected, tally);
            assert!(expected.windows(2).all(|pair| pair[0] < pair[1]));
            most = most.max(expected.len());
            for other in &others {
                other.transparent(&ray, &mut found, tally);
                assert_eq!(found, expected);
                assert_eq!(other.occluded(&ray, tally), reference.occluded(&ray, tally));
            }
        }
        assert!(most > enough, "some rays pass many transparent triangles: {most}");
    }
}

/// What a test that rounds may err by is that of the world, however small the structure is that culls.
#[test]
fn a_speck_of_glass_in_a_large_world_is_found_by_every_test() {
    let world = soup(300, 0.4, 5).into_iter().map(|corners| corners.map(|corner| 1e3 * corner));
    let place = Vec3::new(900.0, -950.0, 870.0);
    for size in [1.0, 1e-3, 0.0] {
        let speck = soup(40, 0.4, 6).into_iter();
        let speck: Vec<_> =
            speck.map(|corners| corners.map(|corner| place + size * corner)).collect();
        let triangles = Arc::new(Triangles::new(world.clone(), speck.clone()));
        let options = BuildOptions::default();
        let mut random = Random(23);
        for test in Test::ALL {
            let brute = build(Backend::Brute, test, &triangles, &options).unwrap();
            let others = backends(&triangles, test, &options);
            let mut hits = 0;
            for number in 0..300 {
                let target = speck[number % speck.len()][number % 3] + size * random.in_cube(0.1);
                let origin = random.in_cube(10f32.powi(number as i32 % 7));
                let ray = Ray { end: f32::INFINITY, ..Ray::between(origin, target) };
                let (mut expected, mut found) = (Vec::new(), Vec::new());
                brute.transparent(&ray, &mut expected, &mut Tally::default());
                for other in &others {
                    other.transparent(&ray, &mut found, &mut Tally::default());
                    assert_eq!(found, expected, "{test}, size {size}: {ray:?}");
                }
                hits += expected.len();
            }
            assert!(hits > 50 || size == 0.0, "{test}, size {size}: {hits}");
        }
    }
}

/// Triangles that lie in each other like shells, the smallest first: trees over them are chains, hundreds of levels deep.
fn shells(count: usize, ratio: f32, copies: usize) -> Vec<Triangle> {
    let mut random = Random(11);
    let mut mesh = Vec::new();
    for shell in (0..count).rev() {
        let size = ratio.powi(shell as i32);
        for _ in 0..copies {
            let side = |bit: usize| if bit == 0 { -size } else { size };
            let corner = Vec3::from_array(std::array::from_fn(|_| side(random.below(2))));
            mesh.push([corner, -corner, random.in_cube(size)]);
        }
    }
    mesh
}

#[test]
fn trees_of_any_depth_lose_nothing() {
    let deep = [(36, 0.8, 16), (60, 0.9, 20), (900, 0.99, 20)];
    for mesh in deep.map(|(count, ratio, copies)| shells(count, ratio, copies)) {
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        let options = BuildOptions::default();
        let brute = build(Backend::Brute, Test::Exact, &triangles, &options).unwrap();
        let others = backends(&triangles, Test::Exact, &options);
        let mut random = Random(12);
        for i in 0..3000 {
            // Through one of them, and not far beyond.
            let [a, b, c] = mesh[random.below(mesh.len())];
            let through = a + random.unit() * (b - a + random.unit() * (c - b));
            let normal = (b - a).cross(c - a).normalize() * (b - a).length();
            let step = normal * random.unit().powi(6);
            let ray = Ray::between(through - step, through + step);
            let tally = &mut Tally::default();
            let expected = brute.occluded(&ray, tally);
            for (backend, other) in OWN.iter().zip(&others) {
                let what = format!("{backend} on {} triangles, ray {i}: {ray:?}", mesh.len());
                assert_eq!(other.occluded(&ray, tally), expected, "{what}");
            }
        }
    }
}

#[test]
fn a_ray_that_starts_just_before_a_triangle_sees_it_however_its_distance_rounds() {
    let near = [[-8.0, -8.0, 8.0], [8.0, -8.0, -8.0], [-2.4, 8.0, 3.2]];
    let far = [[50.0, -30.0, -30.0], [50.0, 40.0, -30.0], [50.0, 0.0, 40.0]];
    let mesh = [near, far].map(|triangle| triangle.map(Vec3::from));
    let (origin, direction) = (Vec3::new(-1.2, 3.8e-15, 1.6), Vec3::new(33.0, 10.0, 3.5));
    // The plane is 5.3e-18 away, which f64 cancels.
    let ray = Ray { origin, direction, end: f32::INFINITY };
    let tally = &mut Tally::default();
    for mesh in [&mesh[..], &mesh[..1]] {
        let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
        let options = BuildOptions::default();
        let mut all = backends(&triangles, Test::Exact, &options);
        all.push(build(Backend::Brute, Test::Exact, &triangles, &options).unwrap());
        for backend in all {
            assert!(backend.meets(0, &ray, tally));
            let nearest = backend.nearest(&ray, tally).expect("it is in the way");
            assert_eq!(nearest.triangle, 0);
            assert!(nearest.t > 0.0 && nearest.t < 1e-5, "{nearest:?}");
        }
    }
}
