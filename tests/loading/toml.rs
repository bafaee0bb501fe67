//! Scene descriptions.

use glam::{DVec3, Vec3};
use umbra::{
    geometry::Ray,
    occlusion::{Backend, BuildOptions, Tally, build},
    scene::{Light, load},
};

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
    let point = |fields: &str| format!("\n[[light]]\nkind = \"point\"\n{fields}\n");
    let cases = [
        (format!("{TRIANGLE}colour = 3\n"), "line 3: unknown field `colour`"),
        ("ambient = [1, 2]\n".to_owned(), "line 1: invalid length 2"),
        (point("position = [0, 5]\nintensity = [1, 1, 1]"), "line 4: invalid length 2"),
        (point("position = [0, 5]\nintensity = [1, 1, 1]"), "in `position = [0, 5]`"),
        (point("position = [0, 5, 0]\nintensity = true"), "in `intensity = true`"),
        (point("intensity = [1, 1, 1]"), "line 2: missing field `position`"),
        (point("from = [1, 1, 1]"), "line 2: a point light has no field `from`; leave it out"),
        (point("colour = 3"), "line 4: unknown field `colour`"),
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
    assert_eq!(
        mesh("triangles = []"),
        "a.toml: line 1: mesh 1: triangles: no triangles; give at least one face that has an area"
    );
    let files = Files::new();
    files.write("a.toml", "[[mesh]]\nfile = \"lost.obj\"\n");
    let message = files.load("a.toml").expect_err("there is none").to_string();
    assert!(message.contains("a.toml: line 1: mesh 1: cannot read "), "{message}");
    assert!(message.contains("lost.obj: "), "{message}");
    files.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    files.write("a.toml", format!("{TRIANGLE}\n[[mesh]]\nfile = \"points.obj\"\n"));
    let message = files.refusal("a.toml");
    assert!(message.starts_with("a.toml: line 4: mesh 2: "), "{message}");
    assert!(message.contains("points.obj: no triangles; give at least"), "{message}");
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
    assert!(message.contains("b.toml: line 1: mesh 1: "), "{message}");
}

#[test]
fn faults_in_a_mesh_are_counted() {
    let files = Files::new();
    files.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    files.write("a.toml", "[[mesh]]\nfile = \"a.obj\"\n[[mesh]]\nfile = \"a.obj\"\n");
    let scene = files.load("a.toml").expect("a sound file");
    assert_eq!((scene.triangles.len(), scene.dropped.out_of_range), (2, 2));
}

