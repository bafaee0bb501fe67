//! What the command line writes: no input is lost, no output is written half.

mod common;

use std::fs;
use std::path::Path;

use common::command::{TRIANGLE, refused};

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

/// A glTF file of one triangle whose numbers are in `triangle.bin`.
const GLTF: &str = r#"{
    "asset": { "version": "2.0" },
    "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
    "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
    "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0] }],
    "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    "buffers": [{ "uri": "triangle.bin", "byteLength": 36 }]
}"#;

#[test]
fn no_output_replaces_a_file_that_the_scene_pulls_in() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "paint.mtl", "newmtl red\nKd 1 0 0\n");
    write(folder, "mesh.obj", &format!("mtllib paint.mtl\nusemtl red\n{TRIANGLE}"));
    write(folder, "room.toml", "[[mesh]]\nfile = \"mesh.obj\"\n");
    write(folder, "mesh.gltf", GLTF);
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    fs::write(folder.join("triangle.bin"), corners.map(f32::to_le_bytes).concat()).unwrap();
    write(folder, "rays.csv", "1,1,1,1,1,-1\n");
    for (scene, file) in [
        ("mesh.obj", "paint.mtl"),
        ("room.toml", "mesh.obj"),
        ("room.toml", "paint.mtl"),
        ("mesh.gltf", "triangle.bin"),
    ] {
        let told = &[file, "reads or writes it already", "another name"];
        for line in [
            format!("render {scene} -o new.png --size 8x6 --stats {file}"),
            format!("query {scene} --rays rays.csv -o {file}"),
            format!("compare {scene} --size 8x6 --backends grid --list ./{file}"),
            format!("tradeoff {scene} --quick --backends grid --csv {file}"),
        ] {
            refused(folder, &line, told);
        }
    }
}
