use std::{collections::HashSet, f64::consts::TAU};

use glam::{DVec2, DVec3, IVec2};
use proptest::prelude::*;

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

/// How many triangles hold a place that is on none of their edges.
fn covers(corners: &[DVec2], triangles: &[[usize; 3]], place: DVec2) -> usize {
    let holds = |triangle: &&[usize; 3]| {
        let sides = edges(triangle.map(|i| corners[i])).map(|[a, b]| turn([a, b, place]));
        sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
    };
    triangles.iter().filter(holds).count()
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

/// Two squares that meet in a corner; a notched square with corners that are given twice.
#[test]
fn corners_that_touch_and_corners_given_twice_fill_nothing_outside() {
    let touching = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 2], [1, 2], [1, 1], [0, 1]];
    let twice = [[0, 0], [6, 0], [6, 6], [6, 6], [3, 2], [0, 6], [0, 0]];
    for (shape, size) in [(&touching[..], 2.0), (&twice[..], 24.0)] {
        let shape: Vec<_> = shape.iter().map(|corner| corner.map(f64::from)).collect();
        for start in 0..shape.len() {
            let mut corners = polygon(&shape);
            corners.rotate_left(start);
            let got = area(&corners, &triangulate(&corners));
            assert_eq!(got, size, "from corner {start}");
        }
    }
}

#[test]
fn the_hole_at_the_end_of_a_seam_stays_open() {
    let keyhole = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [1, 1], [1, 3], [3, 3], [3, 1], [1, 1]];
    let keyhole = polygon(&keyhole.map(|corner| corner.map(f64::from)));
    for start in 0..keyhole.len() {
        let mut corners = keyhole.clone();
        corners.rotate_left(start);
        assert_eq!(area(&corners, &triangulate(&corners)), 12.0, "from corner {start}");
    }
}

#[test]
fn an_outline_that_crosses_itself_or_has_no_area_ends() {
    let bow = polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 2.0]]);
    assert!(!triangulate(&bow).is_empty());
    let line = polygon(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [3.0, 0.0], [0.5, 0.0]]);
    assert_eq!(area(&line, &triangulate(&line)), 0.0);
    let star: Vec<_> = (0..1001).map(|i| DVec2::from_angle(TAU * f64::from(i) * 0.4995)).collect();
    let star: Vec<_> = star.iter().map(|corner| corner.to_array()).collect();
    assert!(!triangulate(&polygon(&star)).is_empty());
}

/// How many boxes are looked at for each corner.
fn looks_a_corner(polygon: &[DVec3]) -> usize {
    let before = tree::LOOKS.get();
    assert_eq!(triangulate(polygon).len(), polygon.len() - 2);
    (tree::LOOKS.get() - before) / polygon.len()
}

/// A wall that winds round and round.
#[test]
fn beside_an_ear_of_a_long_wall_few_corners_are_looked_at() {
    let spiral = |count: i32| {
        let side = |width: f64| {
            let at =
                move |i: i32| DVec2::from_angle(f64::from(i) / 8.0) * (width + f64::from(i) / 20.0);
            (0..count / 2).map(at)
        };
        let corners = side(1.0).chain(side(0.8).rev());
        polygon(&corners.map(|corner| corner.to_array()).collect::<Vec<_>>())
    };
    let [short, long] = [1000, 8000].map(|count| looks_a_corner(&spiral(count)));
    assert!(long < 3 * short, "{short} {long}");
}

/// A comb with its back below: at half of its corners it turns right, but beside each ear there are few of them.
#[test]
fn beside_an_ear_of_a_long_comb_few_corners_are_looked_at() {
    let comb = |teeth: usize| {
        let (first, last) = ([0.0, -1.0], [2.0 * teeth as f64, -1.0]);
        // The last corner of the edge is a low one, so that ears reach from one end of the comb to the other.
        let edge = (0..2 * teeth - 1).rev().map(|at| [at as f64, (at % 2) as f64]);
        polygon(&[first, last].into_iter().chain(edge).collect::<Vec<_>>())
    };
    let [short, long] = [1000, 16_000].map(|teeth| looks_a_corner(&comb(teeth)));
    assert!(long < 3 * short, "{short} {long}");
}

/// Unit steps, counter-clockwise.
const STEPS: [IVec2; 4] = [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y];

fn step_between(from: IVec2, to: IVec2) -> usize {
    STEPS.iter().position(|&step| step == to - from).expect("a unit step")
}

/// The unit squares of a plane that a polygon fills, and its outline: squares are glued to edges of it, or hung on
/// its corners. So it touches itself at corners and along seams, and may go round a hole.
fn glued(choices: &[(usize, usize)]) -> (HashSet<IVec2>, Vec<IVec2>) {
    let mut filled = HashSet::from([IVec2::ZERO]);
    let mut outline = vec![IVec2::ZERO, IVec2::X, IVec2::ONE, IVec2::Y];
    for &(place, how) in choices {
        let at = place % outline.len();
        let here = outline[at];
        let next = outline[(at + 1) % outline.len()];
        let last = outline[(at + outline.len() - 1) % outline.len()];
        let (ahead, back) = (step_between(here, next), step_between(here, last));
        let (first, new): (usize, Vec<IVec2>) = if how == 0 {
            // What is outside is from `back` counter-clockwise to `ahead`.
            let room = (ahead + 4 - back) % 4;
            if room == 0 {
                continue;
            }
            let first = (back + place % room) % 4;
            let (one, two) = (STEPS[first], STEPS[(first + 1) % 4]);
            (first, vec![here + one, here + one + two, here + two, here])
        } else {
            let out = STEPS[(ahead + 3) % 4];
            ((ahead + 3) % 4, vec![here + out, next + out])
        };
        // The lower left corner of the square between two directions.
        let square = here + STEPS[first].min(IVec2::ZERO) + STEPS[(first + 1) % 4].min(IVec2::ZERO);
        if filled.insert(square) {
            outline.splice(at + 1..at + 1, new);
        }
    }
    (filled, outline)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn what_is_within_the_outline_is_covered_once_and_nothing_else_is(
        choices in prop::collection::vec((0usize..1000, 0usize..4), 0..40),
        doubled in prop::collection::vec(0usize..1000, 0..4),
        start in 0usize..1000,
        is_reversed: bool,
        slant in -2i32..3,
    ) {
        let (filled, mut outline) = glued(&choices);
        for place in doubled {
            let at = place % outline.len();
            outline.insert(at, outline[at]);
        }
        let start = start % outline.len();
        outline.rotate_left(start);
        if is_reversed {
            outline.reverse();
        }
        let slanted = |place: DVec2| place + DVec2::new(0.0, f64::from(slant) * place.x);
        let corners: Vec<DVec2> = outline.iter().map(|corner| slanted(corner.as_dvec2())).collect();
        let solid: Vec<DVec3> = corners.iter().map(|corner| corner.extend(3.0)).collect();
        let triangles = triangulate(&solid);
        let (min, max) = outline.iter().fold((IVec2::ZERO, IVec2::ONE), |(min, max), &corner| {
            (min.min(corner), max.max(corner))
        });
        for square in (min.x - 1..=max.x).flat_map(|x| (min.y - 1..=max.y).map(move |y| IVec2::new(x, y))) {
            // Places on no line through two corners.
            for angle in [0.5, 2.5, 4.5] {
                let within = DVec2::splat(0.5) + 0.3 * DVec2::from_angle(angle);
                let count = covers(&corners, &triangles, slanted(square.as_dvec2() + within));
                prop_assert_eq!(count, usize::from(filled.contains(&square)), "{:?} in {:?}", square, outline);
            }
        }
    }
}
