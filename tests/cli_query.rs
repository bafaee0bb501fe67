//! `umbra query` gives the library's own answers, in order, in constant memory.

mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

use common::Random;
use common::command::{TRIANGLE, assert_refusal, npy, run, said, umbra};
use glam::Vec3;
use umbra::geometry::Ray;
use umbra::occlusion::{Backend, BuildOptions, Tally, build};
use umbra::scene;

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", said(output));
}

/// Points in and around the box of a scene.
fn points(scene: &scene::Scene, count: usize) -> Vec<[Vec3; 2]> {
    let bounds = scene.bounds();
    let (centre, size) = (0.5 * (bounds.min + bounds.max), bounds.max - bounds.min);
    let mut random = Random(7);
    let mut point = || centre + size * random.in_cube(0.55);
    (0..count).map(|_| [point(), point()]).collect()
}

fn csv(rows: &[[Vec3; 2]]) -> String {
    let mut text = "ox,oy,oz,tx,ty,tz\n".to_owned();
    for [origin, target] in rows {
        let [o, t] = [origin.as_dvec3(), target.as_dvec3()];
        writeln!(text, "{},{},{},{},{},{}", o.x, o.y, o.z, t.x, t.y, t.z).unwrap();
    }
    text
}

fn numbers(rows: &[[Vec3; 2]]) -> impl Iterator<Item = f32> {
    rows.iter().flatten().flat_map(|point| point.to_array())
}

/// The data of an array of answers.
fn answers_of_npy(bytes: &[u8], rows: usize) -> &[u8] {
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!(header % 64, 0);
    let text = std::str::from_utf8(&bytes[10..header]).unwrap();
    let expected = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({rows},), }}");
    assert_eq!(text.trim_end(), expected);
    &bytes[header..]
}

#[test]
fn answers_are_those_of_the_library_in_order() {
    let scene = scene::load("chair-room").unwrap();
    let rows = points(&scene, 120_000);
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("rays.csv"), csv(&rows)).unwrap();
    let shape = format!("({}, 6)", rows.len());
    let single: Vec<u8> = numbers(&rows).flat_map(f32::to_le_bytes).collect();
    let double: Vec<u8> = numbers(&rows).flat_map(|n| f64::from(n).to_le_bytes()).collect();
    fs::write(folder.join("single.npy"), npy("'<f4'", "False", &shape, &single)).unwrap();
    fs::write(folder.join("double.npy"), npy("'<f8'", "False", &shape, &double)).unwrap();

    for backend in [Backend::Grid, Backend::Cwbvh] {
        let options = BuildOptions::default();
        let engine = build(backend, backend.default_test(), &scene.triangles, &options).unwrap();
        let mut tally = Tally::default();
        let wanted: Vec<u8> = rows
            .iter()
            .map(|&[origin, target]| {
                engine.occluded(&Ray::between(origin, target), &mut tally).into()
            })
            .collect();
        let blocked = wanted.iter().filter(|&&answer| answer == 1).count();
        assert!((rows.len() / 10..rows.len() * 9 / 10).contains(&blocked), "{blocked}");
        let line = |rays: &str, out: &str| {
            format!(
                "query chair-room --backend {backend} --rays {rays} -o {out} --stats stats.json"
            )
        };
        succeeded(&run(folder, &line("rays.csv", "out.csv")));
        let text: String = wanted.iter().map(|answer| format!("{answer}\n")).collect();
        assert!(fs::read_to_string(folder.join("out.csv")).unwrap() == text);
        for rays in ["single.npy", "double.npy"] {
            succeeded(&run(folder, &line(rays, "out.npy")));
            let bytes = fs::read(folder.join("out.npy")).unwrap();
            assert!(answers_of_npy(&bytes, rows.len()) == wanted);
        }
        let stats = fs::read_to_string(folder.join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
        assert_eq!(stats["counts"]["rows"], rows.len());
        assert_eq!(stats["counts"]["blocked"], blocked);
        assert_eq!(stats["counts"]["invalid"], 0);
        assert_eq!(stats["backend"], backend.name());
    }
}

