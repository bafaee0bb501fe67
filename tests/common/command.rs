//! Runs the program itself, and looks at what it leaves.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// One triangle in the plane z = 0.
pub const TRIANGLE: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n";

/// The program, in a folder.
pub fn umbra(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbra"));
    command.current_dir(folder);
    command
}

/// Runs a command line, split at blanks.
pub fn run(folder: &Path, line: &str) -> Output {
    umbra(folder).args(line.split_whitespace()).output().expect("umbra starts")
}

/// Everything in a folder.
pub fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.insert(path.clone(), Vec::new());
            found.extend(contents(&path));
        } else {
            let bytes = std::fs::read(&path).unwrap_or_default();
            found.insert(path, bytes);
        }
    }
    found
}

/// What the program said.
pub fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("messages are UTF-8")
}

/// The program refused: status 2, nothing on standard output, and a last line that holds all of `told`.
pub fn assert_refusal(output: &Output, told: &[&str]) {
    let said = said(output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(output.stdout.is_empty(), "{said}");
    let last = said.lines().last().unwrap_or_default();
    assert!(last.starts_with("umbra: ") && !said.contains("panicked"), "{said}");
    for part in told {
        assert!(last.contains(part), "'{part}' is not in: {said}");
    }
}

/// Runs a command line that must be refused, with one line alone, and leave the folder as it was.
pub fn refused(folder: &Path, line: &str, told: &[&str]) {
    let before = contents(folder);
    let output = run(folder, line);
    assert_refusal(&output, told);
    assert_eq!(said(&output).lines().count(), 1, "umbra {line}: {}", said(&output));
    assert!(contents(folder) == before, "umbra {line} changed its folder");
}

/// An array of NumPy, version 1, whose data are given.
pub fn npy(kind: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}
