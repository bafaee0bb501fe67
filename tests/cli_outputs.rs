//! What the command line writes: no input is lost, no output is written half.

mod common;

use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};

use common::command::{TRIANGLE, assert_refusal, contents, refused, run, said, umbra};

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", said(output));
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

#[cfg(unix)]
#[test]
fn two_outputs_through_a_link_to_nothing_yet_are_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "triangle.obj", TRIANGLE);
    std::os::unix::fs::symlink("a.png", folder.join("b.png")).unwrap();
    let line = "render triangle.obj --size 8x6 -o a.png --stats b.png";
    refused(folder, line, &["b.png", "another name"]);
    // A link alone stays one, and what it points to is made.
    succeeded(&run(folder, "render triangle.obj --size 8x6 -o b.png"));
    assert!(folder.join("b.png").is_symlink() && folder.join("a.png").is_file());
}

/// The disk is full for one of them.
#[cfg(target_os = "linux")]
#[test]
fn all_outputs_are_written_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "triangle.obj", TRIANGLE);
    write(folder, "rays.csv", "1,1,1,1,1,-1\n");
    write(folder, "old.csv", "of an earlier run");
    for line in [
        "render triangle.obj --size 8x6 -o x.png --aov --stats /dev/full",
        "query triangle.obj --rays rays.csv -o old.csv --stats /dev/full",
        "scene drum --tessellation 0.01 -o d.obj --stats /dev/full",
        "compare triangle.obj --size 8x6 --backends grid --list old.csv --stats /dev/full",
        "tradeoff triangle.obj --size 8x6 --quick --backends grid --svg /dev/full --csv x.csv",
    ] {
        let before = contents(folder);
        let output = run(folder, line);
        assert_eq!(output.status.code(), Some(2), "umbra {line}: {}", said(&output));
        assert!(said(&output).contains("cannot write /dev/full: No space left"));
        assert!(contents(folder) == before, "umbra {line} changed its folder");
    }
}

/// The geometry of a drum is larger than the 16 KiB that a file may have here, its materials are not.
#[cfg(unix)]
#[test]
fn no_materials_are_written_for_an_obj_that_has_no_room() {
    let folder = tempfile::tempdir().unwrap();
    let script = "trap '' XFSZ; ulimit -f 16; exec \"$0\" scene drum -o d.obj";
    let output = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_umbra")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_refusal(&output, &["cannot write d.obj: File too large"]);
    assert!(contents(folder.path()).is_empty());
}

/// The program waits for more rays when it is killed.
#[cfg(target_os = "linux")]
#[test]
fn a_command_that_is_killed_leaves_nothing_beside_its_output() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "triangle.obj", TRIANGLE);
    let mut command = umbra(folder);
    command.args(["query", "triangle.obj", "--rays", "-", "-o", "out.csv"]);
    let mut child = command.stdin(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut rays = child.stdin.take().unwrap();
    // More than a block, so that answering has begun; it takes what is written only once it asks for more.
    rays.write_all("1,1,1,1,1,-1\n".repeat(1_000_000).as_bytes()).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    let names: Vec<_> = contents(folder).into_keys().collect();
    assert_eq!(names, [folder.join("triangle.obj")]);
}

#[cfg(unix)]
#[test]
fn a_file_that_is_replaced_stays_as_private_as_it_was() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "triangle.obj", TRIANGLE);
    let mode = |name: &str| folder.join(name).metadata().unwrap().permissions().mode() & 0o777;
    for private in [0o600, 0o640, 0o664] {
        write(folder, "x.png", "of an earlier run");
        fs::set_permissions(folder.join("x.png"), fs::Permissions::from_mode(private)).unwrap();
        succeeded(&run(folder, "render triangle.obj --size 8x6 -o x.png --stats new.json"));
        assert_eq!(mode("x.png"), private);
        assert_eq!(mode("new.json"), mode("triangle.obj"), "the umask decides about a new file");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_that_standard_output_does_not_take_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "triangle.obj", TRIANGLE);
    let closed = || Stdio::from(std::io::pipe().unwrap().1);
    for line in [
        "compare triangle.obj --size 8x6 --backends grid --stats s.json",
        "certify --queries 100 --stats s.json",
        "extremes --queries 100 --cases grazing --backends grid --stats s.json",
        "paper --quick --size 8x6 --scene drum --backends grid --stats s.json",
        "tradeoff triangle.obj --size 8x6 --quick --backends grid --tests exact --stats s.json",
    ] {
        let mut command = umbra(folder);
        command.args(line.split_whitespace());
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command.stdout(full).output().unwrap();
        assert_refusal(&output, &["cannot write standard output: No space left"]);
        assert!(!folder.join("s.json").exists(), "umbra {line}");
        // Whoever has seen enough is no failure, and gets the files.
        let mut command = umbra(folder);
        command.args(line.split_whitespace());
        let output = command.stdout(closed()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "umbra {line}: {}", said(&output));
        assert!(!said(&output).contains("cannot") && !said(&output).contains("panicked"));
        fs::remove_file(folder.join("s.json")).unwrap();
    }
}

#[test]
fn a_dash_is_not_the_name_of_an_output() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "mesh.obj", TRIANGLE);
    for line in [
        "render mesh.obj -o a.png --size 8x6 --stats -",
        "certify --queries 10 --stats -",
        "tradeoff mesh.obj --quick --csv -",
    ] {
        refused(folder.path(), line, &["cannot write -", "give the name of a file"]);
    }
}

