//! Bad input on the command line: one clear line, exit status 2, nothing written.

mod common;

use std::fs;
use std::path::Path;
use std::process::Stdio;

use common::command::{TRIANGLE, assert_refusal, npy, refused, run, said, umbra};
use tempfile::TempDir;

/// Both commands that read a scene and write a file.
const COMMANDS: [&str; 2] = ["render SCENE -o out.png", "query SCENE --rays rays.csv -o out.csv"];

const ROW: &str = "1,1,1,1,1,-1\n";

/// A folder with a scene, rays, and outputs of an earlier run.
fn workplace() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("triangle.obj", TRIANGLE.as_bytes());
    write("rays.csv", ROW.as_bytes());
    write("out.png", b"of an earlier run");
    write("out.csv", b"of an earlier run");
    folder
}

fn scene_refused(name: &str, bytes: Option<&[u8]>, told: &[&str]) {
    let folder = workplace();
    if let Some(bytes) = bytes {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    for command in COMMANDS {
        refused(folder.path(), &command.replace("SCENE", name), told);
    }
}

fn render_refused(arguments: &str, told: &[&str]) {
    let line = format!("render triangle.obj -o out.png {arguments}");
    refused(workplace().path(), &line, told);
}

/// A GLB of the given length field.
fn glb(length: u32) -> Vec<u8> {
    [b"glTF", &2u32.to_le_bytes()[..], &length.to_le_bytes(), &[0; 8]].concat()
}

#[test]
fn scenes_that_are_not_there() {
    scene_refused("missing.obj", None, &["cannot read missing.obj"]);
    scene_refused("missing.glb", None, &["cannot read missing.glb"]);
    scene_refused("missing.toml", None, &["cannot read missing.toml"]);
    let builtin = "jittered-sparse, jittered-dense, drum, chair-room";
    scene_refused("teapot", None, &["'teapot'", builtin]);
}

#[test]
fn scenes_that_are_directories() {
    let folder = workplace();
    for name in ["rooms", "rooms.obj", "rooms.glb"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        for command in COMMANDS {
            let line = command.replace("SCENE", name);
            refused(folder.path(), &line, &[&format!("cannot read {name}: this is a directory")]);
        }
    }
}

#[test]
fn scenes_that_are_damaged() {
    for name in ["empty.obj", "empty.glb", "empty.gltf", "empty.toml"] {
        scene_refused(name, Some(b""), &[name, "the file is empty"]);
    }
    scene_refused("short.glb", Some(&glb(5000)), &["short.glb", "cut short"]);
    scene_refused("short.glb", Some(b"glTF"), &["short.glb", "cut short"]);
    scene_refused(
        "magic.glb",
        Some(b"PNG and more bytes than a header has"),
        &["magic.glb", "glTF"],
    );
    scene_refused("glb.obj", Some(&glb(5000)), &["glb.obj", "a GLB"]);
    scene_refused("binary.obj", Some(b"v 0 0 0\n\0"), &["binary.obj", "byte 8 is 0"]);
    scene_refused("scene.fbx", Some(b"Kaydara"), &["scene.fbx", ".obj, .glb, .gltf and .toml"]);
    scene_refused("bad.obj", Some(b"v 0 0 0\nv 1 x 0\n"), &["bad.obj", "line 2"]);
    scene_refused("bad.toml", Some(b"up = [0, 1, 0]\nmesh = 3\n"), &["bad.toml", "line 2"]);
}

#[test]
fn scenes_without_triangles() {
    scene_refused(
        "points.obj",
        Some(b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        &["points.obj", "no triangles"],
    );
    let flat = b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    scene_refused("flat.obj", Some(flat), &["flat.obj", "no triangles", "1 of zero area"]);
    let range = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\nf 0 1 2\nf -4 -1 -2\n";
    scene_refused("range.obj", Some(range), &["range.obj", "index out of range"]);
}

#[test]
fn sizes_samples_and_depths() {
    for size in ["0x0", "0x10", "10x0", "100000x100000"] {
        render_refused(&format!("--size {size}"), &[size, "at least 1", "pixels"]);
    }
    for size in ["10", "x", "10x", "-1x5", "99999999999x1", "1.5x2"] {
        render_refused(&format!("--size={size}"), &["--size", size.trim_matches('x')]);
    }
    for samples in ["0", "65", "4294967295"] {
        render_refused(&format!("--samples {samples}"), &["samples", samples, "1 to 64"]);
    }
    for samples in ["-1", "many", "1.5", "4294967296"] {
        render_refused(&format!("--samples={samples}"), &["--samples", samples, "1 to 64"]);
    }
    render_refused("--depth 200", &["--depth", "200", "0 to 31"]);
    for exposure in ["0", "nan", "inf", "-1"] {
        render_refused(&format!("--exposure {exposure}"), &["--exposure", "finite", "above 0"]);
    }
    for threads in ["abc", "-3"] {
        render_refused(&format!("--threads {threads}"), &["--threads", threads, "1 to 1024"]);
    }
    for threads in ["0", "1025", "100000000"] {
        render_refused(&format!("--threads {threads}"), &["--threads", threads, "1 to 1024"]);
    }
    render_refused("--grid 0,1,1", &["--grid", "1 to 1024"]);
    render_refused(
        "--grid 1024,1024,1024",
        &["--grid", "1024x1024x1024 voxels", "at most 134217728"],
    );
    let line = "render drum -o new.png --tree-depth 32";
    refused(workplace().path(), line, &["--tree-depth", "32", "0 to 31"]);
    let line = "paper --quick --scene drum --every 0";
    assert_refusal(&run(workplace().path(), line), &["--every", "at least 1"]);
    let line = "paper --quick --scene drum --every 61";
    assert_refusal(&run(workplace().path(), line), &["every 61", "1 to 60"]);
    render_refused("--bits 9", &["--bits", "8, 16"]);
}

#[test]
fn unknown_names_come_with_the_known_ones() {
    render_refused("--backend octree", &["'octree'", "grid, embree, bvh2, cwbvh, brute"]);
    render_refused("--test maybe", &["'maybe'", "moller, pluecker, watertight, exact"]);
    render_refused("--order random", &["'random'", "scanline", "tiles"]);
    render_refused("--shadows none", &["'none'", "trace"]);
    let line = "render triangle.obj -o new.png --backend embree --test exact";
    assert_refusal(&run(workplace().path(), line), &["embree", "pluecker", "moller"]);
    render_refused("--colour red", &["'--colour'"]);
    let folder = workplace();
    refused(folder.path(), "draw triangle.obj", &["'draw'"]);
    refused(folder.path(), "scene teapot -o a.obj", &["'teapot'", "chair-room"]);
    refused(folder.path(), "scene drum -o a.obj --tessellation 200", &["200", "0.01 and 100"]);
    refused(folder.path(), "render triangle.obj", &["--output"]);
    refused(folder.path(), "query triangle.obj -o out.csv", &["--rays"]);
}

#[test]
fn outputs_that_cannot_be() {
    for (command, name) in COMMANDS.iter().zip(["out.png", "out.csv"]) {
        let folder = workplace();
        fs::create_dir(folder.path().join("folder.png")).unwrap();
        let command = command.replace("SCENE", "triangle.obj");
        let to = |place: &str| command.replace(&format!("-o {name}"), &format!("-o {place}"));
        let folder = folder.path();
        refused(folder, &to(&format!("missing/{name}")), &["missing", "make it first"]);
        refused(folder, &to("folder.png"), &["folder.png", "is a folder"]);
        refused(folder, &to(&format!("rays.csv/{name}")), &["rays.csv", "no folder"]);
        // Nobody may make files there, not even root.
        if Path::new("/proc/self").exists() {
            refused(
                folder,
                &to(&format!("/proc/{name}")),
                &[&format!("cannot write /proc/{name}")],
            );
        }
        refused(folder, &format!("{command} --stats missing/a.json"), &["missing/a.json"]);
        refused(folder, &format!("{command} --stats {name}"), &[name, "another name"]);
        refused(folder, &format!("{command} --stats ./{name}"), &[name, "another name"]);
        refused(folder, &format!("{command} --stats triangle.obj"), &["another name"]);
    }
    render_refused("-o out.jpg", &["--output"]);
    let folder = workplace();
    refused(folder.path(), "render triangle.obj -o out.jpg", &["out.jpg", ".png or .exr"]);
    refused(folder.path(), "render triangle.obj -o out", &["out", ".png or .exr"]);
    let line = "render triangle.obj -o a.png --aov --stats a.mask.png";
    refused(folder.path(), line, &["a.mask.png", "another name"]);
    refused(folder.path(), "scene drum -o drum.stl", &["drum.stl", ".obj or .glb"]);
    refused(folder.path(), "scene drum -o missing/drum.glb", &["missing", "make it first"]);
    refused(folder.path(), "scene drum -o a.obj --stats a.mtl", &["a.mtl", "another name"]);
    let line = "query triangle.obj --rays rays.csv -o rays.csv";
    refused(folder.path(), line, &["rays.csv", "another name"]);
}

#[test]
fn rays_that_are_no_rays() {
    let row = [0u8; 48];
    let whole = |shape: &str, data: &[u8]| npy("'<f8'", "False", shape, data);
    let cases: [(&str, Vec<u8>, &[&str]); 18] = [
        ("empty.npy", vec![], &["no .npy file", "numpy.save"]),
        ("rays.npz", b"PK\x03\x04".into(), &["archives such as .npz are not read", "numpy.save"]),
        ("archive", b"PK\x03\x04".into(), &["archives", "as .npy"]),
        ("five.csv", format!("{ROW}{ROW}1,2,3,4,5\n").into(), &["line 3", "'1,2,3,4,5'"]),
        ("seven.csv", format!("{ROW}1,2,3,4,5,6,7\n{ROW}").into(), &["line 2", "six numbers"]),
        ("word.csv", format!("\n#\n{ROW}1,2,three,4,5,6").into(), &["line 4", "three"]),
        ("named.csv", format!("ox,oy,oz,tx,ty,tz\n{ROW}a,b,c,d,e,f\n").into(), &["line 3"]),
        ("blanks.csv", b"1 2 3 4 5 6\n".into(), &["line 1", "commas"]),
        ("bytes.csv", [ROW.as_bytes(), &[255; 70]].concat(), &["line 2", "not text"]),
        (
            "late.csv",
            format!("{}oops\n{ROW}", ROW.repeat(500_000)).into(),
            &["line 500001", "oops"],
        ),
        ("magic.npy", ROW.into(), &["no .npy file"]),
        ("short.npy", whole("(3, 6)", &row.repeat(2)), &["cut short: 2 rows of 3", "numpy.save"]),
        ("shorter.npy", whole("(3, 6)", &row.repeat(3)[..143]), &["cut short: 2 rows of 3"]),
        ("long.npy", whole("(3, 6)", &row.repeat(4)), &["more after its 3 rows", "numpy.save"]),
        ("longer.npy", whole("(1, 6)", &row.repeat(2)), &["more after its 1 row;"]),
        ("three.npy", whole("(2, 3)", &row), &["its shape is (2, 3)", "(N, 6)"]),
        ("order.npy", npy("'<f8'", "True", "(1, 6)", &row), &["Fortran", "ascontiguousarray"]),
        ("whole.npy", npy("'<i8'", "False", "(1, 6)", &row), &["'<i8'", "astype"]),
    ];
    let folder = workplace();
    for (name, bytes, told) in cases {
        fs::write(folder.path().join(name), bytes).unwrap();
        // The scene is loaded before a bad row is found: so its notes come before the last line.
        let before = common::command::contents(folder.path());
        let output = run(folder.path(), &format!("query triangle.obj --rays {name} -o out"));
        assert_refusal(&output, &[&[name], told].concat());
        assert!(common::command::contents(folder.path()) == before, "{name}");
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    fs::create_dir(folder.path().join("folder.csv")).unwrap();
    let line = "query triangle.obj --rays folder.csv -o out";
    refused(folder.path(), line, &["folder.csv", "is a folder"]);
    let line = "query triangle.obj --rays missing.csv -o out";
    refused(folder.path(), line, &["cannot read missing.csv"]);
    let line = "query triangle.obj --rays rays.csv -o out.npy";
    refused(folder.path(), line, &["out.npy", "the rays are .csv"]);
    // What the rays are is said first: of an archive, that answers cannot be .npy would be beside the point.
    fs::write(folder.path().join("rays.npz"), b"PK").unwrap();
    let line = "query triangle.obj --rays rays.npz -o out.npy";
    refused(folder.path(), line, &["rays.npz", "archives such as .npz are not read"]);
    fs::write(folder.path().join("rays.npy"), whole("(1, 6)", &row)).unwrap();
    let line = "query triangle.obj --rays rays.npy -o out.csv";
    refused(folder.path(), line, &["out.csv", "the rays are .npy"]);
}

/// A file that may not grow beyond 1 KiB stands for a full disk: writing fails half way.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_leaves_nothing() {
    let folder = workplace();
    fs::write(folder.path().join("rays.csv"), ROW.repeat(50_000)).unwrap();
    for (command, name) in COMMANDS.iter().zip(["out.png", "out.csv"]) {
        let before = common::command::contents(folder.path());
        let line = command.replace("SCENE", "triangle.obj");
        let script = format!("trap '' XFSZ; ulimit -f 1; exec \"$0\" {line}");
        let output = std::process::Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_umbra")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_refusal(&output, &[&format!("cannot write {name}: File too large")]);
        assert!(
            !common::command::said(&output).contains(".umbra-"),
            "a file nobody knows is named"
        );
        assert!(common::command::contents(folder.path()) == before, "{line}");
    }
}

/// The device on which every write finds the disk full.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_to_be_full() {
    let output = run(workplace().path(), "query triangle.obj --rays rays.csv -o /dev/full");
    assert_refusal(&output, &["cannot write /dev/full", "No space left", "make room"]);
    let line = "query triangle.obj --rays rays.csv -o out --stats /dev/full";
    assert_refusal(&run(workplace().path(), line), &["cannot write /dev/full", "No space left"]);
}

#[cfg(target_os = "linux")]
#[test]
fn help_that_standard_output_does_not_take_is_a_failure() {
    let folder = workplace();
    for line in ["--help", "--version", "render --help"] {
        let mut command = umbra(folder.path());
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command.args(line.split(' ')).stdout(full).output().unwrap();
        assert_refusal(&output, &["cannot write standard output: No space left"]);
    }
}

/// Permission bits do not bind root; so there the program runs as a user whom they bind.
#[cfg(target_os = "linux")]
#[test]
fn files_and_folders_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::CommandExt;
    const NOBODY: u32 = 65534;
    let folder = workplace();
    let allow = |name: &str, mode: u32| {
        fs::set_permissions(folder.path().join(name), fs::Permissions::from_mode(mode)).unwrap();
    };
    fs::write(folder.path().join("secret.obj"), TRIANGLE).unwrap();
    allow("secret.obj", 0o000);
    allow("out.csv", 0o444);
    let program = folder.path().join("umbra");
    fs::copy(env!("CARGO_BIN_EXE_umbra"), &program).unwrap();
    fs::create_dir(folder.path().join("open")).unwrap();
    allow("open", 0o777);
    allow("", 0o555);
    let bits_bind = fs::File::open(folder.path().join("secret.obj")).is_err();
    for (line, told) in [
        ("render secret.obj -o open/a.png", "cannot read secret.obj: Permission denied"),
        ("query secret.obj --rays rays.csv -o open/a", "cannot read secret.obj: Permission denied"),
        (
            "query triangle.obj --rays secret.obj -o open/a",
            "cannot read secret.obj: Permission denied",
        ),
        ("scene drum -o drum.glb", "cannot write drum.glb: Permission denied"),
        ("render triangle.obj -o new.png", "cannot write new.png: Permission denied"),
        (
            "query triangle.obj --rays rays.csv -o new.csv",
            "cannot write new.csv: Permission denied",
        ),
        (
            "query triangle.obj --rays rays.csv -o out.csv",
            "cannot write out.csv: Permission denied",
        ),
    ] {
        let mut command = std::process::Command::new(&program);
        command.current_dir(folder.path()).args(line.split(' '));
        if !bits_bind {
            command.uid(NOBODY).gid(NOBODY);
        }
        let before = common::command::contents(folder.path());
        assert_refusal(&command.output().unwrap(), &[told]);
        assert!(common::command::contents(folder.path()) == before, "{line}");
    }
    allow("", 0o755);
}

