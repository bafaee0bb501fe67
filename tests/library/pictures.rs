//! Settings, films and pictures.

use std::error::Error;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use tempfile::TempDir;
use umbra::glam::Vec3;
use umbra::occlusion::{Backend, BuildOptions, Test, build};
use umbra::render::{
    Film, OutputError, Picture, Progress, Rendered, Seen, Settings, SettingsError, Shown,
    encode_picture, forecast, render, write_picture,
};
use umbra::shadow::Trace;

use super::scene;

fn rendered(settings: &Settings) -> Result<Rendered, SettingsError> {
    let scene = scene();
    let backend = build(Backend::Brute, Test::Exact, &scene.triangles, &BuildOptions::default());
    let backend = backend.unwrap();
    render(&scene, &*backend, &Trace::new(&*backend), settings, &Progress::default())
}

#[test]
fn a_film_gives_back_what_was_set_and_nothing_outside() {
    let mut film = Film::new(2, 2);
    film.set((1, 0), Vec3::ONE);
    assert_eq!((film.at(1, 0), film.at(0, 1)), (Vec3::ONE, Vec3::ZERO));
    for (x, y) in [(2, 0), (0, 2), (u32::MAX, 0)] {
        let mut film = film.clone();
        assert!(catch_unwind(AssertUnwindSafe(|| film.set((x, y), Vec3::ONE))).is_err());
        assert!(catch_unwind(|| film.at(x, y)).is_err());
    }
}

#[test]
fn a_mask_says_what_was_seen_and_nothing_of_places_outside() {
    let settings = Settings { width: 4, height: 4, mask: true, ..Settings::default() };
    let mask = rendered(&settings).unwrap().mask.unwrap();
    let seen: &[Seen] = mask.at(1, 2);
    assert_eq!(seen.len(), 1);
    assert!(catch_unwind(|| mask.at(4, 0).len()).is_err());
    assert!(catch_unwind(|| mask.at(0, 4).len()).is_err());
}

#[test]
fn answers_of_a_light_that_is_not_there_are_not_shown() {
    let shown = |light| Settings {
        width: 4,
        height: 4,
        answers: Some(Shown { light: Some(light) }),
        ..Settings::default()
    };
    assert!(rendered(&shown(0)).is_ok());
    let refused = rendered(&shown(99)).unwrap_err();
    assert_eq!(refused, SettingsError::Light { light: 99, lights: 1 });
}

#[test]
fn what_makes_no_picture_has_no_forecast() {
    let scene = scene();
    let backend = build(Backend::Brute, Test::Exact, &scene.triangles, &BuildOptions::default());
    let backend = backend.unwrap();
    let sound = Settings { width: 64, height: 48, ..Settings::default() };
    assert!(forecast(&scene, &*backend, &sound).is_ok());
    for unsound in [
        Settings { width: 0, height: 0, ..sound },
        Settings { width: u32::MAX, height: u32::MAX, ..sound },
        Settings { samples: 0, ..sound },
        Settings { depth: 200, ..sound },
    ] {
        let expected = unsound.check().unwrap_err();
        assert_eq!(forecast(&scene, &*backend, &unsound), Err(expected), "{unsound:?}");
    }
}

#[test]
fn a_picture_is_what_its_name_says() {
    let folder = TempDir::new().unwrap();
    let place = |name: &str| folder.path().join(name);
    assert_eq!(Picture::of(&place("a.PNG"), 16).unwrap(), Picture::Png16);
    assert!(Picture::of(&place("a.png"), 7).unwrap_err().to_string().contains("8 or 16 bits"));
    let film = Film::new(2, 2);
    for (kind, name) in
        [(Picture::Png8, "a.exr"), (Picture::OpenExr, "a.png"), (Picture::Png16, "a")]
    {
        let refused = write_picture(&film, 1.0, kind, &place(name)).unwrap_err();
        assert!(matches!(refused, OutputError::Kind { .. }), "{refused}");
    }
    assert!(write_picture(&film, 1.0, Picture::Png16, &place("a.png")).is_ok());
    for exposure in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        assert!(catch_unwind(|| encode_picture(&film, exposure, Picture::Png8)).is_err());
    }
}

#[test]
fn the_darkest_film_has_an_exposure() {
    let mut film = Film::new(1, 1);
    film.set((0, 0), Vec3::splat(f32::from_bits(1)));
    let exposure = film.automatic_exposure();
    assert!(exposure.is_finite());
    let _ = encode_picture(&film, exposure, Picture::Png8);
}

#[test]
fn a_place_that_cannot_be_written_is_named_and_no_temporary_one() {
    let refused = write_picture(&Film::new(1, 1), 1.0, Picture::Png8, "not/there.png".as_ref());
    let refused = refused.unwrap_err();
    let told = refused.to_string();
    assert!(
        told.starts_with("cannot write not/there.png: ") && !told.contains(".umbra-"),
        "{told}"
    );
    assert!(refused.source().is_some_and(|source| source.is::<io::Error>()));
}
