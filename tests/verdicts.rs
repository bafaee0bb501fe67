//! A verdict says what is so, or nothing.

mod common;
#[path = "common/rooms.rs"]
mod rooms;

use common::{Random, soup, sphere};
use glam::{Vec3, vec3};
use umbra::exact::{Verdict, oracle::verdict_of_scene};
use umbra::geometry::Triangle;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};
use umbra::scene::{Draft, DraftTriangle, Light, Scene};
use umbra::shadow::{
    Answer, Combination, Method, Outcome, Path, Settled, ShadowQuery, VerdictKind, prepare,
};

fn point(position: Vec3) -> Light {
    Light::Point { position: position.as_dvec3(), intensity: Vec3::ONE }
}

fn sun(direction: Vec3) -> Light {
    Light::Directional { direction: direction.as_dvec3(), irradiance: Vec3::ONE }
}

fn scene(mesh: &[Triangle], lights: Vec<Light>) -> Scene {
    let triangle = |corners: &Triangle| DraftTriangle {
        corners: corners.map(|corner| corner.as_dvec3()),
        normals: [Vec3::ZERO; 3],
        material: 0,
    };
    let triangles = mesh.iter().map(triangle).collect();
    Draft { triangles, lights, ..Draft::default() }.finish().unwrap()
}

/// Every backend, with the exact test where it has one.
fn backends(scene: &Scene) -> Vec<(Backend, Box<dyn Occlusion>)> {
    let made = rooms::BACKENDS.iter().filter_map(|&name| {
        let options = BuildOptions::default();
        Some((name, build(name, name.default_test(), &scene.triangles, &options).ok()?))
    });
    made.collect()
}

/// Points where it is easy to be wrong: on triangles, beside them, at corners, on planes of voxels, and
/// anywhere.
fn origin(scene: &Scene, random: &mut Random) -> Vec3 {
    let bounds = scene.bounds();
    let corners = scene.triangles.get(random.below(scene.triangles.len()) as u32);
    let [a, b, c] = corners;
    let (s, t) = (random.unit(), random.unit());
    let on = a + s * (b - a) + t * (1.0 - s) * (c - a);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let size = bounds.extent().max_element();
    let places = Vec3::from_array(std::array::from_fn(|_| random.below(9) as f32 / 8.0));
    match random.below(7) {
        0 => on,
        1 => on + 1e-5 * size * normal,
        2 => on - 1e-5 * size * normal,
        3 => corners[random.below(3)],
        4 => bounds.min + places * bounds.extent(),
        5 => bounds.centre().as_vec3() + random.in_cube(0.6 * size),
        _ => a + s * (b - a),
    }
}

fn queries(scene: &Scene, light: &Light, count: usize, random: &mut Random) -> Vec<ShadowQuery> {
    let query = |origin| ShadowQuery { ray: light.shadow_ray(origin), path: Path::EYE, spawner: 0 };
    (0..count).map(|_| query(origin(scene, random))).collect()
}

/// Answers with every verdict, alone and before a memory, over every backend: those that verdicts give
/// must be exact, the others must be the backend's. The oracle judges one query in `oracle`.
fn check(scene: &Scene, count: usize, oracle: usize, seed: u64) -> [Settled; VerdictKind::COUNT] {
    let mut random = Random(seed);
    let asked: Vec<Vec<ShadowQuery>> =
        scene.lights.iter().map(|light| queries(scene, light, count, &mut random)).collect();
    let exact = build(Backend::Brute, Test::Exact, &scene.triangles, &BuildOptions::default());
    let exact = exact.unwrap();
    let mesh: Vec<Triangle> =
        (0..scene.triangles.opaque_count()).map(|id| scene.triangles.get(id)).collect();
    let mut sum = [Settled::default(); VerdictKind::COUNT];
    for (name, backend) in backends(scene) {
        for kind in VerdictKind::ALL {
            for method in [Method::Trace, Method::CacheTree] {
                let combination = Combination { method, ..kind.into() };
                let prepared = prepare(combination, scene, &*backend).unwrap();
                let mut worker = prepared.worker();
                for (light, asked) in asked.iter().enumerate() {
                    let mut answers = vec![Answer::default(); asked.len()];
                    worker.answer(light, asked, &mut answers);
                    for (place, (query, answer)) in asked.iter().zip(answers).enumerate() {
                        let what = || format!("{combination} {name}: light {light}, {query:?}");
                        let settled =
                            matches!(answer.outcome, Outcome::VerdictBlocked | Outcome::VerdictLit);
                        let judge = if settled { &*exact } else { &*backend };
                        let expected = judge.occluded(&query.ray, &mut Tally::default());
                        assert_eq!(answer.blocked, expected, "{}", what());
                        if settled && place % oracle == 0 {
                            let (truth, _) = verdict_of_scene(&query.ray, mesh.iter().copied());
                            assert_eq!(answer.blocked, truth == Verdict::Blocked, "{}", what());
                        }
                    }
                }
                let tally = worker.tally();
                let settled = tally.verdicts[kind.index()];
                assert_eq!(
                    (settled.lit, settled.blocked),
                    (tally.verdict_lit, tally.verdict_blocked)
                );
                assert_eq!(settled.lit + settled.blocked + settled.passed_on, tally.queries);
                sum[kind.index()] += settled;
            }
        }
    }
    sum
}

