//! GLB and glTF.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use umbra::scene::{Light, Scene};

use super::{Files, corners, notes_say, refusal, scene};

/// A corner at the origin and one along each of X and Y, as six f32... and indices 0 1 2 as u16.
pub fn triangle_bytes() -> Vec<u8> {
    let positions = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    bytes
}

/// A scene of one node with one triangle, for changes by its callers.
pub fn document() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 8 },
        ],
        "buffers": [{ "byteLength": 44 }],
    })
}

pub fn glb(document: &Value, blob: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let head = [*b"glTF", word(2), word(28 + json.len() + blob.len())].concat();
    [&head, &word(json.len())[..], b"JSON", &json, &word(blob.len()), b"BIN\0", blob].concat()
}

/// The scene with its buffer in a file of its own.
pub fn beside(uri: &str) -> Value {
    let mut document = document();
    document["buffers"][0]["uri"] = json!(uri);
    document
}

pub fn small() -> Vec<u8> {
    glb(&document(), &triangle_bytes())
}

pub fn with(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut document = document();
    change(&mut document);
    glb(&document, &triangle_bytes())
}

pub fn loaded(change: impl FnOnce(&mut Value)) -> Scene {
    scene("a.glb", with(change))
}

fn drafted(change: impl FnOnce(&mut Value)) -> Vec<DVec3> {
    let files = Files::new();
    files.write("a.glb", with(change));
    corners(&files.draft("a.glb"))
}

