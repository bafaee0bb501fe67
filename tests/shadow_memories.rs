//! Memories may hold anything: they only say "blocked", on a triangle's word. And they are small.

mod common;

use std::sync::Arc;

use common::{Aim, BACKENDS, Random, engine, soup};
use glam::{Vec3, vec3};
use proptest::prelude::*;
use umbra::geometry::{Ray, Triangle, TriangleId, Triangles};
use umbra::occlusion::{Backend, Cell, LeftOut, Occlusion, Tally, Test};
use umbra::shadow::{
    Answer, Caster, Direct, Fronts, Inquiry, LastCell, LastOccluder, LastVoxel, Memory, Nearby,
    Path, PerLight, PerPath, Retest, ShadowQuery, Shadows, Shelf, Sparing, Tolerance,
};

/// A mesh whose last third is glass, and every backend over it, brute force first.
struct World {
    mesh: Vec<Triangle>,
    triangles: Arc<Triangles>,
    backends: Vec<Box<dyn Occlusion>>,
}

impl World {
    fn new(mesh: Vec<Triangle>, opaque: usize) -> Self {
        let (front, back) = mesh.split_at(opaque);
        let triangles = Arc::new(Triangles::new(front.to_vec(), back.to_vec()));
        let others = BACKENDS.iter().filter(|name| **name != Backend::Brute);
        let backends = std::iter::once(&Backend::Brute)
            .chain(others)
            .map(|&name| engine(name, Test::Pluecker, &triangles))
            .collect();
        Self { mesh, triangles, backends }
    }

    fn random(seed: u64) -> Self {
        Self::new(soup(240, 0.5, seed), 160)
    }

    fn opaque(&self) -> u32 {
        self.triangles.opaque_count()
    }
}

fn query(ray: Ray, random: &mut Random, triangles: usize) -> ShadowQuery {
    let mut path = Path::EYE;
    for _ in 0..random.below(5) {
        path = if random.bits() & 1 == 0 { path.reflected() } else { path.refracted() };
    }
    ShadowQuery { ray, path, spawner: random.below(triangles) as TriangleId }
}

/// Numbers that are a triangle's, a transparent one's, none's at all.
fn any_triangle(random: &mut Random) -> TriangleId {
    match random.below(4) {
        0 => random.bits() as u32,
        1 => u32::MAX - random.below(3) as u32,
        _ => random.below(250) as u32,
    }
}

fn any_cell(random: &mut Random) -> Cell {
    let mut end = || match random.below(4) {
        0 => random.bits() as u32,
        1 => u32::MAX,
        _ => random.below(400) as u32,
    };
    Cell { start: end(), end: end() }
}

/// Asks one light after another while the memories hold whatever `scramble` writes into them.
fn scrambled<M: Memory, K: Shelf<M>, I: Inquiry>(
    world: &World,
    backend: &dyn Occlusion,
    inquiry: I,
    leaves_out_spawner: bool,
    (shelf, shared): (K, M::Shared),
    mut scramble: impl FnMut(&mut M, &mut Random),
    seed: u64,
) {
    let mut random = Random(seed);
    let mut caster = Caster::<M, K, I>::new(inquiry, shelf, shared);
    let mut left_out = LeftOut::new(world.opaque(), false);
    for _ in 0..120 {
        let aim = Aim::ALL[random.below(Aim::ALL.len())];
        let ray = aim.ray(&world.mesh, &mut random);
        let query = query(ray, &mut random, world.mesh.len());
        let light = random.below(3);
        if random.below(4) != 0 {
            scramble(caster.shelf_mut().at(light, query.path), &mut random);
        }
        left_out.begin(leaves_out_spawner.then_some(query.spawner));
        let expected = match leaves_out_spawner {
            false => backend.occluded(&ray, &mut Tally::default()),
            true => {
                backend.occluder_except(&ray, None, &mut left_out, &mut Tally::default()).is_some()
            }
        };
        let mut answer = [Answer::default()];
        caster.answer(light, &[query], &mut answer);
        assert_eq!(answer[0].blocked, expected, "{query:?}");
    }
    let tally = caster.tally();
    assert!(tally.object_hits <= tally.object_tested && tally.voxel_hits <= tally.voxel_tested);
}