/// At 4,000 km f32 knows a quarter of a metre; a centimetre beside the edge is told apart all the same.
#[test]
fn coordinates_are_those_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (x, y) = (500_000.0, 4_000_000.0);
    let corner = |right: f64, up: f64| format!("v {} {} 100\n", x + right, y + up);
    let square = [corner(0.0, 0.0), corner(10.0, 0.0), corner(10.0, 10.0), corner(0.0, 10.0)];
    fs::write(folder.join("far.obj"), format!("{}f 1 2 3 4\n", square.concat())).unwrap();
    let (mut text, mut data, mut wanted) = (String::new(), Vec::new(), Vec::new());
    for (right, up, blocked) in
        [(5.0, 9.99, 1), (5.0, 10.01, 0), (0.01, 5.0, 1), (-0.01, 5.0, 0), (9.99, 0.01, 1)]
    {
        let row = [x + right, y + up, 99.5, x + right, y + up, 100.5];
        writeln!(text, "{}", row.map(|n: f64| n.to_string()).join(",")).unwrap();
        data.extend(row.iter().flat_map(|n| n.to_le_bytes()));
        wanted.push(blocked);
    }
    fs::write(folder.join("rays.csv"), text).unwrap();
    fs::write(folder.join("rays.npy"), npy("'<f8'", "False", "(5, 6)", &data)).unwrap();
    succeeded(&run(folder, "query far.obj --rays rays.csv -o out.csv"));
    assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), "1\n0\n1\n0\n1\n");
    succeeded(&run(folder, "query far.obj --rays rays.npy -o out.npy"));
    assert_eq!(answers_of_npy(&fs::read(folder.join("out.npy")).unwrap(), 5), wanted);
}

/// Open ends, no offset, opaque triangles only, and numbers that are none.
#[test]
fn the_contract_of_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "[materials.glass]\ntransmission = [0.9, 0.9, 0.9]\n\
        [[mesh]]\ntriangles = [[[0, 0, 0], [4, 0, 0], [0, 4, 0]]]\n\
        [[mesh]]\nmaterial = \"glass\"\ntriangles = [[[0, 0, 5], [4, 0, 5], [0, 4, 5]]]\n";
    fs::write(folder.join("scene.toml"), scene).unwrap();
    let rows = "\
        1,1,1,1,1,-1\n\
        1,1,1,1,1,0\n\
        1,1,0,1,1,-1\n\
        1,1,1e-30,1,1,-1\n\
        1,1,6,1,1,4\n\
        1,1,1,1,1,1\n\
        1,1,nan,1,1,-1\n\
        1,1,inf,1,1,-1\n\
        1,1,1e300,1,1,-1\n";
    fs::write(folder.join("rays.csv"), rows).unwrap();
    let output = run(folder, "query scene.toml --rays rays.csv -o out.csv");
    succeeded(&output);
    assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), "1\n0\n0\n1\n0\n0\n0\n0\n0\n");
    assert!(said(&output).contains("3 rows with NaN"), "{}", said(&output));
}

#[test]
fn no_rays_have_no_answers_and_are_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("triangle.obj"), TRIANGLE).unwrap();
    for text in ["", "ox,oy,oz,tx,ty,tz\n", "# none\n\n", "ox,oy,oz,tx,ty,tz\n# none"] {
        fs::write(folder.join("none.csv"), text).unwrap();
        let output = run(folder, "query triangle.obj --rays none.csv -o out.csv");
        succeeded(&output);
        assert!(fs::read(folder.join("out.csv")).unwrap().is_empty(), "{text}");
        assert!(said(&output).contains("; 0 rows, 0 blocked"), "{}", said(&output));
    }
    fs::write(folder.join("none.npy"), npy("'<f4'", "False", "(0, 6)", &[])).unwrap();
    succeeded(&run(folder, "query triangle.obj --rays none.npy -o none.out"));
    assert!(answers_of_npy(&fs::read(folder.join("none.out")).unwrap(), 0).is_empty());
}

