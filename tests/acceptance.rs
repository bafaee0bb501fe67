//! What Embree's own test program (`tutorials/verify`) asks of Embree, as far as it applies to triangle
//! occlusion, asked of every backend. Written anew; each test names what it is after, and its criterion is
//! Embree's or a stricter one.

mod common;

use std::sync::Arc;

use common::{BACKENDS, Random, engine, soup, sphere};
use glam::Vec3;
use umbra::geometry::{Ray, Triangle, Triangles, is_finite};
use umbra::occlusion::{LeftOut, Occlusion, Tally, Test};

/// Embree's criterion for watertightness: at most this share of rays may leak.
const LEAKS_ALLOWED: f64 = 0.000_02;

/// Where Embree's tests put things that are far away.
const FAR_AWAY: Vec3 = Vec3::new(148_376.0, 1_234.0, -223_423.0);

/// A backend with a test of its, by name.
struct Contender {
    name: String,
    engine: Box<dyn Occlusion>,
}

impl Contender {
    fn blocked(&self, ray: &Ray) -> bool {
        self.engine.occluded(ray, &mut Tally::default())
    }
}

/// Every backend with every test that it has, over some triangles.
fn contenders(triangles: impl Into<Arc<Triangles>>) -> Vec<Contender> {
    contenders_with(triangles, &Test::ALL)
}

fn contenders_with(triangles: impl Into<Arc<Triangles>>, tests: &[Test]) -> Vec<Contender> {
    let triangles = triangles.into();
    let mut contenders = Vec::new();
    for &backend in BACKENDS {
        for &test in tests {
            if backend.has(test) {
                let engine = engine(backend, test, &triangles);
                contenders.push(Contender { name: format!("{backend} {test}"), engine });
            }
        }
    }
    contenders
}

fn mesh(triangles: impl IntoIterator<Item = Triangle>) -> Arc<Triangles> {
    Arc::new(triangles.into_iter().collect())
}