/// Every kind of memory before one backend, asked in one way.
fn all_memories<'a, I: Inquiry + 'a>(
    world: &World,
    backend: &'a dyn Occlusion,
    inquiry: impl Fn() -> I,
    leaves_out: bool,
    seed: u64,
) {
    let tolerance = Tolerance::new(0.5, 0.2);
    let object = |m: &mut LastOccluder, r: &mut Random| m.triangle = any_triangle(r);
    let voxel = |m: &mut LastVoxel, r: &mut Random| {
        *m = LastVoxel { triangle: any_triangle(r), cell: any_cell(r) };
    };
    let near = |m: &mut Nearby<LastVoxel>, r: &mut Random| {
        voxel(&mut m.memory, r);
        (m.origin, m.direction) = (r.in_cube(2.0), r.in_cube(1.0));
        if r.below(8) == 0 {
            m.direction = Vec3::NAN;
        }
    };
    let cell = |m: &mut LastCell, r: &mut Random| m.cell = any_cell(r);
    let mut fronts = Fronts::default();
    let mut random = Random(seed);
    (0..300).for_each(|_| fronts.move_to_front(any_triangle(&mut random), any_cell(&mut random)));
    let per_light = (PerLight::default(), ());
    scrambled(world, backend, inquiry(), leaves_out, per_light, object, seed);
    scrambled(world, backend, inquiry(), leaves_out, (PerLight::default(), ()), voxel, seed);
    scrambled(world, backend, inquiry(), leaves_out, (PerPath::new(3), ()), voxel, seed);
    let shared = (tolerance, ());
    scrambled(world, backend, inquiry(), leaves_out, (PerPath::new(3), shared), near, seed);
    scrambled(world, backend, inquiry(), leaves_out, (PerLight::default(), fronts), cell, seed);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_content_of_a_memory_changes_an_answer(seed in any::<u64>()) {
        let world = World::random(seed);
        for backend in &world.backends {
            let direct = || Direct::new(&**backend, world.opaque());
            all_memories(&world, &**backend, direct, false, seed);
            for retest in [Retest::NotCell, Retest::NotTriangles] {
                let sparing = || Sparing::new(direct(), false, retest);
                all_memories(&world, &**backend, sparing, false, seed);
            }
        }
    }

    #[test]
    fn nor_where_the_spawner_is_left_out(seed in any::<u64>()) {
        let world = World::random(seed);
        for backend in &world.backends {
            for retest in [Retest::Again, Retest::NotCell, Retest::NotTriangles] {
                let direct = || Direct::new(&**backend, world.opaque());
                let sparing = || Sparing::new(direct(), true, retest);
                all_memories(&world, &**backend, sparing, true, seed);
            }
        }
    }
}

#[test]
fn leaving_out_a_triangle_is_being_without_it() {
    let world = World::random(5);
    let mut random = Random(6);
    for spawner in 0..world.mesh.len() {
        let mut rest = world.mesh.clone();
        // The triangle goes away, its place stays: a point blocks nothing.
        rest[spawner] = [Vec3::splat(9.0); 3];
        let without = World::new(rest, 160);
        let mut left_out = LeftOut::new(world.opaque(), true);
        for _ in 0..20 {
            let ray = Aim::Random.ray(&world.mesh, &mut random);
            let tally = &mut Tally::default();
            for (backend, without) in world.backends.iter().zip(&without.backends) {
                let expected = without.occluded(&ray, tally);
                left_out.begin(Some(spawner as TriangleId));
                let found = backend.occluder_except(&ray, None, &mut left_out, tally);
                assert_eq!(found.is_some(), expected);
                assert!(found.is_none_or(|found| found.triangle != spawner as TriangleId));
            }
        }
    }
}

/// Whether a ray from `origin` is blocked when only triangle 0 is left out.
fn blocked_beside_the_spawner(mesh: &[Triangle], origin: Vec3, direction: Vec3) -> bool {
    let world = World::new(mesh.to_vec(), mesh.len());
    let mut left_out = LeftOut::new(world.opaque(), true);
    left_out.begin(Some(0));
    let ray = Ray::towards(origin, direction);
    let found = world.backends[0].occluder_except(&ray, None, &mut left_out, &mut Tally::default());
    found.is_some()
}

