//! The ray tracer: the same picture and counts for every number of threads, light where it should be.

mod common;

use std::process::Command;

use common::{REAL_SCENES, real_scenes};
use glam::{DVec3, Vec3};
use umbra::occlusion::{Backend, BuildOptions, Test, build};
use umbra::render::{Order, Piecewise, Progress, Rendered, Settings, Statistics, render};
use umbra::scene::{Camera, Draft, DraftTriangle, Light, Material, Scene, load};
use umbra::shadow::{Method, Trace, prepare};

fn small() -> Settings {
    Settings { width: 80, height: 60, samples: 2, mask: true, ..Settings::default() }
}

fn picture(scene: &Scene, settings: &Settings, threads: usize) -> Rendered {
    let backend =
        build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        render(scene, &*backend, &Trace::new(&*backend), settings, &Progress::default()).unwrap()
    })
}

#[test]
fn picture_and_counts_do_not_depend_on_the_number_of_threads() {
    for name in ["chair-room", "drum"] {
        let scene = load(name).unwrap();
        for order in [Order::Tiles, Order::Scanline, Order::Serpentine] {
            let settings = Settings { order, ..small() };
            let one = picture(&scene, &settings, 1);
            for threads in [2, 3, 7] {
                let many = picture(&scene, &settings, threads);
                assert_eq!(one.film, many.film, "{name} {order:?} {threads} threads");
                assert_eq!(one.mask, many.mask, "{name} {order:?} {threads} threads");
                assert_eq!(one.statistics, many.statistics, "{name} {order:?} {threads} threads");
            }
        }
    }
}

#[test]
fn the_picture_does_not_depend_on_the_order_of_samples() {
    let scene = load("chair-room").unwrap();
    let tiles = picture(&scene, &small(), 2);
    for (order, rows_per_unit) in
        [(Order::Scanline, 1), (Order::Scanline, 60), (Order::Serpentine, 7)]
    {
        let other = picture(&scene, &Settings { order, rows_per_unit, ..small() }, 2);
        assert_eq!(tiles.film, other.film, "{order:?}");
        assert_eq!(tiles.mask, other.mask, "{order:?}");
        assert_eq!(tiles.statistics.rays, other.statistics.rays, "{order:?}");
    }
}

#[test]
fn a_picture_rendered_in_pieces_is_the_picture() {
    let scene = load("chair-room").unwrap();
    let backend =
        build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap();
    let shadows = prepare(Method::CacheTree, &scene, &*backend).unwrap();
    for order in [Order::Tiles, Order::Scanline, Order::Serpentine] {
        let settings = Settings { order, rows_per_unit: 60, mask: false, ..small() };
        let whole = render(&scene, &*backend, &*shadows, &settings, &Progress::default()).unwrap();
        for every in [1, 4] {
            let mut pieces =
                Piecewise::new(&scene, &*backend, &*shadows, &settings, every).unwrap();
            let pixels = Progress::default();
            while pieces.advance(&pixels) {}
            let done = pieces.finish();
            for &((x, y), colour) in &done.colours {
                assert_eq!(
                    colour,
                    whole.film.pixels()[(y * 80 + x) as usize],
                    "{order:?} ({x}, {y})"
                );
            }
            let rendered = done.colours.len().abs_diff(80 * 60 / every as usize);
            if every == 1 {
                assert_eq!(rendered, 0, "{order:?}");
                assert_eq!(done.statistics, whole.statistics, "{order:?}");
            } else {
                // Tiles at the border are smaller.
                assert!(rendered <= 16 * 16, "{order:?}: {rendered} pixels too many or too few");
            }
        }
    }
}