/// A square in the plane x = `x`, `side` × `side` quads.
fn plane(x: f32, half: f32, side: usize) -> Vec<Triangle> {
    let at = |i: usize| half * (2.0 * i as f32 / side as f32 - 1.0);
    let point = |i, j| Vec3::new(x, at(i), at(j));
    (0..side * side)
        .flat_map(|place| {
            let (i, j) = (place % side, place / side);
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i, j + 1), point(i + 1, j + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect()
}

/// The corners of four objects, as Embree's tests place them.
fn corners() -> [Vec3; 4] {
    [(-10.0, -10.0), (-10.0, 10.0), (10.0, -10.0), (10.0, 10.0)].map(|(x, z)| Vec3::new(x, 0.0, z))
}

#[test]
fn triangle_hit() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mut random = Random(1);
    for contender in contenders(mesh([triangle])) {
        for _ in 0..256 {
            let (u, v) = (random.between(0.001, 0.998), random.between(0.001, 0.998));
            if u + v > 0.999 {
                continue;
            }
            let origin = Vec3::new(0.0, 0.0, -1.0);
            let ray = Ray::towards(origin, u * Vec3::X + v * Vec3::Y - origin);
            assert!(contender.blocked(&ray), "{} {u} {v}", contender.name);
            let nearest = contender.engine.nearest(&ray, &mut Tally::default()).unwrap();
            let (close, what) =
                ((nearest.t - 1.0).abs() <= 16.0 * f64::from(f32::EPSILON), nearest.t);
            assert!(close, "{}: t = {what}", contender.name);
        }
    }
}

#[test]
fn both_sides_block() {
    for contender in contenders(mesh(plane(0.0, 1.0, 1))) {
        let mut random = Random(2);
        for _ in 0..1000 {
            let (y, z) = (random.between(-0.99, 0.99), random.between(-0.99, 0.99));
            for side in [-1.0, 1.0] {
                let ray = Ray::towards(Vec3::new(side, y, z), -side * Vec3::X);
                assert!(contender.blocked(&ray), "{} {ray:?}", contender.name);
            }
        }
    }
}

#[test]
fn watertight_triangles() {
    let meshes =
        [("sphere", mesh(sphere(FAR_AWAY, 2.0, 50))), ("plane", mesh(plane(FAR_AWAY.x, 6.0, 50)))];
    for (name, triangles) in meshes {
        // Embree asks it of its robust mode only.
        let robust = [Test::Pluecker, Test::Watertight, Test::Exact];
        for contender in contenders_with(triangles, &robust) {
            let mut random = Random(3);
            let (mut rays, mut leaks) = (0, 0);
            for _ in 0..5 * 5 {
                for batch in 1..30 {
                    let made: Vec<Ray> = (0..batch)
                        .map(|_| match name {
                            "sphere" => {
                                Ray::towards(FAR_AWAY + random.in_cube(1.0), random.in_cube(1.0))
                            }
                            _ => Ray::towards(
                                Vec3::new(FAR_AWAY.x - 3.0, 0.0, 0.0),
                                Vec3::new(1.0, 0.0, 0.0) + random.in_cube(1.0).with_x(0.0),
                            ),
                        })
                        .collect();
                    let mut blocked = vec![false; batch];
                    contender.engine.occluded_many(&made, &mut blocked, &mut Tally::default());
                    rays += batch;
                    leaks += blocked.iter().filter(|blocked| !**blocked).count();
                }
            }
            assert_eq!(rays, 10_875);
            let share = leaks as f64 / rays as f64;
            assert!(share <= LEAKS_ALLOWED, "{name}, {}: {leaks} leaks", contender.name);
        }
    }
}

#[test]
fn masks_opaque_and_transparent_geometry_each_block_their_own_rays() {
    // Embree's mask test: object j is seen iff its bit is set. Here a set bit makes it opaque.
    for mask in 0..16 {
        let is_opaque = |object: usize| mask & (1 << object) != 0;
        let balls = corners().map(|corner| sphere(corner, 1.0, 10));
        let some = |opaque: bool| {
            let kept = (0..4).filter(move |&object| is_opaque(object) == opaque);
            kept.flat_map(|object| balls[object].clone()).collect::<Vec<_>>()
        };
        let triangles = Arc::new(Triangles::new(some(true), some(false)));
        for contender in contenders(triangles) {
            for (object, corner) in corners().into_iter().enumerate() {
                // Just beside the pole; through the pole itself, default modes may leak.
                let origin = corner + Vec3::new(0.05, 10.0, 0.07);
                let ray = Ray::towards(origin, Vec3::NEG_Y);
                assert_eq!(contender.blocked(&ray), is_opaque(object), "{} {mask}", contender.name);
                let mut found = Vec::new();
                contender.engine.transparent(&ray, &mut found, &mut Tally::default());
                let expected = if is_opaque(object) { 0 } else { 2 };
                assert_eq!(found.len(), expected, "{} {mask} {object}", contender.name);
            }
        }
    }
}

#[test]
fn filter_one_triangle_may_be_left_out() {
    // Embree's filter test: 4 × 4 quads; here the filter rejects the one triangle a ray starts on.
    let quads = plane(-10.0, 4.0, 4);
    let triangles = mesh(quads.iter().copied());
    for contender in contenders(triangles.clone()) {
        let mut left_out = LeftOut::new(triangles.opaque_count(), false);
        for (id, triangle) in quads.iter().enumerate() {
            let target = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
            let ray = Ray::towards(Vec3::ZERO, target);
            let mut ask = |spawner| {
                left_out.begin(spawner);
                let engine = &contender.engine;
                engine.occluder_except(&ray, None, &mut left_out, &mut Tally::default())
            };
            assert_eq!(
                ask(None).map(|found| found.triangle),
                Some(id as u32),
                "{}",
                contender.name
            );
            assert_eq!(ask(Some(id as u32)), None, "{}", contender.name);
            let other = (id as u32 + 1) % quads.len() as u32;
            assert_eq!(ask(Some(other)).map(|found| found.triangle), Some(id as u32));
        }
    }
}

#[test]
fn filter_finds_every_transparent_hit_once() {
    // Embree's multi-hit test: two unit spheres, four hits.
    let balls = [0.0, 3.0].map(|z| sphere(Vec3::new(0.0, 0.0, z), 1.0, 20)).concat();
    let triangles = Arc::new(Triangles::new([], balls.iter().copied()));
    for contender in contenders(triangles) {
        let ray = Ray::towards(Vec3::new(0.01, 0.02, -5.0), Vec3::Z);
        let mut found = Vec::new();
        contender.engine.transparent(&ray, &mut found, &mut Tally::default());
        assert_eq!(found.len(), 4, "{}", contender.name);
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "ascending, each once");
        let mut places: Vec<f32> = found.iter().map(|&id| balls[id as usize][0].z).collect();
        places.sort_by(f32::total_cmp);
        for (place, expected) in places.iter().zip([-1.0, 1.0, 2.0, 4.0]) {
            assert!((place - expected).abs() < 0.2, "{}: {places:?}", contender.name);
        }
        assert!(!contender.blocked(&ray), "{}", contender.name);
    }
}

