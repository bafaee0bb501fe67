//! What stands before a backend changes how a query is answered, never the answer.

mod common;
#[path = "common/rooms.rs"]
mod rooms;

use rooms::{backends, glass_room, small_chair_room};
use umbra::measure::contender::Choice;
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Test, build};
use umbra::render::{Answered, Order, Progress, Rendered, Settings, Shown, Statistics, render};
use umbra::scene::Scene;
use umbra::shadow::{Auto, Method, MethodError, Plan, Retest, SelfShadow, VerdictKind, prepare};

const SETTINGS: Settings = Settings {
    width: 32,
    height: 24,
    samples: 1,
    depth: 4,
    order: Order::Scanline,
    rows_per_unit: 5,
    mask: true,
    answers: None,
    record: false,
};

const ORDERS: [Order; 3] = [Order::Scanline, Order::Serpentine, Order::Tiles];

fn picture(
    scene: &Scene,
    backend: &dyn Occlusion,
    plan: Plan,
    order: Order,
    threads: usize,
) -> Rendered {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let shadows = prepare(plan, scene, backend).unwrap();
    let settings = Settings { order, ..SETTINGS };
    let render = || render(scene, backend, &*shadows, &settings, &Progress::default()).unwrap();
    pool.install(render)
}

/// Every method, and every option of one that has them.
fn plans() -> Vec<Plan> {
    let mut plans: Vec<Plan> = Method::ALL.map(Plan::from).to_vec();
    for retest in [Retest::Again, Retest::NotCell, Retest::NotTriangles] {
        for method in Method::ALL {
            plans.push(Plan { retest, reset_scanlines: true, ..method.into() });
        }
    }
    plans.push(Plan { tree_depth: 1, ..Method::CacheTree.into() });
    plans.push(Plan { tolerance: 0.0, ..Method::CacheTreeTolerance.into() });
    plans.push(Plan { tolerance: 0.5, ..Method::CacheTreeTolerance.into() });
    plans
}

fn assert_same(a: &Rendered, b: &Rendered, what: &str) {
    assert!(a.film == b.film, "{what}: other colours");
    assert!(a.mask == b.mask, "{what}: other shadows");
    assert_eq!(a.statistics.rays, b.statistics.rays, "{what}");
    assert_eq!(a.statistics.shadows.blocked, b.statistics.shadows.blocked, "{what}");
}

#[test]
fn every_method_gives_the_bits_of_trace_over_every_backend() {
    for scene in [glass_room(), small_chair_room()] {
        let backends = backends(&scene);
        let (_, brute) = backends.iter().find(|(name, _)| *name == Backend::Brute).unwrap();
        let expected = picture(&scene, &**brute, Method::Trace.into(), Order::Scanline, 1);
        let shadows = expected.statistics.shadows;
        assert!(shadows.blocked > 0 && shadows.blocked < shadows.queries);
        for (name, backend) in &backends {
            // Embree's own arithmetic is compared with itself here; with ours elsewhere.
            let own = picture(&scene, &**backend, Method::Trace.into(), Order::Scanline, 1);
            if *name != Backend::Embree {
                assert_same(&own, &expected, &format!("{}: {name}", scene.name));
            }
            let options = if *name == Backend::Brute { 0 } else { plans().len() };
            for plan in plans().into_iter().take(options.max(Method::ALL.len())) {
                for order in ORDERS {
                    let found = picture(&scene, &**backend, plan, order, 2);
                    assert_same(
                        &found,
                        &own,
                        &format!("{}: {name} {order:?} {plan:?}", scene.name),
                    );
                }
            }
        }
    }
}

#[test]
fn pictures_and_counts_are_the_same_for_any_number_of_threads() {
    let scene = glass_room();
    for (name, backend) in backends(&scene) {
        if name == Backend::Brute {
            continue;
        }
        for plan in Method::ALL.map(Plan::from) {
            for order in [Order::Serpentine, Order::Tiles] {
                let one = picture(&scene, &*backend, plan, order, 1);
                for threads in [2, 3] {
                    let more = picture(&scene, &*backend, plan, order, threads);
                    let what = format!("{name} {order:?} {plan:?}, {threads} threads");
                    assert_same(&one, &more, &what);
                    assert_eq!(one.statistics, more.statistics, "{what}");
                }
            }
        }
    }
}

