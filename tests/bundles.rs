//! Queries in bundles, as pictures ask them, of all sizes beside each other: verdicts about them are exact.

mod common;

use std::sync::Arc;

use common::Random;
use common::lit::{point, scene, sun};
use glam::{DVec3, Vec3, vec3};
use umbra::geometry::{Ray, Triangle};
use umbra::occlusion::{Backend, BuildOptions, Tally, Test, build};
use umbra::scene::{Light, Scene};
use umbra::shadow::{Answer, Combination, Path, ShadowQuery, VerdictKind, prepare};

/// Worlds that are tried: some, and those of some thousands in which versions before lost a blocker.
const WORLDS: [std::ops::Range<u64>; 3] = [0..40, 1226..1227, 2969..2970];

/// Asks about each light and compares with exact arithmetic, triangle by triangle. How many are lit and blocked.
fn check(
    scene: &Scene,
    kind: VerdictKind,
    asked: &[(usize, Vec<ShadowQuery>)],
    what: &str,
) -> [usize; 2] {
    let options = BuildOptions::default();
    let brute = build(Backend::Brute, Test::Exact, &scene.triangles, &options).unwrap();
    let prepared = prepare(Combination::from(kind), scene, &*brute).unwrap();
    let mut worker = prepared.worker();
    let mut counts = [0; 2];
    for (light, asked) in asked {
        let mut answers = vec![Answer::default(); asked.len()];
        worker.answer(*light, asked, &mut answers);
        for (place, (query, answer)) in asked.iter().zip(&answers).enumerate() {
            let expected = brute.occluded(&query.ray, &mut Tally::default());
            assert_eq!(
                answer.blocked, expected,
                "{kind}, {what}, light {light}, query {place}: {query:?}"
            );
            counts[usize::from(expected)] += 1;
        }
    }
    counts
}

/// A power of ten between these.
fn scale(random: &mut Random, low: f32, high: f32) -> f32 {
    10f32.powf(random.between(low, high))
}

/// Small whole numbers.
fn lattice(random: &mut Random) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.below(9) as f32 - 4.0))
}

/// A world of things of all sizes, and queries among them that it is easy to be wrong about.
struct World {
    /// Powers of ten up to which its things are apart.
    reach: f32,
    lights: Vec<Light>,
    /// By light.
    origins: Vec<Vec<Vec3>>,
    mesh: Vec<Triangle>,
}

impl World {
    fn new(random: &mut Random) -> Self {
        let reach = random.between(-1.5, 2.0);
        let mut world = Self { reach, lights: vec![], origins: vec![], mesh: vec![] };
        for _ in 0..1 + random.below(12) {
            world.add_heap(random);
        }
        for _ in 0..3 {
            let place = world.place(random);
            let light = match random.below(4) {
                0 => sun(lattice(random).normalize_or(Vec3::Y)),
                1 => sun(random.in_cube(1.0).normalize_or(Vec3::Y)),
                _ => point(place),
            };
            let mut origins = Vec::new();
            for _ in 0..1 + random.below(3) {
                world.add_bundles(&light, &mut origins, random);
            }
            for _ in 0..random.below(60) {
                let ray = light.shadow_ray(origins[random.below(origins.len())]);
                world.add_what_it_touches(&ray, random);
            }
            world.origins.push(origins);
            world.lights.push(light);
        }
        world
    }

    /// Triangles of one size, not far from each other.
    fn add_heap(&mut self, random: &mut Random) {
        let centre = scale(random, -2.0, self.reach) * lattice(random);
        let most = if random.below(4) == 0 { 3.5 } else { self.reach };
        let (size, spread) = (scale(random, -3.0, most), scale(random, -3.0, self.reach));
        let any = |random: &mut Random| match random.below(2) {
            0 => lattice(random),
            _ => random.in_cube(4.0),
        };
        for _ in 0..1 + random.below(40) {
            let middle = centre + spread * any(random);
            let snapped = random.below(2) == 0;
            self.mesh.push(std::array::from_fn(|_| {
                let way = if snapped { lattice(random) } else { random.in_cube(1.0) };
                middle + size * way
            }));
        }
    }

    /// A triangle with a corner where a ray passes, or within a rounding of that: mostly all on one side of it, so that the ray
    /// touches no more than a corner of its box.
    fn add_what_it_touches(&mut self, ray: &Ray, random: &mut Random) {
        let far = if ray.end == 1.0 { random.unit() } else { scale(random, -2.0, 4.0) };
        let place = ray.origin + far * ray.direction;
        let size = scale(random, -3.0, self.reach);
        let side = Vec3::from_array(std::array::from_fn(|_| [1.0, -1.0][random.below(2)]));
        let mut corner = || place + size * side * random.in_cube(1.0).abs();
        self.mesh.push([place, corner(), corner()]);
    }

