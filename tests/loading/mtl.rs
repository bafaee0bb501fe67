//! Which MTL files an OBJ file reads, and which of their materials its names find.

use glam::Vec3;
use umbra::scene::{Material, Scene};

use super::{Files, notes_say};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// One triangle for each line of an OBJ file beside `a.mtl`.
fn used(mtl: &str, lines: &[&str]) -> Scene {
    let faces: String = lines.iter().map(|line| format!("{line}\nf 1 2 3\n")).collect();
    let files = Files::new();
    files.write("a.mtl", mtl).write("a.obj", format!("{TRIANGLE}{faces}"));
    files.load("a.obj").expect("a sound file")
}

fn diffuse<const COUNT: usize>(scene: &Scene) -> [Vec3; COUNT] {
    std::array::from_fn(|id| scene.material(id as u32).diffuse)
}

#[test]
fn a_comment_after_a_name_is_no_part_of_it() {
    let mtl = "newmtl red # first\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
    let lines =
        ["mtllib a.mtl # of this file\nusemtl red", "usemtl blue\t# sky", "usemtl red # again"];
    let scene = used(mtl, &lines);
    assert_eq!(diffuse(&scene), [Vec3::X, Vec3::Z, Vec3::X]);
    assert!(!scene.notes.iter().any(|note| note.contains("mtl")), "{:?}", scene.notes);
}

#[test]
fn a_name_that_is_defined_with_a_number_sign_is_taken_whole() {
    let mtl =
        "newmtl Material #25\nKd 1 0 0\nnewmtl Material #26\nKd 0 1 0\nnewmtl a#b\nKd 0 0 1\n";
    let lines = ["mtllib a.mtl\nusemtl Material #25", "usemtl Material #26", "usemtl a#b"];
    assert_eq!(diffuse(&used(mtl, &lines)), [Vec3::X, Vec3::Y, Vec3::Z]);
    // Neither of two is the one that is meant.
    let scene = used(mtl, &["mtllib a.mtl\nusemtl Material #27"]);
    assert_eq!(diffuse(&scene), [Vec3::splat(0.7)]);
    assert!(scene.notes.iter().any(|note| note.contains("'Material #27'")), "{:?}", scene.notes);
    // Nor is the one that there is.
    let scene = used(
        "newmtl Material #25\nKd 1 0 0\n",
        &["mtllib a.mtl\nusemtl Material #26", "usemtl #2"],
    );
    assert_eq!(diffuse(&scene), [Vec3::splat(0.7); 2]);
}

#[test]
fn of_the_words_of_a_comment_none_is_a_file_that_is_missing() {
    let scene = used("", &["mtllib lost.mtl # see the other folder"]);
    let missing: Vec<_> = scene.notes.iter().filter(|note| note.contains("read")).collect();
    assert_eq!(missing, ["material file 'lost.mtl' cannot be read: plain grey instead"]);
}

#[test]
fn materials_that_are_used_but_not_defined_are_named() {
    let noted = |count: usize| {
        let lines: Vec<String> = (1..=count).map(|number| format!("usemtl m{number}")).collect();
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let scene = used("", &[&lines[..], &["usemtl m1"]].concat());
        let mut notes = scene.notes.into_iter().filter(|note| note.contains("defined nowhere"));
        notes.next().expect("a note")
    };
    let told = "used but defined nowhere, so plain grey: ";
    assert_eq!(noted(1), format!("{told}material 'm1'"));
    assert_eq!(noted(2), format!("{told}materials 'm1', 'm2'"));
    assert_eq!(noted(7), format!("{told}materials 'm1', 'm2', 'm3', 'm4' and 3 more"));
}

