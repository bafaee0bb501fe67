//! OBJ and MTL.

use glam::{DVec3, Vec3};
use umbra::scene::{Light, Scene};

use super::{Files, corners, notes_say, refusal, scene};

/// Four corners of a square.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square(faces: &str) -> Scene {
    scene("square.obj", format!("{SQUARE}{faces}"))
}

#[test]
fn polygons_become_triangles_and_relative_indices_count_back() {
    let absolute = square("f 1 2 3 4\n");
    let relative = square("f -4 -3 -2 -1\n");
    assert_eq!(absolute.triangles.len(), 2);
    assert_eq!(absolute.triangles.corners(), relative.triangles.corners());
}

#[test]
fn relative_indices_count_from_their_line() {
    let files = Files::new();
    files.write(
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nv 6 5 5\nv 5 6 5\nf -3 -2 -1",
    );
    let corners = corners(&files.draft("a.obj"));
    assert_eq!(corners[0], DVec3::ZERO);
    assert_eq!(corners[3], DVec3::splat(5.0));
}

#[test]
fn faces_may_come_before_their_vertices() {
    assert_eq!(scene("a.obj", format!("f 1 2 3\n{SQUARE}")).triangles.len(), 1);
}

#[test]
fn faces_with_an_index_out_of_range_are_dropped_and_counted() {
    let faces = "f 1 2 3\nf 1 2 5\nf 0 1 2\nf -5 1 2\nf 1 2 9999999999\nf 1 3 4\n";
    let scene = square(faces);
    assert_eq!((scene.triangles.len(), scene.dropped.out_of_range), (2, 4));
    assert!(
        scene.notes.iter().any(|note| note.starts_with("dropped 4 faces")),
        "{:?}",
        scene.notes
    );
}

#[test]
fn faces_that_are_not_finite_are_dropped_and_counted() {
    let text = format!(
        "{SQUARE}v nan 0 0\nv inf 0 0\nv 1e999 0 0\nv 1e39 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 6\nf 2 3 7\nf 1 2 8"
    );
    let scene = scene("a.obj", text);
    assert_eq!((scene.triangles.len(), scene.dropped.not_finite), (1, 4));
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let text = format!("{SQUARE}v 2 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 5\nf 3 4\n");
    let scene = scene("a.obj", text);
    assert_eq!((scene.triangles.len(), scene.dropped.zero_area), (1, 3));
}

