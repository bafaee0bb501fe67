//! The file of rays, block by block: as much memory for a hundred million rows as for one million.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::csv::{self, BadLine};
use super::npy::{self, Layout};
use crate::cli::failure::Failure;
use crate::measure::count;
use crate::scene::text::{UTF_16, is_utf_16};

/// Bytes that are read at once.
const BLOCK_BYTES: usize = 4 << 20;

/// Bytes that one thread decodes and answers at once: about a thousand rows.
const PART_BYTES: usize = 48 << 10;

/// What every .zip file begins with, and so every .npz.
const ZIP_MAGIC: &[u8] = b"PK";

/// How rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// Text.
    Csv,
    /// An array of NumPy.
    Npy(Layout),
}

impl Format {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npy(_) => "npy",
        }
    }

    /// Cuts a block into parts of whole rows.
    pub fn parts(self, block: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Csv => csv::parts(block, PART_BYTES),
            Self::Npy(layout) => {
                block.chunks(PART_BYTES.next_multiple_of(layout.row_bytes())).collect()
            }
        }
    }

    /// Decodes a part; gives the number of its lines.
    pub fn decode(self, part: &[u8]) -> Result<(Vec<[f64; 6]>, u64), BadLine> {
        let mut rows = Vec::new();
        let lines = match self {
            Self::Csv => csv::decode(part, &mut rows)?,
            Self::Npy(layout) => {
                layout.decode(part, &mut rows);
                rows.len() as u64
            }
        };
        Ok((rows, lines))
    }
}

/// A path as messages name it.
fn named(path: &Path) -> &Path {
    if path == Path::new("-") { Path::new("standard input") } else { path }
}

/// A file of rays being read.
pub(super) struct Rows<'a> {
    path: &'a Path,
    source: Box<dyn Read + Send>,
    /// How rows are written.
    pub format: Format,
    /// Bytes of the file, if that is known.
    pub size: Option<u64>,
    /// Lines before the first block.
    pub header_lines: u64,
    buffer: Vec<u8>,
    /// Bytes at the beginning of the buffer that were handed out already.
    used: usize,
    ended: bool,
    /// Rows of an array still to come.
    remaining: u64,
}

impl<'a> Rows<'a> {
    /// Opens a file, or standard input for `-`, and finds out how rows are written.
    pub fn open(path: &'a Path) -> Result<Self, Failure> {
        let unreadable = |reason: io::Error| Failure::unreadable(named(path), &reason);
        let (source, size): (Box<dyn Read + Send>, _) = if path == Path::new("-") {
            (Box::new(io::stdin()), None)
        } else if path.is_dir() {
            return Err(unreadable(io::Error::other("it is a folder; name a .csv or .npy file")));
        } else {
            let file = File::open(path).map_err(unreadable)?;
            let size = file.metadata().ok().filter(std::fs::Metadata::is_file);
            (Box::new(file), size.map(|metadata| metadata.len()))
        };
        let mut rows = Self {
            path,
            source,
            format: Format::Csv,
            size,
            header_lines: 0,
            buffer: Vec::new(),
            used: 0,
            ended: false,
            remaining: 0,
        };
        rows.fill()?;
        let is_named = |kind| path.extension().is_some_and(|end| end.eq_ignore_ascii_case(kind));
        if rows.buffer.starts_with(npy::MAGIC) {
            let (layout, length) =
                Layout::read(&rows.buffer).map_err(|problem| rows.bad(&problem))?;
            (rows.format, rows.used, rows.remaining) = (Format::Npy(layout), length, layout.rows);
        } else if is_named("npz") || rows.buffer.starts_with(ZIP_MAGIC) {
            let array = "save the array of rays alone, with numpy.save, as .npy";
            return Err(rows.bad(&format!("archives such as .npz are not read; {array}")));
        } else if is_named("npy") {
            return Err(rows.bad(&format!(
                "this is no .npy file: it does not begin with '\\x93NUMPY'; {}",
                npy::SAVE_AGAIN
            )));
        } else if is_utf_16(&rows.buffer) {
            return Err(rows.bad(UTF_16));
        } else {
            (rows.used, rows.header_lines) = csv::header(&rows.buffer);
        }
        Ok(rows)
    }

    /// The next whole rows; empty at the end.
    pub fn next_block(&mut self) -> Result<&[u8], Failure> {
        self.fill()?;
        self.used = match self.format {
            Format::Csv if self.ended => self.buffer.len(),
            Format::Csv => match csv::last_line_end(&self.buffer) {
                Some(line_end) => line_end + 1,
                None => return Err(self.bad("a line is longer than 4 MiB; give CSV or .npy")),
            },
            Format::Npy(layout) => self.whole_rows(layout)?,
        };
        Ok(&self.buffer[..self.used])
    }

    /// Bytes of the rows of an array that are in the buffer.
    fn whole_rows(&mut self, layout: Layout) -> Result<usize, Failure> {
        let (held, row_bytes) = (self.buffer.len(), layout.row_bytes());
        let rows = self.remaining.min((held / row_bytes) as u64);
        if rows == 0 && self.remaining > 0 {
            return Err(self.bad(&format!(
                "it is cut short: {} rows of {}; {}",
                layout.rows - self.remaining,
                layout.rows,
                npy::SAVE_AGAIN
            )));
        }
        if rows == 0 && held > 0 {
            let whole = count(layout.rows, "row");
            let again = npy::SAVE_AGAIN;
            return Err(self.bad(&format!("there is more after its {whole}; {again}")));
        }
        self.remaining -= rows;
        Ok(rows as usize * row_bytes)
    }

    /// Forgets what was handed out, and reads until the buffer is full or the file ends.
    fn fill(&mut self) -> Result<(), Failure> {
        self.buffer.drain(..self.used);
        self.used = 0;
        let wanted = (BLOCK_BYTES - self.buffer.len()) as u64;
        let read = self.source.by_ref().take(wanted).read_to_end(&mut self.buffer);
        let read = read.map_err(|reason| Failure::unreadable(named(self.path), &reason))?;
        self.ended = (read as u64) < wanted;
        Ok(())
    }

    /// What messages call the file.
    pub fn name(&self) -> impl Display {
        named(self.path).display()
    }

    /// A line of the file is bad.
    pub fn bad_line(&self, number: u64, problem: &str) -> Failure {
        self.bad(&format!("line {number}: {problem}"))
    }

    /// The file is bad.
    pub fn bad(&self, problem: &str) -> Failure {
        Failure::Input(format!("{}: {problem}", self.name()))
    }
}