#[test]
fn a_built_in_scene_becomes_a_file_that_is_the_same_scene() {
    use umbra::scene::{builtin::draft_at, load};
    let folder = tempfile::tempdir().unwrap();
    for name in ["chair.obj", "chair.glb"] {
        let line = format!("scene chair-room -o {name} --tessellation 0.1 --stats stats.json");
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{}", said(&output));
        let written = load(folder.path().join(name).to_str().unwrap()).unwrap();
        let scene = draft_at("chair-room", 0.1).unwrap().finish().unwrap();
        assert!(written.triangles.corners() == scene.triangles.corners());
        let stats = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
        assert_eq!(stats["triangles"], scene.triangles.len());
    }
}

#[test]
fn help_and_version() {
    let folder = workplace();
    let output = run(folder.path(), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("Usage: umbra"), "{}", said(&output));
    for (line, told) in [
        ("--help", "Usage: umbra"),
        ("render --help", "Examples:"),
        ("query --help", "Examples:"),
        ("scene --help", "Examples:"),
        ("--version", env!("CARGO_PKG_VERSION")),
    ] {
        let output = run(folder.path(), line);
        assert_eq!(output.status.code(), Some(0));
        assert!(output.stderr.is_empty());
        assert!(String::from_utf8_lossy(&output.stdout).contains(told), "umbra {line}");
    }
}

/// Whoever reads the output may leave at any time.
#[test]
fn closed_pipes_are_no_panic() {
    let folder = workplace();
    let closed = || Stdio::from(std::io::pipe().unwrap().1);
    for (line, status) in [
        ("--help", 0),
        ("--version", 0),
        ("", 2),
        ("render missing.obj -o out.png", 2),
        ("query triangle.obj --rays rays.csv -o -", 0),
        ("query triangle.obj --rays rays.csv -o new.csv", 0),
    ] {
        let mut command = umbra(folder.path());
        command.args(line.split_whitespace()).stdout(closed()).stderr(closed());
        assert_eq!(command.status().unwrap().code(), Some(status), "umbra {line}");
    }
}
