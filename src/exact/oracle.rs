//! The oracle: the verdict by big integers, slow and obviously right.
//!
//! Every finite f32 is an integer multiple of 2⁻¹⁴⁹, so all coordinates become integers, and every
//! quantity below is a polynomial in them: no rounding happens anywhere. The steps are the definition,
//! one after the other: the plane of the triangle, the parameter `t` of the point where the line of the
//! ray meets it, that point, and on which side of each edge it lies. The faster stages use other
//! polynomials (edge against ray instead of point against edge) and share no code with this file.

use std::fmt;

use num_bigint::BigInt;

use crate::geometry::{Ray, Triangle};

/// What exact arithmetic says about a ray and a triangle, or a ray and a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// A point of the open ray lies on the closed triangle.
    Blocked,
    /// The ray misses. So it does if the triangle's plane contains it or the triangle has no area,
    /// and if the ray is invalid or a corner is not finite.
    Clear,
    /// The ray touches the triangle at an end of its interval only: not blocked, but counted apart.
    Tie,
}

impl Verdict {
    /// The name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Blocked => "blocked",
            Self::Clear => "clear",
            Self::Tie => "tie",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The exact verdict on one triangle; takes microseconds.
///
/// ```
/// use umbra::exact::{Verdict, oracle};
/// use umbra::geometry::Ray;
/// use umbra::glam::Vec3;
///
/// let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// let through = |x: f32| Ray::between(Vec3::new(x, 0.5, 1.0), Vec3::new(x, 0.5, -1.0));
/// // The edge belongs to the triangle, and what is next to it does not.
/// assert_eq!(oracle::verdict(&through(0.5), &triangle), Verdict::Blocked);
/// assert_eq!(oracle::verdict(&through(0.5_f32.next_up()), &triangle), Verdict::Clear);
/// ```
#[must_use]
pub fn verdict(ray: &Ray, triangle: &Triangle) -> Verdict {
    if !ray.is_valid() || !triangle.iter().all(|corner| corner.is_finite()) {
        return Verdict::Clear;
    }
    let [a, b, c] = triangle.map(|corner| Point::of(corner.to_array()));
    let (origin, direction) =
        (Point::of(ray.origin.to_array()), Point::of(ray.direction.to_array()));

    // The line meets the plane at t = height / slope. No slope: no area, no direction, or parallel.
    let normal = b.minus(&a).cross(&c.minus(&a));
    let slope = normal.dot(&direction);
    if slope == zero() {
        return Verdict::Clear;
    }
    let height = normal.dot(&a.minus(&origin));
    let (height, slope) = if slope < zero() { (-height, -slope) } else { (height, slope) };

    // The point at t, and the corners, all times slope, which is positive.
    let point = origin.times(&slope).plus(&direction.times(&height));
    for (from, to) in [(&a, &b), (&b, &c), (&c, &a)] {
        let inwards = normal.cross(&to.minus(from));
        if inwards.dot(&point.minus(&from.times(&slope))) < zero() {
            return Verdict::Clear;
        }
    }

    // 0 < t < end, where an infinite end is never reached. An end is also a multiple of 2⁻¹⁴⁹.
    let after_end = if ray.end.is_finite() {
        (&height << LEAST_EXPONENT) - &slope * integer(ray.end)
    } else {
        BigInt::from(-1)
    };
    if height < zero() || after_end > zero() {
        Verdict::Clear
    } else if height == zero() || after_end == zero() {
        Verdict::Tie
    } else {
        Verdict::Blocked
    }
}

/// The exact verdict on many triangles, and the first triangle that gave it.
#[must_use]
pub fn verdict_of_scene(
    ray: &Ray,
    triangles: impl IntoIterator<Item = Triangle>,
) -> (Verdict, Option<usize>) {
    let mut tie = None;
    for (index, triangle) in triangles.into_iter().enumerate() {
        match verdict(ray, &triangle) {
            Verdict::Blocked => return (Verdict::Blocked, Some(index)),
            Verdict::Tie => tie = tie.or(Some(index)),
            Verdict::Clear => {}
        }
    }
    (tie.map_or(Verdict::Clear, |_| Verdict::Tie), tie)
}

/// The least positive f32 is 2 to minus this.
const LEAST_EXPONENT: u32 = 149;

fn zero() -> BigInt {
    BigInt::ZERO
}

/// A finite f32, as a multiple of the least positive one.
fn integer(value: f32) -> BigInt {
    let bits = value.to_bits();
    let exponent = (bits >> 23) & 0xff;
    let fraction = bits & 0x7f_ffff;
    // A denormal has the scale of exponent 1 and no hidden bit.
    let significand = if exponent == 0 { fraction } else { fraction | 0x80_0000 };
    let magnitude = BigInt::from(significand) << exponent.saturating_sub(1);
    if value.is_sign_negative() { -magnitude } else { magnitude }
}

/// A point or vector of integers.
struct Point([BigInt; 3]);

impl Point {
    fn of(coordinates: [f32; 3]) -> Self {
        Self(coordinates.map(integer))
    }