#[test]
fn one_triangle_loads() {
    let scene = scene("a.glb", small());
    assert_eq!(scene.triangles.get(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(scene.material(0).diffuse, Vec3::splat(0.7));
}

#[test]
fn nested_nodes_compose_in_f64() {
    // In f32 neither the translation nor the sum with a corner can be told.
    let corners = drafted(|document| {
        document["nodes"] = json!([
            { "children": [1], "matrix": [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1] },
            { "children": [2], "translation": [376000.123, 3807000.456, 0.001] },
            { "mesh": 0, "scale": [0.5, 0.25, 1] },
        ]);
    });
    let place = |x: f64, y: f64, z: f64| DVec3::new(x, z, -y);
    assert_eq!(corners[0], place(376_000.123, 3_807_000.456, 0.001));
    assert_eq!(corners[1], place(376_000.123 + 0.5, 3_807_000.456, 0.001));
    assert_eq!(corners[2], place(376_000.123, 3_807_000.456 + 0.25, 0.001));
}

#[test]
fn nodes_are_scaled_then_turned_then_moved() {
    let half = 0.5f64.sqrt();
    let corners = drafted(|document| {
        document["nodes"][0] = json!({
            "mesh": 0, "scale": [2, 3, 1], "rotation": [0, 0, half, half], "translation": [10, 0, 0],
        });
    });
    assert!(corners[1].abs_diff_eq(DVec3::new(10.0, 2.0, 0.0), 1e-12), "{}", corners[1]);
    assert!(corners[2].abs_diff_eq(DVec3::new(7.0, 0.0, 0.0), 1e-12), "{}", corners[2]);
}

#[test]
fn a_node_may_be_placed_more_than_once() {
    let scene = loaded(|document| {
        document["scenes"][0]["nodes"] = json!([1, 2]);
        document["nodes"] = json!([
            { "mesh": 0 },
            { "children": [0] },
            { "children": [0], "translation": [0, 0, 5] },
        ]);
    });
    assert_eq!(scene.triangles.len(), 2);
    assert_eq!(scene.triangles.get(1)[0], Vec3::new(0.0, 0.0, 5.0));
}

#[test]
fn mirrored_nodes_keep_their_front_in_front() {
    let normal = |document: Value| {
        let scene = scene("a.glb", glb(&document, &triangle_bytes()));
        let [a, b, c] = scene.triangles.get(0);
        (b - a).cross(c - a)
    };
    let mut mirrored = document();
    mirrored["nodes"][0]["scale"] = json!([-1, 1, 1]);
    assert_eq!(normal(document()), Vec3::Z);
    assert_eq!(normal(mirrored), Vec3::Z);
}

#[test]
fn strips_fans_and_primitives_without_indices_are_read() {
    // Five corners of a strip in the plane, zigzag.
    let zigzag = [[0f32, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0]];
    let blob: Vec<u8> =
        zigzag.iter().flat_map(|&[x, y]| [x, y, 0.0]).flat_map(f32::to_le_bytes).collect();
    let read = |mode: u32| {
        let mut document = document();
        document["meshes"][0]["primitives"][0] =
            json!({ "attributes": { "POSITION": 0 }, "mode": mode });
        document["accessors"] =
            json!([{ "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3" }]);
        document["bufferViews"] = json!([{ "buffer": 0, "byteLength": 60 }]);
        document["buffers"] = json!([{ "byteLength": 60 }]);
        scene("a.glb", glb(&document, &blob))
    };
    let strip = read(5);
    assert_eq!(strip.triangles.len(), 3);
    for id in 0..3 {
        let [a, b, c] = strip.triangles.get(id);
        assert_eq!((b - a).cross(c - a), Vec3::NEG_Z, "all on one side");
    }
    let fan = read(6);
    assert_eq!((fan.triangles.len(), fan.dropped.zero_area), (3, 0));
    assert_eq!(read(4).triangles.len(), 1);
}

#[test]
fn points_and_lines_are_left_out_with_a_note() {
    let scene = loaded(|document| {
        let line = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
        document["meshes"][0]["primitives"].as_array_mut().expect("a list").push(line);
    });
    assert_eq!(scene.triangles.len(), 1);
    assert!(scene.notes.iter().any(|note| note == "points and lines are left out"));
}

#[test]
fn indices_out_of_range_are_dropped_and_counted() {
    let mut blob = triangle_bytes();
    blob.extend([0u16, 1, 3, 0].iter().flat_map(|i| i.to_le_bytes()));
    let mut document = document();
    document["accessors"][1]["count"] = json!(6);
    document["bufferViews"][1]["byteLength"] = json!(16);
    document["buffers"][0]["byteLength"] = json!(52);
    // Six indices: 0 1 2, then 0 0 1.
    let scene = scene("a.glb", glb(&document, &blob));
    assert_eq!((scene.triangles.len(), scene.dropped.zero_area), (1, 1));
    blob[42..44].copy_from_slice(&9u16.to_le_bytes());
    let scene = super::scene("a.glb", glb(&document, &blob));
    assert_eq!((scene.triangles.len(), scene.dropped.out_of_range), (1, 1));
}

#[test]
fn coordinates_that_are_not_finite_are_dropped_and_counted() {
    let mut blob = triangle_bytes();
    blob[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = refusal("a.glb", glb(&document(), &blob));
    assert!(
        message.contains("no triangles left of 1 face: 0 of zero area, 1 not finite"),
        "{message}"
    );
}

#[test]
fn buffers_beside_the_file_and_inside_it_are_read() {
    let files = Files::new();
    let mut document = document();
    document["buffers"][0]["uri"] = json!("my%20data.bin");
    files.write("my data.bin", triangle_bytes()).write("a.gltf", document.to_string());
    assert_eq!(files.load("a.gltf").expect("a sound file").triangles.len(), 1);
    document["buffers"][0]["uri"] = json!(
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="
    );
    files.write("b.gltf", document.to_string());
    let scene = files.load("b.gltf").expect("a sound file");
    assert_eq!(scene.triangles.get(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    document["buffers"][0]["uri"] = json!("lost.bin");
    files.write("c.gltf", document.to_string());
    assert!(files.refusal("c.gltf").starts_with("c.gltf: cannot read its buffer 'lost.bin': "));
}

#[test]
fn lights_and_camera_stand_where_their_nodes_are() {
    let scene = loaded(|document| {
        let half = 0.5f64.sqrt();
        document["cameras"] = json!([
            { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 } },
            { "type": "perspective", "perspective": { "yfov": 0.75, "znear": 0.1 } },
        ]);
        document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 10, "color": [1, 0.5, 0] },
            { "type": "directional", "intensity": 2 },
            { "type": "spot", "spot": { "outerConeAngle": 0.5 }, "range": 4 },
        ] } });
        let light = |index: u32| json!({ "KHR_lights_punctual": { "light": index } });
        document["scenes"][0]["nodes"] = json!([0, 1]);
        document["nodes"] = json!([
            { "mesh": 0 },
            { "children": [2, 3, 4, 5, 6], "translation": [0, 5, 0] },
            { "camera": 0 },
            { "camera": 1, "translation": [0, 0, 3], "scale": [2, 2, 2] },
            { "extensions": light(0) },
            { "extensions": light(1), "rotation": [-half, 0, 0, half] },
            { "extensions": light(2) },
        ]);
    });
    let [
        Light::Point { position, intensity },
        Light::Directional { direction, irradiance },
        Light::Spot { axis, inner, outer, .. },
    ] = scene.lights[..]
    else {
        panic!("a point, a sun and a spot, not {:?}", scene.lights)
    };
    assert_eq!((position, intensity), (DVec3::new(0.0, 5.0, 0.0), Vec3::new(10.0, 5.0, 0.0)));
    assert!(direction.abs_diff_eq(DVec3::Y, 1e-12), "shines down: {direction}");
    assert_eq!((irradiance, axis), (Vec3::splat(2.0), DVec3::NEG_Z));
    assert_eq!((inner, outer), (0.0, 0.5));
    assert_eq!(scene.camera.position, DVec3::new(0.0, 5.0, 3.0));
    assert_eq!((scene.camera.forward, scene.camera.field_of_view), (DVec3::NEG_Z, 0.75));
    assert_eq!(
        scene.notes,
        [
            "an orthographic camera is left out",
            "the range of lights is left out: they reach everywhere"
        ]
    );
}

