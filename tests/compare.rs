//! `umbra compare`: what is found, what is explained, and what the command says.

mod common;

use std::fs;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use common::command::{TRIANGLE, refused, run, said};
use common::{Aim, Random, soup, sphere};
use glam::Vec3;
use umbra::exact::Verdict;
use umbra::exact::adversary::{self, Class};
use umbra::geometry::lanes::Arithmetic;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::measure::compare::{Claim, CompareError, Comparison, Kind, Report, compare};
use umbra::measure::contender::{Choice, Contender};
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, Test};
use umbra::render::{Progress, RecordedQuery, Settings};
use umbra::scene::{Scene, builtin};
use umbra::shadow::{Combination, Path as RayPath, ShadowQuery};

/// A scene of these triangles, where they are.
fn scene_of(mesh: &[Triangle]) -> Scene {
    let mut scene = builtin::draft_at("drum", 0.01).unwrap().finish().unwrap();
    scene.name = "mesh".to_owned();
    scene.triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    scene
}

/// These rays as the queries of a picture, a pixel each.
fn recording_of(rays: &[Ray]) -> Recording {
    let queries = rays.iter().zip(0..).map(|(&ray, pixel)| RecordedQuery {
        query: ShadowQuery { ray, path: RayPath::EYE, spawner: 0 },
        light: 0,
        pixel: (pixel, 0),
        blocked: false,
    });
    Recording::new(rays.len() as u32, 1, vec![queries.collect()])
}

/// Rays of every kind, most of them hard.
fn hard_rays(mesh: &[Triangle], each: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random(seed);
    (0..each * Aim::ALL.len())
        .map(|i| Aim::ALL[i % Aim::ALL.len()].ray(mesh, &mut random))
        .collect()
}

fn compared(scene: &Scene, recording: &Recording, choice: &Choice) -> Report {
    compare(scene, recording, &choice.select().contenders, &AtomicU64::new(0)).unwrap()
}

fn recorded(scene: &Scene) -> Recording {
    let settings = Settings { width: 48, height: 36, depth: 3, ..Settings::default() };
    Recording::of(scene, &settings, &Progress::default()).unwrap()
}

fn answers(recording: &Recording, scene: &Scene, backend: Backend, test: Test) -> Vec<bool> {
    recording.answers_of(&*Contender::new(backend, test).build(&scene.triangles).unwrap())
}

/// The report on one contender's answers.
fn report_on(scene: &Scene, recording: &Recording, claim: Claim, answers: &[bool]) -> Report {
    let mut comparison = Comparison::new(scene, recording);
    comparison.enter("it", claim, answers);
    comparison.finish()
}

/// Every claim that this build knows of a contender.
fn claims() -> Vec<Claim> {
    let arithmetic = Arithmetic::of_this_cpu();
    vec![
        Claim::Exact,
        Claim::Test(Test::Pluecker, arithmetic),
        Claim::Test(Test::Moller, arithmetic),
        Claim::Single { robust: true, arithmetic, clipped: false, verdicts: false },
        Claim::Single { robust: true, arithmetic, clipped: false, verdicts: true },
        Claim::Single { robust: false, arithmetic, clipped: true, verdicts: false },
        Claim::Rounded { robust: true },
        Claim::Rounded { robust: false },
    ]
}

#[test]
fn exact_engines_with_every_method_never_disagree_on_the_builtin_scenes() {
    let choice =
        Choice { tests: vec![Test::Exact], methods: Choice::every_method(), ..Choice::default() };
    for name in builtin::NAMES {
        let scene = builtin::draft_at(name, 0.1).unwrap().finish().unwrap();
        let recording = recorded(&scene);
        let report = compared(&scene, &recording, &choice);
        assert!(report.disagreements.is_empty(), "{name}");
        assert_eq!(report.failure(), None, "{name}");
        assert_eq!(report.contenders.len(), 3 * choice.methods.len());
        assert!(report.checks.by_oracle > 0 && report.checks.by_brute_force > 0);
        assert!(report.blocked > 0 && report.clear > 0, "{name}: there is something to compare");
    }
}

#[test]
fn every_engine_and_test_is_explained_on_the_builtin_scenes() {
    for name in builtin::NAMES {
        let scene = builtin::draft_at(name, 0.1).unwrap().finish().unwrap();
        let report = compared(&scene, &recorded(&scene), &Choice::default());
        assert_eq!(report.failure(), None, "{name}: {}", report.listing(9));
    }
}

