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
//! It runs on hits only, in f64, some 10 ns; 150 ns for the few hits that are within 10⁻⁹ of an edge.

use glam::DVec3;

use crate::geometry::{Ray, Triangle, is_finite};

/// The slack, in units of the largest coordinate.
const ROUNDINGS: f64 = 48.0 * f32::EPSILON as f64;

/// Edges that are farther from the ray than this, relative to the terms of their volumes, are not mistaken
/// for it in f64, by a factor of a million.
const CLEAR: f64 = 1e-9;

/// How near a ray must come to a triangle of a scene whose largest coordinate is this.
pub(in crate::geometry) fn slack(largest_coordinate: f32) -> f64 {
    ROUNDINGS * f64::from(largest_coordinate)
}

/// Whether the closed segment comes within the slack of the triangle, which must be finite.
pub(super) fn meets(ray: &Ray, triangle: &Triangle, slack: f64) -> bool {
    if !is_finite(triangle) {
        return false;
    }
    let origin = ray.origin.as_dvec3();
    let corners = triangle.map(|corner| corner.as_dvec3() - origin);
    let (direction, end) = (ray.direction.as_dvec3(), f64::from(ray.end));
    pierces(&corners, direction, end) || !is_separate(&corners, direction, end, slack)
}

/// Whether the segment passes well inside the triangle.
#[inline]
fn pierces(corners: &[DVec3; 3], direction: DVec3, end: f64) -> bool {
    let [a, b, c] = *corners;
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| direction.dot(from.cross(to)));
    let slope = edges[0] + edges[1] + edges[2];
    let largest = corners.map(|corner| corner.abs().max_element()).into_iter().fold(0.0, f64::max);
    let margin = CLEAR * direction.abs().max_element() * largest * largest;
    let t = (b - a).cross(c - a).dot(a) / slope;
    edges.iter().all(|&edge| edge * slope.signum() > margin) && t >= 0.0 && t <= end
}

/// Whether a plane lies between the segment from 0 and the triangle widened to a cube about each point: separating
/// axes of two convex bodies, the normals of the wide triangle's faces and the products of edges.
#[cold]
fn is_separate(corners: &[DVec3; 3], direction: DVec3, end: f64, slack: f64) -> bool {
    let [a, b, c] = *corners;
    let edges = [b - a, c - b, a - c];
    let separates = |axis: DVec3, run: f64| {
        let [a, b, c] = corners.map(|corner| axis.dot(corner));
        let radius = slack * axis.abs().element_sum();
        // Where the axis is square to the ray, it gets nowhere along it, however far it goes.
        let stop = if run == 0.0 { 0.0 } else { run * end };
        a.max(b).max(c) + radius < stop.min(0.0) || a.min(b).min(c) - radius > stop.max(0.0)
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

    #[test]
    fn nothing_is_near_a_triangle_that_is_not_finite() {
        let broken = [Vec3::ZERO, Vec3::new(f32::INFINITY, 0.0, 0.0), Vec3::Y];
        assert!(!meets(&down(0.2, 0.2), &broken, 0.01));
    }
}
