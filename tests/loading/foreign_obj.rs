//! OBJ and MTL as other programs write them: what is taken for what, and what is said of it.

use glam::Vec3;
use umbra::scene::Scene;

use super::{Files, notes_say, refusal, scene};

/// Four corners of a square.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square(lines: &str) -> Scene {
    scene("square.obj", format!("{SQUARE}{lines}"))
}

/// The square with this material.
fn with_material(mtl: impl AsRef<[u8]>) -> Scene {
    let files = Files::new();
    files.write("a.mtl", mtl);
    files.write("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n"));
    files.load("a.obj").expect("a sound file")
}

/// Text as some programs of Windows save it.
fn utf_16(text: &str, has_mark: bool) -> Vec<u8> {
    let mark = has_mark.then_some('\u{feff}');
    let text: String = mark.into_iter().chain(text.chars()).collect();
    text.encode_utf16().flat_map(u16::to_le_bytes).collect()
}

#[test]
fn what_is_invisible_by_tr_alone_is_opaque_with_a_note() {
    let told = "opaque, for 'Tr' of 1 or more without 'd' is written for what is solid, too: material 'a'; write 'd 0' for what is invisible";
    for mtl in ["newmtl a\nTr 1.000000\n", "newmtl a\nTr 100\nKd 1 1 1\n"] {
        let scene = with_material(mtl);
        assert!(!scene.has_transparent() && notes_say(&scene, told), "{:?}", scene.notes);
        assert_ne!(scene.material(0).diffuse, Vec3::ZERO);
    }
    for (mtl, is_transparent) in [("d 0", true), ("Tr 0.9", true), ("Tr 1\nd 1", false)] {
        let scene = with_material(format!("newmtl a\n{mtl}\n"));
        assert_eq!(scene.has_transparent(), is_transparent, "{mtl}");
        assert!(!notes_say(&scene, "'Tr'"), "{:?}", scene.notes);
    }
}

#[test]
fn what_is_no_number_is_told_from_a_comment_whoever_wrote_it() {
    for word in
        ["1.#QNAN", "-1.#IND", "1.#SNAN0", "1.#INF00", "-1.#INF", "nan(ind)", "-nan(0x8)", "-inf"]
    {
        let scene = square(&format!("v 2 {word} 0\nf 1 2 3\nf 1 2 5\n"));
        assert_eq!((scene.triangles.len(), scene.dropped.not_finite), (1, 1), "{word}");
        let scene = with_material(format!("newmtl a\nKd {word} 0 0\n"));
        assert_eq!(scene.material(0).diffuse, Vec3::splat(0.7), "{word}");
        assert!(notes_say(&scene, "'a.mtl', line 2: 'Kd "), "{word}: {:?}", scene.notes);
    }
    assert_eq!(square("f 1 2 3 4#1.#INF\n").triangles.len(), 2);
}

#[test]
fn a_face_is_flat_with_a_note_where_a_normal_cannot_be_read() {
    let told = "faces with a normal that is not three finite numbers are flat";
    for normal in ["nan 0 1", "1.#QNAN 0 1", "0 1", "x y z", ""] {
        let scene = square(&format!("vn 0 0 1\nvn {normal}\nf 1//1 2//1 3//1\nf 1//1 3//1 4//2\n"));
        assert_eq!(scene.normals, [[Vec3::Z; 3], [Vec3::ZERO; 3]], "{normal}");
        assert!(notes_say(&scene, told), "{normal}: {:?}", scene.notes);
    }
    assert!(!notes_say(&square("vn 0 0 0\nvn nan 0 0\nf 1//1 2//1 3//1\n"), told));
}

#[test]
fn text_of_two_bytes_a_character_is_said_to_be_so() {
    let told = "this is UTF-16; save it as UTF-8";
    for has_mark in [true, false] {
        for name in ["a.obj", "a.gltf", "a.toml"] {
            let message = refusal(name, utf_16("# a scene\n", has_mark));
            assert_eq!(message, format!("{name}: {told}"));
        }
        let scene = with_material(utf_16("newmtl a\nKd 1 0 0\n", has_mark));
        assert!(notes_say(&scene, &format!("material file 'a.mtl': {told}")), "{:?}", scene.notes);
    }
}

#[test]
fn statements_go_on_after_blanks_and_end_with_the_file() {
    let scene = square("f 1 2 \\ \n 3 \\\t\n 4\nf 1 2 3 \\");
    assert_eq!(scene.triangles.len(), 3);
}

#[test]
fn a_material_without_a_name_is_the_plain_one() {
    let scene = square("usemtl red\nf 1 2 3\nusemtl\nf 1 3 4\nusemtl \nf 1 2 4\n");
    let names = [0, 1, 2].map(|id| scene.material(id).name.as_str());
    assert_eq!((names, scene.materials.len()), (["red", "default", "default"], 2));
    assert!(notes_say(&scene, "plain grey: material 'red'"), "{:?}", scene.notes);
}

#[test]
fn what_is_left_out_of_older_and_newer_kinds_is_noted() {
    for (line, told) in [
        ("v 5 5 5 1 0 0", "the colours of vertices are left out: those of materials instead"),
        ("v 5 5 5 1 1 0 0", "the colours of vertices are left out"),
        ("call part.obj", "what is in the files that 'call' names is left out"),
        ("bzp 1 2 3 4", "curves and free-form surfaces are left out"),
        ("bsp 1 2 3 4", "curves and free-form surfaces are left out"),
        ("cdc 1 2 3 4", "curves and free-form surfaces are left out"),
        ("cdp 1 2 3 4", "curves and free-form surfaces are left out"),
    ] {
        let scene = square(&format!("{line}\n{line}\nf 1 2 3\n"));
        let count = scene.notes.iter().filter(|note| note.contains(told)).count();
        assert_eq!(count, 1, "{line}: {:?}", scene.notes);
    }
    assert!(!notes_say(&square("v 5 5 5 1 # of weight one\nf 1 2 3\n"), "colours"));
}

#[test]
fn faces_of_the_first_kind_are_faces() {
    assert_eq!(square("fo 1 2 3 4\n").triangles.len(), 2);
}