#[test]
fn a_file_without_a_sound_triangle_is_refused() {
    assert_eq!(
        refusal("a.obj", SQUARE),
        "a.obj: no triangles; give at least one face that has an area"
    );
    assert_eq!(
        refusal("a.obj", format!("{SQUARE}f 7 8 9\nf 1 1 1\n")),
        "a.obj: no triangles left of 2 faces: 1 of zero area, 0 not finite, 1 with an index out of range; give at least one face that has an area"
    );
    // Far from the origin a point has no area either.
    assert_eq!(
        refusal("a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
        "a.obj: no triangles left of 1 face: 1 of zero area, 0 not finite, 0 with an index out of range; give at least one face that has an area"
    );
}

#[test]
fn unreadable_numbers_are_refused_with_their_line() {
    let message = refusal("a.obj", "v 0 0 0\nv 1 0\n");
    assert_eq!(message, "a.obj: line 2: three numbers must follow 'v', not '1 0'");
    let message = refusal("a.obj", format!("{SQUARE}\n# comment\nf 1 2 x\n"));
    assert_eq!(message, "a.obj: line 7: 'x' is not a corner of a face");
}

#[test]
fn tabs_windows_lines_comments_and_unknown_keywords_do_no_harm() {
    let text = "# ?\r\nv\t0 0  0\r\nv 1 0 0 1 1 1\r\nv 0 1 0 1.0\r\nvt 0\r\ns off\r\ncurv 1\r\nf 1/1 2/1/1 3//1 # end\r\n";
    assert_eq!(scene("a.obj", text).triangles.len(), 1);
}

#[test]
fn a_comment_may_follow_a_number_at_once() {
    let files = Files::new();
    files.write("a.mtl", "newmtl red\nKd 1 0 0#a\nd 0.5# b\n");
    let text = "mtllib a.mtl\nusemtl red\nv 0 0 0#a\nv 1 0 0# b\nv 0 1 0 #c\nvn 0 0 1#d\nf 1//1 2//1 3//1#e\n";
    let scene = files.write("a.obj", text).load("a.obj").expect("a sound file");
    assert_eq!(scene.normals, [[Vec3::Z; 3]]);
    assert_eq!(scene.material(0).diffuse, Vec3::new(0.5, 0.0, 0.0));
}

#[test]
fn lines_may_end_as_on_an_old_macintosh() {
    let files = Files::new();
    let text = format!("# a\nmtllib a.mtl\n{SQUARE}usemtl red\nf 1 2 \\\n 3\r\nf 1 3 4\nf 1 2 x\n");
    let (sound, _) = text.rsplit_once("f 1 2 x").expect("a last line");
    files.write("a.mtl", "newmtl red\rKd 1 0 0\r");
    let scene =
        files.write("a.obj", sound.replace('\n', "\r")).load("a.obj").expect("a sound file");
    assert_eq!((scene.triangles.len(), scene.material(1).diffuse), (2, Vec3::X));
    let message = refusal("a.obj", text.replace('\n', "\r"));
    assert_eq!(message, "a.obj: line 12: 'x' is not a corner of a face");
}

#[test]
fn normals_are_kept_where_all_three_are_sound() {
    let normals = "vn 0 0 1\nvn 0 1 0\nvn 0 0 0\nvn nan 0 0\n";
    let scene = square(&format!(
        "{normals}f 1//1 2//2 3//-4\nf 1//1 3//1 4//3\nf 1//1 3//1 4//4\nf 1//1 3//1 4//9"
    ));
    assert_eq!(scene.normals[0], [Vec3::Z, Vec3::Y, Vec3::Z]);
    assert_eq!(scene.normals[1..], [[Vec3::ZERO; 3]; 3]);
    assert!(square("f 1 2 3").normals.is_empty());
}

#[test]
fn geometry_far_from_the_origin_keeps_its_digits() {
    let text = "v 4000000.125 500000.001 0\nv 4000001 500000 0\nv 4000000 500001 0\nf 1 2 3\n";
    let scene = scene("a.obj", text);
    let [corner, ..] = scene.triangles.get(0);
    assert_eq!(corner.as_dvec3().x + scene.origin.x, 4_000_000.125);
    assert!((corner.as_dvec3().y + scene.origin.y - 500_000.001).abs() < 1e-7);
    // The camera and the lights that were chosen live in the moved world.
    assert!(scene.camera.position.length() < 100.0);
}

#[test]
fn a_missing_mtl_leaves_plain_grey_and_a_note() {
    let scene = square("mtllib lost.mtl\nusemtl red\nf 1 2 3\n");
    assert_eq!(scene.material(0).name, "red");
    assert_eq!(scene.material(0).diffuse, Vec3::splat(0.7));
    assert!(scene.notes.iter().any(|note| note.contains("'lost.mtl' cannot be read")));
    assert!(scene.notes.iter().any(|note| note.contains("defined nowhere")));
}

#[test]
fn mtl_becomes_whitted_materials() {
    let mtl = "stray line\nv .1 0 0\nnewmtl\nnewmtl plain\nKd 0.5\nKs 0.2 0.2 0.2\nNs 30\nmap_Kd\n\
        newmtl mirror\nillum 3\nKd 0 0 0\nKs 0.9 0.8 0.7\n\
        newmtl pane\nKd 1 1 1\nd 0.4\nNi 1.5\n\
        newmtl block\nillum 7\nTr 0.9\nNi 1.5\nKs 0.1 0.1 0.1\n\
        newmtl lamp\nKd spectral file\nKe 17 12 4\nKs nan 0 0\nillum x\n";
    let faces: String = ["plain", "mirror", "lamp", "pane", "block"]
        .map(|name| format!("usemtl {name}\nf 1 2 3\n"))
        .concat();
    let files = Files::new();
    files.write("my materials.mtl", mtl);
    files.write("a.obj", format!("mtllib my materials.mtl\n{SQUARE}{faces}"));
    let scene = files.load("a.obj").expect("a sound file");
    let [plain, mirror, lamp, pane, block] = [0, 1, 2, 3, 4].map(|id| scene.material(id));
    assert_eq!(plain.diffuse, Vec3::splat(0.5));
    assert_eq!((plain.highlight, plain.shininess), (Vec3::splat(0.2), 30.0));
    assert_eq!(mirror.reflection, Vec3::new(0.9, 0.8, 0.7));
    assert_eq!((mirror.highlight, mirror.diffuse), (Vec3::ZERO, Vec3::ZERO));
    assert_eq!(lamp.emission, Vec3::new(17.0, 12.0, 4.0));
    assert_eq!((pane.transmission, pane.refraction_index), (Vec3::splat(0.6), 1.0));
    assert_eq!(pane.diffuse, Vec3::splat(0.4));
    assert_eq!(block.refraction_index, 1.5);
    assert!(block.transmission.abs_diff_eq(Vec3::splat(0.9), 1e-6));
    // Two transparent triangles, last.
    assert_eq!(scene.triangles.opaque_count(), 3);
}

#[test]
fn each_connected_emissive_surface_gets_one_light_on_the_side_of_the_scene() {
    let files = Files::new();
    files.write("a.mtl", "newmtl lamp\nKe 2 2 2\n");
    // Two lamps, one of two triangles, both facing up: below them a floor.
    let lamps = "v 0 3 0\nv 0 3 1\nv 1 3 1\nv 1 3 0\nv 5 3 0\nv 5 3 1\nv 6 3 1\n";
    let floor = "v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\n";
    files.write(
        "a.obj",
        format!(
            "mtllib a.mtl\n{lamps}{floor}usemtl lamp\nf 1 2 3 4\nf 5 6 7\nusemtl x\nf -1 -2 -3 -4"
        ),
    );
    let scene = files.load("a.obj").expect("a sound file");
    let [Light::Point { position, intensity }, Light::Point { position: other, .. }, ..] =
        scene.lights[..]
    else {
        panic!("two lamps, not {:?}", scene.lights)
    };
    assert_eq!(intensity, Vec3::splat(2.0));
    assert!(position.y < 3.0 && position.y > 2.98 && other.y < 3.0 && other.y > 2.98);
    assert!((position.x - 0.5).abs() < 1e-9 && (position.z - 0.5).abs() < 1e-9);
}

#[test]
fn statements_may_go_on_in_the_next_line() {
    let text = "v 0 0 \\\n 0\nv 1 0\\\r\n0\r\nv 0 1 0\n# a comment is one line \\\nv 1 1 0\nf 1 \\\n2 \\\n 4\\\n 3\n";
    let scene = scene("a.obj", text);
    assert_eq!(scene.triangles.get(0), [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!(scene.triangles.len(), 2);
    let message = refusal("a.obj", format!("{text}f 1 2 x\n"));
    assert_eq!(message, "a.obj: line 12: 'x' is not a corner of a face");
    let message = refusal("a.obj", "v 0 0 0\n\nf 1 \\\n 2\\\n x\n");
    assert_eq!(message, "a.obj: line 3: 'x' is not a corner of a face");
}

#[test]
fn lines_of_an_mtl_that_cannot_be_read_are_noted_once_with_their_line() {
    let noted = |mtl: &str| {
        let files = Files::new();
        files.write("a.mtl", mtl);
        files.write("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl red\nf 1 2 3\n"));
        let mut notes = files.load("a.obj").expect("a sound file").notes;
        notes.retain(|note| note.contains("a.mtl"));
        notes
    };
    for line in ["Kd a b c", "Kd nan inf -1", "Kd 1 nan 0", "Ks 1 0", "Ke", "d nan", "Ns x"] {
        let notes = noted(&format!("newmtl red\n{line}\n"));
        assert_eq!(notes.len(), 1, "{line}: {notes:?}");
        let told = format!("material file 'a.mtl', line 2: '{line}' should be ");
        assert!(notes[0].starts_with(&told), "{notes:?}");
    }
    let notes = noted("newmtl red\n\nKd a b c\nd nan\nNs x\n");
    assert_eq!(
        notes,
        [
            "material file 'a.mtl', line 3: 'Kd a b c' should be 'Kd' and three numbers within ±3.4e38; it is left out, and so are 2 other lines"
        ]
    );
    assert!(noted("newmtl red\nKd 1 0 0 # red\nd 1\nKs 0.5\nmap_Kd x\n").is_empty());
}

#[test]
fn what_is_no_face_is_left_out_with_a_note() {
    let plain = square("f 1 2 3\n");
    for (element, told) in [
        ("l 1 2 3", "points and lines are left out"),
        ("p 1", "points and lines are left out"),
        ("surf 0 1 0 1 1 2 3 4", "curves and free-form surfaces are left out"),
        ("curv 0 1 1 2", "curves and free-form surfaces are left out"),
    ] {
        assert!(!notes_say(&plain, told));
        let scene = square(&format!("f 1 2 3\n{element}\n{element}\n"));
        let count = scene.notes.iter().filter(|note| *note == told).count();
        assert_eq!((scene.triangles.len(), count), (1, 1), "{element}: {:?}", scene.notes);
    }
}

#[test]
fn a_face_that_is_flat_for_want_of_a_normal_is_noted() {
    let told = "faces with a normal whose index is out of range are flat";
    assert!(notes_say(&square("vn 0 0 1\nf 1//1 2//1 3//2\n"), told));
    assert!(!notes_say(&square("vn 0 0 1\nf 1//1 2//1 3\n"), told));
}