/// Rays that cannot be answered.
fn invalid(ray: Ray, kind: usize) -> Ray {
    match kind % 8 {
        0 => Ray { origin: Vec3::NAN, ..ray },
        1 => Ray { origin: ray.origin.with_y(f32::INFINITY), ..ray },
        2 => Ray { direction: Vec3::NAN, ..ray },
        3 => Ray { direction: ray.direction.with_z(f32::NEG_INFINITY), ..ray },
        4 => Ray { end: f32::NAN, ..ray },
        5 => Ray { end: 0.0, ..ray },
        6 => Ray { end: -1.0, ..ray },
        _ => Ray { origin: Vec3::NAN, direction: Vec3::NAN, end: f32::NAN },
    }
}

#[test]
fn inactive_rays_are_not_blocked_are_counted_and_disturb_no_neighbour() {
    let triangles = mesh(sphere(Vec3::ZERO, 2.0, 50));
    let mut contenders = contenders(triangles.clone());
    contenders.extend(embree_packets(&triangles));
    for contender in contenders {
        let mut random = Random(4);
        for batch in 1..100 {
            let bad: Vec<bool> = (0..batch).map(|_| random.below(2) == 0).collect();
            let rays: Vec<Ray> = bad
                .iter()
                .enumerate()
                .map(|(place, &bad)| {
                    let ray = Ray::towards(random.in_cube(1.0), random.in_cube(1.0) + 0.01);
                    if bad { invalid(ray, place) } else { ray }
                })
                .collect();
            let mut blocked = vec![true; batch];
            let mut tally = Tally::default();
            contender.engine.occluded_many(&rays, &mut blocked, &mut tally);
            for (place, &bad) in bad.iter().enumerate() {
                assert_eq!(blocked[place], !bad, "{} {:?}", contender.name, rays[place]);
            }
            assert_eq!(tally.invalid_rays, bad.iter().filter(|bad| **bad).count() as u64);
        }
    }
}

#[cfg(feature = "embree")]
fn embree_packets(triangles: &Arc<Triangles>) -> Vec<Contender> {
    use umbra::occlusion::{Backend, BuildOptions, EmbreeOptions, PacketWidth, build};
    let widths = [PacketWidth::Four, PacketWidth::Eight, PacketWidth::Sixteen];
    let built = widths.into_iter().flat_map(|width| [(width, false), (width, true)]).filter_map(
        |(width, coherent)| {
            let embree = EmbreeOptions { width, coherent, ..EmbreeOptions::default() };
            let options = BuildOptions { embree, ..BuildOptions::default() };
            // A width that this CPU lacks is refused.
            let engine = build(Backend::Embree, Test::Pluecker, triangles, &options).ok()?;
            Some(Contender { name: format!("embree {width:?} coherent {coherent}"), engine })
        },
    );
    let built: Vec<_> = built.collect();
    assert!(!built.is_empty(), "packets of four are everywhere");
    built
}

