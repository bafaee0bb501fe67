//! A verdict says what is so, or nothing.

mod common;
#[path = "common/rooms.rs"]
mod rooms;

use std::collections::BTreeSet;

use common::lit::{point, scene, sun};
use common::{BACKENDS, REAL_SCENES, Random, engine, real_scenes, soup, sphere};
use glam::{Vec3, vec3};
use umbra::exact::{Verdict, oracle::verdict_of_scene};
use umbra::geometry::{Triangle, TriangleId};
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Tally, Test, build};
use umbra::render::{Order, Progress, Rendered, Settings, Shown, render};
use umbra::scene::{Draft, DraftTriangle, Light, Material, Scene, builtin, load};
use umbra::shadow::{
    Answer, Combination, Method, MethodError, Outcome, Panes, Path, Plan, SelfShadow, Settled,
    ShadowQuery, VerdictKind, prepare,
};

/// Every backend, with the exact test where it has one.
fn backends(scene: &Scene) -> Vec<(Backend, Box<dyn Occlusion>)> {
    let made = |&name: &Backend| (name, engine(name, name.default_test(), &scene.triangles));
    BACKENDS.iter().map(made).collect()
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
    for seed in 0..12 {
        let mut random = Random(seed);
        let (count, size) = [(12, 1.5), (40, 0.6), (300, 0.3)][seed as usize % 3];
        let mut mesh = soup(count, size, seed);
        if seed % 2 == 1 {
            // Corners on a coarse lattice: shared corners, edges and planes, copies, folds, slivers.
            let snap = |corner: Vec3| (corner * 4.0).round() / 4.0;
            mesh = mesh.iter().map(|corners| corners.map(snap)).collect();
        }
        let lights = lights(&mesh, &mut random);
        for (sum, settled) in sum.iter_mut().zip(check(&scene(&mesh, lights), 60, 20, seed)) {
            *sum += settled;
        }
    }
    for (kind, settled) in VerdictKind::ALL.iter().zip(sum) {
        assert!(settled.lit > 500 && settled.blocked > 500, "{kind}: {settled:?}");
    }
}

#[test]
fn shafts_find_every_pane_of_glass_that_a_query_meets() {
    let glass = Material { transmission: Vec3::splat(0.5), ..Material::default() };
    let (mut clear, mut behind_one, mut behind_more) = (0, 0, 0);
    for seed in 0..6 {
        let mut random = Random(seed);
        let mesh = soup(60, 0.5, seed);
        let triangle = |(place, corners): (usize, &Triangle)| DraftTriangle {
            corners: corners.map(|corner| corner.as_dvec3()),
            normals: [Vec3::ZERO; 3],
            material: place as u32 % 2,
        };
        let draft = Draft {
            triangles: mesh.iter().enumerate().map(triangle).collect(),
            materials: vec![Material::default(), glass.clone()],
            lights: lights(&mesh, &mut random),
            ..Draft::default()
        };
        let scene = draft.finish().unwrap();
        let options = BuildOptions::default();
        let brute = build(Backend::Brute, Test::Exact, &scene.triangles, &options).unwrap();
        let prepared = prepare(VerdictKind::Shaft, &scene, &*brute).unwrap();
        let glass = prepared.glass().expect("half of the triangles are glass");
        let (mut found, mut panes) = (Vec::new(), Panes::default());
        for (light, source) in scene.lights.iter().enumerate() {
            let asked = queries(&scene, source, 150, &mut random);
            panes.begin(asked.len());
            glass.find(light, &asked, &mut panes, &mut Tally::default());
            for (place, query) in asked.iter().enumerate() {
                brute.transparent(&query.ray, &mut found, &mut Tally::default());
                let Some(met) = panes.of(place) else { continue };
                let met: BTreeSet<TriangleId> = met.collect();
                assert!(met.iter().eq(&found), "light {light}, {query:?}: {met:?}, {found:?}");
                clear += u32::from(found.is_empty());
                behind_one += u32::from(found.len() == 1);
                behind_more += u32::from(found.len() > 1);
            }
        }
    }
    let all = (clear, behind_one, behind_more);
    assert!(clear > 1000 && behind_one > 1000 && behind_more > 300, "{all:?}");
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
        for (kind, settled) in VerdictKind::ALL.iter().zip(check(&scene(&mesh, all), 150, 50, 11)) {
            assert!(settled.lit + settled.blocked > 0, "{kind}, {name}: {settled:?}");
        }
    }
}

