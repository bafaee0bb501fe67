//! Engines, shadow methods and comparisons.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use umbra::geometry::Ray;
use umbra::glam::Vec3;
use umbra::measure::compare::{Claim, Comparison, compare};
use umbra::measure::contender::{Choice, Contender};
use umbra::measure::recording::Recording;
use umbra::occlusion::{Backend, BackendError, BuildOptions, Grid, GridOptions, Test, build};
use umbra::render::RecordedQuery;
use umbra::scene::Scene;
use umbra::shadow::{Auto, Method, Path, ShadowQuery, Shadows, Trace, Verdicts, prepare};
use umbra::whole_file::WholeFile;

use super::scene;

#[test]
fn a_grid_of_no_voxels_or_too_many_is_refused() {
    let triangles = scene().triangles;
    for resolution in [[0; 3], [8, 8, 0], [2000; 3], [u32::MAX; 3], [1024; 3]] {
        for (nested, lazy) in [(false, false), (true, false), (true, true)] {
            let grid = GridOptions { resolution: Some(resolution), nested, lazy, most_bytes: None };
            let options = BuildOptions { grid, ..BuildOptions::default() };
            let refused = build(Backend::Grid, Test::Exact, &triangles, &options).unwrap_err();
            let told = refused.to_string();
            assert!(told.contains("give 1 to 1024 along each axis"), "{told}");
        }
    }
    // What may be other than asked for is.
    for (resolution, made) in [([0; 3], [1; 3]), ([2000, 0, 3], [1000, 1, 2])] {
        let options =
            GridOptions { nested: false, resolution: Some(resolution), ..GridOptions::default() };
        assert_eq!(Grid::new(&triangles, options).resolution(), made);
    }
    let most = GridOptions::uniform(&triangles, usize::MAX);
    assert!(most.check().is_ok(), "{most:?}");
}

#[test]
fn queries_about_a_light_that_is_not_there_are_not_compared() {
    let scene = scene();
    let query =
        ShadowQuery { ray: Ray::between(Vec3::ZERO, 3.0 * Vec3::Y), path: Path::EYE, spawner: 0 };
    let recorded = RecordedQuery { query, light: 9, pixel: (0, 0), blocked: false };
    let recording = Recording::new(1, 1, vec![vec![recorded]]);
    let contenders =
        [Contender::new(Backend::Grid, Test::Exact), Contender::new(Backend::Bvh2, Test::Exact)];
    let refused = compare(&scene, &recording, &contenders, &AtomicU64::new(0)).unwrap_err();
    let told = "unnamed scene: a query asks about light 9, and there are 1";
    assert!(refused.to_string().starts_with(told), "{refused}");
}

#[test]
fn a_comparison_of_nothing_contradicts_nothing() {
    let scene = scene();
    let bare = Scene { triangles: Arc::default(), ..scene.clone() };
    let query =
        ShadowQuery { ray: Ray::between(Vec3::ZERO, 3.0 * Vec3::Y), path: Path::EYE, spawner: 0 };
    let recorded = RecordedQuery { query, light: 0, pixel: (0, 0), blocked: false };
    for (scene, queries) in [(&scene, vec![]), (&bare, vec![]), (&bare, vec![recorded])] {
        let (recording, answers) =
            (Recording::new(1, 1, vec![queries.clone()]), vec![false; queries.len()]);
        let mut comparison = Comparison::new(scene, &recording);
        comparison.enter("it", Claim::Exact, &answers);
        let report = comparison.finish();
        assert_eq!((report.queries, report.blocked), (queries.len() as u64, 0));
        assert!(report.failure().is_none() && report.disagreements.is_empty());
    }
}

#[test]
fn without_embree_its_contenders_are_left_out_with_the_reason() {
    let choice =
        Choice { backends: vec![Backend::Embree, Backend::Grid], ..Choice::default() }.select();
    let is_there = choice.contenders.iter().any(|one| one.backend == Backend::Embree);
    assert_eq!(is_there, cfg!(feature = "embree"));
    assert_eq!(choice.left_out.is_empty(), is_there, "{:?}", choice.left_out);
    if !is_there {
        let refused = build(Backend::Embree, Test::Exact, &scene().triangles, &Default::default());
        assert!(matches!(refused.unwrap_err(), BackendError::WithoutEmbree));
    }
}

#[test]
fn whatever_is_made_can_be_printed_in_a_line_or_two() {
    let scene = scene();
    let backend = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default());
    let backend = backend.unwrap();
    let prepared = prepare(Method::CacheTree, &scene, &*backend).unwrap();
    let auto = Auto::new(Method::Trace, Test::Exact, &scene, &*backend).unwrap();
    let recording = Recording::new(1, 1, Vec::new());
    let comparison = Comparison::new(&scene, &recording);
    let file = WholeFile::direct("nowhere", io::sink());
    let (trace, verdicts) = (Trace::new(&*backend), Verdicts::default());
    for printed in [
        format!("{backend:?}"),
        format!("{prepared:?} {:?}", prepared.worker()),
        format!("{auto:?}"),
        format!("{trace:?} {verdicts:?}"),
        format!("{comparison:?}"),
        format!("{file:?}"),
    ] {
        assert!(!printed.is_empty() && printed.len() < 1000, "{printed}");
    }
}

#[test]
fn a_worker_may_move_to_another_thread() {
    fn is_send<T: Send + ?Sized>() {}
    is_send::<dyn Shadows>();
}