    /// A place that has coordinates of corners, or whole numbers of some unit.
    fn place(&self, random: &mut Random) -> Vec3 {
        let free = scale(random, -2.0, self.reach) * lattice(random);
        Vec3::from_array(std::array::from_fn(|axis| match random.below(3) {
            0 => free[axis],
            _ => self.mesh[random.below(self.mesh.len())][random.below(3)][axis],
        }))
    }

    /// Bundles on a line, in a plane or a box, of which some are small and some large; often in one plane with the light.
    fn add_bundles(&self, light: &Light, origins: &mut Vec<Vec3>, random: &mut Random) {
        let mut base = self.place(random);
        let mut mask = Vec3::from_array(std::array::from_fn(|_| random.below(2) as f32));
        if let (Light::Point { position, .. }, true) = (light, random.below(4) > 0) {
            let axis = random.below(3);
            base[axis] = position.as_vec3()[axis];
            mask[axis] = 0.0;
        }
        for _ in 0..1 + random.below(4) {
            let spread = scale(random, -3.0, 3.5) * mask;
            let count = [1, 5, 16, 40, 256, 300, 512][random.below(7)];
            let (kind, way) = (random.below(4), spread * random.in_cube(1.0));
            let shift = [Vec3::ZERO, spread * random.in_cube(1.0)][random.below(2)];
            origins.extend((0..count).map(|i| {
                base + shift
                    + match kind {
                        0 => way * (i as f32 / count as f32 - 0.5),
                        1 => spread * random.in_cube(1.0),
                        2 => spread * lattice(random) / 4.0,
                        _ => mask * scale(random, -4.0, self.reach) * random.in_cube(1.0),
                    }
            }));
        }
    }
}

#[test]
fn verdicts_are_exact_where_bundles_of_all_sizes_follow_each_other() {
    let mut sum = [0; 2];
    for seed in WORLDS.into_iter().flatten() {
        let mut random = Random(seed);
        let World { lights, origins, mesh, .. } = World::new(&mut random);
        let scene = scene(&mesh, lights);
        let mut asked = Vec::new();
        for (number, light) in scene.lights.iter().enumerate() {
            let other = &scene.lights[(number + 1) % scene.lights.len()];
            let queries = origins[number].iter().map(|&origin| {
                // Some are about another light.
                let light = if random.below(100) == 0 { other } else { light };
                query(light.shadow_ray(origin))
            });
            asked.push((number, queries.collect()));
        }
        for kind in VerdictKind::ALL {
            let counts = check(&scene, kind, &asked, &format!("seed {seed}"));
            sum[0] += counts[0];
            sum[1] += counts[1];
        }
    }
    assert!(sum[0] > 100_000 && sum[1] > 100_000, "lit and blocked: {sum:?}");
}

fn query(ray: Ray) -> ShadowQuery {
    ShadowQuery { ray, path: Path::EYE, spawner: 0 }
}

/// Asks every kind of verdict about the first light.
fn check_all(scene: &Scene, asked: Vec<ShadowQuery>) {
    let asked = [(0, asked)];
    for kind in VerdictKind::ALL {
        check(scene, kind, &asked, "");
    }
}

/// Bundles share the ground that planes stand on, and are relative to its middle: where that is far away, they round more coarsely than
/// by themselves.
#[test]
fn a_small_bundle_on_the_ground_of_a_large_one_meets_what_it_only_touches() {
    // Off by 12 micrometres, half of what separates numbers at the middle of the ground, 300 metres away.
    let aside = 1.2e-5;
    let hedge = |i: usize| {
        let (from, to) = (0.5 * i as f32 - 2.0, 0.5 * i as f32 - 1.5);
        [vec3(aside, 0.5, from), vec3(aside, 0.5, to), vec3(1.0, 0.5, from)]
    };
    // Clusters are large on the whole, so that bundles as long are not sorted.
    let plain = |y: f32| [vec3(-2e3, y, -2e3), vec3(2e3, y, -2e3), vec3(0.0, y, 2e3)];
    let mut mesh: Vec<Triangle> = (0..8).map(hedge).collect();
    mesh.extend((1..100).map(|floor| plain(-10.0 * floor as f32)));
    let scene = scene(&mesh, vec![point(vec3(aside, 1.0, 0.0))]);
    assert_eq!(scene.triangles.get(0), mesh[0], "nothing was moved");
    let places = (0..256).map(|i| i as f32 / 255.0);
    let long = places.clone().map(|s| vec3(1400.0 * s - 400.0, 0.0, 2.0 * s - 1.0));
    let short = places.map(|s| vec3(aside, 0.0, 2.0 * s - 1.0));
    let asked: Vec<ShadowQuery> =
        long.chain(short).map(|origin| query(scene.lights[0].shadow_ray(origin))).collect();
    let blocked = check(&scene, VerdictKind::Shaft, &[(0, asked.clone())], "")[1];
    assert!(blocked >= 256);
    check_all(&scene, asked);
}