fn statistics(scene: &Scene, plan: Plan) -> Statistics {
    let (_, grid) = &backends(scene)[0];
    picture(scene, &**grid, plan, Order::Scanline, 1).statistics
}

#[test]
fn rates_count_what_the_paper_counts() {
    let scene = glass_room();
    let object = statistics(&scene, Method::ObjectCache.into()).shadows;
    assert!(object.object_tested > object.object_hits && object.object_hits > 0);
    assert_eq!((object.voxel_tested, object.voxel_hits), (0, 0));
    for method in [Method::VoxelCache, Method::CacheTree, Method::CacheTreeTolerance] {
        let tally = statistics(&scene, method.into()).shadows;
        assert!(tally.voxel_hits > 0, "{method}");
        // The voxel is tested where the object failed.
        assert_eq!(tally.voxel_tested, tally.object_tested - tally.object_hits, "{method}");
        let remembered = tally.object_hits + tally.voxel_hits;
        assert_eq!(tally.backend.traversals, tally.queries - remembered, "{method}");
        assert!(remembered <= tally.blocked, "{method}");
    }
    assert_eq!(statistics(&scene, Method::Trace.into()).shadows.object_tested, 0);
}

#[test]
fn a_wide_tolerance_omits_nothing_and_none_omits_almost_everything() {
    let scene = glass_room();
    let tested = |tolerance| {
        let plan = Plan { tolerance, ..Method::CacheTreeTolerance.into() };
        statistics(&scene, plan).shadows.object_tested
    };
    let tree = statistics(&scene, Method::CacheTree.into()).shadows.object_tested;
    assert!(tested(0.0) < tree / 10);
    assert!(tested(0.05) < tree && tested(0.05) > tested(0.0));
    assert!(tested(0.5) <= tree && tested(0.5) > tested(0.05));
}

#[test]
fn forgetting_at_each_scanline_forgets_once_a_scanline() {
    let scene = glass_room();
    let kept = statistics(&scene, Method::ObjectCache.into()).shadows;
    let plan = Plan { reset_scanlines: true, ..Method::ObjectCache.into() };
    let forgotten = statistics(&scene, plan).shadows;
    assert!(forgotten.object_tested < kept.object_tested);
    let most = u64::from(SETTINGS.height) * scene.lights.len() as u64;
    assert!(kept.object_tested - forgotten.object_tested <= most);
}

#[test]
fn a_tolerance_that_is_none_is_refused() {
    let scene = glass_room();
    let (_, grid) = &backends(&scene)[0];
    for tolerance in [-0.1, 0.6, f32::NAN] {
        let plan = Plan { tolerance, ..Method::CacheTreeTolerance.into() };
        let refused = prepare(plan, &scene, &**grid).err().unwrap();
        assert!(matches!(refused, MethodError::Tolerance(_)), "{refused}");
    }
}

#[test]
fn a_tree_deeper_than_any_path_is_refused() {
    let scene = glass_room();
    let (_, grid) = &backends(&scene)[0];
    let prepared =
        |tree_depth| prepare(Plan { tree_depth, ..Method::CacheTree.into() }, &scene, &**grid);
    assert!(prepared(31).is_ok());
    let refused = prepared(32).err().unwrap();
    assert!(matches!(refused, MethodError::TreeDepth(32)), "{refused}");
}

#[test]
fn glass_seen_first_by_a_memory_still_attenuates() {
    // The hazard of Figure 1: the search of a remembered voxel passes over the glass in it; had it
    // marked the glass as tested, the attenuation would be lost. Pictures of a room full of glass show it.
    let scene = glass_room();
    assert!(scene.has_transparent());
    for (name, backend) in backends(&scene) {
        let expected = picture(&scene, &*backend, Method::Trace.into(), Order::Scanline, 1);
        let plan = Plan { retest: Retest::NotTriangles, ..Method::VoxelCache.into() };
        let found = picture(&scene, &*backend, plan, Order::Scanline, 1);
        assert!(found.statistics.shadows.voxel_hits > 0 && found.film == expected.film, "{name}");
    }
}

