//! Signs of determinants, where they are certain, and what they say about segments and shadow polygons.

use glam::DVec3;

use crate::shadow::voxels::Source;

/// What f64 errs by in a determinant of differences, as a share of its permanent; twice. Each term meets
/// two roundings of differences a factor, two of products and two of sums.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Whether `u · (v × w)` is above zero, where `u` may be off by `slack` along each axis; `None` where that
/// is not certain.
pub(super) fn is_positive(u: DVec3, v: DVec3, w: DVec3, slack: DVec3) -> Option<bool> {
    let cross = v.cross(w);
    let [a, b] = [v.abs(), w.abs()];
    let sizes = DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
    let determinant = u.dot(cross);
    let error = ROUNDING * (u.abs() + slack).dot(sizes) + slack.dot(cross.abs());
    // Neither holds for NaN, and nothing is certain where products underflow.
    if determinant > error + f64::MIN_POSITIVE {
        Some(true)
    } else if determinant < -error - f64::MIN_POSITIVE {
        Some(false)
    } else {
        None
    }
}

/// Whether a light is in front of a triangle.
pub(super) fn is_lit_from_the_front(&[a, b, c]: &[DVec3; 3], source: &Source) -> Option<bool> {
    let (towards, slack) = source.towards(a);
    is_positive(towards, b - a, c - a, slack)
}

/// Whether a point is in front of a triangle.
pub(super) fn is_in_front(&[a, b, c]: &[DVec3; 3], point: DVec3) -> Option<bool> {
    is_positive(point - a, b - a, c - a, DVec3::ZERO)
}

/// Whether the line from `from` along `direction` passes inside a triangle.
pub(super) fn passes(
    corners: &[DVec3; 3],
    from: DVec3,
    direction: DVec3,
    slack: DVec3,
) -> Option<bool> {
    let [a, b, c] = corners.map(|corner| corner - from);
    let signs = [(a, b), (b, c), (c, a)].map(|(v, w)| is_positive(direction, v, w, slack));
    // Two that differ are enough for a miss.
    match (signs.contains(&Some(true)), signs.contains(&Some(false)), signs.contains(&None)) {
        (true, true, _) => Some(false),
        (_, _, false) => Some(true),
        _ => None,
    }
}

/// How the number of volumes changes from one point to another for crossing a triangle itself: into its
/// volume or out of it.
pub(super) fn through_triangle(
    corners: &[DVec3; 3],
    lit_from_the_front: bool,
    from: DVec3,
    to: DVec3,
) -> Option<i32> {
    let (start, end) = (is_in_front(corners, from)?, is_in_front(corners, to)?);
    if start == end || !passes(corners, from, to - from, DVec3::ZERO)? {
        return Some(0);
    }
    Some(if start == lit_from_the_front { 1 } else { -1 })
}

/// Which way the segment between two points crosses the shadow polygon of the edge from `a` to `b`:
/// 1 to the side from which light, `a`, `b` are seen counterclockwise, -1 from it, 0 if it does not.
///
/// The line through the points meets the plane of light and edge at αL + βa + γb. The polygon is where
/// β and γ are above zero and α is below, divided by their sum, whose sign is known from which side the
/// points lie on. Each is a determinant of the line and the other two.
pub(super) fn through_polygon(
    a: DVec3,
    b: DVec3,
    source: &Source,
    from: DVec3,
    to: DVec3,
) -> Option<i32> {
    let (towards, slack) = source.towards(a);
    let start = is_positive(towards, b - a, from - a, slack)?;
    let end = is_positive(towards, b - a, to - a, slack)?;
    if start == end {
        return Some(0);
    }
    let along = to - from;
    let (towards, slack) = source.towards(from);
    let at_a = is_positive(towards, a - from, along, slack)?;
    let at_b = is_positive(towards, b - from, along, slack)?;
    // The sum is above zero where the segment comes from the positive side.
    let sum = start;
    if at_a == at_b || at_a != sum {
        return Some(0);
    }
    let at_light = is_positive(along, a - from, b - from, DVec3::ZERO)?;
    Some(match (at_light == sum, end) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => -1,
    })
}