    fn plus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] + &other.0[i]))
    }

    fn minus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] - &other.0[i]))
    }

    fn times(&self, factor: &BigInt) -> Self {
        Self([0, 1, 2].map(|i| &self.0[i] * factor))
    }

    fn dot(&self, other: &Self) -> BigInt {
        (0..3).map(|i| &self.0[i] * &other.0[i]).sum()
    }

    fn cross(&self, other: &Self) -> Self {
        Self(
            [(1, 2), (2, 0), (0, 1)]
                .map(|(i, j)| &self.0[i] * &other.0[j] - &self.0[j] * &other.0[i]),
        )
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const TRIANGLE: Triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn down(x: f32, y: f32, end: f32) -> Ray {
        Ray { origin: Vec3::new(x, y, 1.0), direction: Vec3::NEG_Z, end }
    }

    #[test]
    fn an_f32_is_a_multiple_of_the_least_one() {
        assert_eq!(integer(f32::from_bits(1)), BigInt::from(1));
        assert_eq!(integer(-f32::from_bits(0x7f_ffff)), BigInt::from(-0x7f_ffff));
        assert_eq!(integer(f32::MIN_POSITIVE), BigInt::from(0x80_0000));
        assert_eq!(integer(-1.0), -(BigInt::from(1_u8) << 149_u32));
        assert_eq!(integer(f32::MAX), BigInt::from(0xff_ffff) << 253);
        assert_eq!(integer(-0.0), zero());
    }

    #[test]
    fn the_triangle_is_closed() {
        for (x, y) in
            [(0.25, 0.25), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        {
            assert_eq!(verdict(&down(x, y, f32::INFINITY), &TRIANGLE), Verdict::Blocked, "{x} {y}");
        }
        let least = f32::from_bits(1);
        for (x, y) in [(-least, 0.5), (0.5, -least), (1.0, least), (0.5, 0.5_f32.next_up())] {
            assert_eq!(verdict(&down(x, y, f32::INFINITY), &TRIANGLE), Verdict::Clear, "{x} {y}");
        }
    }

    #[test]
    fn the_interval_is_open_and_its_ends_are_ties() {
        assert_eq!(verdict(&down(0.2, 0.2, 1.0), &TRIANGLE), Verdict::Tie);
        assert_eq!(verdict(&down(0.2, 0.2, 1.0_f32.next_up()), &TRIANGLE), Verdict::Blocked);
        assert_eq!(verdict(&down(0.2, 0.2, 1.0_f32.next_down()), &TRIANGLE), Verdict::Clear);
        let on_the_face = Ray { origin: Vec3::new(0.2, 0.2, 0.0), ..down(0.0, 0.0, f32::MAX) };
        assert_eq!(verdict(&on_the_face, &TRIANGLE), Verdict::Tie);
        assert_eq!(
            verdict(&Ray { direction: Vec3::Z, ..down(0.2, 0.2, f32::INFINITY) }, &TRIANGLE),
            Verdict::Clear
        );
    }

    #[test]
    fn nothing_flat_or_broken_blocks() {
        let inside = Ray::between(Vec3::new(0.1, 0.1, 0.0), Vec3::new(0.3, 0.3, 0.0));
        assert_eq!(verdict(&inside, &TRIANGLE), Verdict::Clear);
        let ray = down(0.2, 0.2, f32::INFINITY);
        assert_eq!(verdict(&Ray { direction: Vec3::ZERO, ..ray }, &TRIANGLE), Verdict::Clear);
        assert_eq!(verdict(&Ray { origin: Vec3::NAN, ..ray }, &TRIANGLE), Verdict::Clear);
        assert_eq!(verdict(&Ray { end: f32::NAN, ..ray }, &TRIANGLE), Verdict::Clear);
        assert_eq!(verdict(&ray, &[Vec3::ZERO, Vec3::INFINITY, Vec3::Y]), Verdict::Clear);
        assert_eq!(
            verdict(&ray, &[Vec3::ZERO, Vec3::splat(0.2), Vec3::splat(0.4)]),
            Verdict::Clear
        );
        assert_eq!(verdict(&ray, &[Vec3::new(0.2, 0.2, 0.0); 3]), Verdict::Clear);
    }

    #[test]
    fn a_scene_is_blocked_before_it_ties_before_it_is_clear() {
        let ray = down(0.2, 0.2, 1.0);
        let lifted = TRIANGLE.map(|corner| corner + 0.5 * Vec3::Z);
        let lowered = TRIANGLE.map(|corner| corner - 0.5 * Vec3::Z);
        assert_eq!(verdict_of_scene(&ray, [lowered]), (Verdict::Clear, None));
        assert_eq!(verdict_of_scene(&ray, [lowered, TRIANGLE]), (Verdict::Tie, Some(1)));
        assert_eq!(
            verdict_of_scene(&ray, [TRIANGLE, lowered, lifted]),
            (Verdict::Blocked, Some(2))
        );
    }
}
