//! Damaged GLB and glTF files: a clear line, never a panic.

use serde_json::{Value, json};

use super::{
    Files,
    gltf::{beside, small, triangle_bytes, with},
    refusal, scene,
};

fn refused(change: impl FnOnce(&mut Value)) -> String {
    refusal("a.glb", with(change))
}

#[test]
fn truncated_glb_is_refused_with_a_clear_line() {
    let whole = small();
    for length in 1..whole.len() {
        let message = refusal("a.glb", &whole[..length]);
        let clear = message.contains("cut short") || message.contains("does not begin with 'glTF'");
        assert!(clear, "{length} bytes: {message}");
    }
    let length = whole.len();
    let message = refusal("a.glb", &whole[..length - 1]);
    assert_eq!(message, format!("a.glb: the GLB is cut short: {} bytes of {length}", length - 1));
}

#[test]
fn wrong_magic_and_version_are_refused() {
    let mut bytes = small();
    bytes[4] = 1;
    assert_eq!(refusal("a.glb", &bytes), "a.glb: the GLB is of version 1; umbra reads version 2");
    bytes[0] = b'G';
    assert_eq!(refusal("a.glb", &bytes), "a.glb: not a GLB: it does not begin with 'glTF'");
    assert!(refusal("a.gltf", "{").starts_with("a.gltf: not glTF JSON: "));
}

#[test]
fn indices_to_nowhere_are_refused() {
    let cases: [(&str, &str, u32); 10] = [
        ("/scene", "scene", 1),
        ("/scenes/0/nodes/0", "node", 1),
        ("/nodes/0/mesh", "mesh", 1),
        ("/nodes/0/camera", "camera", 0),
        ("/meshes/0/primitives/0/attributes/POSITION", "accessor", 2),
        ("/meshes/0/primitives/0/indices", "accessor", 2),
        ("/meshes/0/primitives/0/material", "material", 0),
        ("/accessors/0/bufferView", "buffer view", 2),
        ("/bufferViews/0/buffer", "buffer", 1),
        ("/nodes/0/children/0", "node", 1),
    ];
    for (place, kind, count) in cases {
        let message = refused(|document| {
            document["nodes"][0]["children"] = json!([]);
            match document.pointer_mut(place) {
                Some(index) => *index = json!(7),
                None => {
                    let (parent, field) = place.rsplit_once('/').expect("a pointer");
                    let parent = document.pointer_mut(parent).expect("a place");
                    match parent.as_array_mut() {
                        Some(list) => list.push(json!(7)),
                        None => parent[field] = json!(7),
                    }
                }
            }
        });
        let there = if count == 0 { "none".to_owned() } else { format!("only {count}") };
        assert_eq!(message, format!("a.glb: {kind} 7 is used, but the file has {there}"));
    }
}

#[test]
fn accessors_beyond_their_buffer_are_refused() {
    let changes: [(&str, Value); 8] = [
        ("/accessors/0/count", json!(4)),
        ("/accessors/0/count", json!(u64::MAX)),
        ("/accessors/0/byteOffset", json!(4)),
        ("/accessors/1/byteOffset", json!(u64::MAX)),
        ("/bufferViews/0/byteOffset", json!(12)),
        ("/bufferViews/0/byteLength", json!(u64::MAX)),
        ("/bufferViews/0/byteStride", json!(16)),
        ("/bufferViews/1/byteLength", json!(4)),
    ];
    for (place, value) in changes {
        let message = refused(|document| {
            let (parent, field) = place.rsplit_once('/').expect("a pointer");
            document.pointer_mut(parent).expect("a place")[field] = value.clone();
            if field != "count" {
                document["buffers"][0]["byteLength"] = json!(44);
            }
        });
        let clear = message.contains("reaches beyond the end") || message.contains("too many");
        assert!(clear, "{place} = {value}: {message}");
    }
    let message = refused(|document| document["buffers"][0]["byteLength"] = json!(45));
    assert_eq!(message, "a.glb: buffer 0 is cut short: 44 bytes of 45");
}