/// Lights inside, outside, on a corner, on an edge, in a plane of a triangle, and far away; suns that
/// shine askew, along an axis and along a triangle's plane.
fn lights(mesh: &[Triangle], random: &mut Random) -> Vec<Light> {
    let [a, b, c] = mesh[random.below(mesh.len())];
    let normal = (b - a).cross(c - a);
    vec![
        point(random.in_cube(0.9)),
        point(random.in_cube(3.0)),
        point(a),
        point(b + 0.5 * (c - b)),
        point(a + 2.0 * (b - a) + 0.5 * (c - a)),
        point(a + 1e-4 * normal),
        point(1e6 * random.in_cube(1.0)),
        sun(random.in_cube(1.0).normalize_or(Vec3::X)),
        sun(Vec3::Y),
        sun((b - a).normalize_or(Vec3::Z)),
    ]
}

#[test]
fn verdicts_are_exact_on_soups() {
    let mut sum = [Settled::default(); VerdictKind::COUNT];
    for seed in 0..24 {
        let mut random = Random(seed);
        let (count, size) = [(12, 1.5), (40, 0.6), (300, 0.3)][seed as usize % 3];
        let mut mesh = soup(count, size, seed);
        if seed % 2 == 1 {
            // Corners on a coarse lattice: shared corners, edges and planes, copies, folds, slivers.
            let snap = |corner: Vec3| (corner * 4.0).round() / 4.0;
            mesh = mesh.iter().map(|corners| corners.map(snap)).collect();
        }
        let lights = lights(&mesh, &mut random);
        for (sum, settled) in sum.iter_mut().zip(check(&scene(&mesh, lights), 60, 3, seed)) {
            *sum += settled;
        }
    }
    for (kind, settled) in VerdictKind::ALL.iter().zip(sum) {
        assert!(settled.lit > 1000 && settled.blocked > 1000, "{kind}: {settled:?}");
    }
}

/// A lattice of quads, bent into the third dimension; `open` leaves out some.
fn cloth(n: usize, open: bool) -> Vec<Triangle> {
    let corner = |i: usize, j: usize| {
        let (x, z) = (i as f32 / n as f32 * 2.0 - 1.0, j as f32 / n as f32 * 2.0 - 1.0);
        vec3(x, 0.1 * (3.0 * x).sin() * (2.0 * z).cos(), z)
    };
    let mut mesh = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] =
                [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            if !open || (i * 7 + j * 3) % 5 != 0 {
                // Windings differ, as they do in files.
                mesh.push(if (i + j) % 3 == 0 { [a, c, b] } else { [a, b, c] });
                mesh.push([a, c, d]);
            }
        }
    }
    mesh
}

#[test]
fn verdicts_are_exact_on_meshes_closed_open_and_not_manifold() {
    let ball = sphere(Vec3::ZERO, 0.8, 7);
    let half: Vec<Triangle> =
        ball.iter().copied().filter(|[a, b, c]| a.y + b.y + c.y > 0.3).collect();
    let mut doubled = ball.clone();
    doubled.extend(half.iter().map(|&[a, b, c]| [b, a, c]));
    let floor = [[vec3(-2., -1., -2.), vec3(2., -1., -2.), vec3(0., -1., 3.)]];
    let mut standing = ball.clone();
    standing.extend(floor);
    for (name, mesh) in [
        ("ball", ball),
        ("half a ball", half),
        ("a ball with a double shell", doubled),
        ("a ball on a floor", standing),
        ("cloth", cloth(8, false)),
        ("cloth with holes", cloth(8, true)),
        ("a triangle", floor.to_vec()),
    ] {
        let mut random = Random(7);
        let mut all = lights(&mesh, &mut random);
        all.extend([point(Vec3::ZERO), point(vec3(0., 3., 0.)), point(vec3(0.05, -0.7, 0.1))]);
        for (kind, settled) in VerdictKind::ALL.iter().zip(check(&scene(&mesh, all), 150, 5, 11)) {
            assert!(settled.lit + settled.blocked > 0, "{kind}, {name}: {settled:?}");
        }
    }
}
