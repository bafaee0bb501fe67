//! Scene descriptions.

use glam::{DVec3, Vec3};
use umbra::scene::{Light, load};

use super::{Files, corners, refusal, scene};

const TRIANGLE: &str = "[[mesh]]\ntriangles = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]\n";

#[test]
fn the_sample_scene_loads() {
    let scene = load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/gallery.toml")).expect("a scene");
    assert_eq!((scene.triangles.len(), scene.triangles.opaque_count()), (46, 44));
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert_eq!(scene.lights.len(), 3);
    assert_eq!(scene.ambient, Vec3::new(0.08, 0.08, 0.09));
}

#[test]
fn meshes_are_scaled_then_turned_then_moved_in_f64() {
    let files = Files::new();
    files.write(
        "a.toml",
        format!(
            "{TRIANGLE}scale = [2, 1, 1]\nrotate = [0, 0, 90]\ntranslate = [4000000.1, 0, 0.25]\n"
        ),
    );
    let corners = corners(&files.draft("a.toml"));
    let moved = DVec3::new(4_000_000.1, 0.0, 0.25);
    assert_eq!(corners[0], moved);
    assert!(corners[1].abs_diff_eq(moved + DVec3::new(0.0, 2.0, 0.0), 1e-9));
    assert!(corners[2].abs_diff_eq(moved + DVec3::new(-1.0, 0.0, 0.0), 1e-9));
}

#[test]
fn rotations_go_about_x_then_y_then_z() {
    let files = Files::new();
    files.write("a.toml", format!("{TRIANGLE}rotate = [90, 90, 0]\n"));
    let corners = corners(&files.draft("a.toml"));
    // y turns to z about x, then z to x about y; x stays about x, then turns to -z.
    assert!(corners[2].abs_diff_eq(DVec3::X, 1e-12), "{}", corners[2]);
    assert!(corners[1].abs_diff_eq(DVec3::NEG_Z, 1e-12), "{}", corners[1]);
}

#[test]
fn lights_and_camera_are_what_the_file_says() {
    let scene = scene(
        "a.toml",
        format!(
            "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nfield_of_view = 90\n{TRIANGLE}\
             [[light]]\nkind = \"spot\"\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity = [1, 2, 3]\nouter = 90\n\
             [[light]]\nkind = \"directional\"\nfrom = [0, 0, 2]\nirradiance = [1, 1, 1]\n"
        ),
    );
    let [Light::Spot { axis, intensity, inner, outer, .. }, Light::Directional { direction, .. }] =
        scene.lights[..]
    else {
        panic!("a spot and a sun, not {:?}", scene.lights)
    };
    assert_eq!((axis, intensity, inner), (DVec3::NEG_Y, Vec3::new(1.0, 2.0, 3.0), 0.0));
    assert_eq!((outer, direction), (std::f64::consts::FRAC_PI_2, DVec3::Z));
    assert_eq!(
        (scene.camera.position, scene.camera.forward),
        (DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z)
    );
    assert_eq!(scene.camera.field_of_view, std::f64::consts::FRAC_PI_2);
}

#[test]
fn mistakes_are_answered_with_their_line() {
    let cases = [
        (format!("{TRIANGLE}colour = 3\n"), "line 3: unknown field `colour`"),
        ("ambient = [1, 2]\n".to_owned(), "line 1: invalid length 2"),
        ("[camera]\nposition = [0, 0, 0]\n".to_owned(), "line 1: missing field `target`"),
        ("[[mesh]\n".to_owned(), "line 1: "),
        ("[[light]]\nkind = \"laser\"\n".to_owned(), "unknown variant `laser`"),
        ("[materials.a]\nshiny = 1\n".to_owned(), "line 2: unknown field `shiny`"),
    ];
    for (text, words) in cases {
        let message = refusal("a.toml", &text);
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn meshes_that_cannot_be_had_are_named() {
    let mesh = |entry: &str| refusal("a.toml", format!("[[mesh]]\n{entry}\n"));
    assert!(mesh("").ends_with("mesh 1: give one of file, builtin, quads and triangles"));
    assert!(mesh("file = \"x.ply\"").contains("is no mesh; name an .obj, .glb or .gltf file"));
    assert!(mesh("triangles = []\nmaterial = \"gold\"").ends_with("there is no [materials.gold]"));
    assert!(mesh("triangles = []").ends_with("a.toml: no triangles"));
    let files = Files::new();
    files.write("a.toml", "[[mesh]]\nfile = \"lost.obj\"\n");
    let message = files.load("a.toml").expect_err("there is none").to_string();
    assert!(message.contains("lost.obj: "), "{message}");
}

#[test]
fn built_in_scenes_can_be_placed() {
    let files = Files::new();
    files.write("a.toml", "[[mesh]]\nbuiltin = \"jittered-sparse\"\n");
    let scene = files.load("a.toml").expect("a sound file");
    assert!(
        scene
            .notes
            .iter()
            .any(|note| note == "jittered-sparse: its lights and camera are left out")
    );
    files.write("b.toml", "[[mesh]]\nbuiltin = \"teapot\"\n");
    let message = files.load("b.toml").expect_err("there is none").to_string();
    assert!(message.contains("'teapot'; built-in scenes: jittered-sparse"), "{message}");
}

#[test]
fn faults_in_a_mesh_are_counted() {
    let files = Files::new();
    files.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    files.write("a.toml", "[[mesh]]\nfile = \"a.obj\"\n[[mesh]]\nfile = \"a.obj\"\n");
    let scene = files.load("a.toml").expect("a sound file");
    assert_eq!((scene.triangles.len(), scene.dropped.out_of_range), (2, 2));
}
