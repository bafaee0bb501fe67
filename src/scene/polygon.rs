//! Polygons become triangles.

use glam::{DVec2, DVec3};

/// Cuts a polygon into triangles: a fan from its first corner where that covers the polygon and
/// nothing else, as for every convex one; else by cutting off ears.
pub(super) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let fan = (2..corners.len()).map(|last| [0, last - 1, last]);
    if corners.len() < 4 {
        return fan.collect();
    }
    let flat = flatten(corners);
    if fan.clone().all(|triangle| doubled_area(triangle.map(|i| flat[i])) >= 0.0) {
        return fan.collect();
    }
    cut_ears(&flat)
}

/// The polygon seen along the axis nearest to its normal, counter-clockwise.
fn flatten(corners: &[DVec3]) -> Vec<DVec2> {
    let origin = corners[0];
    let normal: DVec3 =
        (2..corners.len()).map(|i| (corners[i - 1] - origin).cross(corners[i] - origin)).sum();
    let size = normal.abs();
    let project = |p: DVec3| {
        if size.x >= size.y && size.x >= size.z {
            DVec2::new(p.y, p.z * normal.x.signum())
        } else if size.y >= size.z {
            DVec2::new(p.z, p.x * normal.y.signum())
        } else {
            DVec2::new(p.x, p.y * normal.z.signum())
        }
    };
    corners.iter().map(|&corner| project(corner - origin)).collect()
}

fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

fn cut_ears(flat: &[DVec2]) -> Vec<[usize; 3]> {
    let mut ring: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    while ring.len() > 3 {
        let around = |at: usize| {
            let n = ring.len();
            [ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]]
        };
        let is_ear = |&at: &usize| {
            let ear = around(at);
            let [a, b, c] = ear.map(|i| flat[i]);
            let inside = |p: DVec2| {
                [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|t| doubled_area(t) >= 0.0)
            };
            doubled_area([a, b, c]) > 0.0
                && ring.iter().all(|&i| {
                    ear.contains(&i) || ear.iter().any(|&e| flat[e] == flat[i]) || !inside(flat[i])
                })
        };
        // A polygon that crosses itself may have no ear: then any corner will do.
        let at = (0..ring.len()).find(is_ear).unwrap_or(1);
        triangles.push(around(at));
        ring.remove(at);
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| DVec3::new(5.0, x, y)).collect()
    }

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let doubled = |t: &[usize; 3]| {
            (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).length()
        };
        triangles.iter().map(doubled).sum::<f64>() / 2.0
    }

    #[test]
    fn convex_polygons_are_fans() {
        let square = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_polygons_are_covered_once_and_nothing_else_is() {
        // An L and an arrow head, from every corner, both ways round.
        let letter = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let arrow = [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]];
        for (shape, size) in [(&letter[..], 4.0), (&arrow[..], 0.5)] {
            for start in 0..shape.len() {
                let mut corners = polygon(shape);
                corners.rotate_left(start);
                for _ in 0..2 {
                    let triangles = triangulate(&corners);
                    assert_eq!(triangles.len(), shape.len() - 2);
                    let got = area(&corners, &triangles);
                    assert!((got - size).abs() < 1e-12, "start {start}: area {got}, not {size}");
                    corners.reverse();
                }
            }
        }
    }
}