fn picture(scene: &Scene, backend: &dyn Occlusion, plan: impl Into<Plan>) -> Rendered {
    let shadows = prepare(plan, scene, backend).unwrap();
    let settings = Settings {
        width: 40,
        height: 30,
        order: Order::Tiles,
        mask: true,
        answers: Some(Shown::default()),
        ..Settings::default()
    };
    render(scene, backend, &*shadows, &settings, &Progress::default()).unwrap()
}

fn assert_same(found: &Rendered, expected: &Rendered, what: &str) {
    assert!(found.film == expected.film, "{what}: other colours");
    assert!(found.mask == expected.mask, "{what}: other shadows");
}

#[test]
fn verdicts_change_no_picture_of_a_builtin_scene_over_any_backend() {
    for name in builtin::NAMES {
        let scene = builtin::draft_at(name, 0.02).unwrap().finish().unwrap();
        for (backend_name, backend) in backends(&scene) {
            // Embree has no exact test: what verdicts say before it is judged on soups.
            if matches!(backend_name, Backend::Embree | Backend::Brute) {
                continue;
            }
            let expected = picture(&scene, &*backend, Method::Trace);
            for kind in VerdictKind::ALL {
                for method in [Method::Trace, Method::CacheTree] {
                    let combination = Combination { method, ..kind.into() };
                    let found = picture(&scene, &*backend, combination);
                    assert_same(&found, &expected, &format!("{name} {backend_name} {combination}"));
                    let tally = found.statistics.shadows;
                    assert!(tally.verdict_lit > 0, "{name} {combination}");
                }
            }
        }
    }
}

#[test]
fn verdicts_change_no_picture_of_a_real_scene() {
    let Some(folder) = real_scenes() else { return };
    for name in REAL_SCENES {
        let scene = load(folder.join(name).to_str().unwrap()).unwrap();
        let options = BuildOptions::default();
        let backend = build(Backend::Grid, Test::Exact, &scene.triangles, &options).unwrap();
        let expected = picture(&scene, &*backend, Method::Trace);
        for kind in VerdictKind::ALL {
            // With room for all that they prepare: by the usual limit, some leave much to the backend.
            let found = picture(&scene, &*backend, Plan { budget: Some(4 << 30), ..kind.into() });
            assert_same(&found, &expected, &format!("{name} {kind}"));
            let tally = found.statistics.shadows;
            assert!(tally.verdict_lit + tally.verdict_blocked > 0, "{name} {kind}: {tally:?}");
        }
    }
}

#[test]
fn all_verdicts_go_together() {
    let scene = rooms::glass_room();
    let all = VerdictKind::ALL.into_iter();
    let verdicts = all.fold(Combination::default().verdicts, |set, kind| set.with(kind));
    for (name, backend) in backends(&scene).into_iter().filter(|(n, _)| *n != Backend::Embree) {
        let expected = picture(&scene, &*backend, Method::Trace);
        let found = picture(&scene, &*backend, Combination { verdicts, method: Method::Woo });
        assert_same(&found, &expected, &name.to_string());
        // Each is asked what those before it passed on.
        let tally = found.statistics.shadows;
        let mut asked = tally.queries;
        for settled in tally.verdicts {
            assert_eq!(settled.lit + settled.blocked + settled.passed_on, asked);
            asked = settled.passed_on;
        }
    }
}

#[test]
fn pictures_of_the_answers_show_what_verdicts_settled() {
    let scene = rooms::glass_room();
    let (_, grid) = &backends(&scene)[0];
    for kind in VerdictKind::ALL {
        let found = picture(&scene, &**grid, kind);
        let (map, tally) = (found.answers.unwrap(), found.statistics.shadows);
        let mut sums = [0u64; Outcome::ALL.len()];
        for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
            for (sum, n) in sums.iter_mut().zip(map.at(x, y).outcomes) {
                *sum += u64::from(n);
            }
        }
        assert!(tally.verdict_lit > 0 && tally.verdict_blocked > 0, "{kind}");
        assert_eq!(sums[Outcome::VerdictLit as usize], tally.verdict_lit);
        assert_eq!(sums[Outcome::VerdictBlocked as usize], tally.verdict_blocked);
    }
}

