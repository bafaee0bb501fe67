//! The grid whose voxels hold grids: what it promises beyond what every backend does.

mod common;

use std::sync::Arc;

use common::{Aim, Random, soup, sphere};
use glam::Vec3;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::occlusion::{Backend, BuildOptions, NestedGrid, Occlusion, Tally, Test, Walk, build};

fn over(mesh: &[Triangle]) -> Arc<Triangles> {
    Arc::new(mesh.iter().copied().collect())
}

fn engine(backend: Backend, triangles: &Arc<Triangles>) -> Box<dyn Occlusion> {
    build(backend, Test::Exact, triangles, &BuildOptions::default()).unwrap()
}

/// Long thin triangles that share a corner, in a fan.
fn fan(count: usize) -> Vec<Triangle> {
    let place = |n: usize| {
        let (sin, cos) = (n as f32 / count as f32 * 1.5).sin_cos();
        Vec3::new(cos, sin, 0.01 * cos)
    };
    (0..count).map(|n| [Vec3::ZERO, place(n), place(n + 1)]).collect()
}

#[test]
fn every_point_of_a_triangle_leads_to_the_cell_that_lists_it() {
    for mesh in [soup(3000, 0.1, 1), soup(300, 1.0, 2), sphere(Vec3::ONE, 0.7, 40), fan(500)] {
        let grid = NestedGrid::new(&over(&mesh));
        // One grid has room for 64 eights.
        assert!(grid.grid_count() > 1 || mesh.len() <= 64 * 8);
        let mut random = Random(5);
        for _ in 0..20_000 {
            let id = random.below(mesh.len());
            let [a, b, c] = mesh[id].map(|corner| corner.as_dvec3());
            let (u, v) = (f64::from(random.unit()), f64::from(random.unit()));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = a + u * (b - a) + v * (c - a);
            let cell = grid.cell_with(id as u32, point);
            let listed = &grid.order()[cell.start as usize..cell.end as usize];
            assert!(listed.contains(&(id as u32)), "{id} at {point}");
        }
    }
}

#[test]
fn every_triangle_is_stored_once_in_eights_of_which_most_are_full() {
    let copies = vec![soup(1, 0.3, 6)[0]; 2000];
    for mesh in [soup(3000, 0.1, 1), soup(300, 1.0, 2), fan(500), copies] {
        let grid = NestedGrid::new(&over(&mesh));
        let mut listed = Vec::new();
        for eight in grid.order().chunks(8) {
            // The last triangle fills it up.
            let mut eight = eight.to_vec();
            eight.dedup();
            listed.extend(eight);
        }
        listed.sort_unstable();
        assert_eq!(listed, (0..mesh.len() as u32).collect::<Vec<_>>());
        assert!(grid.order().len() <= 2 * mesh.len(), "{} entries", grid.order().len());
    }
}

#[test]
fn long_thin_triangles_and_copies_do_not_fill_the_memory() {
    let copies = vec![soup(1, 0.3, 6)[0]; 2000];
    for mesh in [fan(5000), copies] {
        let grid = NestedGrid::new(&over(&mesh));
        assert!(grid.memory() <= 80 * mesh.len(), "{} bytes", grid.memory());
    }
}

#[test]
fn rays_from_anywhere_of_any_length_are_answered_as_by_brute_force() {
    // Few, as brute force needs exact arithmetic for most of them from far away.
    let mesh = soup(60, 0.4, 7);
    let triangles = over(&mesh);
    let (grid, brute) = (engine(Backend::Grid, &triangles), engine(Backend::Brute, &triangles));
    let mut random = Random(8);
    for distance in [0.9f32, 1.1, 3.0, 1e3, 1e6, 1e9, 1e30] {
        for length in [1e-30f32, 1e-19, 1e-3, 1.0, 1e17, 1e30] {
            let mut blocked = 0;
            for _ in 0..60 {
                let target = random.in_cube(1.0);
                let origin = distance * random.in_cube(1.0);
                let direction = length * (target - origin).normalize();
                let ray = Ray { origin, direction, end: f32::INFINITY };
                let tally = &mut Tally::default();
                let expected = brute.occluded(&ray, tally);
                blocked += u32::from(expected);
                assert_eq!(grid.occluded(&ray, tally), expected, "{ray:?}");
                assert_eq!(grid.nearest(&ray, tally), brute.nearest(&ray, tally), "{ray:?}");
            }
            assert!(blocked > 0 || length < 1e-18 || distance > 1e5, "{distance} {length}");
        }
    }
}

