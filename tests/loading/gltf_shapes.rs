//! Where the corners of glTF meshes are: morph targets, skins, accessors that are sparse or store nothing.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::{
    Files, corners,
    gltf::{document, glb},
    notes_say, refusal, scene,
};

/// The corners of the usual triangle.
const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn bytes(vectors: impl IntoIterator<Item = impl IntoIterator<Item = f32>>) -> Vec<u8> {
    vectors.into_iter().flatten().flat_map(f32::to_le_bytes).collect()
}

/// A file whose primitive is the usual triangle without indices; each accessor has its list.
fn file(lists: &[(Value, Vec<u8>)], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut document = document();
    document["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
    let (mut views, mut blob) = (Vec::new(), Vec::new());
    for (_, bytes) in lists {
        views.push(json!({ "buffer": 0, "byteOffset": blob.len(), "byteLength": bytes.len() }));
        blob.extend(bytes);
        blob.resize(blob.len().next_multiple_of(4), 0);
    }
    document["bufferViews"] = json!(views);
    document["buffers"][0]["byteLength"] = json!(blob.len());
    document["accessors"] = lists.iter().map(|(accessor, _)| accessor.clone()).collect();
    for (view, accessor) in document["accessors"].as_array_mut().unwrap().iter_mut().enumerate() {
        accessor["bufferView"] = json!(view);
    }
    change(&mut document);
    glb(&document, &blob)
}

fn accessor(kind: &str, component: u32, count: usize) -> Value {
    json!({ "type": kind, "componentType": component, "count": count })
}

fn vectors(list: &[[f32; 3]]) -> (Value, Vec<u8>) {
    (accessor("VEC3", 5126, list.len()), bytes(list.iter().copied()))
}

fn drafted(file: &[u8]) -> Vec<DVec3> {
    let files = Files::new();
    corners(&files.write("a.glb", file).draft("a.glb"))
}

#[test]
fn morph_targets_move_corners_and_normals_by_their_weights() {
    let lists = [
        vectors(&TRIANGLE),
        vectors(&[[0.0, 0.0, 1.0]; 3]),
        vectors(&[[4.0, 0.0, 0.0]; 3]),
        vectors(&[[0.0, 2.0, 0.0]; 3]),
    ];
    let morphed = |own: Value, of_node: Value| {
        let file = file(&lists, |document| {
            let mesh = &mut document["meshes"][0];
            mesh["primitives"][0]["attributes"]["NORMAL"] = json!(1);
            mesh["primitives"][0]["targets"] = json!([{ "POSITION": 2 }, { "NORMAL": 3 }]);
            if own.is_array() {
                mesh["weights"] = own;
            }
            if of_node.is_array() {
                document["nodes"][0]["weights"] = of_node;
            }
        });
        let scene = scene("a.glb", file);
        (scene.triangles.get(0)[0].x, scene.normals[0][0])
    };
    assert_eq!(morphed(json!(null), json!(null)), (0.0, Vec3::Z), "all weights are 0");
    assert_eq!(morphed(json!([0.5, 0]), json!(null)), (2.0, Vec3::Z));
    assert_eq!(morphed(json!([0.5, 0]), json!([1, 0])), (4.0, Vec3::Z), "those of the node count");
    let (x, normal) = morphed(json!([0, 0.5]), json!(null));
    assert_eq!(x, 0.0);
    assert!(normal.abs_diff_eq(Vec3::new(0.0, 0.5f32.sqrt(), 0.5f32.sqrt()), 1e-6), "{normal}");
}

#[test]
fn morph_targets_that_do_not_fit_are_refused() {
    let lists = [vectors(&TRIANGLE), vectors(&[[4.0, 0.0, 0.0]; 2])];
    let refused = |weights: Value| {
        let file = file(&lists, |document| {
            document["meshes"][0]["primitives"][0]["targets"] =
                json!([{ "POSITION": 1 }, { "POSITION": 1 }]);
            document["meshes"][0]["weights"] = weights;
        });
        refusal("a.glb", file)
    };
    let told = "a.glb: a primitive has 3 positions, but 2 in a morph target; export the file again";
    assert_eq!(refused(json!([1, 0])), told);
    let told = "a.glb: a mesh has 1 weight for 2 morph targets; give one for each";
    assert_eq!(refused(json!([1])), told);
}

/// A triangle of which the first two corners hang on one joint and the last on both, half each.
fn skinned(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    // By columns: moved by -1 in y, and by nothing.
    let unmoved =
        |y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0];
    let lists = [
        vectors(&TRIANGLE),
        (accessor("VEC4", 5121, 3), [0, 1, 0, 0].repeat(3)),
        (accessor("VEC4", 5126, 3), bytes(weights)),
        (accessor("MAT4", 5126, 2), bytes([unmoved(-1.0), unmoved(0.0)])),
    ];
    file(&lists, |document| {
        document["scenes"][0]["nodes"] = json!([0, 1]);
        document["nodes"] = json!([
            { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
            { "children": [2], "translation": [0, 0, 5] },
            { "children": [3], "translation": [0, 1, 0], "scale": [2, 2, 2] },
            { "translation": [1, 0, 0] },
        ]);
        document["skins"] = json!([{ "joints": [2, 3], "inverseBindMatrices": 3 }]);
        document["meshes"][0]["primitives"][0]["attributes"] =
            json!({ "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 });
        change(document);
    })
}

#[test]
fn a_skin_follows_its_joints_and_not_its_node() {
    let placed = drafted(&skinned(|_| {}));
    // By the first joint 1 down, then twice as large, 1 up, 5 forward: by the second 1 to the right, then the same.
    let first = |x: f64, y: f64| DVec3::new(2.0 * x, 2.0 * (y - 1.0) + 1.0, 5.0);
    let second = |x: f64, y: f64| DVec3::new(2.0 * (x + 1.0), 2.0 * y + 1.0, 5.0);
    let expected = [first(0.0, 0.0), first(1.0, 0.0), (first(0.0, 1.0) + second(0.0, 1.0)) / 2.0];
    assert_eq!(placed, expected);
}

#[test]
fn a_skin_without_inverse_matrices_or_a_mesh_without_joints_is_read() {
    let bare = drafted(&skinned(|document| {
        document["skins"] = json!([{ "joints": [2, 3] }]);
    }));
    assert_eq!(bare[0], DVec3::new(0.0, 1.0, 5.0));
    let unbound = skinned(|document| {
        document["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 });
    });
    assert_eq!(drafted(&unbound)[0], DVec3::new(100.0, 0.0, 0.0));
    let told = "a primitive of a skinned mesh has no joints and weights: it stands where its node";
    assert!(notes_say(&scene("a.glb", unbound), told));
}

#[test]
fn skins_that_do_not_fit_are_refused() {
    let told = refusal("a.glb", skinned(|document| document["skins"][0]["joints"] = json!([2])));
    assert_eq!(told, "a.glb: joint 1 is used, but the skin has only 1");
    let three = json!([1, 2, 3]);
    let told = refusal("a.glb", skinned(|document| document["skins"][0]["joints"] = three));
    let words = "a skin has 3 joints, but 2 inverse bind matrices; export the file again";
    assert_eq!(told, format!("a.glb: {words}"));
}

#[test]
fn sparse_accessors_and_accessors_that_store_nothing_are_read() {
    let moved = [vectors(&TRIANGLE), (json!({}), vec![1, 2]), vectors(&[[7.0; 3], [8.0; 3]])];
    let sparse = |base: bool, indices: u32| {
        file(&moved, |document| {
            let position = &mut document["accessors"][0];
            position["sparse"] = json!({
                "count": 2,
                "indices": { "bufferView": 1, "componentType": indices },
                "values": { "bufferView": 2 },
            });
            if !base {
                position.as_object_mut().unwrap().remove("bufferView");
            }
            // The list of indices is no accessor.
            document["accessors"].as_array_mut().unwrap().truncate(1);
        })
    };
    assert_eq!(drafted(&sparse(true, 5121)), [DVec3::ZERO, DVec3::splat(7.0), DVec3::splat(8.0)]);
    assert_eq!(drafted(&sparse(false, 5121))[1..], [DVec3::splat(7.0), DVec3::splat(8.0)]);
    let told = refusal("a.glb", sparse(true, 5125));
    assert!(told.contains("accessor 0 (positions) reaches beyond the end"), "{told}");
    let mut beyond = moved.clone();
    beyond[1].1 = vec![1, 3];
    let told = refusal(
        "a.glb",
        file(&beyond, |document| {
            document["accessors"][0]["sparse"] = json!({
                "count": 2,
                "indices": { "bufferView": 1, "componentType": 5121 },
                "values": { "bufferView": 2 },
            });
            document["accessors"].as_array_mut().unwrap().truncate(1);
        }),
    );
    assert!(
        told.ends_with("replaces elements that it does not have; export the file again"),
        "{told}"
    );
    let nothing = file(&[vectors(&TRIANGLE)], |document| {
        document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    });
    assert!(refusal("a.glb", nothing).contains("no triangles left of 1 face: 1 of zero area"));
}