/// Where rays have no end, boxes may be much farther away than all origins, and round as much more coarsely.
#[test]
fn rays_to_a_sun_meet_what_they_touch_far_away() {
    let direction = vec3(0.46039924, 0.43101567, 0.77605283);
    let origin = vec3(0.10398253, 0.45430747, 0.38726512);
    let (y, z) = (19.080523, 32.92416);
    let roof = [vec3(20.0, y, z), vec3(20.0, y, z + 2.0), vec3(20.0, y + 1.0, z + 1.0)];
    let floor = [vec3(-1.0, -1.0, 0.0), vec3(1.0, -1.0, 0.0), vec3(0.0, 1.0, 0.0)];
    let scene = scene(&[[roof; 8], [floor; 8]].concat(), vec![sun(direction)]);
    let ray = scene.lights[0].shadow_ray(origin);
    let asked = vec![query(ray)];
    assert_eq!(check(&scene, VerdictKind::Shaft, &[(0, asked.clone())], ""), [0, 1]);
    check_all(&scene, asked);
    // Edges of boxes where a ray passes them, near and far, in bundles of any size.
    let mut random = Random(7);
    for far in [1e1, 1e3, 1e6] {
        let direction = random.in_cube(1.0).normalize();
        let origins: Vec<Vec3> = (0..300).map(|_| random.in_cube(0.5)).collect();
        let touched = origins.iter().map(|&origin| -> Triangle {
            let place = origin + far * direction;
            let size = 0.02 * far;
            [
                place,
                place + size * random.in_cube(1.0).abs(),
                place + size * random.in_cube(1.0).abs(),
            ]
        });
        let mut mesh: Vec<Triangle> = touched.collect();
        // As far away on the other side, lest all be moved to the origin.
        mesh.push(mesh[0].map(|corner| -corner));
        let scene = self::scene(&mesh, vec![sun(direction)]);
        assert_eq!(scene.origin, DVec3::ZERO, "nothing was moved");
        let ray = |&origin: &Vec3| query(scene.lights[0].shadow_ray(origin));
        let asked: Vec<ShadowQuery> = origins.iter().map(ray).collect();
        for count in [1, 5, 16, 300] {
            for asked in asked.chunks(count) {
                check_all(&scene, asked.to_vec());
            }
        }
    }
}

/// Suns have directions of unit length once a scene is finished, but its fields are public.
#[test]
fn suns_of_any_length_lose_no_blocker() {
    let mut random = Random(11);
    for reach in [1.0, 1e6] {
        let mesh: Vec<Triangle> = (0..40)
            .map(|_| {
                let place = random.in_cube(reach);
                [(); 3].map(|()| place + random.in_cube(0.5 * reach))
            })
            .collect();
        let mut scene = scene(&mesh, vec![sun(Vec3::Y)]);
        for power in -44..38 {
            let length = 10f64.powi(power);
            let direction = length * DVec3::new(0.48, 0.36, 0.8);
            scene.lights[0] = Light::Directional { direction, irradiance: Vec3::ONE };
            let ray = |_| query(scene.lights[0].shadow_ray(random.in_cube(reach)));
            let asked: Vec<ShadowQuery> = (0..256).map(ray).collect();
            for kind in VerdictKind::ALL {
                check(&scene, kind, &[(0, asked.clone())], &format!("length {length:e}"));
            }
            for asked in asked.iter().take(32) {
                check(&scene, VerdictKind::Shaft, &[(0, vec![*asked])], "alone");
            }
        }
    }
}

