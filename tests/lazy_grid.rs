//! The grid that is divided where rays come loses nothing, and divides nothing else.

mod common;

use std::sync::{Arc, mpsc};
use std::time::Duration;

use common::{Aim, Random, soup, sphere};
use glam::Vec3;
use rayon::{Scope, ThreadPoolBuilder};
use umbra::geometry::lanes::Scalar;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::occlusion::{
    Backend, BuildOptions, Cell, DividedGrid, Grid, GridOptions, LeftOut, Occlusion, Tally, Test,
    Visit, Walk, build,
};

const LAZY: GridOptions =
    GridOptions { resolution: None, nested: true, lazy: true, most_bytes: None };

/// A small ball of many triangles and a few large ones far around it.
fn teapot_in_a_stadium() -> Vec<Triangle> {
    let mut mesh = sphere(Vec3::new(0.2, 0.1, 0.0), 0.5, 40);
    mesh.extend(soup(40, 1.0, 3).iter().map(|corners| corners.map(|corner| corner * 30.0)));
    mesh
}

fn triangles(mesh: &[Triangle]) -> Arc<Triangles> {
    Arc::new(mesh.iter().copied().collect())
}

fn engine(triangles: &Arc<Triangles>, grid: GridOptions) -> Box<dyn Occlusion> {
    let options = BuildOptions { grid, ..BuildOptions::default() };
    build(Backend::Grid, Test::Exact, triangles, &options).unwrap()
}

#[test]
fn it_answers_like_the_grid_that_is_divided_beforehand() {
    for mesh in [teapot_in_a_stadium(), soup(3000, 0.1, 4), soup(300, 1.0, 5)] {
        let triangles = triangles(&mesh);
        let (eager, lazy) = (engine(&triangles, GridOptions::default()), engine(&triangles, LAZY));
        for aim in Aim::ALL {
            let mut random = Random(9);
            for _ in 0..3000 {
                let ray = aim.ray(&mesh, &mut random);
                let tally = &mut Tally::default();
                assert_eq!(lazy.occluded(&ray, tally), eager.occluded(&ray, tally), "{ray:?}");
                assert_eq!(lazy.nearest(&ray, tally), eager.nearest(&ray, tally), "{ray:?}");
            }
        }
    }
}

#[test]
fn threads_that_come_to_a_voxel_at_once_get_the_same_answers() {
    let mesh = teapot_in_a_stadium();
    let triangles = triangles(&mesh);
    let mut random = Random(12);
    let rays: Vec<Ray> = (0..4000).map(|_| Aim::Random.ray(&mesh, &mut random)).collect();
    let asked = |engine: &dyn Occlusion| -> Vec<bool> {
        rays.iter().map(|ray| engine.occluded(ray, &mut Tally::default())).collect()
    };
    let expected = asked(&*engine(&triangles, GridOptions::default()));
    for _ in 0..20 {
        let lazy = engine(&triangles, LAZY);
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..4).map(|_| scope.spawn(|| asked(&*lazy))).collect();
            for worker in workers {
                assert!(worker.join().unwrap() == expected);
            }
        });
    }
}

#[test]
fn a_worker_never_takes_in_a_ray_while_it_divides_the_voxel_that_the_ray_comes_to() {
    // Else it waits for itself, for ever. One voxel that would be worth several threads, and rays that come to it meanwhile.
    let (finished, wait) = mpsc::channel();
    std::thread::spawn(move || {
        let mesh = soup(50_000, 0.05, 6);
        let triangles = triangles(&mesh);
        let across = Ray::between(Vec3::splat(-1.0), Vec3::ONE);
        let pool = ThreadPoolBuilder::new().num_threads(8).build().unwrap();
        for _ in 0..5 {
            let lazy = engine(&triangles, GridOptions { resolution: Some([1; 3]), ..LAZY });
            let ask = |_: &Scope<'_>| assert!(lazy.occluded(&across, &mut Tally::default()));
            pool.scope(|scope| {
                scope.spawn(ask);
                // The voxel is being divided when the others come.
                std::thread::sleep(Duration::from_millis(3));
                (0..100).for_each(|_| scope.spawn(ask));
            });
        }
        finished.send(()).unwrap();
    });
    wait.recv_timeout(Duration::from_mins(1)).expect("workers wait, or an answer is wrong");
}

#[test]
fn it_stops_dividing_where_memory_ends_and_loses_nothing() {
    let mesh = teapot_in_a_stadium();
    let triangles = triangles(&mesh);
    let eager = engine(&triangles, GridOptions::default());
    let bare = DividedGrid::new(&triangles, LAZY).unwrap().memory() as u64;
    let mut held = Vec::new();
    for most in [bare, bare + 50_000, u64::MAX] {
        let lazy = engine(&triangles, GridOptions { most_bytes: Some(most), ..LAZY });
        let mut random = Random(31);
        for _ in 0..500 {
            let ray = Aim::Random.ray(&mesh, &mut random);
            let tally = &mut Tally::default();
            assert_eq!(lazy.occluded(&ray, tally), eager.occluded(&ray, tally), "{ray:?}");
        }
        assert!(lazy.memory() as u64 <= most);
        held.push(lazy.memory() as u64);
    }
    assert!(held[0] == bare && held[2] > bare, "{held:?}");
}

