//! glTF as other programs write it: what may be passed over is, with a note, and what cannot is said to the point.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::{
    Files, corners,
    gltf::{beside, document, glb, loaded, small, triangle_bytes, with},
    notes_say, refusal,
};

/// The message for the scene in a `.gltf` file.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut document = beside("a.bin");
    change(&mut document);
    Files::new()
        .write("a.bin", triangle_bytes())
        .write("a.gltf", document.to_string())
        .refusal("a.gltf")
}

#[test]
fn the_version_is_looked_at_first() {
    // As in glTF 1.0: lists have names for numbers, and so have scenes.
    for asset in [json!({ "version": "1.0" }), json!({ "version": 1.0 }), json!({})] {
        let older = json!({
            "asset": asset, "scene": "main", "meshes": { "box": {} }, "nodes": {}, "accessors": {},
        });
        let told = "a.gltf: the file is of glTF version '1.0'; umbra reads version 2: convert it";
        assert_eq!(refusal("a.gltf", older.to_string()), told);
    }
    let scene = loaded(|document| document["asset"] = json!({ "version": 2.0, "minVersion": 2.0 }));
    assert_eq!(scene.triangles.len(), 1);
}

#[test]
fn a_primitive_without_positions_is_left_out_with_a_note() {
    for shapeless in [json!({ "attributes": {} }), json!({ "attributes": {}, "indices": 1 })] {
        let scene = loaded(|document| {
            let primitives = document["meshes"][0]["primitives"].as_array_mut();
            primitives.expect("a list").push(shapeless);
        });
        assert_eq!(scene.triangles.len(), 1);
        let told = "primitive 1 of mesh 0 has no positions: it is left out";
        assert!(notes_say(&scene, told), "{:?}", scene.notes);
    }
}

#[test]
fn weights_without_a_morph_target_are_left_out_with_a_note() {
    let scene = loaded(|document| document["meshes"][0]["weights"] = json!([0.5]));
    let told = "a mesh has more weights than morph targets: those beyond are left out";
    assert!(notes_say(&scene, told), "{:?}", scene.notes);
}

#[test]
fn extensions_of_looks_are_harmless_where_they_are_required() {
    for name in ["KHR_technique_webgl", "KHR_techniques_webgl", "KHR_materials_unlit"] {
        let scene = loaded(|document| {
            (document["extensionsUsed"], document["extensionsRequired"]) =
                (json!([name]), json!([name]));
        });
        assert!(notes_say(&scene, name), "{:?}", scene.notes);
    }
}

