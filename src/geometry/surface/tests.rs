//! Claims about all kinds of surfaces.

use std::collections::HashMap;

use glam::{DAffine3, DVec2, DVec3};

use super::{
    Deviation, Mesh, Path, Resolution, Revolution, Sheet, Surface, Tube, tessellate, triangle_count,
};

fn ball() -> Revolution {
    let profile = [(0.0, -1.0), (0.7, -0.7), (1.0, 0.0), (0.7, 0.7), (0.0, 1.0)];
    Revolution::through(&profile.map(DVec2::from))
}

fn vase() -> Revolution {
    Revolution::through(&[(0.3, 0.0), (0.5, 0.2), (0.2, 0.9), (0.4, 1.2)].map(DVec2::from))
}

fn body() -> Sheet {
    let ring = |y: f64, size: f64| {
        let corners = [(1.0, 0.0), (0.6, 0.4), (-0.6, 0.4), (-1.0, 0.0), (-0.6, -0.3), (0.6, -0.3)];
        corners.map(|(x, z)| DVec3::new(x * size, y, -z * size)).to_vec()
    };
    let loops = [ring(0.1, 0.5), ring(0.5, 0.8), ring(1.2, 0.4), ring(1.5, 0.2)];
    Sheet::body(DVec3::ZERO, &loops, DVec3::Y * 1.6)
}

fn cloth() -> Sheet {
    let row = |z: f64, lift: f64| {
        [0.0, 1.0, 2.0, 3.0].map(|x| DVec3::new(x, lift * x * (3.0 - x), z)).to_vec()
    };
    Sheet::through(&[row(0.0, 0.1), row(-1.0, 0.4), row(-2.2, -0.2)])
}

fn pipe() -> Tube {
    let points =
        [(0.0, 0.0), (1.0, 0.1), (1.6, 0.8), (1.7, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    Tube { path: Path::through(&points, None, None), radius: 0.1, side: DVec3::Z }
}

/// How often each edge occurs, once vertices at one place are one.
fn edges(mesh: &Mesh) -> HashMap<[usize; 2], u32> {
    let mut places = HashMap::new();
    let welded: Vec<usize> = mesh
        .positions
        .iter()
        .map(|position| {
            let next = places.len();
            // Adding zero makes −0 to 0.
            *places.entry(position.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut edges = HashMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|index| welded[index as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([from.min(to), from.max(to)]).or_insert(0) += 1;
        }
    }
    edges
}

fn append(mesh: &mut Mesh, other: Mesh) {
    let offset = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|i| i + offset)));
}

#[test]
fn every_edge_of_a_closed_surface_has_two_triangles() {
    for (u, v) in [(3, 2), (7, 5), (12, 9), (31, 40)] {
        for mesh in
            [tessellate(&ball(), Resolution { u, v }), tessellate(&body(), Resolution { u, v })]
        {
            assert!(edges(&mesh).values().all(|&triangles| triangles == 2), "{u} × {v}");
        }
    }
}

#[test]
fn surfaces_that_share_an_edge_have_no_crack_there() {
    let run = |points: &[(f64, f64)]| {
        let points: Vec<_> = points.iter().map(|&point| DVec2::from(point)).collect();
        tessellate(&Revolution::through(&points), Resolution { u: 37, v: 5 })
    };
    let mut can = run(&[(0.0, 0.1), (0.3, 0.1)]);
    append(&mut can, run(&[(0.3, 0.1), (0.35, 0.3), (0.31, 0.7)]));
    append(&mut can, run(&[(0.31, 0.7), (0.0, 0.7)]));
    assert!(edges(&can).values().all(|&triangles| triangles == 2));
}

#[test]
fn open_surfaces_are_open_only_at_their_edges() {
    for (mesh, open) in [
        (tessellate(&cloth(), Resolution { u: 5, v: 7 }), 24),
        (tessellate(&pipe(), Resolution { u: 5, v: 7 }), 10),
    ] {
        let once = edges(&mesh).values().filter(|&&triangles| triangles == 1).count();
        assert_eq!(once, open);
    }
}

#[test]
fn counts_are_those_of_the_triangles_made() {
    fn check(surface: &impl Surface) {
        for (u, v) in [(0, 0), (1, 1), (3, 2), (10, 7)] {
            let resolution = Resolution { u, v };
            let made = tessellate(surface, resolution).triangles.len() as u64;
            assert_eq!(made, triangle_count(surface, resolution));
        }
    }
    check(&ball());
    check(&vase());
    check(&body());
    check(&cloth());
    check(&pipe());
}

#[test]
fn a_tolerance_that_is_not_above_zero_is_refused() {
    for tolerance in [0.0, -0.01, f64::NAN] {
        let resolution = || Resolution::for_tolerance(&ball(), tolerance);
        assert!(std::panic::catch_unwind(resolution).is_err(), "{tolerance}");
    }
}

#[test]
fn triangles_stay_within_the_tolerance() {
    fn check(surface: &impl Surface, tolerance: f64) {
        let resolution = Resolution::for_tolerance(surface, tolerance);
        let Resolution { u: across, v: along } = resolution;
        let at = |u: f64, v: f64| surface.point(u / across as f64, v / along as f64);
        let mut worst: f64 = 0.0;
        for row in 0..along {
            for column in 0..across {
                let (u, v) = (column as f64, row as f64);
                let (a, b, c, d) = (at(u, v), at(u + 1.0, v), at(u, v + 1.0), at(u + 1.0, v + 1.0));
                for i in 0..=8 {
                    for j in 0..=8 {
                        let (s, t) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                        let flat = if s >= t {
                            a * (1.0 - s) + b * (s - t) + d * t
                        } else {
                            a * (1.0 - t) + c * (t - s) + d * s
                        };
                        worst = worst.max(flat.distance(at(u + s, v + t)));
                    }
                }
            }
        }
        assert!(worst <= tolerance, "{worst} is more than {tolerance} at {across} × {along}");
        // The bound is not idle either.
        assert!(worst > tolerance / 40.0, "{worst} is far less than {tolerance}");
    }
    for tolerance in [0.05, 0.01, 0.002] {
        check(&ball(), tolerance);
        check(&vase(), tolerance);
        check(&body(), tolerance);
        check(&cloth(), tolerance);
        check(&pipe(), tolerance);
    }
}

#[test]
fn normals_are_across_the_surface() {
    fn check(surface: &impl Surface) {
        const STEP: f64 = 1e-6;
        for i in 1..40 {
            for j in 1..40 {
                let (u, v) = (f64::from(i) / 40.3, f64::from(j) / 40.7);
                let along_u = surface.point(u + STEP, v) - surface.point(u - STEP, v);
                let along_v = surface.point(u, v + STEP) - surface.point(u, v - STEP);
                let difference = surface.normal(u, v) - along_u.cross(along_v).normalize();
                assert!(difference.length() < 1e-4, "at ({u}, {v}): {difference}");
            }
        }
    }
    check(&ball());
    check(&vase());
    check(&body());
    check(&cloth());
    check(&pipe());
}

#[test]
fn normals_of_closed_surfaces_point_out() {
    let points_out = |mesh: &Mesh, centre: DVec3| {
        mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| (*p - centre).dot(*n) > 0.0)
    };
    assert!(points_out(&tessellate(&ball(), Resolution { u: 20, v: 12 }), DVec3::ZERO));
    assert!(points_out(&tessellate(&body(), Resolution { u: 20, v: 12 }), DVec3::Y * 0.6));
}

