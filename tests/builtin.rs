//! The built-in scenes are what they say: the paper's numbers, and the same bits everywhere.

use umbra::scene::builtin::{NAMES, deviation, draft, draft_at, triangle_count, view};
use umbra::scene::{Light, Scene};

/// Name, triangles and lights of the paper's Table 2, and the hash of our triangles.
const TABLE_2: [(&str, usize, usize, u64); 4] = [
    ("jittered-sparse", 551_408, 15, 0xab68_1a21_0bfa_7fff),
    ("jittered-dense", 551_408, 15, 0xdb46_8bf8_5cbb_b127),
    ("drum", 59_692, 6, 0x5ee5_3705_cc26_f828),
    ("chair-room", 40_937, 4, 0xb2a7_b861_516f_def2),
];

fn scene(name: &str) -> Scene {
    draft(name).unwrap().finish().unwrap()
}

/// FNV-1a over the bits of all corners, normals and materials.
fn hash(scene: &Scene) -> u64 {
    let corners = (0..scene.triangles.len() as u32).flat_map(|id| scene.triangles.get(id));
    let normals = scene.normals.iter().flatten().copied();
    let bits = corners.chain(normals).flat_map(|v| v.to_array()).map(f32::to_bits);
    bits.chain(scene.material_of.iter().copied())
        .flat_map(u32::to_le_bytes)
        .fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
        })
}

#[test]
fn triangles_and_lights_are_those_of_the_paper() {
    for (name, triangles, lights, _) in TABLE_2 {
        let scene = scene(name);
        assert_eq!((scene.triangles.len(), scene.lights.len()), (triangles, lights), "{name}");
        assert_eq!(scene.dropped.total(), 0, "{name}");
    }
}

#[test]
fn every_machine_makes_the_same_triangles() {
    let hashes = TABLE_2.map(|(name, ..)| format!("{name} {:#018x}", hash(&scene(name))));
    assert_eq!(hashes, TABLE_2.map(|(name, _, _, hash)| format!("{name} {hash:#018x}")));
}

#[test]
fn the_count_is_that_of_the_triangles_made() {
    for name in NAMES {
        for tessellation in [0.01, 0.07, 0.3, 2.0] {
            let scene = draft_at(name, tessellation).unwrap().finish().unwrap();
            assert_eq!(scene.dropped.total(), 0, "{name} at {tessellation}");
            assert_eq!(Some(scene.triangles.len() as u64), triangle_count(name, tessellation));
        }
    }
}

#[test]
fn tessellation_is_a_factor_on_the_triangles() {
    for (name, triangles, ..) in TABLE_2 {
        for tessellation in [0.05, 0.1, 0.5, 2.0, 10.0, 100.0] {
            let wanted = triangles as f64 * tessellation;
            let made = triangle_count(name, tessellation).unwrap() as f64;
            assert!((made / wanted - 1.0).abs() < 0.05, "{name} at {tessellation}: {made}");
        }
        // Some shapes have no hundredth of their triangles to give.
        let least = triangle_count(name, 0.01).unwrap();
        assert!(least < triangles as u64 / 38, "{name}: {least}");
    }
}

#[test]
fn both_jittered_scenes_have_the_same_jitter() {
    let [sparse, dense] = ["jittered-sparse", "jittered-dense"].map(|name| draft(name).unwrap());
    for (small, large) in sparse.triangles.iter().zip(&dense.triangles) {
        let [a, b] = [small, large].map(|t| (t.corners[1] - t.corners[0]).normalize());
        assert!((a - b).length() < 1e-9, "a triangle is turned differently");
    }
}

#[test]
fn nothing_stands_in_the_camera_or_a_light() {
    for name in NAMES {
        let scene = scene(name);
        let lights = scene.lights.iter().map(|light| match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => *position,
            Light::Directional { .. } => panic!("the paper's lights have places"),
        });
        for place in lights.chain([scene.camera.position]) {
            let place = place.as_vec3();
            let near = (0..scene.triangles.len() as u32)
                .flat_map(|id| scene.triangles.get(id))
                .map(|corner| corner.distance(place))
                .fold(f32::INFINITY, f32::min);
            assert!(near > 1e-3, "{name}: a corner is {near} from {place}");
        }
    }
}

#[test]
fn normals_are_of_unit_length_and_on_the_side_of_their_triangles() {
    for name in ["drum", "chair-room"] {
        let scene = scene(name);
        let mut against = 0;
        for (id, normals) in scene.normals.iter().enumerate() {
            let [a, b, c] = scene.triangles.get(id as u32);
            let flat = (b - a).cross(c - a).normalize();
            for normal in normals.iter().filter(|normal| **normal != glam::Vec3::ZERO) {
                assert!((normal.length() - 1.0).abs() < 1e-5, "{name} {id}: {normal}");
                against += usize::from(normal.dot(flat) <= 0.0);
            }
        }
        // Where a profile bends sharply within one cell, a corner's normal may lean past the plane.
        assert!(against * 100 < scene.normals.len(), "{name}: {against}");
    }
}

#[test]
fn unknown_names_and_senseless_tessellations_are_refused() {
    assert!(draft("teapot").is_none() && view("teapot").is_none());
    assert!(draft_at("teapot", 1.0).is_err() && triangle_count("teapot", 1.0).is_none());
    for tessellation in [0.0, -1.0, 101.0, f64::NAN] {
        let refusal = draft_at("drum", tessellation).unwrap_err().to_string();
        assert!(refusal.contains("tessellation"), "{refusal}");
    }
}

#[test]
fn more_triangles_are_nearer_to_the_true_surfaces() {
    for name in ["drum", "chair-room"] {
        let size = scene(name).bounds().diagonal();
        let deviations = [0.01, 0.1, 1.0, 10.0].map(|factor| deviation(name, factor).unwrap());
        for pair in deviations.windows(2) {
            let [coarse, fine] = [pair[0], pair[1]].map(|d| d.root_mean_square());
            assert!(fine > 0.0 && fine < 0.5 * coarse, "{name}: {coarse} then {fine}");
            assert!(pair[1].greatest < pair[0].greatest, "{name}: {pair:?}");
        }
        assert!(deviations[3].greatest < 1e-3 * size, "{name}: {deviations:?}");
    }
    assert_eq!(deviation("jittered-dense", 1.0), None);
    assert_eq!(deviation("teapot", 1.0), None);
}