#[test]
fn a_file_that_is_named_again_is_read_once_and_missing_once() {
    let files = Files::new();
    files.write("a.mtl", "newmtl red\nKd 1 0 0\n").write("b.mtl", "newmtl blue\nKd 0 0 1\nKs x\n");
    let lines = "mtllib a.mtl b.mtl\nmtllib lost.mtl\nmtllib lost.mtl a.mtl\nmtllib b.mtl\n";
    let text = format!("{TRIANGLE}{}usemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n", lines.repeat(3));
    let scene = files.write("a.obj", text).load("a.obj").expect("a sound file");
    assert_eq!(diffuse(&scene), [Vec3::X, Vec3::Z]);
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.files, ["a.obj", "a.mtl", "b.mtl"].map(|name| files.path(name)));
    for words in ["'lost.mtl' cannot be read", "file 'b.mtl', line 3"] {
        let count = scene.notes.iter().filter(|note| note.contains(words)).count();
        assert_eq!(count, 1, "{:?}", scene.notes);
    }
}

#[test]
fn numbers_beyond_single_precision_are_left_out_with_their_line() {
    let mtl = "newmtl lamp\nKe 1e39 0 0\nNs -1e39\nKd 1 0 0\n";
    let scene = used(mtl, &["mtllib a.mtl\nusemtl lamp"]);
    assert_eq!((scene.material(0).emission, scene.material(0).diffuse), (Vec3::ZERO, Vec3::X));
    let told = "line 2: 'Ke 1e39 0 0' should be 'Ke' and three numbers within ±3.4e38; it is left \
                out, and so is 1 other line";
    assert!(scene.notes.iter().any(|note| note.ends_with(told)), "{:?}", scene.notes);
}

/// The first of these materials, and the scene.
fn first(mtl: &str) -> (Material, Scene) {
    let scene = used(mtl, &["mtllib a.mtl\nusemtl a"]);
    (scene.material(0).clone(), scene)
}

#[test]
fn textures_are_left_out_with_a_note() {
    let textures = "textures are left out: plain colours instead";
    let cut_out = "what a texture cuts out (map_d) is solid here";
    let (_, scene) = first("newmtl a\nKd 1 0 0\nmap_Kd wood.png\n");
    assert!(notes_say(&scene, textures) && !notes_say(&scene, cut_out), "{:?}", scene.notes);
    let (leaf, scene) = first("newmtl a\nmap_d -clamp on leaf.png\n");
    assert!(notes_say(&scene, textures) && notes_say(&scene, cut_out), "{:?}", scene.notes);
    assert!(!leaf.is_transparent());
    let (screen, scene) = first("newmtl a\nKe 1 1 1\nmap_Ke screen.png\n");
    assert_eq!(screen.emission, Vec3::ZERO);
    assert!(notes_say(&scene, "what glows by a texture (map_Ke) is dark here"));
    let (_, scene) = first("newmtl a\nKd 1 0 0\n");
    assert!(!notes_say(&scene, "texture"));
}

#[test]
fn a_filter_is_what_passes_through_what_refracts() {
    let (glass, _) = first("newmtl a\nillum 6\nKd 1 1 1\nTf 0.5 1 0.25\nNi 1.5\n");
    let filter = Vec3::new(0.5, 1.0, 0.25);
    assert_eq!((glass.transmission, glass.diffuse), (filter, 1.0 - filter));
    assert_eq!(glass.refraction_index, 1.5);
    let (half, _) = first("newmtl a\nillum 7\nKd 1 1 1\nTf 0 1 0\nd 0.5\n");
    assert_eq!((half.transmission, half.diffuse), (0.5 * Vec3::Y, Vec3::splat(0.5)));
    // Some programs write `illum 4` and `Tf 1 1 1` for whatever is opaque.
    let (opaque, scene) = first("newmtl a\nillum 4\nTf 1 1 1\n");
    assert!(!opaque.is_transparent() && notes_say(&scene, "'Tf' is left out beside 'illum 4'"));
    let (opaque, scene) = first("newmtl a\nillum 2\nTf 1 1 1\n");
    assert!(!opaque.is_transparent() && !notes_say(&scene, "'Tf'"));
}