#[test]
fn a_name_that_is_too_long_is_refused_before_anything_is_rendered_or_replaced() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "mesh.obj", TRIANGLE);
    // Long enough for the picture, and too long for those beside it.
    let name = format!("{}.png", "a".repeat(245));
    write(folder.path(), &name, "an old picture");
    let line = format!("render mesh.obj -o {name} --size 8x6 --aov");
    refused(folder.path(), &line, &["cannot write", ".png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn names_of_files_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;
    let name = |bytes| std::ffi::OsStr::from_bytes(bytes);
    let (mesh, picture, page) = (name(b"\xff.obj"), name(b"\xff.png"), name(b"\xff.html"));
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(mesh), TRIANGLE).unwrap();
    let mut command = umbra(folder.path());
    command.args(["render", "--size", "8x6", "-o"]).args([picture, mesh]);
    succeeded(&command.output().unwrap());
    let mut command = umbra(folder.path());
    command.args(["tradeoff", "--quick", "--size", "8x6", "--backends", "grid", "--html"]);
    succeeded(&command.args([page, mesh]).output().unwrap());
    assert!(folder.path().join(picture).is_file() && folder.path().join(page).is_file());
}

#[test]
fn one_thing_is_no_plural() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "mesh.obj", TRIANGLE);
    write(folder.path(), "rays.csv", "1,1,1,1,1,-1\n");
    let output = run(folder.path(), "render mesh.obj -o a.png --size 8x6");
    assert!(said(&output).contains("mesh.obj: 1 triangle, 1 light, grid"), "{}", said(&output));
    let output = run(folder.path(), "query mesh.obj --rays rays.csv -o out.csv");
    assert!(said(&output).contains("; 1 row, 1 blocked"), "{}", said(&output));
    write(folder.path(), "one.toml", ONE_QUERY);
    let backends = "one.toml --size 1x1 --backends grid";
    for (line, told) in [
        (
            "compare",
            "one.toml: 1 triangle, 1 light, 1x1; 1 shadow query: 0 blocked, 1 clear, 0 ties",
        ),
        ("tradeoff --quick", "one.toml: 1 triangle, 1 light; 1x1, 1 shadow ray, 0.0 % blocked"),
    ] {
        let output = run(folder.path(), &format!("{line} {backends}"));
        succeeded(&output);
        let table = String::from_utf8(output.stdout).unwrap();
        assert!(table.contains(told), "{table}");
    }
}

/// A camera of one pixel above a triangle, under a light.
const ONE_QUERY: &str = "
[camera]
position = [1, 1, 5]
target = [1, 1, 0]
[[mesh]]
triangles = [[[0, 0, 0], [4, 0, 0], [0, 4, 0]]]
[[light]]
kind = \"point\"
position = [0, 0, 3]
intensity = [1, 1, 1]
";

#[test]
fn numbers_have_separators_on_the_terminal_and_none_in_files() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "rays.csv", &"1,1,1,1,1,-1\n".repeat(1234));
    for (line, told) in [
        ("scene jittered-sparse -o sparse.glb", "551,408 triangles, "),
        ("render sparse.glb -o a.png --size 64x48", "551,408 triangles, "),
        ("query sparse.glb --rays rays.csv -o out.csv", "; 1,234 rows, "),
    ] {
        let output = run(folder.path(), &format!("{line} --stats stats.json"));
        succeeded(&output);
        assert!(said(&output).contains(told), "{}", said(&output));
        let stats = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        assert!(stats.contains("\"triangles\": 551408,"), "{stats}");
    }
}

#[test]
fn every_file_of_statistics_says_which_umbra_wrote_it() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "one.toml", ONE_QUERY);
    write(folder.path(), "rays.csv", "1,1,1,1,1,-1\n");
    for line in [
        "render one.toml -o a.png --size 8x6",
        "compare one.toml --size 8x6 --backends grid --threads 3",
        "query one.toml --rays rays.csv -o out.csv",
        "tradeoff one.toml --size 8x6 --quick --backends grid --tests exact",
        "paper --quick --size 8x6 --scene drum --backends grid",
        "paper --quick --size 8x6 --scene drum --backends grid --variants",
        "certify --queries 9 --classes sliver",
        "extremes --queries 9 --cases grazing --backends grid",
        "scene drum -o drum.obj --tessellation 0.01",
    ] {
        succeeded(&run(folder.path(), &format!("{line} --stats stats.json")));
        let text = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(stats["version"], env!("CARGO_PKG_VERSION"), "umbra {line}");
        assert!(!line.starts_with("compare") || stats["threads"] == 3);
        assert_eq!(text.matches("\n  \"version\"").count(), 1, "umbra {line}");
    }
}

#[test]
fn a_picture_without_shadow_queries_is_refused_in_the_same_words() {
    let folder = tempfile::tempdir().unwrap();
    let away = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 9]\n";
    let triangle = "[[mesh]]\ntriangles = [[[0, 0, 0], [4, 0, 0], [0, 4, 0]]]\n";
    let light = "[[light]]\nkind = \"point\"\nposition = [0, 0, 1]\nintensity = [1, 1, 1]\n";
    write(folder.path(), "away.toml", &format!("{away}{triangle}{light}"));
    for line in ["compare away.toml --size 8x6", "tradeoff away.toml --size 8x6 --quick"] {
        let told = "away.toml: no shadow query is asked in this picture; give the scene another";
        refused(folder.path(), &format!("{line} --backends grid"), &[told]);
    }
}