#[test]
fn leaving_out_the_spawner_is_enough_for_a_triangle_alone_and_not_beside_others() {
    let (a, b, c) = (Vec3::ZERO, vec3(2.0, 0.0, 0.0), vec3(0.0, 2.0, 0.0));
    let (middle, up) = (vec3(0.5, 0.5, 0.0), vec3(0.3, 0.2, 1.0));
    let spawner = [a, b, c];
    assert!(!blocked_beside_the_spawner(&[spawner], middle, up), "alone");

    let copy = [b, c, a];
    assert!(blocked_beside_the_spawner(&[spawner, copy], middle, up), "a duplicate");

    let coplanar = [vec3(-1.0, -1.0, 0.0), vec3(4.0, -1.0, 0.0), vec3(-1.0, 4.0, 0.0)];
    assert!(blocked_beside_the_spawner(&[spawner, coplanar], middle, up), "one in its plane");

    let neighbour = [b, vec3(2.0, 2.0, 0.0), c];
    let on_the_edge = vec3(1.0, 1.0, 0.0);
    assert!(blocked_beside_the_spawner(&[spawner, neighbour], on_the_edge, up), "a common edge");

    // Of a convex surface, at a point that rounding moved below it: the neighbour blocks though no
    // point of the surface sees it.
    let folded = [b, vec3(2.0, 2.0, -0.01), c];
    let rounded_inwards = vec3(1.0001, 1.0001, -0.0001);
    assert!(
        blocked_beside_the_spawner(&[spawner, folded], rounded_inwards, vec3(0.0, 0.0, 1.0)),
        "a rounded point"
    );

    // An offset origin sees the light in all of these.
    for mesh in [vec![spawner], vec![spawner, copy], vec![spawner, coplanar]] {
        assert!(!blocked_beside_the_spawner(&mesh, middle + vec3(0.0, 0.0, 1e-5), up));
    }
    let edge = on_the_edge + vec3(0.0, 0.0, 1e-5);
    assert!(!blocked_beside_the_spawner(&[spawner, neighbour], edge, up));
}

fn all_paths(bounces: u8) -> Vec<Path> {
    let mut paths = vec![Path::EYE];
    let mut last = paths.clone();
    for _ in 0..bounces {
        last = last.iter().flat_map(|path| [path.reflected(), path.refracted()]).collect();
        paths.extend(&last);
    }
    paths
}

#[test]
fn trees_are_as_large_as_the_paper_says() {
    println!("bounces  nodes  bytes  paper");
    for (bounces, nodes, bytes, paper, most) in
        [(5, 63, 1008, "less than 1 KB", 1024), (10, 2047, 32_752, "32 KB", 32_768)]
    {
        let mut shelf = PerPath::<LastVoxel>::new(bounces);
        for path in all_paths(bounces) {
            shelf.at(0, path);
        }
        let ours = shelf.count() * PerPath::<LastVoxel>::NODE_BYTES;
        println!("{bounces:7}  {:5}  {ours:5}  {paper}", shelf.count());
        assert_eq!((shelf.count(), ours), (nodes, bytes));
        assert!(ours <= most);
    }
}

#[test]
fn trees_have_nodes_only_for_lights_and_paths_that_occur() {
    let mut shelf = PerPath::<LastVoxel>::new(10);
    assert_eq!(shelf.count(), 0);
    shelf.at(7, Path::EYE.reflected().refracted());
    assert_eq!(shelf.count(), 3, "the root, a child, a grandchild of one light");
    shelf.at(7, Path::EYE.reflected().refracted());
    shelf.at(7, Path::EYE.reflected());
    assert_eq!(shelf.count(), 3);
    shelf.at(7, Path::EYE.refracted());
    assert_eq!(shelf.count(), 4);
    shelf.clear();
    assert_eq!(shelf.count(), 0);
}

#[test]
fn paths_of_the_bit_table_lead_to_different_nodes() {
    let mut shelf = PerPath::<LastOccluder>::new(10);
    let paths = all_paths(6);
    for (number, &path) in paths.iter().enumerate() {
        shelf.at(0, path).triangle = number as u32;
    }
    for (number, &path) in paths.iter().enumerate() {
        assert_eq!(shelf.at(0, path).triangle, number as u32, "{path:?}");
    }
}

#[test]
fn beyond_the_depth_limit_the_last_node_serves() {
    let mut shelf = PerPath::<LastOccluder>::new(2);
    let last = Path::EYE.reflected().refracted();
    shelf.at(0, last).triangle = 42;
    for beyond in [last.reflected(), last.refracted(), last.reflected().reflected()] {
        assert_eq!(shelf.at(0, beyond).triangle, 42);
    }
    assert_eq!(shelf.count(), 3);
    assert_eq!(shelf.at(0, Path::EYE.reflected()).triangle, u32::MAX);
}

#[test]
fn a_full_tree_serves_from_the_node_above() {
    let mut shelf = PerPath::<LastOccluder>::new(31);
    for path in all_paths(16) {
        shelf.at(0, path);
    }
    assert_eq!(shelf.count(), 65_535, "all nodes of 15 bounces");
    let mut deepest = Path::EYE;
    (0..31).for_each(|_| deepest = deepest.refracted());
    shelf.at(0, deepest).triangle = 1;
    let mut served = Path::EYE;
    (0..15).for_each(|_| served = served.refracted());
    assert_eq!(shelf.at(0, served).triangle, 1);
}
