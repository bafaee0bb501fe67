//! Cameras and lights that files without any get.

use glam::DVec3;
use umbra::scene::{Light, Scene};

use super::{Files, notes_say, scene};

/// A box in OBJ, its faces seen from outside or from within.
fn cuboid(min: DVec3, max: DVec3, is_seen_from_within: bool) -> String {
    const FACES: [[i32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let corner = |number: i32| {
        let pick = |axis: usize| if number >> axis & 1 == 0 { min[axis] } else { max[axis] };
        format!("v {} {} {}\n", pick(0), pick(1), pick(2))
    };
    let face = |mut face: [i32; 4]| {
        if is_seen_from_within {
            face.reverse();
        }
        let [a, b, c, d] = face.map(|corner| corner - 8);
        format!("f {a} {b} {c} {d}\n")
    };
    (0..8).map(corner).chain(FACES.map(face)).collect()
}

/// A box of 4 by 3 by 6, perhaps with another one in a corner of it.
fn room(is_seen_from_within: bool, is_furnished: bool) -> Scene {
    let mut text = cuboid(DVec3::ZERO, DVec3::new(4.0, 3.0, 6.0), is_seen_from_within);
    if is_furnished {
        text += &cuboid(DVec3::new(2.4, 0.01, 3.6), DVec3::new(3.7, 2.0, 5.6), false);
    }
    scene("room.obj", text)
}

/// A point in the room, as the file gives it.
fn is_within(scene: &Scene, point: DVec3) -> bool {
    let point = point + scene.origin;
    point.cmpgt(DVec3::ZERO).all() && point.cmplt(DVec3::new(4.0, 3.0, 6.0)).all()
}

#[test]
fn a_closed_room_is_seen_from_its_emptiest_corner_by_a_lamp_within() {
    let room = room(true, true);
    assert!(notes_say(&room, "looks about the closed room from a corner"), "{:?}", room.notes);
    assert!(notes_say(&room, "a point light under the ceiling"), "{:?}", room.notes);
    let eye = room.camera.position + room.origin;
    assert!(is_within(&room, room.camera.position), "{eye}");
    assert!(eye.x < 1.0 && eye.z < 1.5, "the cupboard stands in the corner across: {eye}");
    assert!(room.camera.forward.x > 0.0 && room.camera.forward.z > 0.0);
    let [Light::Point { position, intensity }] = room.lights[..] else {
        panic!("one lamp, not {:?}", room.lights)
    };
    assert!(is_within(&room, position) && (position + room.origin).y > 2.0, "{position}");
    assert!(intensity.min_element() > 0.0);
}

/// Its walls must be seen from within: those of a solid hide a lamp.
#[test]
fn a_room_with_an_open_side_is_lit_by_a_lamp_within() {
    let open = |gone: usize, is_seen_from_within: bool| {
        let text = cuboid(DVec3::ZERO, DVec3::new(4.0, 3.0, 6.0), is_seen_from_within);
        let mut faces = 0;
        let is_kept = |line: &&str| {
            faces += usize::from(line.starts_with('f'));
            !line.starts_with('f') || faces - 1 != gone
        };
        // What is gone still counts for the box of the room.
        let lines: Vec<&str> = text.lines().filter(is_kept).collect();
        let cupboard = cuboid(DVec3::new(2.4, 0.01, 3.6), DVec3::new(3.7, 2.0, 5.6), false);
        scene("room.obj", format!("{}\n{cupboard}", lines.join("\n")))
    };
    let front = open(5, true);
    assert!(notes_say(&front, "looks into the open side"), "{:?}", front.notes);
    let [Light::Point { position, .. }] = front.lights[..] else {
        panic!("one lamp, not {:?}", front.lights)
    };
    assert!(is_within(&front, position) && (position + front.origin).y > 2.0, "{position}");
    for (gone, is_seen_from_within) in [(3, true), (5, false)] {
        let scene = open(gone, is_seen_from_within);
        let is_lamp = matches!(scene.lights[..], [Light::Point { .. }]);
        // The chosen camera looks down into a room without a ceiling, so that a wall is the ceiling that it sees.
        assert_eq!(is_lamp, gone == 3, "{:?}", scene.notes);
    }
}

#[test]
fn a_solid_is_seen_from_outside_whatever_is_in_it_and_so_is_an_empty_box() {
    for solid in [room(false, true), room(true, false), room(false, false)] {
        assert!(notes_say(&solid, "sees the whole scene"), "{:?}", solid.notes);
        assert!(!is_within(&solid, solid.camera.position));
        assert!(matches!(solid.lights[..], [Light::Directional { .. }]));
    }
}

#[test]
fn the_length_and_the_slant_of_up_move_nobody_out_of_a_room() {
    let mut text = cuboid(DVec3::ZERO, DVec3::new(4.0, 3.0, 6.0), true);
    text += &cuboid(DVec3::new(2.4, 0.01, 3.6), DVec3::new(3.7, 2.0, 5.6), false);
    let files = Files::new();
    files.write("room.obj", text);
    for up in ["[0, 5, 0]", "[0, 0.1, 0]", "[0, 1, 0.9]", "[0.3, 1, 0.2]"] {
        files.write("room.toml", format!("up = {up}\n[[mesh]]\nfile = \"room.obj\"\n"));
        let room = files.load("room.toml").expect("a sound file");
        let eye = room.camera.position + room.origin;
        assert!(is_within(&room, room.camera.position), "{up}: {eye}");
        assert!(eye.x < 1.0 && eye.z < 1.5 && eye.y > 1.5, "{up}: {eye}");
        assert!(matches!(room.lights[..], [Light::Point { .. }]), "{up}");
    }
}

/// A room of which the front is open, with a lamp under its ceiling.
#[test]
fn a_lamp_that_single_precision_cannot_hold_leaves_nothing_black() {
    for exponent in [-30, -15, 0, 15, 20, 25] {
        let size = 10f64.powi(exponent);
        let corners = |y: f64, half: f64| {
            [[-half, -half], [half, -half], [half, half], [-half, half]]
                .map(|[x, z]| format!("v {:e} {:e} {:e}\n", x * size, y * size, z * size))
        };
        let files = Files::new();
        files.write("a.mtl", "newmtl lamp\nKe 17 12 4\n");
        let text = [corners(0.0, 2.0), corners(3.0, 0.5)].concat().concat();
        let faces = "mtllib a.mtl\nf 1 2 3 4\nusemtl lamp\nf 5 6 7 8\n";
        let scene = files.write("a.obj", text + faces).load("a.obj").expect("a sound file");
        let floor = DVec3::new(0.6 * size, 0.0, 0.6 * size) - scene.origin;
        let lit: f32 = scene
            .lights
            .iter()
            .filter_map(|light| light.illuminate(floor))
            .map(|light| light.irradiance.max_element())
            .sum();
        assert!(lit > 0.1 && lit < 100.0, "at {size:e}: {lit}, {:?}", scene.notes);
        assert!(scene.ambient.is_finite() && scene.ambient.max_element() > 1e-3, "{size:e}");
        let is_held = (-15..=15).contains(&exponent);
        let told = "the emissive surfaces are too large or too small for lights in their place";
        assert_eq!(notes_say(&scene, told), !is_held, "{size:e}: {:?}", scene.notes);
    }
}
