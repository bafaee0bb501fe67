//! What the loaders make of small files, sound and damaged.

mod damaged_gltf;
mod foreign_gltf;
mod foreign_obj;
mod gltf;
mod gltf_materials;
mod gltf_shapes;
mod mtl;
mod obj;
mod sensible;
mod toml;

use std::{fs, path::PathBuf};

use glam::{DVec3, Vec3};
use tempfile::TempDir;
use umbra::scene::{Draft, Scene, SceneError, draft, load};

/// Files in a folder that vanishes.
struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(TempDir::new().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        fs::write(self.path(name), content).expect("a temporary file");
        self
    }

    fn load(&self, name: &str) -> Result<Scene, SceneError> {
        load(self.path(name).to_str().expect("a path in UTF-8"))
    }

    fn draft(&self, name: &str) -> Draft {
        draft(self.path(name).to_str().expect("a path in UTF-8")).expect("a sound file")
    }

    /// The message for a file that is refused: one line that names the file once.
    fn refusal(&self, name: &str) -> String {
        let message = match self.load(name) {
            Ok(scene) => panic!("{name} loads with {} triangles", scene.triangles.len()),
            Err(error) => error.to_string(),
        };
        let path = self.path(name).display().to_string();
        assert_eq!(message.matches(&path).count(), 1, "names the file once: {message}");
        assert!(!message.contains('\n'), "one line: {message}");
        message.replace(&path, name)
    }
}

/// Loads one file.
fn scene(name: &str, content: impl AsRef<[u8]>) -> Scene {
    Files::new().write(name, content).load(name).expect("a sound file")
}

/// The message for one refused file.
fn refusal(name: &str, content: impl AsRef<[u8]>) -> String {
    Files::new().write(name, content).refusal(name)
}

/// All corners of a draft, for comparing places.
fn corners(draft: &Draft) -> Vec<DVec3> {
    draft.triangles.iter().flat_map(|triangle| triangle.corners).collect()
}

fn notes_say(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(words))
}

#[test]
fn a_missing_file_is_named() {
    for name in ["nowhere.obj", "nowhere.glb", "nowhere.gltf", "nowhere.toml"] {
        let message = Files::new().refusal(name);
        assert!(message.starts_with(&format!("cannot read {name}: ")), "{message}");
        assert!(message.ends_with("; check its name and its folder"), "{message}");
    }
}

#[test]
fn a_directory_is_no_scene() {
    let files = Files::new();
    for name in ["folder", "folder.glb"] {
        fs::create_dir(files.path(name)).expect("a temporary folder");
        assert!(files.refusal(name).contains("directory"));
    }
}

#[test]
fn an_empty_file_is_said_to_be_empty() {
    for name in ["empty.obj", "empty.glb", "empty.gltf", "empty.toml"] {
        assert_eq!(refusal(name, ""), format!("{name}: the file is empty"));
    }
}

#[test]
fn an_unknown_kind_of_file_is_answered_with_the_known_ones() {
    let message = refusal("scene.ply", "ply");
    assert_eq!(message, "scene.ply: unknown kind of file; umbra reads .obj, .glb, .gltf and .toml");
}

#[test]
fn an_unknown_name_is_answered_with_the_built_in_ones() {
    let message = load("no-such-scene").expect_err("there is none").to_string();
    assert!(
        message.starts_with("no file and no built-in scene is called 'no-such-scene'; built-in")
    );
    for name in umbra::scene::builtin::NAMES {
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn extensions_count_in_any_case() {
    assert_eq!(scene("A.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").triangles.len(), 1);
}

/// What some editors write before UTF-8 text.
const BYTE_ORDER_MARK: &str = "\u{feff}";

#[test]
fn a_byte_order_mark_changes_nothing() {
    let files = Files::new();
    files.write("a.mtl", format!("{BYTE_ORDER_MARK}newmtl red\nKd 1 0 0\n"));
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nmtllib a.mtl\nusemtl red\nf 1 2 3\n";
    files.write("a.obj", format!("{BYTE_ORDER_MARK}{text}"));
    let scene = files.load("a.obj").expect("a sound file");
    assert_eq!(scene.triangles.get(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(scene.material(0).diffuse, Vec3::X);
    let (document, mesh) = (gltf::beside("a.bin"), "[[mesh]]\nfile = \"a.gltf\"\n");
    files.write("a.bin", gltf::triangle_bytes());
    files.write("a.gltf", format!("{BYTE_ORDER_MARK}{document}"));
    files.write("a.toml", format!("{BYTE_ORDER_MARK}{mesh}"));
    for name in ["a.gltf", "a.toml"] {
        assert_eq!(files.load(name).expect("a sound file").triangles.len(), 1);
    }
}
