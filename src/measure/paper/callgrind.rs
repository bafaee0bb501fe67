//! Instructions counted by Callgrind, a tool of Valgrind: the same in every run, on any machine.
//!
//! Valgrind runs the program on a processor that it simulates, many times slower than the real one.
//! Callgrind counts there the instructions of threads that ask for it. We ask from within: a *client
//! request* is a sequence of instructions that does nothing on a real processor, and that Valgrind
//! recognises (Valgrind's manual, sections 3.1 and 6.5). The thread that is measured has its own
//! instructions collected, and has Callgrind write down now and then how many came together.
//!
//! The simulated processor has AVX2, and no AVX-512: there the kernels for AVX2 are measured.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Requests as Valgrind and Callgrind number them (`valgrind.h`, `callgrind.h`).
const RUNNING_ON_VALGRIND: u64 = 0x1001;
const DUMP_STATS: u64 = (b'C' as u64) << 24 | (b'T' as u64) << 16;
const TOGGLE_COLLECT: u64 = DUMP_STATS + 2;

/// What Callgrind calls its files: the first that it is asked for is `counts.1`.
const FILE: &str = "counts";

/// What Valgrind itself says goes into this file.
pub const LOG: &str = "log";

/// The command, and its arguments, that go before a program whose threads shall count in a folder.
#[must_use]
pub fn callgrind(folder: &Path) -> [String; 6] {
    // Valgrind replaces what follows a % in names of files.
    let path = |file: &str| folder.join(file).to_string_lossy().replace('%', "%%");
    [
        "valgrind".to_owned(),
        "--tool=callgrind".to_owned(),
        "--collect-atstart=no".to_owned(),
        "--dump-line=no".to_owned(),
        format!("--callgrind-out-file={}", path(FILE)),
        format!("--log-file={}", path(LOG)),
    ]
}

/// Counts the instructions of the thread that made it.
pub struct Callgrind {
    folder: PathBuf,
    files: Cell<u32>,
    /// Of all files so far.
    count: Cell<u64>,
}

impl Callgrind {
    /// Starts counting what this thread does, with files in the folder that [`callgrind`] named; none
    /// if the program does not run under Valgrind.
    #[must_use]
    pub fn start(folder: &Path) -> Option<Self> {
        if request(RUNNING_ON_VALGRIND) == 0 {
            return None;
        }
        request(TOGGLE_COLLECT);
        Some(Self { folder: folder.to_owned(), files: Cell::new(0), count: Cell::new(0) })
    }

    /// The count so far; what reading takes is left out.
    ///
    /// # Errors
    /// If Callgrind's file cannot be read.
    pub fn read(&self) -> io::Result<u64> {
        request(TOGGLE_COLLECT);
        request(DUMP_STATS);
        self.files.set(self.files.get() + 1);
        let path = self.folder.join(format!("{FILE}.{}", self.files.get()));
        let since = total(&fs::read_to_string(&path)?).ok_or_else(|| {
            io::Error::new(io::ErrorKind::InvalidData, format!("no totals in {}", path.display()))
        })?;
        fs::remove_file(path)?;
        self.count.set(self.count.get() + since);
        request(TOGGLE_COLLECT);
        Ok(self.count.get())
    }
}

impl Drop for Callgrind {
    fn drop(&mut self) {
        request(TOGGLE_COLLECT);
    }
}

/// The count in a file of Callgrind's.
fn total(text: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix("totals:"))?.trim().parse().ok()
}

/// Asks something of Valgrind; 0 if the program does not run under it.
#[cfg(target_arch = "x86_64")]
fn request(number: u64) -> u64 {
    let request = [number, 0, 0, 0, 0, 0];
    let mut answer = 0;
    // SAFETY: rdi is rotated by twice its 64 bits and rbx exchanged with itself, so nothing changes on a
    // real processor but the flags. Valgrind reads six words at rax, which live until it answers in rdx.
    unsafe {
        std::arch::asm!(
            "rol rdi, 3",
            "rol rdi, 13",
            "rol rdi, 61",
            "rol rdi, 51",
            "xchg rbx, rbx",
            in("rax") request.as_ptr(),
            inout("rdx") answer,
        );
    }
    answer
}

#[cfg(not(target_arch = "x86_64"))]
fn request(_number: u64) -> u64 {
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_processor_does_not_count() {
        // These tests do not run under Valgrind; what `umbra paper --instructions` counts is tested there.
        assert!(Callgrind::start(Path::new("nowhere")).is_none());
    }

    #[test]
    fn totals_are_found() {
        assert_eq!(total("events: Ir\nfn=(1) main\n0 7\n\ntotals: 891063722\n"), Some(891_063_722));
        assert_eq!(total("events: Ir\n"), None);
    }

    #[test]
    fn names_of_files_survive_valgrind() {
        let command = callgrind(Path::new("/tmp/50%"));
        assert!(command[4].ends_with("=/tmp/50%%/counts"), "{command:?}");
    }
}