/// Counts what it is shown.
struct Counter(u64);

impl Visit for Counter {
    fn visit(&mut self, _: Cell, triangles: &[u32]) -> std::ops::ControlFlow<()> {
        self.0 += triangles.len() as u64;
        std::ops::ControlFlow::Continue(())
    }

    fn end(&self) -> f32 {
        f32::INFINITY
    }
}

#[test]
fn a_voxel_is_divided_on_the_first_visit_and_not_before() {
    let triangles = triangles(&teapot_in_a_stadium());
    let grid = DividedGrid::new(&triangles, LAZY).unwrap();
    assert_eq!(grid.divided_count(), 0);
    let (far, near) = (Vec3::new(25.0, 25.0, 25.0), Vec3::new(3.0, 0.1, 0.0));
    grid.walk::<Scalar<false, false>, _>(&Ray::between(far, far + Vec3::X), &mut Counter(0));
    assert_eq!(grid.divided_count(), 0, "nothing is crowded there");
    let before = grid.memory();
    let through_the_ball = Ray::between(near, Vec3::new(-3.0, 0.1, 0.0));
    let mut first = Counter(0);
    grid.walk::<Scalar<false, false>, _>(&through_the_ball, &mut first);
    let divided = grid.divided_count();
    assert!(divided > 0 && grid.memory() > before);
    let mut second = Counter(0);
    grid.walk::<Scalar<false, false>, _>(&through_the_ball, &mut second);
    assert_eq!((grid.divided_count(), second.0), (divided, first.0));

    // What a uniform grid cannot: few of the ball's triangles are met.
    let uniform = Grid::new(&triangles, GridOptions { nested: false, ..GridOptions::default() });
    let mut all = Counter(0);
    uniform.walk::<Scalar<false, false>, _>(&through_the_ball, &mut all);
    assert!(10 * second.0 < all.0, "{} of {}", second.0, all.0);
}

#[test]
fn a_ray_that_was_tested_against_one_cell_still_meets_the_others() {
    // Cells are what mailboxes note: those of divided voxels must not be taken for their neighbours.
    let mesh = teapot_in_a_stadium();
    let triangles = triangles(&mesh);
    let lazy = engine(&triangles, LAZY);
    let mut random = Random(21);
    let order = lazy.order().len() as u32;
    for _ in 0..3000 {
        let ray = Aim::Random.ray(&mesh, &mut random);
        let start = random.below(order as usize) as u32;
        let cell = Cell { start, end: (start + 1 + random.below(40) as u32).min(order) };
        let tally = &mut Tally::default();
        let mut left_out = LeftOut::new(triangles.opaque_count(), false);
        left_out.begin(None);
        if lazy.occluder_in(cell, &ray, tally).is_none() {
            left_out.note_cell(cell);
        }
        let found = lazy.occluder_except(&ray, None, &mut left_out, tally).is_some();
        assert_eq!(found, lazy.occluded(&ray, tally), "{ray:?} {cell:?}");
    }
}

#[test]
fn the_cell_of_an_occluder_can_be_asked_whatever_voxel_it_was_met_in() {
    // Of a divided voxel with many triangles it was no run of the order, and whoever asked it panicked.
    let mesh = sphere(Vec3::ZERO, 0.5, 60);
    let triangles = triangles(&mesh);
    let engine = engine(&triangles, GridOptions { resolution: Some([2; 3]), ..LAZY });
    let mut random = Random(22);
    let mut without = 0;
    for _ in 0..200 {
        let ray = Aim::Random.ray(&mesh, &mut random);
        let tally = &mut Tally::default();
        let mut left_out = LeftOut::new(triangles.opaque_count(), true);
        left_out.begin(None);
        let found = engine.occluder(&ray, tally);
        let sparing = engine.occluder_except(&ray, None, &mut left_out, tally);
        for cell in [found, sparing].into_iter().flatten().map(|occluder| occluder.cell) {
            let is_empty = cell.start == cell.end;
            without += u32::from(is_empty);
            left_out.begin(None);
            let inside = engine.occluder_except(&ray, Some(cell), &mut left_out, tally);
            assert_eq!(engine.occluder_in(cell, &ray, tally).is_some(), !is_empty, "{cell:?}");
            assert_eq!(inside.is_some(), !is_empty, "{cell:?}");
        }
    }
    assert!(without > 50, "{without}");
}

#[test]
fn what_is_nearest_is_looked_for_from_the_near_side_in_divided_voxels_too() {
    // A column of many sheets in one voxel, and rays along it from either end.
    let sheet = |n: u32| {
        let z = n as f32 / 500.0 - 1.0;
        [Vec3::new(-1.0, -1.0, z), Vec3::new(3.0, -1.0, z), Vec3::new(-1.0, 3.0, z)]
    };
    let triangles = triangles(&(0..1000).map(sheet).collect::<Vec<_>>());
    let engine = engine(&triangles, GridOptions { resolution: Some([1; 3]), ..LAZY });
    for z in [-2.0, 2.0] {
        let tally = &mut Tally::default();
        let ray = Ray::towards(Vec3::new(0.1, 0.2, z), Vec3::new(0.0, 0.0, -z));
        assert!(engine.nearest(&ray, tally).is_some());
        assert!(tally.triangle_tests <= 32, "{} from {z}", tally.triangle_tests);
    }
}