#[test]
fn every_backend_gives_the_same_picture() {
    let scene = load("chair-room").unwrap();
    let grid = picture(&scene, &small(), 2);
    for backend in [Backend::Bvh2, Backend::Cwbvh] {
        let backend =
            build(backend, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap();
        let other =
            render(&scene, &*backend, &Trace::new(&*backend), &small(), &Progress::default())
                .unwrap();
        assert_eq!(grid.film, other.film);
    }
}

/// A square of side 2 around a point, facing up.
fn square(y: f64, material: u32) -> [DraftTriangle; 2] {
    let corner = |x: f64, z: f64| DVec3::new(x, y, z);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    [[a, b, c], [a, c, d]].map(|corners| DraftTriangle {
        corners,
        normals: [Vec3::ZERO; 3],
        material,
    })
}

/// White floor, seen from above through its middle, with more squares above it and a light at height 3.
fn floor_below(squares: &[(f64, Material)]) -> Scene {
    let white = Material { diffuse: Vec3::ONE, ..Material::default() };
    let mut draft = Draft {
        name: "floor".to_owned(),
        materials: vec![white],
        lights: vec![Light::Point { position: DVec3::new(0.0, 3.0, 0.0), intensity: Vec3::ONE }],
        // From the side, below the squares, at the middle of the floor.
        camera: Some(Camera::look_at(
            DVec3::new(3.0, 0.5, 0.1),
            DVec3::new(0.0, 0.0, 0.1),
            DVec3::Y,
            0.01,
        )),
        ..Draft::default()
    };
    draft.triangles.extend(square(0.0, 0));
    for (height, material) in squares {
        let index = draft.materials.len() as u32;
        draft.materials.push(material.clone());
        draft.triangles.extend(square(*height, index));
    }
    draft.finish().unwrap()
}

fn middle(scene: &Scene) -> Vec3 {
    let settings = Settings { width: 1, height: 1, ..Settings::default() };
    picture(scene, &settings, 1).film.pixels()[0]
}

fn glass(transmission: Vec3) -> Material {
    Material { diffuse: Vec3::ZERO, transmission, ..Material::default() }
}

#[test]
fn a_white_floor_under_a_point_light_has_the_radiance_of_lambert() {
    // Irradiance 1/d² times the cosine, albedo 1, radiance over pi.
    let (height, aside) = (3f32, 0.1f32);
    let squared = height * height + aside * aside;
    let expected = height / squared.sqrt() / squared / std::f32::consts::PI;
    let seen = middle(&floor_below(&[]));
    assert!((seen.x - expected).abs() < 1e-4 * expected, "{seen} {expected}");
}

#[test]
fn an_opaque_square_blocks_and_glass_attenuates_once_a_sheet() {
    let lit = middle(&floor_below(&[]));
    assert_eq!(middle(&floor_below(&[(1.0, Material::default())])), Vec3::ZERO);
    let red = Vec3::new(0.5, 0.25, 0.125);
    let one = middle(&floor_below(&[(1.0, glass(red))]));
    assert!((one - lit * red).abs().max_element() < 1e-6, "{one} {lit}");
    let two = middle(&floor_below(&[(1.0, glass(red)), (1.5, glass(red))]));
    assert!((two - lit * red * red).abs().max_element() < 1e-6, "{two} {lit}");
    // An opaque one behind glass blocks all the same.
    assert_eq!(middle(&floor_below(&[(1.0, glass(red)), (2.0, Material::default())])), Vec3::ZERO);
}

/// Looks up at a slab of glass that is `index` inside, from inside it, along a direction at this angle.
fn sky_through_glass(degrees: f64) -> Statistics {
    let glass = Material { refraction_index: 1.5, ..glass(Vec3::ONE) };
    let mut draft = Draft {
        name: "slab".to_owned(),
        materials: vec![glass],
        background: Vec3::ONE,
        ..Draft::default()
    };
    draft.triangles.extend(square(1.0, 0));
    let angle = degrees.to_radians();
    let target = DVec3::new(0.0, 1.0, 0.0);
    let position = target - DVec3::new(angle.sin(), angle.cos(), 0.0);
    draft.camera = Some(Camera::look_at(position, target, DVec3::Z, 0.001));
    draft.lights.push(Light::Directional { direction: DVec3::Y, irradiance: Vec3::ZERO });
    let scene = draft.finish().unwrap();
    let settings = Settings { width: 1, height: 1, depth: 1, ..Settings::default() };
    let rendered = picture(&scene, &settings, 1);
    // Nothing is lost: what is not reflected is refracted, and the sky is white on all sides.
    assert!((rendered.film.pixels()[0] - Vec3::ONE).abs().max_element() < 1e-5, "{degrees}");
    rendered.statistics
}

#[test]
fn beyond_the_critical_angle_everything_is_reflected() {
    // Seen from below, the square's winding says "inside": the critical angle of 1.5 is 41.8 degrees.
    let below = sky_through_glass(41.0);
    assert_eq!((below.rays.reflected, below.rays.refracted), (1, 1));
    let beyond = sky_through_glass(43.0);
    assert_eq!((beyond.rays.reflected, beyond.rays.refracted), (1, 0));
}

#[test]
fn spot_lights_end_at_their_cone_and_directional_ones_reach_everywhere() {
    let mut scene = floor_below(&[]);
    let spot = |outer: f64| Light::Spot {
        position: DVec3::new(0.0, 3.0, 0.0),
        axis: DVec3::NEG_Y,
        intensity: Vec3::ONE,
        inner: 0.5 * outer,
        outer,
    };
    let full = middle(&scene);
    scene.lights = vec![spot(0.5)];
    assert_eq!(middle(&scene), full);
    scene.lights = vec![spot(0.01)];
    assert_eq!(middle(&scene), Vec3::ZERO);
    scene.lights = vec![Light::Directional { direction: DVec3::Y, irradiance: Vec3::ONE }];
    let expected = std::f32::consts::FRAC_1_PI;
    assert!((middle(&scene).x - expected).abs() < 1e-6);
}

#[test]
fn the_shadow_mask_counts_what_every_light_sees() {
    let scene = floor_below(&[(1.0, Material::default())]);
    let settings = Settings { width: 4, height: 4, samples: 3, mask: true, ..Settings::default() };
    let mask = picture(&scene, &settings, 1).mask.unwrap();
    for (x, y) in (0..4).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let [seen] = mask.at(x, y) else { panic!("one light") };
        assert_eq!((seen.asked, seen.blocked), (9, 9));
    }
}

#[test]
fn every_real_scene_renders() {
    let Some(folder) = real_scenes() else { return };
    for name in REAL_SCENES {
        let scene = load(folder.join(name).to_str().unwrap()).unwrap();
        let rendered =
            picture(&scene, &Settings { width: 64, height: 48, ..Settings::default() }, 2);
        let lit = rendered.film.pixels().iter().filter(|p| p.max_element() > 0.0).count();
        assert!(lit * 4 > rendered.film.pixels().len(), "{name}: {lit} pixels are not black");
        assert!(rendered.statistics.rays.shadow > 0, "{name}");
    }
}

#[test]
#[cfg(unix)]
fn the_largest_real_scene_loads_builds_and_renders_within_four_gib() {
    let Some(folder) = real_scenes() else { return };
    let output = tempfile::tempdir().unwrap();
    // The limit is on addresses, which are more than memory in use.
    let script =
        "ulimit -v 4194304; exec \"$0\" render \"$1\" -o \"$2\" --size 640x486 --samples 1";
    for backend in ["grid", "cwbvh"] {
        let status = Command::new("sh")
            .args(["-c", &format!("{script} --backend {backend}"), env!("CARGO_BIN_EXE_umbra")])
            .arg(folder.join("tower_bridge.glb"))
            .arg(output.path().join("bridge.png"))
            .status()
            .unwrap();
        assert!(status.success(), "{backend}");
    }
}
