//! Blockers that obvhs 0.4 loses by itself, and that umbra finds with the same trees.
//!
//! `cargo run --release --example obvhs_losses`
//!
//! Each scene is a floor of quads. obvhs builds its tree and traverses it as its own examples do, with its own
//! ray and its own triangle test; umbra uses the tree for culling only, with a ray and a test of its own.
//! The truth is the exact verdict. docs/how-wrong.md explains each loss.

use std::sync::Arc;
use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use umbra::exact::Verdict;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::measure::extremes::truth;
use umbra::occlusion::{Backend, BuildOptions, Tally, Test, build};

/// Rays of each scene.
const RAYS: usize = 10_000;

/// Quads along a side of the floor.
const SIDE: usize = 16;

/// A floor from −8 to 8 at height 0, in unit quads.
fn floor() -> Vec<Triangle> {
    let point = |i: usize, j: usize| Vec3::new(i as f32 - 8.0, 0.0, j as f32 - 8.0);
    (0..SIDE * SIDE)
        .flat_map(|quad| {
            let (i, j) = (quad % SIDE, quad / SIDE);
            let [a, b] = [point(i, j), point(i + 1, j)];
            let [c, d] = [point(i, j + 1), point(i + 1, j + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect()
}

/// A number from 0 to 1 for each index: steps of the golden ratio.
fn spread(index: usize, stream: usize) -> f32 {
    (0.618_034 * (1 + index) as f64 + 0.414_214 * (index * stream) as f64).fract() as f32
}

/// A point of the floor, away from its border.
fn on_floor(index: usize) -> Vec3 {
    Vec3::new(14.0 * spread(index, 1) - 7.0, 0.0, 14.0 * spread(index, 2) - 7.0)
}

/// Straight down from far above just inside the floor's border: the direction has two zero components.
fn down_beside_the_border(index: usize) -> Ray {
    let inside = 1e-5 * (1.0 + spread(index, 1));
    let origin = Vec3::new(8.0 - inside, 1000.0, 14.0 * spread(index, 2) - 7.0);
    Ray { origin, direction: Vec3::NEG_Y, end: 2000.0 }
}

/// From just above the floor to a light far below: the blocker is near the start of a long segment.
fn towards_a_distant_light(index: usize) -> Ray {
    let origin = on_floor(index) + Vec3::new(0.0, 0.1, 0.0);
    Ray::between(origin, Vec3::new(100.0, -4000.0, 50.0))
}

/// From above to points of the quads' diagonals and on: what one triangle leaves, its neighbour must take.
fn at_shared_edges(index: usize) -> Ray {
    let (i, j) = ((spread(index, 1) * 15.9).floor(), (spread(index, 2) * 15.9).floor());
    let along = spread(index, 3);
    let target = Vec3::new(i - 8.0 + along, 0.0, j - 7.0 - along);
    let origin = Vec3::new(20.0 * spread(index, 4) - 10.0, 5.0, 20.0 * spread(index, 5) - 10.0);
    Ray { origin, direction: 2.0 * (target - origin), end: 1.0 }
}

/// Whether obvhs alone says that the ray is blocked: with its binary tree, and with its compressed wide one.
struct Alone {
    triangles: Vec<obvhs::triangle::Triangle>,
    bvh2: obvhs::bvh2::Bvh2,
    cwbvh: obvhs::cwbvh::CwBvh,
}

impl Alone {
    fn new(mesh: &[Triangle]) -> Self {
        let pad = |&[v0, v1, v2]: &Triangle| obvhs::triangle::Triangle {
            v0: Vec3A::from(v0),
            v1: Vec3A::from(v1),
            v2: Vec3A::from(v2),
        };
        let triangles: Vec<_> = mesh.iter().map(pad).collect();
        let (options, time) = (BvhBuildParams::medium_build(), &mut Duration::default());
        let bvh2 = build_bvh2_from_tris(&triangles, options, time);
        let cwbvh = build_cwbvh_from_tris(&triangles, options, time);
        Self { triangles, bvh2, cwbvh }
    }

    fn answers(&self, ray: &Ray) -> [bool; 2] {
        let ray = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, ray.end);
        let by_bvh2 = !self.bvh2.ray_traverse_miss(ray, |ray, place| {
            self.triangles[self.bvh2.primitive_indices[place] as usize].intersect(ray)
        });
        let by_cwbvh = !self.cwbvh.ray_traverse_miss(ray, |ray, place| {
            self.triangles[self.cwbvh.primitive_indices[place] as usize].intersect(ray)
        });
        [by_bvh2, by_cwbvh]
    }
}

fn main() {
    let mesh = floor();
    let triangles = Arc::new(mesh.iter().copied().collect::<Triangles>());
    let alone = Alone::new(&mesh);
    let ours = [Backend::Bvh2, Backend::Cwbvh].map(|backend| {
        build(backend, Test::Exact, &triangles, &BuildOptions::default()).expect("it is ours")
    });
    println!("{RAYS} rays each            blocked   obvhs alone loses    umbra is wrong on");
    println!("                                        bvh2     cwbvh      bvh2     cwbvh");
    type Shot = fn(usize) -> Ray;
    let scenes: [(&str, Shot); 3] = [
        ("down beside the border", down_beside_the_border),
        ("towards a distant light", towards_a_distant_light),
        ("at shared edges", at_shared_edges),
    ];
    for (name, shot) in scenes {
        let (mut blocked, mut lost, mut wrong) = (0, [0; 2], [0; 2]);
        for ray in (0..RAYS).map(shot) {
            let is_blocked = truth(&ray, &triangles) == Verdict::Blocked;
            blocked += usize::from(is_blocked);
            for (tree, answer) in alone.answers(&ray).into_iter().enumerate() {
                lost[tree] += usize::from(is_blocked && !answer);
                let ours = ours[tree].occluded(&ray, &mut Tally::default());
                wrong[tree] += usize::from(ours != is_blocked);
            }
        }
        let [a, b] = lost;
        let [c, d] = wrong;
        println!("{name:24}{blocked:>12}{a:>8}{b:>10}{c:>10}{d:>10}");
    }

    let triangle = &alone.triangles[0];
    let middle = (triangle.v0 + triangle.v1 + triangle.v2) / 3.0;
    let above = middle + 3.0 * Vec3A::Y;
    let ray = obvhs::ray::Ray::new_inf(above, Vec3A::NEG_Y);
    println!("a triangle 3 away: intersect gives t = {}", triangle.intersect(&ray));
    #[cfg(target_arch = "x86_64")]
    {
        let long = obvhs::ray::Ray::new_inf(above, 4.0 * Vec3A::NEG_Y);
        let (plain, embree) = (triangle.intersect(&long), triangle.intersect_embree(&long));
        println!("with a direction 4 long: intersect {plain}, intersect_embree {embree}");
    }

    let copies = vec![alone.triangles[0]; 2000];
    let (options, time) = (BvhBuildParams::medium_build(), &mut Duration::default());
    let chain = build_bvh2_from_tris(&copies, options, time);
    println!("2,000 copies of one triangle: a tree {} deep in {:.1?}", chain.max_depth, *time);
}