#[test]
fn counts_are_the_same_for_any_number_of_threads() {
    let scene = rooms::glass_room();
    let (_, grid) = &backends(&scene)[0];
    for kind in VerdictKind::ALL {
        let statistics = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| picture(&scene, &**grid, kind)).statistics
        };
        assert_eq!(statistics(1), statistics(3), "{kind}");
    }
}

#[test]
fn nothing_is_lost_when_the_memory_limit_shrinks_a_structure_to_nothing() {
    let scene = rooms::small_chair_room();
    let (_, grid) = &backends(&scene)[0];
    let expected = picture(&scene, &**grid, Method::Trace);
    for kind in VerdictKind::ALL {
        let mut settled = Vec::new();
        for bytes in std::iter::once(u64::MAX).chain((0..22).rev().map(|power| 1 << power)) {
            let budget = bytes.saturating_add(grid.memory() as u64);
            let plan = Plan { budget: Some(budget), ..kind.into() };
            let what = format!("{kind} within {bytes} bytes");
            let found = picture(&scene, &**grid, plan);
            assert_same(&found, &expected, &what);

            let prepared = prepare(plan, &scene, &**grid).unwrap();
            let settings = Settings { width: 40, height: 30, ..Settings::default() };
            render(&scene, &**grid, &*prepared, &settings, &Progress::default()).unwrap();
            assert!(prepared.memory() as u64 <= bytes, "{what}: {} bytes", prepared.memory());
            let [report] = &prepared.verdicts()[..] else { panic!("one verdict, one report") };
            assert_eq!((report.verdict, report.bytes), (kind, prepared.memory()));
            let shadows = found.statistics.shadows;
            let now = shadows.verdict_lit + shadows.verdict_blocked;
            if settled.first().is_some_and(|&all| now < all) {
                assert!(!report.notes.is_empty(), "{what}: says nothing");
            }
            settled.push(now);
        }
        assert!(settled[0] > 0 && *settled.last().unwrap() == 0, "{kind}: {settled:?}");
        // Shafts need their tree whole.
        let shrinks = settled.windows(2).any(|pair| pair[1] < pair[0] && pair[1] > 0);
        assert!(shrinks || kind == VerdictKind::Shaft, "{kind}: {settled:?}");
    }
}

#[test]
fn a_verdict_does_not_go_with_leaving_out_the_spawner() {
    let scene = rooms::glass_room();
    let (_, grid) = &backends(&scene)[0];
    for kind in VerdictKind::ALL {
        let plan = Plan { self_shadow: SelfShadow::Exclude, ..kind.into() };
        let refused = prepare(plan, &scene, &**grid).err().unwrap();
        assert!(matches!(refused, MethodError::LeavesOut(_)), "{refused}");
    }
}

#[test]
fn rays_that_do_not_go_to_the_light_are_passed_on() {
    let scene = rooms::glass_room();
    let (_, grid) = &backends(&scene)[0];
    let good = scene.lights[0].shadow_ray(vec3(0.1, 0.2, 0.3));
    let mut strange = [good; 6];
    strange[0].direction *= 0.5;
    strange[1].end = f32::INFINITY;
    strange[2].end = 0.5;
    strange[3].origin = Vec3::NAN;
    strange[4] = scene.lights[2].shadow_ray(good.origin);
    strange[5] = scene.lights[0].shadow_ray(Vec3::splat(1e7));
    for kind in VerdictKind::ALL {
        let prepared = prepare(kind, &scene, &**grid).unwrap();
        let mut worker = prepared.worker();
        for ray in strange {
            let mut answer = [Answer::default()];
            worker.answer(0, &[ShadowQuery { ray, path: Path::EYE, spawner: 0 }], &mut answer);
            assert_eq!(answer[0].blocked, grid.occluded(&ray, &mut Tally::default()), "{ray:?}");
        }
        let tally = worker.tally();
        // Shafts have no reach: a ray to the light is one from however far away.
        let strange = if kind == VerdictKind::Shaft { 5 } else { 6 };
        assert_eq!(tally.verdicts[kind.index()].passed_on, strange, "{kind}");
        assert_eq!(tally.backend.invalid_rays, 1);
    }
}