#[test]
fn numbers_that_make_no_sense_are_refused_with_their_line_and_field() {
    let camera = |fields: &str| format!("{TRIANGLE}[camera]\nposition = [0, 0, 5]\n{fields}\n");
    let seen = "target = [0, 0, 0]";
    let light = |kind: &str, fields: &str| {
        let head = format!("{TRIANGLE}[[light]]\nkind = \"{kind}\"\n");
        let place = if kind == "directional" { "" } else { "position = [0, 5, 0]\n" };
        format!("{head}{place}{fields}\n")
    };
    let spot = |fields: &str| light("spot", &format!("intensity = [1, 1, 1]\n{fields}"));
    let material = |field: &str| format!("{TRIANGLE}[materials.\"a.b\"]\n{field}\n");
    let cases = [
        (format!("exposure = 0\n{TRIANGLE}"), "line 1: exposure = 0 "),
        (format!("\nexposure = -1.5\n{TRIANGLE}"), "line 2: exposure = -1.5 "),
        (format!("exposure = nan\n{TRIANGLE}"), "line 1: exposure = nan "),
        (format!("ambient = [0, -1, 0]\n{TRIANGLE}"), "line 1: ambient = [0, -1, 0] "),
        (format!("background = [inf, 0, 0]\n{TRIANGLE}"), "line 1: background = [inf, 0, 0] "),
        (format!("up = [0, 0, 0]\n{TRIANGLE}"), "line 1: up = [0, 0, 0] "),
        (format!("up = [0, nan, 0]\n{TRIANGLE}"), "line 1: up = [0, nan, 0] "),
        (format!("up = [0, 0, -2]\n{}", camera(seen)), "line 1: up = [0, 0, -2] "),
        (camera("target = [0, 0, 5]"), "line 5: camera: target = [0, 0, 5] "),
        (camera("target = [0, 0, 1e39]"), "line 5: camera: target = [0, 0, 1e39] "),
        (camera(&format!("{seen}\nfield_of_view = 0")), "line 6: camera: field_of_view = 0 "),
        (camera(&format!("{seen}\nfield_of_view = 180")), "line 6: camera: field_of_view = 180 "),
        (camera(&format!("{seen}\nfield_of_view = nan")), "line 6: camera: field_of_view = nan "),
        (camera(seen).replace("0, 0, 5", "0, inf, 5"), "line 4: camera: position = [0, inf, 5] "),
        (material("diffuse = [-1, 0, 0]"), "line 4: materials.a.b: diffuse = [-1, 0, 0] "),
        (material("highlight = [nan, 0, 0]"), "line 4: materials.a.b: highlight = "),
        (material("emission = [1e39, 0, 0]"), "line 4: materials.a.b: emission = "),
        (material("reflection = [0, 1.5, 0]"), "line 4: materials.a.b: reflection = "),
        (material("transmission = [\n 2,\n 0, 0]"), "materials.a.b: transmission = [ 2, 0, 0] "),
        (material("refraction_index = 0"), "line 4: materials.a.b: refraction_index = 0 "),
        (material("refraction_index = 0.5"), "line 4: materials.a.b: refraction_index = 0.5 "),
        (material("shininess = -1"), "line 4: materials.a.b: shininess = -1 "),
        (format!("{TRIANGLE}scale = [1, nan, 1]"), "line 3: mesh 1: scale = [1, nan, 1] "),
        (light("point", "intensity = [-1, 0, 0]"), "line 6: light 1: intensity = [-1, 0, 0] "),
        (light("point", "intensity = [0, 0, 1e39]"), "line 6: light 1: intensity = "),
        (light("directional", "from = [0, 0, 0]\nirradiance = [1, 1, 1]"), "line 5: light 1: from"),
        (
            light("directional", "from = [0, 1, 0]\nirradiance = [nan, 1, 1]"),
            "line 6: light 1: irr",
        ),
        (spot("target = [0, 5, 0]\nouter = 9"), "line 7: light 1: target = [0, 5, 0] "),
        (spot(&format!("{seen}\ninner = 20\nouter = 9")), "line 8: light 1: inner = 20 "),
        (spot(&format!("{seen}\ninner = -1\nouter = 9")), "line 8: light 1: inner = -1 "),
        (spot(&format!("{seen}\nouter = 181")), "line 8: light 1: outer = 181 "),
    ];
    for (text, words) in cases {
        let message = refusal("a.toml", &text);
        assert!(message.starts_with("a.toml: line ") && message.contains(words), "{message}");
        assert!(message.contains(" makes no sense; "), "{message}");
    }
}

/// Where nothing is said of `up`, a camera may look straight down.
#[test]
fn a_camera_may_look_along_the_up_that_it_was_not_given() {
    let text = format!("{TRIANGLE}[camera]\nposition = [0, 5, 0]\ntarget = [0, 0, 0]\n");
    assert_eq!(scene("a.toml", text).camera.forward, DVec3::NEG_Y);
}