/// Small meshes and hard rays: about every third answer of an f32 test is in doubt here.
fn hard_scenes() -> Vec<(Scene, Recording)> {
    let far = Vec3::new(148_376.0, 1234.0, -223_423.0);
    let meshes = [
        soup(300, 0.3, 51),
        sphere(Vec3::ZERO, 1.0, 12),
        sphere(far, 2.0, 12),
        soup(1, 0.8, 52),
        soup(40, 1e-3, 53),
    ];
    let scenes =
        meshes.iter().map(|mesh| (scene_of(mesh), recording_of(&hard_rays(mesh, 200, 54))));
    scenes.collect()
}

#[test]
fn f32_tests_err_on_hard_rays_and_are_explained() {
    let mut wrong = 0;
    for (scene, recording) in hard_scenes() {
        let choice = Choice {
            backends: vec![Backend::Grid, Backend::Bvh2, Backend::Cwbvh, Backend::Brute],
            ..Choice::default()
        };
        let report = compared(&scene, &recording, &choice);
        assert_eq!(report.failure(), None, "{}", report.listing(9));
        wrong += report.disagreements.len();
    }
    assert!(wrong > 100, "only {wrong}: the rays are not hard");
}

#[cfg(feature = "embree")]
#[test]
fn every_embree_variant_of_this_cpu_is_explained_on_hard_rays() {
    let choice = Choice {
        backends: vec![Backend::Embree],
        embree: umbra::measure::contender::EmbreeVariant::all(),
        ..Choice::default()
    };
    let mut wrong = [0, 0];
    for (scene, recording) in hard_scenes() {
        let report = compared(&scene, &recording, &choice);
        assert_eq!(report.failure(), None, "{}", report.listing(20));
        for row in &report.contenders {
            wrong[usize::from(row.claim == "rounding")] += row.false_blocked + row.false_clear;
        }
    }
    assert!(wrong.iter().all(|count| *count > 100), "only {wrong:?}: the rays are not hard");
}

/// Rays of the adversary's class and their triangles, each ray as often as fills a packet: coherent packets take
/// their rays to be alike, and these are of all scales.
fn adversarial(class: Class) -> (Scene, Recording) {
    let queries = (0..).map(|index| adversary::query(class, index));
    // Loaders drop what is not finite.
    let finite = queries.filter(|(_, triangle)| triangle.iter().all(|corner| corner.is_finite()));
    let (rays, mesh): (Vec<Ray>, Vec<Triangle>) = finite.take(48).unzip();
    let rays: Vec<Ray> = rays.into_iter().flat_map(|ray| [ray; 16]).collect();
    (scene_of(&mesh), recording_of(&rays))
}

#[test]
fn every_contender_is_explained_on_the_adversarys_queries() {
    let trace = vec![Combination::default()];
    let choice = Choice { methods: trace, ..Choice::everything() };
    for &class in Class::ALL {
        let (scene, recording) = adversarial(class);
        let report = compared(&scene, &recording, &choice);
        assert_eq!(report.failure(), None, "{}: {}", class.name(), report.listing(5));
    }
}

#[test]
fn a_lie_is_found_whatever_is_claimed() {
    let scene = scene_of(&sphere(Vec3::ZERO, 1.0, 12));
    let mesh: Vec<Triangle> =
        (0..scene.triangles.len() as u32).map(|id| scene.triangles.get(id)).collect();
    // Ordinary rays, about which no rounding can be in doubt.
    let mut random = Random(55);
    let rays: Vec<Ray> = (0..500).map(|_| Aim::Random.ray(&mesh, &mut random)).collect();
    let recording = recording_of(&rays);
    let truth = answers(&recording, &scene, Backend::Brute, Test::Exact);
    for claim in claims() {
        assert_eq!(report_on(&scene, &recording, claim, &truth).failure(), None, "{claim:?}");
        for (lie, kind) in [(true, Kind::FalseBlocked), (false, Kind::FalseClear)] {
            let place = truth.iter().position(|blocked| *blocked != lie).unwrap();
            let mut lying = truth.clone();
            lying[place] = lie;
            let report = report_on(&scene, &recording, claim, &lying);
            let [found] = &report.disagreements[..] else { panic!("{claim:?} {report:?}") };
            assert_eq!(
                (found.query, found.kind, found.explained),
                (place, kind, false),
                "{claim:?}"
            );
            assert_eq!((found.pixel, found.ray), ((place as u32, 0), rays[place]));
            assert_eq!(report.contenders[0].unexplained, 1);
            let said = report.failure().unwrap();
            let expected =
                if claim == Claim::Exact { "claims to be exact" } else { "nothing explains" };
            assert!(said.contains(expected), "{said}");
        }
    }
}

