//! Scenes.

use std::error::Error;
use std::io;

use tempfile::TempDir;
use umbra::glam::{DVec3, Vec3};
use umbra::scene::builtin::{deviation, triangle_count};
use umbra::scene::{Camera, Draft, DraftTriangle, Light, Scene, SceneError, load, write};

use super::{SHEET, draft, scene};

fn notes_say(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(words))
}

#[test]
fn a_triangle_of_a_material_that_is_not_there_is_refused_with_its_place() {
    let stray = DraftTriangle { material: 7, ..SHEET };
    let refused = Draft { triangles: vec![SHEET, stray], ..draft() }.finish().unwrap_err();
    assert!(matches!(refused, SceneError::Unsound { .. }));
    let told = "unnamed scene: triangle 1 is of material 7, and there are 1, counted from 0";
    assert!(refused.to_string().starts_with(told), "{refused}");
}

#[test]
fn a_camera_whose_axes_make_no_sense_gives_way_to_a_sensible_one() {
    let sound = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
    assert!(sound.is_sound());
    let camera = |camera| Draft { camera: Some(camera), ..draft() }.finish().unwrap();
    assert_eq!(camera(sound).camera, sound);
    for unsound in [
        Camera { right: DVec3::ZERO, ..sound },
        Camera { forward: 2.0 * sound.forward, ..sound },
        Camera { up: sound.forward, ..sound },
        Camera { position: DVec3::splat(1e39), ..sound },
        Camera { field_of_view: f64::NAN, ..sound },
    ] {
        assert!(!unsound.is_sound(), "{unsound:?}");
        let scene = camera(unsound);
        assert!(scene.camera.is_sound() && notes_say(&scene, "left out a camera"), "{unsound:?}");
    }
}

#[test]
fn a_spot_that_is_wider_within_than_without_is_left_out_with_a_note() {
    let spot = Light::Spot {
        position: 3.0 * DVec3::Y,
        axis: DVec3::NEG_Y,
        intensity: Vec3::ONE,
        inner: 0.5,
        outer: 0.2,
    };
    let scene = Draft { lights: vec![spot], ..draft() }.finish().unwrap();
    assert!(notes_say(&scene, "left out 1 light whose") && !scene.lights.contains(&spot));
}

#[test]
fn notes_and_messages_name_a_file_only_where_there_is_one() {
    assert!(notes_say(&scene(), "no usable camera: ") && notes_say(&scene(), "no usable light: "));
    let empty = Draft::default().finish().unwrap_err().to_string();
    assert!(empty.starts_with("unnamed scene: no triangles"), "{empty}");
}

#[test]
fn points_of_the_world_come_to_where_their_triangles_are() {
    let place = DVec3::new(84_992.25, 447_488.5, 4.0);
    let far = DraftTriangle { corners: SHEET.corners.map(|corner| corner + place), ..SHEET };
    let scene = Draft { triangles: vec![far], ..Draft::default() }.finish().unwrap();
    assert_ne!(scene.origin, DVec3::ZERO);
    assert_eq!(far.corners.map(|corner| scene.to_local(corner)), scene.triangles.get(0));
    assert_eq!(scene.triangles.get(0).map(|corner| scene.to_world(corner)), far.corners);
}

#[test]
fn tessellations_out_of_range_have_no_count() {
    for tessellation in [1e30, f64::INFINITY, -1.0, 0.0, f64::NAN] {
        assert_eq!(triangle_count("jittered-sparse", tessellation), None, "{tessellation}");
        assert_eq!(triangle_count("drum", tessellation), None, "{tessellation}");
        assert_eq!(deviation("drum", tessellation), None, "{tessellation}");
    }
}

#[test]
fn a_scene_that_could_not_be_read_back_is_not_written() {
    let folder = TempDir::new().unwrap();
    let refusal = |scene: &Scene, name: &str| write(scene, &folder.path().join(name)).unwrap_err();
    let dark = Light::Point { position: DVec3::Y, intensity: Vec3::NAN };
    let unsound = Scene { lights: vec![dark], ..scene() };
    let told = "unnamed scene: the numbers of light 0 make no sense; give others";
    assert!(refusal(&unsound, "a.glb").to_string().starts_with(told));
    let unsound = Scene { exposure: Some(f32::NAN), ..scene() };
    assert!(refusal(&unsound, "a.glb").to_string().contains("the numbers of the exposure"));
    assert!(matches!(refusal(&scene(), "a.ply"), SceneError::UnknownKind { .. }));
    assert!(folder.path().read_dir().unwrap().next().is_none(), "something was written");
}

#[test]
fn what_the_system_said_is_the_source_of_an_error() {
    let said = |error: &dyn Error| error.source().is_some_and(|source| source.is::<io::Error>());
    assert!(said(&load("not/there.obj").unwrap_err()));
    assert!(said(&write(&scene(), "not/there.obj".as_ref()).unwrap_err()));
}
