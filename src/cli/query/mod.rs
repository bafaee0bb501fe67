//! `umbra query`: the user's own rays.

mod csv;
mod npy;
mod rows;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use clap::Args;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::failure::{Failure, say};
use super::options::{Built, EngineOptions, load_triangles, note_transparent};
use super::outputs::{Outputs, STANDARD_OUTPUT, check_outputs, unprinted};
use super::progress::with_rate;
use crate::geometry::Ray;
use crate::measure::{count, grouped};
use crate::occlusion::{Occlusion, Tally};
use crate::whole_file::WholeFile;
use csv::BadLine;
use rows::{Format, Rows};

const DETAILS: &str = "\
Rays are rows of six numbers, ox,oy,oz,tx,ty,tz: an origin and a target. They are either lines of
CSV (a header ox,oy,oz,tx,ty,tz, blank lines and what follows a # are skipped) or a NumPy array
of shape (N, 6), float32 or float64, little-endian, saved as .npy. The answers are of the same kind
and in the same order: a line 0 or 1 for each row, or an array of N uint8.

1: an opaque triangle meets the open segment between origin and target; 0: none does. The ends are
not part of the segment, and the origin is taken as given, without an offset. Transparent triangles
do not block. All of this holds to the letter with --test exact, the default of all engines but embree;
other tests round, and may say either near the edges of triangles, or where an end lies on one.

Coordinates are those of the scene's file. Where umbra moves a scene that is far from the origin, it
moves the rays by as much, in f64; then origin and target are rounded to f32, and so is target - origin, which is
the ray's direction: a target that lies nearer to a triangle than such roundings may come to lie on the other
side of it. A row with NaN or infinity, or in which a number or target - origin is beyond f32, is answered 0;
how many there were is said at the end.
A line that is not six numbers ends the command: it says which, and no file is written (standard output
may have had answers to lines before it).

Examples:
  umbra query chair-room --rays rays.csv -o blocked.csv
  umbra query city.glb --rays rays.npy -o blocked.npy --backend bvh2
  produce-rays | umbra query office.obj --rays - -o - | consume-answers";

/// Says for each ray of a file whether anything stands between its origin and its target
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Query {
    /// A built-in scene, or an .obj, .glb, .gltf or .toml file
    scene: PathBuf,
    /// The rays: CSV or .npy; - for standard input
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// The answers, of the same kind as the rays; - for standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    engine: EngineOptions,
    /// Writes all counts and times as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

/// What was answered.
#[derive(Clone, Copy, Default, Serialize)]
struct Counts {
    rows: u64,
    blocked: u64,
    invalid: u64,
    #[serde(flatten)]
    tally: Tally,
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    triangles: usize,
    opaque_triangles: u32,
    local_origin: [f64; 3],
    notes: &'a [String],
    backend: &'a str,
    test: &'a str,
    #[serde(flatten)]
    engine_options: &'a EngineOptions,
    memory_limit: Option<u64>,
    format: &'a str,
    threads: usize,
    backend_bytes: usize,
    load_seconds: f64,
    build_seconds: f64,
    query_seconds: f64,
    rows_per_second: f64,
    counts: Counts,
}

/// How far a query is; read by whoever shows it.
#[derive(Default)]
struct Done {
    bytes: AtomicU64,
    rows: AtomicU64,
}

impl Query {
    pub fn run(self) -> Result<(), Failure> {
        let (scene, rays) = (&*self.scene, &*self.rays);
        let output = (!is_stream(&self.output)).then_some(&self.output);
        let outputs: Vec<_> = output.into_iter().chain(&self.stats).map(PathBuf::as_path).collect();
        self.engine.check()?;
        check_outputs(&outputs, &[scene, rays])?;
        let rows = Rows::open(rays)?;
        check_name(&self.output, rows.format)?;
        let pool = self.engine.pool()?;
        pool.install(|| self.answer(rows, &outputs))
    }

    fn answer(&self, mut rows: Rows, outputs: &[&Path]) -> Result<(), Failure> {
        let start = Instant::now();
        let mut scene = load_triangles(&self.scene, outputs)?;
        note_transparent(&mut scene, "query");
        let load_seconds = start.elapsed().as_secs_f64();
        let Built { backend, seconds: build_seconds, .. } = self.engine.build(&scene)?;
        let start = Instant::now();
        let done = Done::default();
        let (counts, file) = with_rate(
            rows.size,
            || (done.bytes.load(Relaxed), done.rows.load(Relaxed)),
            || answer_all(&mut rows, &*backend, scene.origin, &self.output, &done),
        )?;
        let mut files = Outputs::default();
        files.push(file);
        let query_seconds = start.elapsed().as_secs_f64();
        let rows_per_second = counts.rows as f64 / query_seconds;
        say!(
            "{}: {}, {} {}; {}, {} blocked, in {query_seconds:.2} s: {:.2} million a second; loaded in {load_seconds:.2} s, built in {build_seconds:.2} s",
            scene.name,
            count(scene.triangles.len() as u64, "triangle"),
            self.engine.backend,
            self.engine.test(),
            count(counts.rows, "row"),
            grouped(counts.blocked),
            rows_per_second / 1e6,
        );
        if counts.invalid > 0 {
            say!(
                "umbra: {}: {} with NaN or infinity, or in which a number or target - origin is beyond f32: answered 0",
                rows.name(),
                count(counts.invalid, "row")
            );
        }
        let Some(stats) = &self.stats else { return files.finish() };
        let report = Report {
            scene: &scene.name,
            triangles: scene.triangles.len(),
            opaque_triangles: scene.triangles.opaque_count(),
            local_origin: scene.origin.to_array(),
            notes: &scene.notes,
            backend: self.engine.backend.name(),
            test: self.engine.test().name(),
            engine_options: &self.engine,
            memory_limit: self.engine.most_bytes(),
            format: rows.format.name(),
            threads: rayon::current_num_threads(),
            backend_bytes: backend.memory(),
            load_seconds,
            build_seconds,
            query_seconds,
            rows_per_second,
            counts,
        };
        files.add_json(stats, &report)?;
        files.finish()
    }
}

fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// Answers are of the kind of the rays; a name that says otherwise would mislead.
fn check_name(output: &Path, format: Format) -> Result<(), Failure> {
    let other = match format {
        Format::Csv => "npy",
        Format::Npy(_) => "csv",
    };
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(other)) {
        return Ok(());
    }
    let path = output.display();
    let kind = format.name();
    Err(Failure::Input(format!(
        "{path}: the rays are .{kind}, so the answers are too; name the output .{kind}"
    )))
}

/// Answers block after block, each in parallel, and writes the answers in order, to a file that is not in its place yet.
fn answer_all(
    rows: &mut Rows,
    backend: &dyn Occlusion,
    origin: DVec3,
    output: &Path,
    done: &Done,
) -> Result<(Counts, WholeFile), Failure> {
    let unwritable = |reason: io::Error| match is_stream(output) {
        true => unprinted(&reason),
        false if reason.kind() == io::ErrorKind::BrokenPipe => Failure::NoReader,
        false => Failure::unwritable(output, &reason),
    };
    let format = rows.format;
    let mut file = if is_stream(output) {
        WholeFile::direct(STANDARD_OUTPUT, io::stdout())
    } else {
        WholeFile::create(output).map_err(unwritable)?
    };
    if let Format::Npy(layout) = format {
        file.write_all(&npy::header(layout.rows)).map_err(unwritable)?;
    }
    let mut counts = Counts::default();
    let mut lines = rows.header_lines;
    loop {
        let block = rows.next_block()?;
        if block.is_empty() {
            break;
        }
        done.bytes.fetch_add(block.len() as u64, Relaxed);
        let answers: Vec<_> = format
            .parts(block)
            .into_par_iter()
            .map(|part| Answers::of(part, format, backend, origin))
            .collect();
        for answers in answers {
            let answers = answers.map_err(|bad| rows.bad_line(lines + bad.number, &bad.problem))?;
            file.write_all(&answers.bytes).map_err(unwritable)?;
            lines += answers.lines;
            counts += answers.counts;
        }
        done.rows.store(counts.rows, Relaxed);
    }
    file.flush().map_err(unwritable)?;
    Ok((counts, file))
}

/// The answers to a part of the rows.
struct Answers {
    bytes: Vec<u8>,
    lines: u64,
    counts: Counts,
}

impl Answers {
    fn of(
        part: &[u8],
        format: Format,
        backend: &dyn Occlusion,
        origin: DVec3,
    ) -> Result<Self, BadLine> {
        let (rows, lines) = format.decode(part)?;
        let rays: Vec<_> = rows.iter().map(|row| ray(row, origin)).collect();
        let mut blocked = vec![false; rays.len()];
        let mut tally = Tally::default();
        backend.occluded_many(&rays, &mut blocked, &mut tally);
        let bytes = match format {
            Format::Csv => blocked.iter().flat_map(|&b| [b'0' + u8::from(b), b'\n']).collect(),
            Format::Npy(_) => blocked.iter().map(|&b| b.into()).collect(),
        };
        let counts = Counts {
            rows: rays.len() as u64,
            blocked: blocked.iter().filter(|&&b| b).count() as u64,
            invalid: rays.iter().filter(|ray| !ray.is_valid()).count() as u64,
            tally,
        };
        Ok(Self { bytes, lines, counts })
    }
}

/// From world coordinates to a query: moved in f64, rounded once.
fn ray(&[ox, oy, oz, tx, ty, tz]: &[f64; 6], origin: DVec3) -> Ray {
    let local = |x, y, z| (DVec3::new(x, y, z) - origin).as_vec3();
    Ray::between(local(ox, oy, oz), local(tx, ty, tz))
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rows += other.rows;
        self.blocked += other.blocked;
        self.invalid += other.invalid;
        self.tally += other.tally;
    }
}