#[test]
fn what_was_left_out_is_not_said_to_be_missing() {
    let scene = loaded(|document| {
        document["cameras"] =
            json!([{ "type": "perspective", "perspective": { "yfov": 0, "znear": 0.1 } }]);
        document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "point", "color": [-1, 0, 0] },
        ] } });
        document["nodes"][0]["camera"] = json!(0);
        document["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    });
    for thing in ["camera", "light"] {
        let left_out = |note: &String| note.starts_with("left out") && note.contains(thing);
        assert!(scene.notes.iter().any(left_out), "{:?}", scene.notes);
        let added = format!("no usable {thing} in the file: ");
        assert!(scene.notes.iter().any(|note| note.starts_with(&added)), "{:?}", scene.notes);
    }
}

#[test]
fn surroundings_that_make_no_sense_are_left_out_and_chosen_instead() {
    let plain = loaded(|_| {});
    let sound = json!({ "ambient": [0, 0.5, 0], "background": [0, 0, 2], "exposure": 3 });
    let with = |field: &str, value: Value| {
        let mut umbra = sound.clone();
        umbra[field] = value;
        loaded(|document| document["scenes"][0]["extras"] = json!({ "umbra": umbra }))
    };
    let told = |scene: &Scene, words: &str| scene.notes.iter().any(|note| note == words);
    let scene = with("exposure", json!(3));
    assert_eq!((scene.ambient, scene.exposure), (Vec3::new(0.0, 0.5, 0.0), Some(3.0)));
    for exposure in [json!(-2), json!(0), json!(1e39)] {
        let scene = with("exposure", exposure);
        assert_eq!((scene.exposure, scene.background), (None, Vec3::new(0.0, 0.0, 2.0)));
        assert!(told(&scene, "left out an exposure that makes no sense"), "{:?}", scene.notes);
    }
    for (field, value) in [("ambient", json!([0, -1, 0])), ("background", json!([1e39, 0, 0]))] {
        let scene = with(field, value);
        assert_eq!((scene.ambient, scene.background), (plain.ambient, plain.background));
        let words =
            "left out the ambient light and the background: the numbers of one make no sense";
        assert!(told(&scene, words), "{:?}", scene.notes);
    }
}

#[test]
fn corners_beyond_the_last_whole_triangle_are_noted() {
    let scene = loaded(|document| document["accessors"][1]["count"] = json!(4));
    let told = "a primitive has 4 corners, not three for each triangle: the last one is left out";
    assert_eq!(scene.triangles.len(), 1);
    assert!(scene.notes.iter().any(|note| note == told), "{:?}", scene.notes);
}

#[test]
fn a_primitive_without_a_whole_triangle_is_noted() {
    for mode in [4, 5, 6] {
        let scene = loaded(|document| {
            let few =
                json!({ "bufferView": 1, "componentType": 5123, "count": 2, "type": "SCALAR" });
            document["accessors"].as_array_mut().unwrap().push(few);
            let bare = json!({ "attributes": { "POSITION": 0 }, "indices": 2, "mode": mode });
            document["meshes"][0]["primitives"].as_array_mut().unwrap().push(bare);
        });
        let told = "a primitive has fewer than three corners: it is left out";
        assert_eq!(scene.triangles.len(), 1);
        assert!(scene.notes.iter().any(|note| note == told), "mode {mode}: {:?}", scene.notes);
    }
}

#[test]
fn scenes_without_nodes_and_animations_that_move_no_node_are_read() {
    let channel = |target: Value| json!({ "sampler": 0, "target": target });
    let scene = loaded(|document| {
        document["scenes"] = json!([{ "nodes": [0] }, { "name": "empty" }]);
        document["animations"] = json!([{
            "channels": [
                channel(json!({ "path": "translation" })),
                channel(json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": {} } })),
                channel(json!({ "path": "scale", "node": 0 })),
            ],
            "samplers": [{ "input": 0, "output": 0 }],
        }]);
    });
    assert_eq!(scene.triangles.len(), 1);
    assert!(notes_say(&scene, "animations are left out: everything stands where its node does"));
    let empty = refusal("a.glb", with(|document| document["scenes"] = json!([{}])));
    assert_eq!(empty, "a.glb: no triangles; give at least one face that has an area");
    let message = refusal(
        "a.glb",
        with(|document| {
            document["scenes"] = json!([{}]);
            document["skins"] = json!([{}]);
        }),
    );
    assert_eq!(message, "a.glb: not glTF JSON: missing field `joints`");
}

#[test]
fn extensions_that_are_not_read_are_named() {
    let scene = loaded(|document| {
        document["extensionsUsed"] = json!([
            "KHR_lights_punctual",
            "KHR_materials_sheen",
            "KHR_texture_transform",
            "EXT_mesh_gpu_instancing",
            "X_y",
        ]);
    });
    let told = "glTF extensions that umbra does not read are left out: KHR_materials_sheen, X_y";
    let instances = "EXT_mesh_gpu_instancing is not read: of all instances of a mesh there is one";
    for note in [told, instances] {
        assert!(scene.notes.iter().any(|known| known == note), "{:?}", scene.notes);
    }
}