#[test]
fn a_concave_quad_blocks_what_it_covers_and_nothing_else() {
    let arrow = ["[2, 0, 0]", "[0.5, 0.5, 0]", "[0, 2, 0]", "[0, 0, 0]"];
    for start in 0..4 {
        let mut corners = arrow;
        corners.rotate_left(start);
        let scene = scene("a.toml", format!("[[mesh]]\nquads = [[{}]]\n", corners.join(", ")));
        let (backend, options) = (Backend::Brute, BuildOptions::default());
        let engine = build(backend, backend.default_test(), &scene.triangles, &options).unwrap();
        let blocks = |x: f32, y: f32| {
            let ray = Ray::between(Vec3::new(x, y, 1.0), Vec3::new(x, y, -1.0));
            engine.occluded(&ray, &mut Tally::default())
        };
        assert_eq!(scene.triangles.len(), 2);
        for (x, y, is_within) in [
            (0.8, 0.8, false),
            (0.6, 0.6, false),
            (0.3, 0.2, true),
            (1.5, 0.1, true),
            (0.1, 1.5, true),
        ] {
            assert_eq!(blocks(x, y), is_within, "from corner {start}: ({x}, {y})");
        }
    }
}

#[test]
fn materials_are_those_of_the_description_whatever_the_meshes_bring() {
    let files = Files::new();
    files.write("a.mtl", "newmtl red\nKd 1 0 0\n");
    files.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    let (file, own) = ("[[mesh]]\nfile = \"a.obj\"\n", format!("{TRIANGLE}material = \"red\"\n"));
    for (text, line) in [(format!("{file}{own}"), 3), (format!("{own}{file}"), 1)] {
        files.write("a.toml", &text);
        let message = files.refusal("a.toml");
        let told = format!("a.toml: line {line}: mesh ");
        assert!(message.starts_with(&told), "{message}");
        assert!(message.ends_with(": there is no [materials.red]"), "{message}");
        files.write("a.toml", format!("{text}[materials.red]\ndiffuse = [0.5, 0, 0]\n"));
        let scene = files.load("a.toml").expect("a sound file");
        let mut reds = [0, 1].map(|id| scene.material(id).diffuse.x);
        reds.sort_by(f32::total_cmp);
        assert_eq!(reds, [0.5, 1.0], "one of each");
    }
}

#[test]
fn more_triangles_than_can_be_held_are_refused_before_they_are_made() {
    let count = umbra::scene::builtin::triangle_count("jittered-dense", 1.0).expect("a name");
    let meshes = usize::try_from((1 << 32) / count + 1).expect("a small number");
    let text = "[[mesh]]\nbuiltin = \"jittered-dense\"\n".repeat(meshes);
    let message = refusal("a.toml", text);
    let told = format!("a.toml: {} triangles are too many; ", count * meshes as u64);
    assert!(message.starts_with(&told), "{message}");
}

#[test]
fn ambient_light_and_background_are_chosen_each_by_itself() {
    let plain = scene("a.toml", TRIANGLE);
    assert!(plain.ambient.min_element() > 0.0 && plain.background.min_element() > 0.0);
    let given = Vec3::new(0.5, 0.25, 0.0);
    let lit = scene("a.toml", format!("ambient = [0.5, 0.25, 0]\n{TRIANGLE}"));
    assert_eq!((lit.ambient, lit.background), (given, plain.background));
    let sky = scene("a.toml", format!("background = [0.5, 0.25, 0]\n{TRIANGLE}"));
    assert_eq!((sky.ambient, sky.background), (plain.ambient, given));
}

#[test]
fn notes_of_meshes_name_the_file_and_come_once() {
    let files = Files::new();
    for name in ["a", "b"] {
        files
            .write(&format!("{name}.obj"), "mtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }
    let mesh = |name: &str| format!("[[mesh]]\nfile = \"{name}.obj\"\n");
    files.write("a.toml", [mesh("a"), mesh("b"), mesh("a")].concat());
    let scene = files.load("a.toml").expect("a sound file");
    let told: Vec<_> = scene.notes.iter().filter(|note| note.contains("lost.mtl")).collect();
    let expected = ["a.obj", "b.obj"].map(|name| {
        let path = files.path(name);
        format!("{}: material file 'lost.mtl' cannot be read: plain grey instead", path.display())
    });
    assert_eq!(told, expected.iter().collect::<Vec<_>>());
}