#[test]
fn a_light_of_an_unknown_type_is_left_out_with_a_note() {
    let scene = loaded(|document| {
        document["extensions"] =
            json!({ "KHR_lights_punctual": { "lights": [{ "type": "ambient" }] } });
        document["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    });
    assert!(notes_say(&scene, "light 0 is of an unknown type: it is left out"));
}

#[test]
fn vertices_that_hang_on_no_joint_stand_where_their_node_does() {
    let blob = [triangle_bytes(), [1u8, 0, 0, 0].repeat(3), vec![0; 12]].concat();
    let mut document = document();
    document["nodes"] = json!([{ "mesh": 0, "skin": 0, "translation": [3, 0, 0] }, {}]);
    document["skins"] = json!([{ "joints": [1, 1] }]);
    document["meshes"][0]["primitives"][0]["attributes"] =
        json!({ "POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3 });
    for (offset, normalized) in [(44, false), (56, true)] {
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": 12 });
        document["bufferViews"].as_array_mut().expect("a list").push(view);
        let accessor = json!({
            "bufferView": document["bufferViews"].as_array().expect("a list").len() - 1,
            "componentType": 5121, "count": 3, "type": "VEC4", "normalized": normalized,
        });
        document["accessors"].as_array_mut().expect("a list").push(accessor);
    }
    document["buffers"][0]["byteLength"] = json!(68);
    let files = Files::new();
    files.write("a.glb", glb(&document, &blob));
    let moved = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| corner + 3.0 * DVec3::X);
    assert_eq!(corners(&files.draft("a.glb")), moved);
    let scene = files.load("a.glb").expect("a sound file");
    assert!(notes_say(&scene, "corners of a skinned mesh hang on no joint"), "{:?}", scene.notes);
}

#[test]
fn a_stride_of_zero_is_none() {
    let scene = loaded(|document| document["bufferViews"][0]["byteStride"] = json!(0));
    assert_eq!(scene.triangles.get(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn what_no_used_scene_has_does_no_harm() {
    let scene = loaded(|document| {
        document["nodes"] = json!([{ "mesh": 0 }, { "children": [2] }, { "children": [1, 9] }]);
        document["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
        let buffers = document["buffers"].as_array_mut().expect("a list");
        buffers.push(json!({ "byteLength": 9, "uri": "lost.bin" }));
    });
    assert_eq!((scene.triangles.len(), scene.files.len()), (1, 1));
    // A skin may name joints that no scene has.
    let message = refused(|document| {
        document["nodes"] =
            json!([{ "mesh": 0, "skin": 0 }, { "children": [2] }, { "children": [1, 3] }, {}]);
        document["skins"] = json!([{ "joints": [3] }]);
    });
    assert!(message.ends_with("is below itself"), "{message}");
}

#[test]
fn quantised_positions_are_read_whether_they_are_shares_or_not() {
    let quantised = |component: u32, normalized: bool, bytes: &[u8]| {
        let mut document = document();
        let size = bytes.len() / 3;
        (document["extensionsUsed"], document["extensionsRequired"]) =
            (json!(["KHR_mesh_quantization"]), json!(["KHR_mesh_quantization"]));
        document["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
        document["accessors"] = json!([{
            "bufferView": 0, "componentType": component, "normalized": normalized, "count": 3, "type": "VEC3",
        }]);
        document["bufferViews"] =
            json!([{ "buffer": 0, "byteLength": bytes.len(), "byteStride": size }]);
        document["buffers"] = json!([{ "byteLength": bytes.len() }]);
        let scene = super::scene("a.glb", glb(&document, bytes));
        assert!(!notes_say(&scene, "KHR_mesh_quantization"), "{:?}", scene.notes);
        scene.triangles.get(0)
    };
    let shorts = |corners: [[i16; 4]; 3]| -> Vec<u8> {
        corners.iter().flatten().flat_map(|number| number.to_le_bytes()).collect()
    };
    let corners = shorts([[0, -2, 0, 0], [300, 0, 0, 0], [0, 1, 0, 0]]);
    assert_eq!(
        quantised(5122, false, &corners),
        [Vec3::new(0.0, -2.0, 0.0), Vec3::new(300.0, 0.0, 0.0), Vec3::Y]
    );
    let corners = shorts([[i16::MIN, 0, 0, 0], [i16::MAX, 0, 0, 0], [0, i16::MAX, 0, 0]]);
    assert_eq!(quantised(5122, true, &corners), [Vec3::NEG_X, Vec3::X, Vec3::Y]);
    let corners = [[0, 0, 0, 0], [255, 0, 0, 0], [0, 255, 0, 0]].concat();
    assert_eq!(quantised(5121, true, &corners), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(quantised(5121, false, &corners)[1], Vec3::new(255.0, 0.0, 0.0));
    let corners = [[0, 129, 0, 0], [127, 0, 0, 0], [0, 127, 0, 0]].concat();
    assert_eq!(quantised(5120, true, &corners), [Vec3::NEG_Y, Vec3::X, Vec3::Y]);
}

#[test]
fn addresses_of_buffers_are_read_in_any_case_and_quoted_in_short() {
    let files = Files::new();
    let data = "DATA:application/octet-stream;BASE64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    files.write("a.gltf", beside(data).to_string());
    assert_eq!(files.load("a.gltf").expect("a sound file").triangles.len(), 1);
    let message = |uri: &str| refused(|document| document["buffers"][0]["uri"] = json!(uri));
    for uri in ["http://example.com/a.bin", "file:///tmp/a.bin"] {
        let told = "only files beside it and data URIs are read; save it beside the file";
        assert_eq!(message(uri), format!("a.gltf: cannot read its buffer '{uri}': {told}"));
    }
    let long = message(&"dat;".repeat(300));
    assert!(long.len() < 200 && long.contains(&format!("'{}...'", "dat;".repeat(15))), "{long}");
    let told = "a.gltf: cannot read its buffer 'lost.bin': ";
    let lost = message("lost.bin");
    assert!(lost.starts_with(told) && lost.ends_with("; check its name and its folder"), "{lost}");
    let told =
        "a.gltf: buffer 0 has no 'uri', as only that of a GLB may; give the name of its file";
    let none = refused(|document| document["buffers"][0] = json!({ "byteLength": 44 }));
    assert!(none.starts_with(told), "{none}");
}

#[test]
fn a_length_that_the_chunks_of_a_glb_exceed_is_said() {
    let mut bytes = small();
    let there = bytes.len();
    for length in [0u8, 8, 100] {
        bytes[8..12].copy_from_slice(&u32::from(length).to_le_bytes());
        let told = format!(
            "a.glb: the header of the GLB says that it has {length} bytes, too few for its chunks, and {there} are there; export the file again"
        );
        assert_eq!(refusal("a.glb", &bytes), told);
    }
}

#[test]
fn a_primitive_with_a_problem_is_named() {
    let primitive = |field: &str, value: Value| {
        refusal("a.glb", with(|document| document["meshes"][0]["primitives"][0][field] = value))
    };
    let told = "a.glb: primitive 0 of mesh 0 has an unknown mode; give one from 0 to 6";
    assert_eq!(primitive("mode", json!(9)), told);
    let told = "a.glb: primitive 0 of mesh 0 has no positions, and nothing else is there; give it";
    assert!(primitive("attributes", json!({})).starts_with(told));
}

#[test]
fn the_colours_of_vertices_are_left_out_with_a_note() {
    let scene = loaded(|document| {
        document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    });
    let told = "the colours of vertices are left out: those of materials instead";
    assert_eq!(scene.notes.iter().filter(|note| *note == told).count(), 1, "{:?}", scene.notes);
}
