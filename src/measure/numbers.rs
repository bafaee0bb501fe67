//! Numbers that can be read.

use crate::geometry::Ray;
use crate::words::things;

/// 1234567 as 1,234,567.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// So many things, of which one is called `one`.
pub(crate) fn count(number: u64, one: &str) -> String {
    format!("{} {}", grouped(number), things(number, one))
}

/// How large a scene is.
pub(crate) fn size(triangles: usize, lights: usize) -> String {
    format!("{}, {}", count(triangles as u64, "triangle"), count(lights as u64, "light"))
}

/// A share per million: rare ones in hundredths, many as whole numbers.
pub(crate) fn told(share: f64) -> String {
    match share {
        0.0 => "0".to_owned(),
        ..10.0 => format!("{share:.2}"),
        ..100.0 => format!("{share:.1}"),
        _ => grouped(share.round() as u64),
    }
}

/// Origin, direction and end of a ray, as the bits of their f32: eight hexadecimal digits each.
pub(crate) fn bits(ray: &Ray) -> String {
    let [x, y, z] = ray.origin.to_array();
    let [dx, dy, dz] = ray.direction.to_array();
    let words = [x, y, z, dx, dy, dz, ray.end].map(|value| format!("{:08x}", value.to_bits()));
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn digits_are_grouped_by_three() {
        let numbers = [0, 7, 999, 1000, 123_456, 1_234_567];
        assert_eq!(numbers.map(grouped), ["0", "7", "999", "1,000", "123,456", "1,234,567"]);
    }

    #[test]
    fn one_thing_is_no_plural() {
        assert_eq!([0, 1, 2].map(|n| count(n, "ray")), ["0 rays", "1 ray", "2 rays"]);
        assert_eq!(count(1234, "shadow query"), "1,234 shadow queries");
        assert_eq!(count(1, "shadow query"), "1 shadow query");
    }

    #[test]
    fn shares_are_told_with_three_digits_or_so() {
        let told = [0.0, 0.314, 9.5, 21.05, 36385.9].map(told);
        assert_eq!(told, ["0", "0.31", "9.50", "21.1", "36,386"]);
    }

    #[test]
    fn a_ray_is_seven_words_of_bits() {
        let ray = Ray { origin: Vec3::ONE, direction: Vec3::NEG_ONE, end: f32::INFINITY };
        let (one, other) = ("3f800000 ".repeat(3), "bf800000 ".repeat(3));
        assert_eq!(bits(&ray), format!("{one}{other}7f800000"));
    }
}
