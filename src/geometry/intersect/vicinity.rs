//! A hit counts only where the ray comes near the triangle.
//!
//! f32 tests report hits that are nowhere near the triangle: almost parallel to a sliver, or from very
//! far away, every quantity is rounding noise, and noise has the right signs now and then. An engine that
//! looks at every triangle would see such a hit, one that culls by boxes or voxels would not, and the
//! answer would depend on the engine. So a hit must also pass this test: the segment comes within the
//! *slack* of the triangle along every axis, where the slack is 48 roundings of the scene's largest
//! coordinate. That is more than an f32 test errs by where it makes sense (Embree's box tests err by
//! up to 10 roundings of the coordinates), and less than that by which every culler here widens
//! what it keeps. So no culler loses a hit that counts, wherever the ray comes from.
//!
//! It runs on hits only, in f64, some 10 ns; 150 ns for the few hits that are within 10⁻⁶ of an edge.
//!
//! How far f64 may be wrong, with u = 2⁻⁵³ and L the largest coordinate. All is measured from the place of the ray that is
//! nearest to a corner, not from the origin: so terms are as large as the triangle and its distance from the ray, R, however
//! far the ray comes from. The way there, of length D, displaces corners by u(3D + R): by 2⁻³⁰ L from 2²⁰ diagonals away,
//! and from farther away nothing is culled (`clip`). From there on:
//! * an edge's volume errs by 30u R²|d|, and counts from 10⁻⁶ R²|d| on. So the line passes through the triangle, and the volume of
//!   both, the sum of the three, is at least 3 · 10⁻⁶ R²|d|;
//! * the place where it does is a quotient by that volume, and errs by 96u E²R|d| over it, where E ≤ 2R is the longest
//!   edge: by 64u E / 10⁻⁶ at most, an eighth of a rounding of L, as E ≤ 2L. Measured from the origin, R would be the
//!   origin's distance, and from 10⁴ sizes away that error could be larger than the slack.
//!
//! What is less clear than that is left to separating axes, which have the slack as their margin.

use glam::DVec3;

use crate::geometry::{Ray, Triangle, is_finite};

/// The slack, in units of the largest coordinate.
const ROUNDINGS: f64 = 48.0 * f32::EPSILON as f64;

/// Edges that are farther from the ray than this, relative to the terms of their volumes, are not mistaken
/// for it in f64, and place the ray's way through the plane well enough: see above.
const CLEAR: f64 = 1e-6;

/// How near a ray must come to a triangle of a scene whose largest coordinate is this.
pub(in crate::geometry) fn slack(largest_coordinate: f32) -> f64 {
    ROUNDINGS * f64::from(largest_coordinate)
}

/// Whether the closed segment comes within the slack of the triangle, which must be finite.
pub(super) fn meets(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
    if !is_finite(triangle) {
        return false;
    }
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let corners = triangle.map(|corner| corner.as_dvec3() - origin);
    let end = f64::from(ray.end);
    // In this order, NaN, of a ray without direction, becomes 0.
    let near = (direction.dot(corners[0]) / direction.length_squared()).max(0.0).min(end);
    let place = near * direction;
    let corners = corners.map(|corner| corner - place);
    let segment = Segment { direction, start: -near, end: end - near };
    pierces(&corners, &segment) || !is_separate(&corners, &segment, slack)
}

/// A part of a line through 0.
struct Segment {
    direction: DVec3,
    start: f64,
    end: f64,
}

/// Whether the segment passes well inside the triangle.
#[inline]
fn pierces(corners: &[DVec3; 3], segment: &Segment) -> bool {
    let [a, b, c] = *corners;
    let direction = segment.direction;
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(direction);
    let largest = corners.map(|corner| corner.abs().max_element()).into_iter().fold(0.0, f64::max);
    let margin = CLEAR * direction.abs().max_element() * largest * largest;
    let turned = slope.signum();
    let volume = |from: DVec3, to: DVec3| direction.dot(from.cross(to)) * turned;
    let least = volume(a, b).min(volume(b, c)).min(volume(c, a));
    // How far the plane is, without a division.
    let (way, slope) = (normal.dot(a) * turned, slope.abs());
    least > margin && segment.start * slope <= way && way <= segment.end * slope
}

