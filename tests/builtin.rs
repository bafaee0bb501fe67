//! The built-in scenes are what they say.

use umbra::scene::builtin::{NAMES, draft, draft_at, triangle_count, view};

#[test]
fn lights_are_those_of_the_paper() {
    let lights = NAMES.iter().map(|name| draft(name).unwrap().lights.len());
    assert_eq!(lights.collect::<Vec<_>>(), [15, 15, 6, 4]);
}

#[test]
fn the_jittered_scenes_have_the_triangles_of_the_paper() {
    for name in ["jittered-sparse", "jittered-dense"] {
        assert_eq!(draft(name).unwrap().finish().unwrap().triangles.len(), 551_408);
    }
}

#[test]
fn the_count_is_that_of_the_triangles_made() {
    for name in NAMES {
        for tessellation in [0.01, 0.2, 1.0, 2.0] {
            let draft = draft_at(name, tessellation).unwrap();
            assert_eq!(Some(draft.triangles.len() as u64), triangle_count(name, tessellation));
        }
    }
}

#[test]
fn unknown_names_and_senseless_tessellations_are_refused() {
    assert!(draft("teapot").is_none() && view("teapot").is_none());
    assert!(draft_at("teapot", 1.0).is_err());
    for tessellation in [0.0, -1.0, 101.0, f64::NAN] {
        assert!(draft_at("drum", tessellation).is_err());
    }
}