#[test]
fn bounds_leave_hardly_any_ordinary_ray_in_doubt() {
    let mesh = soup(300, 0.3, 63);
    let scene = scene_of(&mesh);
    let mut random = Random(64);
    let rays: Vec<Ray> = (0..3000).map(|_| Aim::Random.ray(&mesh, &mut random)).collect();
    let recording = recording_of(&rays);
    let mut lies = answers(&recording, &scene, Backend::Brute, Test::Exact);
    lies.iter_mut().for_each(|blocked| *blocked = !*blocked);
    for claim in claims() {
        let found = report_on(&scene, &recording, claim, &lies).contenders[0].unexplained;
        assert!(found >= 2990, "{claim:?}: only {found} of 3000 lies were found");
    }
}

#[test]
fn a_wrong_answer_of_another_test_is_not_explained() {
    let mesh = soup(300, 0.3, 56);
    let scene = scene_of(&mesh);
    let recording = recording_of(&hard_rays(&mesh, 300, 57));
    let moller = answers(&recording, &scene, Backend::Brute, Test::Moller);
    let arithmetic = Arithmetic::of_this_cpu();
    let honest = report_on(&scene, &recording, Claim::Test(Test::Moller, arithmetic), &moller);
    assert!(honest.failure().is_none() && !honest.disagreements.is_empty());
    let report = report_on(&scene, &recording, Claim::Test(Test::Watertight, arithmetic), &moller);
    assert!(report.failure().is_some());
}

#[test]
fn a_right_answer_that_embree_cannot_give_is_found_unless_verdicts_may_have_given_it() {
    let mesh = sphere(Vec3::ZERO, 1.0, 12);
    let scene = scene_of(&mesh);
    let recording = recording_of(&hard_rays(&mesh, 300, 58));
    let truth = answers(&recording, &scene, Backend::Brute, Test::Exact);
    let arithmetic = Arithmetic::of_this_cpu();
    let claim = |verdicts| Claim::Single { robust: false, arithmetic, clipped: false, verdicts };
    let behind_verdicts = report_on(&scene, &recording, claim(true), &truth);
    assert!(behind_verdicts.failure().is_none() && behind_verdicts.disagreements.is_empty());
    let report = report_on(&scene, &recording, claim(false), &truth);
    let row = &report.contenders[0];
    assert_eq!((row.false_blocked, row.false_clear), (0, 0));
    assert!(row.unexplained > 0 && report.failure().is_some());
    assert!(report.disagreements.iter().all(|found| found.kind == Kind::OutOfBounds));
}

/// A ray that starts on the triangle, one that ends on it, one through it, and one past it.
fn ties() -> (Scene, Recording) {
    let scene = scene_of(&[[Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)]]);
    let [below, on, above] = [-1.0, 0.0, 1.0].map(|z| Vec3::new(1.0, 1.0, z));
    let aside = Vec3::new(9.0, 9.0, 1.0);
    let rays = [(on, above), (below, on), (below, above), (above, aside)];
    let rays = rays.map(|(from, to)| Ray::between(from, to));
    (scene, recording_of(&rays))
}

#[test]
fn ties_are_counted_apart() {
    let (scene, recording) = ties();
    let choice = Choice { backends: vec![Backend::Grid], ..Choice::default() };
    let report = compared(&scene, &recording, &choice);
    assert_eq!((report.blocked, report.clear, report.ties), (1, 1, 2));
    let row = |name: &str| report.contenders.iter().find(|row| row.name == name).unwrap();
    // Plücker's interval is closed at both ends, Möller's at the light.
    assert_eq!(row("grid pluecker").ties_blocked, 2);
    assert_eq!(row("grid moller").ties_blocked, 1);
    assert_eq!(row("grid exact").ties_blocked, 0);
    for row in &report.contenders {
        assert_eq!((row.agree, row.false_blocked, row.false_clear), (2, 0, 0), "{}", row.name);
    }
    assert!(report.disagreements.is_empty() && report.failure().is_none());
}