#[test]
fn nothing_is_said_of_a_camera_or_light_that_rays_do_not_need() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let dropped = "f 1 1 2\n";
    fs::write(folder.join("triangle.obj"), format!("{TRIANGLE}{dropped}")).unwrap();
    fs::write(folder.join("rays.csv"), "1,1,1,1,1,-1\n").unwrap();
    let output = run(folder, "query triangle.obj --rays rays.csv -o out.csv --stats stats.json");
    succeeded(&output);
    assert_eq!(said(&output).lines().count(), 2, "what was dropped, and what was answered");
    assert!(said(&output).contains("dropped 1 face"), "{}", said(&output));
    let stats = fs::read_to_string(folder.join("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
    assert_eq!(stats["notes"].as_array().unwrap().len(), 1, "{}", stats["notes"]);
}

/// Whoever asks what is blocked would not guess that a solid thing is not.
#[test]
fn transparent_triangles_are_said_to_block_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.mtl"), "newmtl glass\nd 0.5\n").unwrap();
    let glass = "usemtl glass\nf 1 2 3\n";
    fs::write(folder.join("rays.csv"), "1,1,1,1,1,-1\n").unwrap();
    for (faces, told) in [
        (glass.to_owned(), "1 of 2 triangles is transparent: it attenuates light and blocks"),
        (glass.repeat(2), "2 of 3 triangles are transparent: they attenuate light and block"),
    ] {
        let text = format!("mtllib a.mtl\n{TRIANGLE}{faces}");
        fs::write(folder.join("scene.obj"), text).unwrap();
        let output = run(folder, "query scene.obj --rays rays.csv -o out.csv --stats stats.json");
        succeeded(&output);
        let told = format!("{told} nothing in `query`");
        assert!(said(&output).contains(&told), "{}", said(&output));
        let stats = fs::read_to_string(folder.join("stats.json")).unwrap();
        assert!(stats.contains(&told), "{stats}");
    }
    let output = run(folder, "compare scene.obj --backends grid,bvh2 --size 4x3");
    assert!(said(&output).contains("block nothing in `compare`"), "{}", said(&output));
}

/// Each as spreadsheets and older machines write it.
#[test]
fn rays_are_read_as_others_write_them_or_refused_with_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("triangle.obj"), TRIANGLE).unwrap();
    let line = "query triangle.obj --rays rays.csv -o out.csv";
    let rows = "ox,oy,oz,tx,ty,tz\n1,1,1,1,1,-1 # down\n1,1,1,1,1,2\n";
    for text in [rows.to_owned(), rows.replace('\n', "\r"), rows.replace('\n', "\r\n")] {
        fs::write(folder.join("rays.csv"), text).unwrap();
        succeeded(&run(folder, line));
        assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), "1\n0\n");
    }
    for (separator, found) in [(";", "semicolons"), ("\t", "tabs"), (" ", "blanks")] {
        fs::write(folder.join("rays.csv"), ["1"; 6].join(separator)).unwrap();
        let told = format!("has {found} between its numbers; give commas");
        assert_refusal(&run(folder, line), &["line 1: ", &told, "delimiter=','"]);
    }
    let words: Vec<u8> = rows.encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(folder.join("rays.csv"), words).unwrap();
    assert_refusal(&run(folder, line), &["rays.csv: this is UTF-16; save it as UTF-8"]);
}

/// Both ends are finite f32 numbers, and yet there is no ray between them.
#[test]
fn a_segment_longer_than_f32_is_said_to_be_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("triangle.obj"), TRIANGLE).unwrap();
    fs::write(folder.join("rays.csv"), "0,1e38,-3e38,0,1e38,3e38\n").unwrap();
    let output = run(folder, "query triangle.obj --rays rays.csv -o out.csv");
    succeeded(&output);
    let told = "1 row with NaN or infinity, or in which a number or target - origin is beyond f32";
    assert!(said(&output).contains(told), "{}", said(&output));
}