/// Whether a plane lies between the segment and the triangle widened to a cube about each point: separating
/// axes of two convex bodies, the normals of the wide triangle's faces and the products of edges.
#[cold]
fn is_separate(corners: &[DVec3; 3], segment: &Segment, slack: f64) -> bool {
    let [a, b, c] = *corners;
    let edges = [b - a, c - b, a - c];
    let direction = segment.direction;
    let separates = |axis: DVec3, run: f64| {
        let [a, b, c] = corners.map(|corner| axis.dot(corner));
        let radius = slack * axis.abs().element_sum();
        // Where the axis is square to the ray, it gets nowhere along it, however far it goes.
        let [from, to] =
            [segment.start, segment.end].map(|t| if run == 0.0 { 0.0 } else { run * t });
        a.max(b).max(c) + radius < from.min(to) || a.min(b).min(c) - radius > from.max(to)
    };
    let along = |axis: DVec3| separates(axis, axis.dot(direction));
    let across = |edge: DVec3| separates(direction.cross(edge), 0.0);
    DVec3::AXES.into_iter().any(along)
        || along(edges[0].cross(edges[1]))
        || edges.into_iter().any(across)
        || DVec3::AXES.into_iter().any(across)
        || edges.into_iter().any(|edge| DVec3::AXES.into_iter().any(|axis| along(axis.cross(edge))))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::random::SplitMix64;

    const TRIANGLE: Triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn down(x: f32, y: f32) -> Ray {
        Ray { origin: Vec3::new(x, y, 1.0), direction: Vec3::NEG_Z, end: f32::INFINITY }
    }

    #[test]
    fn the_triangle_is_as_wide_as_the_slack() {
        for (x, y) in [(0.2, 0.2), (0.0, 0.0), (-0.009, 0.5), (0.5, -0.009), (0.505, 0.505)] {
            assert!(meets(&down(x, y), &TRIANGLE, 0.01), "{x} {y}");
        }
        for (x, y) in [(-0.011, 0.5), (0.5, -0.011), (0.515, 0.515), (1.02, 0.0), (7.0, 7.0)] {
            assert!(!meets(&down(x, y), &TRIANGLE, 0.01), "{x} {y}");
        }
    }

    #[test]
    fn ends_count_as_far_as_the_slack_and_no_end_is_no_trouble() {
        let until = |end| Ray { end, ..down(0.2, 0.2) };
        assert!(meets(&until(0.995), &TRIANGLE, 0.01) && !meets(&until(0.985), &TRIANGLE, 0.01));
        let up = Ray { direction: Vec3::Z, ..down(0.2, 0.2) };
        assert!(!meets(&up, &TRIANGLE, 0.01));
        assert!(meets(&Ray { origin: Vec3::new(0.2, 0.2, 0.005), ..up }, &TRIANGLE, 0.01));
    }

    #[test]
    fn a_ray_in_the_plane_is_near_only_if_it_comes_near() {
        let beside = Ray::towards(Vec3::new(-1.0, -0.02, 0.0), Vec3::X);
        assert!(!meets(&beside, &TRIANGLE, 0.01));
        assert!(meets(&beside, &TRIANGLE, 0.03));
        // Inside the box of the triangle, yet far from it.
        let corner = Ray::between(Vec3::new(0.9, 0.9, -1.0), Vec3::new(0.9, 0.9, 1.0));
        assert!(!meets(&corner, &TRIANGLE, 0.01));
    }

    /// A number in [-1, 1).
    fn any(random: &mut SplitMix64) -> f32 {
        (2.0 * random.unit() - 1.0) as f32
    }

    fn any_point(random: &mut SplitMix64) -> Vec3 {
        Vec3::new(any(random), any(random), any(random))
    }

    /// A triangle of a scene whose largest coordinate is 1, down to specks and slivers.
    fn any_triangle(random: &mut SplitMix64) -> Triangle {
        let [size, width] = [(); 2].map(|()| 0.01f32.powf(any(random).abs()));
        let [a, b, c] = [(); 3].map(|()| any_point(random));
        [a, a.lerp(b, size), a.lerp(b.lerp(c, 0.5 * width), 0.5 * size)]
    }

    #[test]
    fn a_ray_that_ends_before_a_triangle_is_not_near_it_however_far_it_came() {
        let (slack, mut random) = (slack(1.0), SplitMix64::seeded(1));
        let mut counts = [0; 2];
        for distance in [3.0, 1e2, 1e4, 3e4, 1e5, 1e6] {
            for _ in 0..10_000 {
                let triangle = any_triangle(&mut random);
                let [a, b, c] = triangle;
                let inside = a.lerp(b, any(&mut random).abs()).lerp(c, any(&mut random).abs());
                let away = any_point(&mut random);
                // The rounding of the direction makes far rays shorter or longer, and this the near ones.
                let end = 1.0 + 8.0 * slack as f32 * any(&mut random) / distance;
                let ray = Ray { end, ..Ray::between(inside + distance * away, inside) };
                // How far short of the plane it ends, along the axes: right but for some 2⁻⁵³ of the distance.
                let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
                let normal = (b - a).cross(c - a);
                let normal = normal * normal.dot(away.as_dvec3()).signum();
                let short = normal.dot(ray.at(f64::from(end)) - a) / normal.abs().element_sum();
                let is_near = meets(&ray, &triangle, slack);
                assert!(!is_near || short < 1.01 * slack, "{short:e} short: {ray:?} {triangle:?}");
                counts[usize::from(is_near)] += 1;
            }
        }
        assert!(counts.iter().all(|&count| count > 10_000), "{counts:?}");
    }

    #[test]
    fn a_ray_that_ends_before_a_large_triangle_is_not_near_it_from_thirty_thousand_sizes_away() {
        let corner = |(y, z)| Vec3::new(-1e-4, y, z);
        let triangle = [(-0.97, -0.93), (0.99, -0.91), (0.05, 0.96)].map(corner);
        let (slack, mut random) = (slack(0.99), SplitMix64::seeded(2));
        for _ in 0..10_000 {
            let size = 30_000.0 * (0.75 + 0.25 * any(&mut random));
            let origin = size * (0.9 + 0.1 * any_point(&mut random));
            // Along x nothing is rounded: the end is 20 slacks before the plane.
            let ray = Ray::between(origin, 0.1 * any_point(&mut random).with_x(0.0));
            assert!(!meets(&ray, &triangle, slack), "{ray:?}");
            assert!(meets(&Ray { end: 1.001, ..ray }, &triangle, slack), "{ray:?}");
        }
    }

    #[test]
    fn nothing_is_near_a_triangle_that_is_not_finite() {
        let broken = [Vec3::ZERO, Vec3::new(f32::INFINITY, 0.0, 0.0), Vec3::Y];
        assert!(!meets(&down(0.2, 0.2), &broken, 0.01));
    }
}
