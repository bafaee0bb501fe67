//! Planes against the exact test, where it is hard.

use proptest::prelude::*;

use super::super::strategies::point;
use super::*;
use crate::exact::certified;
use crate::geometry::lanes::{Available, LanesJob};
use crate::geometry::{Ray, Triangle, Triangles};
use crate::occlusion::Clusters;

/// Triangles, and origins that are asked about each.
struct Case<'a> {
    source: Source,
    triangles: &'a [Triangle],
    origins: &'a [Vec3],
}

impl LanesJob for Case<'_> {
    /// Of each origin: triangles that certainly block, and those that are left open.
    type Answer = Vec<(u32, u32)>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Answer {
        let clusters = Clusters::new(&Triangles::new(self.triangles.iter().copied(), []));
        let mut all = OriginBox::EMPTY;
        for &origin in self.origins {
            all = all.union(OriginBox { low: origin, high: origin });
        }
        let ground = Ground::around(&self.source, &all, 1.0);
        let mut planes = Planes::EMPTY;
        planes.set::<L>(&ground, &clusters.all()[0]);
        let mut said = Vec::new();
        for &origin in self.origins {
            let (certain, open) = planes.cast_on_one::<L>(origin - ground.centre);
            let ids = clusters.all()[0].ids();
            let mut by_id = (0, 0);
            for (lane, id) in ids.iter().enumerate() {
                by_id.0 |= (certain >> lane & 1) << id;
                by_id.1 |= (open >> lane & 1) << id;
            }
            said.push(by_id);
        }
        said
    }
}

fn ray(source: &Source, origin: Vec3) -> Ray {
    match *source {
        Source::Point(light) => Ray::between(origin, light),
        Source::Direction(direction) => Ray::towards(origin, direction),
    }
}

/// How many answers are left open; all others must be right.
fn open(source: Source, triangles: &[Triangle], origins: &[Vec3]) -> usize {
    let mut all = 0;
    for arithmetic in Available::all() {
        let said = arithmetic.run(Case { source, triangles, origins });
        for (origin, (certain, open)) in origins.iter().zip(said) {
            for (id, triangle) in triangles.iter().enumerate() {
                if open & (1 << id) != 0 {
                    all += 1;
                    continue;
                }
                let expected = certified::blocks(&ray(&source, *origin), triangle);
                let is_certain = certain & (1 << id) != 0;
                assert_eq!(is_certain, expected, "{arithmetic:?} {source:?} {triangle:?} {origin}");
            }
        }
    }
    all
}

fn triangles() -> impl Strategy<Value = Vec<Triangle>> {
    let triangle = (point(1.0), prop::array::uniform3(point(1.0)), -4..1i32);
    let triangle = triangle
        .prop_map(|(place, corners, size)| corners.map(|corner| place + 10f32.powi(size) * corner));
    prop::collection::vec(triangle, WIDTH)
}

/// Origins from which the line to the light passes, as nearly as f32 can say, an edge or a corner of a triangle, or that are in its plane.
fn hard(source: Source, triangles: &[Triangle], numbers: &[(f32, f32, u8)]) -> Vec<Vec3> {
    let near = numbers.iter().zip(triangles.iter().cycle());
    near.map(|(&(along, beyond, kind), &[a, b, c])| {
        let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        let (along, beyond) = (f64::from(along), f64::from(beyond));
        let touched = match kind % 4 {
            0 => a.lerp(b, along),
            1 => b.lerp(c, along),
            2 => c,
            _ => return a.lerp(b, along).lerp(c, beyond / 4.0).as_vec3(),
        };
        match source {
            Source::Point(light) => light.as_dvec3().lerp(touched, beyond).as_vec3(),
            Source::Direction(direction) => (touched - beyond * direction.as_dvec3()).as_vec3(),
        }
    })
    .collect()
}

fn numbers() -> impl Strategy<Value = Vec<(f32, f32, u8)>> {
    prop::collection::vec((0f32..1.0, 0.5f32..4.0, any::<u8>()), 64)
}

proptest! {
    #[test]
    fn what_planes_say_of_hard_rays_to_a_point_is_what_the_exact_test_says(
        triangles in triangles(), light in point(3.0), numbers in numbers(),
    ) {
        let source = Source::Point(light);
        open(source, &triangles, &hard(source, &triangles, &numbers));
    }

    #[test]
    fn what_planes_say_of_hard_rays_to_a_direction_is_what_the_exact_test_says(
        triangles in triangles(), direction in point(1.0), numbers in numbers(),
    ) {
        let source = Source::Direction(direction);
        open(source, &triangles, &hard(source, &triangles, &numbers));
    }

    #[test]
    fn of_other_rays_planes_leave_few_open(
        triangles in triangles(), light in point(1.0), origins in prop::collection::vec(point(1.0), 64),
    ) {
        let light = light + Vec3::new(0.0, 5.0, 0.0);
        let left = open(Source::Point(light), &triangles, &origins);
        prop_assert!(left * 50 < origins.len() * WIDTH * 3, "{left}");
    }
}

#[test]
fn triangles_that_are_too_far_or_too_large_are_left_open() {
    let huge =
        [Vec3::new(-1e30, 1.0, -1e30), Vec3::new(1e30, 1.0, -1e30), Vec3::new(0.0, 1.0, 1e30)];
    let far = [Vec3::splat(1e20), Vec3::splat(1e20) + Vec3::X, Vec3::splat(1e20) + Vec3::Y];
    let lost = [Vec3::splat(f32::NAN), Vec3::X, Vec3::Y];
    let sources = [Source::Point(Vec3::new(0.0, 5.0, 0.0)), Source::Direction(Vec3::Y)];
    for source in sources {
        let left = open(source, &[huge, far, lost], &[Vec3::ZERO, Vec3::X]);
        // The one that is lost is in no cluster.
        assert_eq!(left, 4 * Available::all().count(), "all of the others, in each arithmetic");
    }
}