#[cfg(not(feature = "embree"))]
fn embree_packets(_: &Arc<Triangles>) -> Vec<Contender> {
    Vec::new()
}

#[test]
fn nan_and_infinite_rays_cost_nothing_and_are_not_blocked() {
    // Embree asks that they take no more than 2.5 times as long; here they traverse nothing at all.
    for contender in contenders(mesh(sphere(Vec3::ZERO, 2.0, 100))) {
        let mut tally = Tally::default();
        let good = Ray::towards(Vec3::ZERO, Vec3::ONE);
        for kind in 0..1000 {
            let ray = invalid(good, kind);
            assert!(!contender.engine.occluded(&ray, &mut tally), "{} {ray:?}", contender.name);
            assert!(contender.engine.occluder(&ray, &mut tally).is_none(), "{}", contender.name);
            assert!(contender.engine.nearest(&ray, &mut tally).is_none(), "{}", contender.name);
        }
        let expected = Tally { invalid_rays: 3000, ..Tally::default() };
        assert_eq!(tally, expected, "{}", contender.name);
    }
}

#[test]
fn update_moved_geometry_is_built_anew_and_every_ray_hits() {
    for step in 0..16 {
        // Object k has moved as often as bit k was set so far.
        let mut places = corners();
        for earlier in 0..=step {
            for (object, place) in places.iter_mut().enumerate() {
                if earlier & (1 << object) != 0 {
                    *place += Vec3::new(2.0, 0.1, 2.0);
                }
            }
        }
        let balls = places.map(|place| sphere(place, 1.0, 10)).concat();
        for contender in contenders(mesh(balls)) {
            for place in places {
                let ray = Ray::towards(place + Vec3::new(0.1, 10.0, 0.1), Vec3::NEG_Y);
                assert!(contender.blocked(&ray), "{} step {step}", contender.name);
            }
        }
    }
}

#[test]
fn enable_disable_geometry() {
    for enabled in 0..16 {
        let is_there = |object: usize| enabled & (1 << object) != 0;
        let balls = (0..4).filter(|&object| is_there(object));
        let balls: Vec<_> = balls.flat_map(|object| sphere(corners()[object], 1.0, 10)).collect();
        for contender in contenders(mesh(balls)) {
            for (object, corner) in corners().into_iter().enumerate() {
                let ray = Ray::towards(corner + Vec3::new(0.1, 10.0, 0.1), Vec3::NEG_Y);
                assert_eq!(
                    contender.blocked(&ray),
                    is_there(object),
                    "{} {enabled}",
                    contender.name
                );
            }
        }
    }
}

#[test]
fn empty_scene() {
    for contender in contenders(mesh([])) {
        let ray = Ray::towards(Vec3::ZERO, Vec3::X);
        let (tally, found) = (&mut Tally::default(), &mut vec![7]);
        assert!(!contender.blocked(&ray), "{}", contender.name);
        assert!(contender.engine.occluder(&ray, tally).is_none());
        assert!(contender.engine.nearest(&ray, tally).is_none());
        contender.engine.transparent(&ray, found, tally);
        assert!(found.is_empty() && contender.engine.order().is_empty(), "{}", contender.name);
    }
}

#[test]
fn a_scene_of_transparent_triangles_alone_blocks_nothing() {
    let ball = sphere(Vec3::ZERO, 1.0, 8);
    for contender in contenders(Arc::new(Triangles::new([], ball))) {
        assert!(!contender.blocked(&Ray::towards(Vec3::ZERO, Vec3::X)), "{}", contender.name);
    }
}