#[test]
fn a_tie_that_an_exact_engine_calls_blocked_is_wrong() {
    let (scene, recording) = ties();
    let report = report_on(&scene, &recording, Claim::Exact, &[true, false, true, false]);
    assert_eq!(report.disagreements[0].exact, Verdict::Tie);
    assert_eq!(report.contenders[0].false_blocked, 0, "ties stay apart from the shares");
    assert!(report.failure().is_some());
}

#[test]
fn the_exact_verdict_and_its_triangle_are_the_oracles() {
    let mesh = soup(300, 0.3, 59);
    let scene = scene_of(&mesh);
    let recording = recording_of(&hard_rays(&mesh, 300, 60));
    let report = compared(
        &scene,
        &recording,
        &Choice { tests: vec![Test::Moller, Test::Exact], ..Choice::default() },
    );
    assert!(!report.disagreements.is_empty());
    for found in &report.disagreements {
        let (verdict, _) = umbra::exact::oracle::verdict_of_scene(&found.ray, mesh.iter().copied());
        assert_eq!(verdict, found.exact, "{found:?}");
        assert_eq!(found.blocked, found.exact == Verdict::Clear);
        let triangle = found.triangle.expect("somebody reported one");
        let alone = umbra::exact::oracle::verdict(&found.ray, &mesh[triangle as usize]);
        assert_eq!(alone == Verdict::Blocked, found.exact == Verdict::Blocked, "{found:?}");
    }
}

#[test]
fn one_contender_and_a_picture_without_queries_are_no_comparison() {
    let (scene, recording) = ties();
    let one = [Contender::new(Backend::Grid, Test::Exact)];
    let error = compare(&scene, &recording, &one, &AtomicU64::new(0)).unwrap_err();
    assert!(matches!(error, CompareError::Few(1)));
    let contenders = Choice::default().select().contenders;
    let error = compare(&scene, &recording_of(&[]), &contenders, &AtomicU64::new(0)).unwrap_err();
    assert!(matches!(error, CompareError::NoQueries(_)));
}

#[test]
fn rays_that_are_none_are_clear_to_everybody() {
    let (scene, _) = ties();
    let nan = Vec3::new(f32::NAN, 0.0, 0.0);
    let rays = [Ray::between(nan, Vec3::ONE), Ray::towards(Vec3::ONE, Vec3::splat(f32::INFINITY))];
    let report = compared(&scene, &recording_of(&rays), &Choice::default());
    assert_eq!((report.clear, report.disagreements.len(), report.failure()), (2, 0, None));
}

#[test]
fn pictures_whose_queries_do_not_fit_are_refused() {
    let (scene, _) = ties();
    let settings =
        |width, samples| Settings { width, height: width, samples, ..Settings::default() };
    assert!(Recording::check(&scene, &settings(160, 1)).is_ok());
    let error = Recording::check(&scene, &settings(16_000, 64)).unwrap_err().to_string();
    assert!(error.contains("GiB; give a smaller size"), "{error}");
}

/// A folder with a scene of two triangles, one above the other, and without camera or light.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let roof = "v 1 1 1\nv 2 1 1\nv 1 2 1\nf 4 5 6\n";
    fs::write(folder.path().join("roof.obj"), format!("{TRIANGLE}{roof}")).unwrap();
    folder
}

#[test]
fn the_command_says_what_it_compared_and_what_it_decided() {
    let folder = workplace();
    let output = run(folder.path(), "compare roof.obj --size 40x30");
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("no usable light in the file: added"), "{}", said(&output));
    let table = String::from_utf8(output.stdout).unwrap();
    for part in
        ["2 triangles", "grid exact", "cwbvh watertight", "unexplained", "contradicted 0 times"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
}