/// No row is lost as a header, and no column read as another.
#[test]
fn a_first_row_is_answered_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("triangle.obj"), TRIANGLE).unwrap();
    let line = "query triangle.obj --rays rays.csv -o out.csv";
    fs::write(folder.join("rays.csv"), "\"1\",\"1\",\"1\",\"1\",\"1\",\"-1\"\n1,1,1,1,1,2\n")
        .unwrap();
    succeeded(&run(folder, line));
    assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), "1\n0\n");
    for first in ["1e,--2,1f,2_0,$3,x", "tx,ty,tz,ox,oy,oz"] {
        fs::write(folder.join("rays.csv"), format!("{first}\n1,1,1,1,1,2\n")).unwrap();
        let told = ["rays.csv: line 1: ", first, "give ox,oy,oz,tx,ty,tz in this order"];
        assert_refusal(&run(folder, line), &told);
    }
}

#[test]
fn rays_and_answers_go_through_pipes() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), TRIANGLE).unwrap();
    let mut command = umbra(folder.path());
    command.args(["query", "triangle.obj", "--rays", "-", "-o", "-"]);
    let pipe = std::process::Stdio::piped;
    let mut child = command.stdin(pipe()).stdout(pipe()).stderr(pipe()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"1,1,1,1,1,-1\n1,1,1,1,1,2").unwrap();
    let output = child.wait_with_output().unwrap();
    succeeded(&output);
    assert_eq!(output.stdout, b"1\n0\n");
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"1,1,1,1,1,-1\noops\n").unwrap();
    let said = said(&child.wait_with_output().unwrap());
    assert!(said.contains("umbra: standard input: line 2: 'oops'"), "{said}");
}

/// A link stays a link; a device stays a device.
#[cfg(unix)]
#[test]
fn what_an_output_is_stays() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("triangle.obj"), TRIANGLE).unwrap();
    fs::write(folder.join("rays.csv"), "1,1,1,1,1,-1\n").unwrap();
    fs::write(folder.join("file"), "before").unwrap();
    symlink("file", folder.join("link")).unwrap();
    succeeded(&run(folder, "query triangle.obj --rays rays.csv -o link"));
    assert!(folder.join("link").is_symlink());
    assert_eq!(fs::read_to_string(folder.join("file")).unwrap(), "1\n");
    succeeded(&run(folder, "query triangle.obj --rays rays.csv -o /dev/null"));
    assert!(Path::new("/dev/null").metadata().unwrap().file_type().is_char_device());
}

/// Peak memory in KiB of a query of that many rows, taken while the last of them are on their way.
#[cfg(target_os = "linux")]
fn peak_memory(folder: &Path, rows: usize) -> usize {
    use std::io::Write as _;
    use std::process::Stdio;
    let mut command = umbra(folder);
    command.args(["query", "triangle.obj", "--threads", "2", "--rays", "-", "-o", "out.npy"]);
    let mut child = command.stdin(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    pipe.write_all(&npy("'<f4'", "False", &format!("({rows}, 6)"), &[])).unwrap();
    let block = [1.0f32, 1.0, 1.0, 1.0, 1.0, -1.0].map(f32::to_le_bytes).concat().repeat(10_000);
    for _ in 0..rows / 10_000 {
        pipe.write_all(&block).unwrap();
    }
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let peak = peak.trim().trim_end_matches(" kB").parse().unwrap();
    drop(pipe);
    assert!(child.wait().unwrap().success());
    let bytes = fs::read(folder.join("out.npy")).unwrap();
    assert!(answers_of_npy(&bytes, rows).iter().all(|&answer| answer == 1));
    peak
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_rows() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), TRIANGLE).unwrap();
    let few = peak_memory(folder.path(), 600_000);
    let many = peak_memory(folder.path(), 6_000_000);
    // The rows themselves take 130,000 KiB more.
    assert!(many < few + 16_384, "{few} KiB for few rows, {many} KiB for many");
}