/// A triangle that is not finite blocks nothing, and shares no edge with one that is.
#[test]
fn a_broken_triangle_opens_no_other() {
    let roof = [vec3(-0.3, 0.5, -0.4), vec3(0.4, 0.5, -0.2), vec3(0.0, 0.5, 0.4)];
    let floor = [vec3(-1.0, -1.0, -1.0), vec3(1.0, -1.0, -1.0), vec3(0.0, -1.0, 1.0)];
    let mut scene = scene(&[floor], vec![point(vec3(0.1, 3.0, 0.05))]);
    let place = |number: usize| number as f32 / 16.0 - 0.97;
    let origins = (0..1024).map(|number| vec3(place(number % 32), -0.6, place(number / 32)));
    let asked: Vec<_> = origins.map(|origin| query(scene.lights[0].shadow_ray(origin))).collect();
    for beyond in [f32::NAN, f32::INFINITY] {
        let broken = [roof[0], roof[1], vec3(beyond, 0.0, 0.0)];
        for mesh in [[broken, roof, floor], [roof, broken, floor]] {
            scene.triangles = Arc::new(mesh.into_iter().collect());
            scene.material_of = vec![0; 3];
            for kind in VerdictKind::ALL {
                check(&scene, kind, &[(0, asked.clone())], "beside a broken triangle");
            }
        }
    }
}

/// The first query of a packet may be one that nobody of the packet is like.
#[test]
fn a_ray_that_goes_elsewhere_spoils_no_packet() {
    let light = vec3(0.0, 10.0, 0.0);
    let roof = [vec3(-0.05, 5.0, -0.05), vec3(0.05, 5.0, -0.05), vec3(0.0, 5.0, 0.05)];
    for (source, end) in [(point(light), 0.25), (sun(Vec3::Y), 1.0)] {
        // Or it would be moved to the origin.
        let floor = [vec3(-9.0, -9.0, -9.0), vec3(9.0, -9.0, -9.0), vec3(0.0, -9.0, 9.0)];
        let scene = scene(&[[roof; 8], [floor; 8]].concat(), vec![source]);
        let row = (0..15).map(|i| scene.lights[0].shadow_ray(vec3(i as f32, 0.0, 0.0)));
        let strange = Ray { origin: vec3(9.0, 0.0, 9.0), direction: Vec3::X, end };
        for place in [0, 7, 15] {
            let mut rays: Vec<Ray> = row.clone().collect();
            rays.insert(place, strange);
            let asked: Vec<ShadowQuery> = rays.into_iter().map(query).collect();
            assert_eq!(check(&scene, VerdictKind::Shaft, &[(0, asked.clone())], "")[1], 1);
            check_all(&scene, asked);
        }
    }
}

/// In the view of a sun a place errs by roundings of its distance.
#[test]
fn origins_far_outside_the_scene_meet_what_is_in_it() {
    let direction = vec3(-0.36186028, 0.051469825, -0.9308104);
    let origin = vec3(361_860.56, -51_469.43, 930_810.6);
    let leaf = [
        vec3(0.2957304, 0.4421392, 0.24544494),
        vec3(0.29842824, 0.3486037, 0.28882387),
        vec3(0.29695565, 0.39167818, 0.24064861),
    ];
    let sheet = [vec3(-1.0, -1.0, -1.0), vec3(1.0, 1.0, -1.0), vec3(1.0, 1.0, 1.0)];
    let scene = scene(&[[leaf; 8], [sheet; 8]].concat(), vec![sun(direction)]);
    check_all(&scene, vec![query(scene.lights[0].shadow_ray(origin))]);
}

#[test]
fn a_ray_that_starts_nowhere_is_counted_and_not_settled() {
    for source in [point(Vec3::Y), sun(Vec3::Y)] {
        let roof = [vec3(-1.0, 0.5, -1.0), vec3(1.0, 0.5, -1.0), vec3(0.0, 0.5, 1.0)];
        let scene = scene(&[roof], vec![source]);
        let options = BuildOptions::default();
        let brute = build(Backend::Brute, Test::Exact, &scene.triangles, &options).unwrap();
        for kind in VerdictKind::ALL {
            let prepared = prepare(Combination::from(kind), &scene, &*brute).unwrap();
            for lost in [Vec3::NAN, Vec3::INFINITY, vec3(0.0, f32::NAN, 0.0)] {
                let mut worker = prepared.worker();
                let direction = scene.lights[0].shadow_ray(Vec3::ZERO).direction;
                let ray = Ray { origin: lost, ..scene.lights[0].shadow_ray(lost) };
                for ray in [ray, Ray { direction, ..ray }] {
                    worker.answer(0, &[query(ray)], &mut [Answer::default()]);
                }
                let tally = worker.tally();
                assert_eq!(tally.backend.invalid_rays, 2, "{kind}, {lost}");
                assert_eq!(tally.verdicts[kind.index()].passed_on, 2, "{kind}, {lost}");
            }
        }
    }
}