#[test]
fn the_command_writes_all_it_is_asked_for() {
    let folder = workplace();
    let line = "compare roof.obj --size 40x30 --backends grid,bvh2 --tests exact,moller --list all.csv --difference all.png --stats all.json";
    let output = run(folder.path(), line);
    assert!(output.status.success(), "{}", said(&output));
    let csv = fs::read_to_string(folder.path().join("all.csv")).unwrap();
    assert!(csv.starts_with("contender,pixel_x,pixel_y,light,"), "{csv}");
    let picture = image::open(folder.path().join("all.png")).unwrap();
    assert!(picture.width() == 640 && picture.height() > 480, "squares, and a legend below");
    let stats = fs::read(folder.path().join("all.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
    assert_eq!(stats["contenders"].as_array().unwrap().len(), 4);
    assert_eq!(stats["queries"], stats["contenders"][0]["agree"]);
    assert!(stats["notes"][0].as_str().unwrap().contains("camera"));
}

#[test]
fn the_list_has_every_disagreement_with_the_bits_of_its_ray() {
    let mesh = soup(300, 0.3, 61);
    let scene = scene_of(&mesh);
    let recording = recording_of(&hard_rays(&mesh, 300, 62));
    let report =
        compared(&scene, &recording, &Choice { tests: vec![Test::Moller], ..Choice::default() });
    let csv = report.csv();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(!rows.is_empty() && rows.len() == report.disagreements.len());
    let columns = csv.lines().next().unwrap().split(',').count();
    for (row, found) in rows.iter().zip(&report.disagreements) {
        assert_eq!(row.len(), columns);
        let bits: Vec<u32> = row[columns - 1]
            .split(' ')
            .map(|word| u32::from_str_radix(word, 16).unwrap())
            .collect();
        let decimals: Vec<u32> =
            row[9..16].iter().map(|field| field.parse::<f32>().unwrap().to_bits()).collect();
        let Ray { origin: o, direction: d, end } = found.ray;
        let expected = [o.x, o.y, o.z, d.x, d.y, d.z, end].map(f32::to_bits);
        assert_eq!((&bits[..], &decimals[..]), (&expected[..], &expected[..]));
    }
    let lines = report.listing(3);
    assert!(lines.contains("more disputed queries;") && lines.contains("grid moller"), "{lines}");
    let unlisted = report.listing(0);
    let disputed: std::collections::BTreeSet<usize> =
        report.disagreements.iter().map(|found| found.query).collect();
    let told = format!("{} disputed queries, not listed; ", disputed.len());
    assert!(disputed.len() < 1000 && unlisted.starts_with(&told), "{unlisted}");
    assert_eq!(report.listing(1000).lines().count(), report.listing(999).lines().count());
}

fn compare_refused(arguments: &str, told: &[&str]) {
    refused(workplace().path(), &format!("compare roof.obj {arguments}"), told);
}

#[test]
fn bad_input_is_told_in_one_line() {
    compare_refused("--backends grid --tests exact", &["at least two contenders", "are 1"]);
    compare_refused("--backends embree --tests exact", &["are 0", "embree has no test 'exact'"]);
    compare_refused("--backends grid,teapot", &["'teapot'", "grid, embree, bvh2, cwbvh, brute"]);
    compare_refused("--tests exact,teapot", &["'teapot'", "moller, pluecker, watertight, exact"]);
    compare_refused("--methods teapot", &["'teapot'", "voxel-cache"]);
    compare_refused(
        "--methods trace,object-cache+woo",
        &["object-cache and woo are both memories"],
    );
    compare_refused("--size 0x3", &["size 0x3"]);
    compare_refused("--threads 0", &["--threads", "from 1 to 1024"]);
    compare_refused("--difference roof.gif", &["roof.gif", ".png or .exr"]);
    compare_refused("--list roof.obj", &["cannot write roof.obj"]);
    compare_refused("--stats no/such/folder.json", &["no folder"]);
}

#[cfg(feature = "embree")]
#[test]
fn embree_variants_that_are_none_are_told_in_one_line() {
    compare_refused(
        "--embree-variants avx3",
        &["--embree-variants", "'avx3'", "avx512", "coherent"],
    );
    compare_refused("--embree-variants sse2-16", &["sse2 has no packets of 16"]);
    compare_refused("--embree-variants coherent", &["add 4, 8 or 16"]);
}

#[cfg(not(feature = "embree"))]
#[test]
fn without_embree_its_backend_says_how_to_get_it() {
    compare_refused(
        "--backends grid,embree --tests pluecker",
        &["at least two contenders", "embree: this umbra was built without Embree"],
    );
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let folder = workplace();
    let table = |threads: &str| {
        let line =
            format!("compare roof.obj --size 40x30 --methods trace,cache-tree --threads {threads}");
        run(folder.path(), &line).stdout
    };
    assert_eq!(table("1"), table("3"));
}