#[test]
fn leaving_out_the_spawner_gives_one_picture_for_every_method_and_backend() {
    let scene = glass_room();
    let exclude = |plan| Plan { self_shadow: SelfShadow::Exclude, ..plan };
    let backends = backends(&scene);
    for (name, backend) in backends.iter().filter(|(name, _)| *name != Backend::Brute) {
        let own = picture(&scene, &**backend, exclude(Method::Trace.into()), Order::Scanline, 1);
        for plan in plans().into_iter().map(exclude) {
            for order in [Order::Scanline, Order::Tiles] {
                let found = picture(&scene, &**backend, plan, order, 3);
                assert_same(&found, &own, &format!("{name} {order:?} {plan:?}"));
            }
        }
    }
}

/// What all pixels of a picture of answers show together.
fn shown(rendered: &Rendered) -> Answered {
    let map = rendered.answers.as_ref().unwrap();
    let places = (0..SETTINGS.height).flat_map(|y| (0..SETTINGS.width).map(move |x| (x, y)));
    places.map(|(x, y)| *map.at(x, y)).fold(Answered::default(), together)
}

fn together(a: Answered, b: Answered) -> Answered {
    let outcomes = std::array::from_fn(|outcome| a.outcomes[outcome] + b.outcomes[outcome]);
    Answered { outcomes, cost: a.cost + b.cost }
}

/// Whether a picture of the answers shows all that the counts do, glass included.
fn assert_shows_every_query(rendered: &Rendered, what: &str) {
    let (tally, glass) = (rendered.statistics.shadows, rendered.statistics.transparent);
    let all = shown(rendered);
    let [object, voxel, blocked, lit, proved_blocked, proved_lit] = all.outcomes.map(u64::from);
    assert_eq!((object, voxel), (tally.object_hits, tally.voxel_hits), "{what}");
    assert_eq!((proved_lit, proved_blocked), (tally.verdict_lit, tally.verdict_blocked), "{what}");
    assert_eq!(object + voxel + blocked + proved_blocked, tally.blocked, "{what}");
    assert_eq!(blocked + lit, tally.backend.traversals, "{what}");
    let [casting, attenuating] = [tally.backend, glass].map(|t| t.cells + t.triangle_tests);
    assert!(attenuating > 0, "{what}");
    assert_eq!(all.cost, casting + attenuating, "{what}");
}

#[test]
fn pictures_of_the_answers_show_every_query_and_change_nothing() {
    let scene = glass_room();
    let grid = exact_grid(&scene);
    for combination in Choice::every_method() {
        let shadows = prepare(combination, &scene, &*grid).unwrap();
        // Of the verdicts shafts alone find the glass, too.
        let finds_glass = combination == VerdictKind::Shaft.into();
        assert_eq!(shadows.glass().is_some(), finds_glass, "{combination}");
        for order in ORDERS {
            let what = format!("{combination} {order:?}");
            let rendered = |answers| {
                let settings = Settings { order, answers, ..SETTINGS };
                render(&scene, &*grid, &*shadows, &settings, &Progress::default()).unwrap()
            };
            let (without, with) = (rendered(None), rendered(Some(Shown::default())));
            assert!(without.answers.is_none());
            assert_same(&with, &without, &what);
            // Whoever answers many together may do less than for one by one.
            if combination.verdicts.is_empty() {
                assert_eq!(with.statistics, without.statistics, "{what}");
            }
            assert_shows_every_query(&with, &what);
            let lights = 0..scene.lights.len() as u32;
            let by_light = lights.map(|light| shown(&rendered(Some(Shown { light: Some(light) }))));
            assert_eq!(by_light.fold(Answered::default(), together), shown(&with), "{what}");
            let map = with.answers.unwrap();
            for picture in [map.outcome_picture(), map.cost_picture()] {
                assert_eq!(picture.width(), SETTINGS.width);
                assert!(picture.height() > SETTINGS.height, "the legend is below");
            }
        }
    }
}

#[test]
fn pictures_of_the_answers_show_every_query_whomever_auto_asks() {
    let scene = glass_room();
    let grid = exact_grid(&scene);
    for order in ORDERS {
        let shadows = Auto::new(Method::Trace, Test::Exact, &scene, &*grid).unwrap();
        let settings = Settings { order, answers: Some(Shown::default()), ..SETTINGS };
        let shown = render(&scene, &*grid, &shadows, &settings, &Progress::default()).unwrap();
        assert_shows_every_query(&shown, &format!("{order:?}"));
    }
}

fn exact_grid(scene: &Scene) -> Box<dyn Occlusion> {
    build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap()
}