#[test]
fn accessors_of_the_wrong_type_are_refused() {
    for (place, value, words) in [
        ("/accessors/0/componentType", json!(5123), "accessor 0 (positions) is of the wrong type"),
        ("/accessors/0/type", json!("VEC2"), "accessor 0 (positions) is of the wrong type"),
        ("/accessors/1/componentType", json!(5126), "accessor 1 (indices) is of the wrong type"),
        ("/meshes/0/primitives/0/mode", json!(9), "primitive 0 of mesh 0 has an unknown mode"),
        ("/meshes/0/primitives/0/attributes", json!({}), "primitive 0 of mesh 0 has no positions"),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "KHR_draco_mesh_compression",
        ),
        ("/nodes/0/children", json!([0]), "node 0 is below itself"),
        ("/scenes", json!([]), "scene 0 is used, but the file has none"),
    ] {
        let message = refused(|document| {
            let (parent, field) = place.rsplit_once('/').expect("a pointer");
            document.pointer_mut(parent).expect("a place")[field] = value;
        });
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn more_triangles_than_memory_holds_are_refused_before_they_are_made() {
    // A graph in which each node has the next one twice, or thrice.
    for (depth, children) in [(60, 2), (26, 3)] {
        let message = refused(|document| {
            let chain = |child| json!({ "children": vec![child; children] });
            let mut nodes: Vec<Value> = (1..depth).map(chain).collect();
            nodes.push(json!({ "mesh": 0 }));
            document["nodes"] = json!(nodes);
        });
        assert!(message.contains("too many") || message.contains("GiB"), "{message}");
    }
    let message = refused(|document| document["accessors"][1]["count"] = json!(12_000_000_000u64));
    assert!(message.contains("too many") || message.contains("GiB"), "{message}");
}

#[test]
fn no_damaged_byte_makes_the_loader_panic() {
    let whole = small();
    let files = Files::new();
    for place in 0..whole.len() {
        for value in [0, b'9', b'"'] {
            let mut bytes = whole.clone();
            bytes[place] = value;
            // Any answer will do.
            let _ = files.write("a.glb", bytes).load("a.glb");
        }
    }
}

/// A device may have no end.
#[cfg(unix)]
#[test]
fn only_plain_files_are_buffers_and_materials() {
    let files = Files::new();
    files.write("a.gltf", beside("/dev/zero").to_string());
    let message = files.refusal("a.gltf");
    let told = "a.gltf: cannot read its buffer '/dev/zero': this is no plain file; name one";
    assert_eq!(message, told);
    files.write("a.obj", "mtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let scene = files.load("a.obj").expect("a sound file");
    assert!(scene.notes.iter().any(|note| note.contains("'/dev/zero' cannot be read")));
}

#[test]
fn of_a_buffer_beside_the_file_its_length_is_read_and_no_more() {
    let files = Files::new();
    let mut bytes = triangle_bytes();
    bytes.extend([7; 100]);
    files.write("a.bin", &bytes).write("a.gltf", beside("a.bin").to_string());
    assert_eq!(files.load("a.gltf").expect("a sound file").triangles.len(), 1);
    files.write("a.bin", &bytes[..43]);
    assert_eq!(files.refusal("a.gltf"), "a.gltf: buffer 0 is cut short: 43 bytes of 44");
}

#[test]
fn cameras_that_are_of_no_kind_are_refused() {
    for (camera, words) in [
        (json!({ "type": "perspective" }), "camera 0 is a perspective one without 'perspective'"),
        (json!({ "type": "fisheye" }), "camera 0 is of an unknown type"),
    ] {
        let message = refused(|document| {
            document["cameras"] = json!([camera]);
            document["nodes"][0]["camera"] = json!(0);
        });
        assert!(message.starts_with(&format!("a.glb: {words}; give ")), "{message}");
    }
}

#[test]
fn another_version_of_gltf_is_refused() {
    for version in ["1.0", "3.0", "20", ""] {
        let message = refused(|document| document["asset"]["version"] = json!(version));
        let told = format!("a.glb: the file is of glTF version '{version}'; umbra reads version 2");
        assert!(message.starts_with(&told), "{message}");
    }
}

#[test]
fn elements_that_overlap_are_refused() {
    let message = refused(|document| document["bufferViews"][0]["byteStride"] = json!(4));
    let told = "a.glb: accessor 0 (positions) has a byteStride of 4, less than its elements of 12";
    assert!(message.starts_with(told), "{message}");
}

#[test]
fn a_cone_that_is_wider_within_than_without_is_refused() {
    let message = refused(|document| {
        document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "spot", "spot": { "innerConeAngle": 0.5, "outerConeAngle": 0.25 } },
        ] } });
        document["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    });
    let told = "a.glb: light 0 has an innerConeAngle of 0.5, more than its outerConeAngle of 0.25";
    assert!(message.starts_with(told), "{message}");
}

#[test]
fn a_file_that_needs_a_newer_reader_is_refused() {
    for least in ["2.1", "2.9", "3.0"] {
        let message = refused(|document| document["asset"]["minVersion"] = json!(least));
        let told = format!("a.glb: the file needs a reader of glTF version '{least}'; umbra reads");
        assert!(message.starts_with(&told), "{message}");
    }
    let sound = with(|document| document["asset"]["minVersion"] = json!("2.0"));
    assert_eq!(scene("a.glb", sound).triangles.len(), 1);
}

#[test]
fn a_file_without_a_scene_is_refused() {
    let message = refused(|document| {
        document.as_object_mut().expect("an object").remove("scene");
        document["scenes"] = json!([]);
    });
    assert_eq!(message, "a.glb: the file has no scene; give it one whose nodes are to be seen");
}