#[test]
fn four_times_the_triangles_deviate_a_quarter() {
    fn check(surface: &impl Surface) {
        let [coarse, fine] = [24, 48].map(|cells| {
            Deviation::of(surface, Resolution { u: cells, v: cells }, DAffine3::IDENTITY)
        });
        let ratio = coarse.root_mean_square() / fine.root_mean_square();
        assert!((3.0..5.0).contains(&ratio), "{ratio}");
        assert!(coarse.greatest > fine.greatest && coarse.greatest > coarse.root_mean_square());
    }
    check(&ball());
    check(&vase());
    check(&body());
    check(&cloth());
    check(&pipe());
}

#[test]
fn the_deviation_of_a_ball_is_that_of_its_chords() {
    // 16 cells round the equator: the middle of a chord is 1 − cos(π/16) inside of the circle.
    let chord = 1.0 - (std::f64::consts::PI / 16.0).cos();
    let round = Deviation::of(&ball(), Resolution { u: 16, v: 400 }, DAffine3::IDENTITY);
    assert!(round.greatest >= chord && round.greatest < 1.05 * chord, "{round:?} {chord}");
    let larger = Deviation::of(
        &ball(),
        Resolution { u: 16, v: 400 },
        DAffine3::from_scale(DVec3::splat(3.0)),
    );
    assert!((larger.greatest / round.greatest - 3.0).abs() < 1e-9, "{larger:?}");
}

#[test]
#[should_panic(expected = "rows of a sheet are equally long")]
fn a_sheet_of_rows_of_different_length_is_refused() {
    // What a longer row had more was left out without a word.
    let row = |points: u32| (0..points).map(|x| DVec3::new(f64::from(x), 0.0, 0.0)).collect();
    let _ = Sheet::through(&[row(3), row(4)]);
}

#[test]
#[should_panic(expected = "loops of a body are equally long")]
fn a_body_of_loops_of_different_length_is_refused() {
    let ring = |points: u32| (0..points).map(|x| DVec3::new(f64::from(x), 1.0, 0.0)).collect();
    let _ = Sheet::body(DVec3::ZERO, &[ring(4), ring(6)], DVec3::Y);
}