#[test]
fn rays_along_the_walls_of_voxels_lose_nothing() {
    let mesh = sphere(Vec3::ZERO, 0.9, 24);
    let triangles = over(&mesh);
    let walls = NestedGrid::new(&triangles);
    let (grid, brute) = (engine(Backend::Grid, &triangles), engine(Backend::Brute, &triangles));
    let mut random = Random(9);
    let mut corner = || {
        let corner = [0; 3].map(|_: u32| random.below(5) as u32);
        walls.corner(random.below(walls.grid_count()), corner).as_vec3()
    };
    let mut blocked = 0;
    for axis in 0..3 {
        for _ in 0..3000 {
            let (from, other) = (corner(), corner());
            // Along a wall, along an edge, and through corners.
            let mut along = from;
            along[axis] = other[axis];
            for ray in [Ray::between(from, along), Ray::between(from, other)] {
                let tally = &mut Tally::default();
                let expected = brute.occluded(&ray, tally);
                blocked += u32::from(expected);
                assert_eq!(grid.occluded(&ray, tally), expected, "{ray:?}");
            }
        }
    }
    assert!(blocked > 1000, "{blocked}");
}

#[test]
fn opaque_triangles_come_first_in_every_eight() {
    let mesh = soup(3000, 0.2, 10);
    let triangles = Arc::new(Triangles::new(mesh[..1000].to_vec(), mesh[1000..].to_vec()));
    let grid = NestedGrid::new(&triangles);
    let mut random = Random(11);
    assert!(grid.order().chunks(8).all(<[u32]>::is_sorted));
    // And so what is transparent is found behind them.
    let [grid, brute] = [Backend::Grid, Backend::Brute].map(|backend| engine(backend, &triangles));
    let mut all = 0;
    for _ in 0..200 {
        let ray = Aim::Random.ray(&mesh, &mut random);
        let [found, expected] = [&grid, &brute].map(|engine| {
            let mut found = Vec::new();
            engine.transparent(&ray, &mut found, &mut Tally::default());
            found
        });
        assert_eq!(found, expected, "{ray:?}");
        all += found.len();
    }
    assert!(all > 200, "{all}");
}

#[test]
fn many_rays_are_answered_and_counted_as_one_by_one() {
    let mesh = soup(3000, 0.05, 12);
    let triangles = over(&mesh);
    let grid = engine(Backend::Grid, &triangles);
    let mut random = Random(13);
    let broken = Ray::between(Vec3::splat(f32::NAN), Vec3::ZERO);
    let mut rays = vec![broken, Ray { end: 0.0, ..Ray::between(Vec3::ZERO, Vec3::ONE) }];
    for distance in [0.5f32, 1.5, 1e4, 1e30] {
        for _ in 0..100 {
            rays.push(Ray::between(distance * random.in_cube(1.0), random.in_cube(1.0)));
        }
    }
    for rays in [&rays[..0], &rays[..1], &rays[1..3], &rays[..33], &rays] {
        let (mut together, mut apart) = (Tally::default(), Tally::default());
        let mut blocked = vec![false; rays.len()];
        grid.occluded_many(rays, &mut blocked, &mut together);
        let expected: Vec<bool> = rays.iter().map(|ray| grid.occluded(ray, &mut apart)).collect();
        assert_eq!(blocked, expected);
        assert_eq!(together, apart);
    }
}

#[test]
fn what_lies_behind_the_nearest_hit_is_left_out() {
    let mesh = soup(20_000, 0.1, 14);
    let grid = engine(Backend::Grid, &over(&mesh));
    let mut random = Random(15);
    let (mut tally, mut hits) = (Tally::default(), 0);
    for _ in 0..1000 {
        let from = 3.0 * random.in_cube(1.0).normalize();
        let ray = Ray::towards(from, random.in_cube(0.3) - from);
        hits += usize::from(grid.nearest(&ray, &mut tally).is_some());
    }
    assert!(hits > 900, "{hits}");
    // 6.0 eights a ray. In the order in which they are stored it would be 14.5, and 7.6 if what is left of the grids around were not
    // looked at again.
    assert!(tally.cells < 7000, "{}", tally.cells);
}