#[test]
fn a_fold_covers_nothing_beyond_its_edge() {
    // Two sheets that hang together at an edge above the floor, both to its left.
    let (near, far) = (vec3(0.3, 0.0, -9.0), vec3(0.3, 0.0, 9.0));
    let floor = [vec3(-9.0, -2.0, -9.0), vec3(9.0, -2.0, -9.0), vec3(0.0, -2.0, 9.0)];
    let mesh = [[near, far, vec3(-30.0, 0.0, 0.0)], [far, near, vec3(-30.0, 1.0, 0.0)], floor];
    let lights = vec![point(vec3(0.0, 12.0, 0.0)), point(vec3(0.2, 9.0, 1.0)), sun(Vec3::Y)];
    let scene = scene(&mesh, lights);
    for seed in 0..4 {
        for (kind, settled) in VerdictKind::ALL.iter().zip(check(&scene, 400, 100, seed)) {
            assert!(settled.lit > 0 && settled.blocked > 0, "{kind}: {settled:?}");
        }
    }
}

#[test]
fn a_fold_right_above_a_small_voxel_covers_nothing_beyond_its_edge() {
    // The same fold, with small triangles far away, so that voxels are small: the shaft of one that its edge crosses
    // meets no other edge, and only the side on which both sheets lie says that some of its light comes through.
    let mut random = Random(3);
    let filler = |_| -> Triangle {
        let corner = vec3(-28.0, -1.9, 6.0) + 1.5 * random.in_cube(1.0) * vec3(1.0, 0.05, 1.0);
        [corner, corner + vec3(0.1, 0.0, 0.0), corner + vec3(0.0, 0.0, 0.1)]
    };
    let fillers: Vec<Triangle> = (0..6000).map(filler).collect();
    // Voxels are half a unit wide or so: some of these edges cross one right of its middle.
    for step in 0..8 {
        let x = 0.1 * step as f32;
        let (near, far) = (vec3(x, 0.0, -9.0), vec3(x, 0.0, 9.0));
        let fold = [[near, far, vec3(-30.0, 0.0, 0.0)], [far, near, vec3(-30.0, 1.0, 0.0)]];
        let floor = [vec3(-30.0, -2.0, -9.0), vec3(9.0, -2.0, -9.0), vec3(9.0, -2.0, 9.0)];
        let mesh = [&fold[..], &[floor], &fillers].concat();
        let scene = scene(&mesh, vec![point(vec3(x, 12.0, 0.0))]);
        let kind = VerdictKind::VoxelOcclusion;
        let exact = Test::Exact;
        let grid = build(Backend::Grid, exact, &scene.triangles, &BuildOptions::default()).unwrap();
        let prepared = prepare(kind, &scene, &*grid).unwrap();
        let mut worker = prepared.worker();
        let across = (-40..=40).flat_map(|place| (-3..=3).map(move |row| (place, row)));
        let queries: Vec<ShadowQuery> = across
            .map(|(place, row)| {
                let origin = vec3(x + 0.03 * place as f32, -1.95, 0.4 * row as f32);
                let ray = scene.lights[0].shadow_ray(origin);
                ShadowQuery { ray, path: Path::EYE, spawner: 0 }
            })
            .collect();
        let mut answers = vec![Answer::default(); queries.len()];
        worker.answer(0, &queries, &mut answers);
        for (query, answer) in queries.iter().zip(&answers) {
            let blocked = grid.occluded(&query.ray, &mut Tally::default());
            assert_eq!(answer.blocked, blocked, "edge at {x}: {:?}", query.ray);
        }
        let settled = worker.tally().verdicts[kind.index()];
        assert!(settled.blocked > 0 && settled.lit > 0, "{settled:?}");
    }
}