#[test]
fn many_builds_of_one_triangle() {
    for triangle in soup(50, 0.5, 5) {
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let ray =
            Ray::between(middle + Vec3::new(0.3, 1.0, 0.2), middle - Vec3::new(0.3, 1.0, 0.2));
        for contender in contenders(mesh([triangle])) {
            assert!(contender.blocked(&ray), "{} {triangle:?}", contender.name);
        }
    }
}

#[test]
fn bounds_are_exact() {
    let ball = sphere(Vec3::ONE, 1.5, 16);
    let low = ball.iter().flatten().fold(Vec3::INFINITY, |low, corner| low.min(*corner));
    let high = ball.iter().flatten().fold(Vec3::NEG_INFINITY, |high, corner| high.max(*corner));
    let bounds = mesh(ball).bounds().unwrap();
    assert_eq!((bounds.min, bounds.max), (low, high));
}

/// Triangles of any bits.
fn garbage(count: usize, random: &mut Random) -> Vec<Triangle> {
    let mut any = || f32::from_bits(random.bits() as u32);
    (0..count).map(|_| [0; 3].map(|_| Vec3::new(any(), any(), any()))).collect()
}

#[test]
fn garbage_geometry_builds_and_blocks_only_what_is_there() {
    let mut random = Random(6);
    for scene in 0..60 {
        let mut triangles = garbage(20, &mut random);
        // A third of the scenes have something sane among it.
        if scene % 3 == 0 {
            triangles.extend(sphere(Vec3::ZERO, 1.0, 6));
        }
        // And some that would be in the way if they were finite.
        triangles.extend(soup(20, 0.5, scene).into_iter().map(|[a, b, _]| [a, b, Vec3::NAN]));
        let all = contenders(mesh(triangles.iter().copied()));
        let there = contenders(mesh(triangles.into_iter().filter(is_finite)));
        for _ in 0..100 {
            let ray = Ray::towards(random.in_cube(2.0), random.in_cube(1.0));
            let exact = all.iter().filter(|contender| contender.name.ends_with("exact"));
            let answers: Vec<_> = exact.map(|contender| contender.blocked(&ray)).collect();
            assert!(answers.iter().all(|answer| *answer == answers[0]), "{ray:?} {answers:?}");
            for (all, there) in all.iter().zip(&there) {
                assert_eq!(all.blocked(&ray), there.blocked(&ray), "{} {ray:?}", all.name);
            }
        }
    }
}

#[test]
fn triangles_that_are_not_finite_block_nothing_and_hide_nothing() {
    let mut broken = Vec::new();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for corner in 0..3 {
            for axis in 0..3 {
                let mut triangle = [Vec3::NEG_ONE, Vec3::X, Vec3::Y];
                triangle[corner][axis] = value;
                broken.push(triangle);
            }
        }
    }
    for contender in contenders(mesh(broken.iter().copied())) {
        let mut random = Random(7);
        for _ in 0..500 {
            let ray = Ray::towards(random.in_cube(2.0), random.in_cube(1.0));
            assert!(!contender.blocked(&ray), "{} {ray:?}", contender.name);
        }
    }
    broken.extend(sphere(Vec3::ZERO, 1.0, 12));
    for contender in contenders(mesh(broken)) {
        let mut random = Random(8);
        for _ in 0..500 {
            let ray = Ray::towards(random.in_cube(0.4), random.in_cube(1.0));
            assert!(contender.blocked(&ray), "{} {ray:?}", contender.name);
        }
    }
}

#[test]
fn overlapping_primitives() {
    // More copies of one triangle than any leaf or voxel should hold.
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for copies in [1_000, 30_000] {
        for contender in contenders(mesh(std::iter::repeat_n(triangle, copies))) {
            let through = |x: f32| Ray::towards(Vec3::new(x, 0.25, -1.0), Vec3::Z);
            assert!(contender.blocked(&through(0.25)), "{} {copies}", contender.name);
            assert!(!contender.blocked(&through(0.8)), "{} {copies}", contender.name);
            // The grid once listed half of the copies in half of its voxels.
            let memory = contender.engine.memory();
            assert!(memory < 1000 * copies, "{} {copies}: {memory} bytes", contender.name);
        }
    }
}

