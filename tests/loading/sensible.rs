//! Cameras and lights that files without any get.

use glam::DVec3;
use umbra::scene::{Light, Scene};

use super::{Files, scene};

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

fn notes_say(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(words))
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