#[test]
fn triangles_on_the_planes_of_spatial_splits() {
    // Coordinates on which Embree's splitting of triangles once divided by nothing.
    let coordinates = [-6.400_002_4, 25.6, 34.0, 57.600_002];
    let mut random = Random(9);
    let mut any = || coordinates[random.below(4)];
    let triangles: Vec<Triangle> =
        (0..200).map(|_| [0; 3].map(|_| Vec3::new(any(), any(), any()))).collect();
    let exact: Vec<_> = contenders(mesh(triangles.iter().copied()));
    let mut random = Random(10);
    let mut blocked = 0;
    for _ in 0..300 {
        let ray = Ray::between(25.0 + random.in_cube(40.0), 25.0 + random.in_cube(40.0));
        let answers: Vec<_> = exact.iter().map(|contender| contender.blocked(&ray)).collect();
        blocked += u32::from(answers[0]);
        let differ = answers.iter().filter(|answer| **answer != answers[0]).count();
        assert_eq!(differ, 0, "generic rays are easy for every test: {ray:?}");
    }
    assert!(blocked > 100, "{blocked}");
    #[cfg(feature = "embree")]
    high_quality_builds(&triangles);
}

#[cfg(feature = "embree")]
fn high_quality_builds(triangles: &[Triangle]) {
    use umbra::occlusion::{Backend, BuildOptions, EmbreeOptions, Quality, build};
    let embree = EmbreeOptions { quality: Quality::High, ..EmbreeOptions::default() };
    let options = BuildOptions { embree, ..BuildOptions::default() };
    let built = build(Backend::Embree, Test::Moller, &mesh(triangles.iter().copied()), &options);
    assert!(built.is_ok());
}

#[test]
fn occluded_and_nearest_agree() {
    // Embree's "IntersectOccluded" variant of every test.
    let triangles = soup(300, 0.3, 11);
    for contender in contenders(mesh(triangles.iter().copied())) {
        let mut random = Random(12);
        for _ in 0..500 {
            let ray = Ray::between(random.in_cube(1.5), random.in_cube(1.5));
            let tally = &mut Tally::default();
            let blocked = contender.blocked(&ray);
            let nearest = contender.engine.nearest(&ray, tally);
            let occluder = contender.engine.occluder(&ray, tally);
            assert_eq!(nearest.is_some(), blocked, "{} {ray:?}", contender.name);
            assert_eq!(occluder.is_some(), blocked, "{} {ray:?}", contender.name);
        }
    }
}

#[test]
fn random_scenes_of_all_kinds_build_and_answer() {
    // Embree's regression test: nothing may crash, whatever the scene and the rays.
    let mut random = Random(13);
    for scene in 0..30 {
        let mut triangles = Vec::new();
        for _ in 0..1 + random.below(4) {
            let centre = random.in_cube(10.0);
            match random.below(6) {
                0 => triangles.extend(sphere(centre, random.unit(), 5)),
                1 => triangles.extend(plane(centre.x, 1.0, 4)),
                2 => triangles.extend(garbage(10, &mut random)),
                3 => triangles.extend(std::iter::repeat_n([centre; 3], 10)),
                4 => triangles.extend(std::iter::repeat_n([1e30 * Vec3::X, centre, Vec3::Y], 5)),
                _ => triangles.extend(soup(50, 0.5, random.bits())),
            }
        }
        for contender in contenders(mesh(triangles)) {
            for kind in 0..100 {
                let origin = random.in_cube(10.0) * [1.0, 1e30][random.below(2)];
                let ray = Ray::towards(origin, random.in_cube(1.0));
                let ray = if kind % 10 == 0 { invalid(ray, kind / 10) } else { ray };
                let blocked = contender.blocked(&ray);
                assert!(ray.is_valid() || !blocked, "{} scene {scene} {ray:?}", contender.name);
            }
        }
    }
}
