//! `umbra paper`: Table 2 of the paper beside ours.

use std::io;
use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::lists::known;
use super::numbers::{finite, whole};
use super::options::{MOST_DEPTH, only_over, parse_resolution, parse_size};
use super::outputs::{check_outputs, print_beside_files, write_json};
use super::progress::with_bar;
use super::shadows::retest_over_embree;
use crate::measure::paper::{
    Conditions, LOG, NODE_BYTES, Published, SceneReport, Storage, TABLE, VariantReport, callgrind,
    compare_variants, reproduce, storage, storage_table,
};
use crate::occlusion::{Backend, BuildOptions, GridOptions, Test};
use crate::render::{MOST_SAMPLES, Progress};
use crate::scene::builtin::NAMES;
use crate::shadow::{CombinationError, Method, Plan, Retest, VerdictKind, VerdictSet};

const DETAILS: &str = "\
Everything runs in one thread; the pictures are the paper's unless a size is given. All methods render
in turns, a few milliseconds each; of each piece of the picture the least of all repetitions counts. The
± is half the difference between the even and the odd repetitions. The whole table takes hours;
--every 9 makes it of a ninth of the scanlines, which changes rates and gains little; --quick takes
seconds, but its rates and gains are those of other pictures.

--instructions counts instructions instead of time, which gives the same figures every time, whatever
else the machine does. It runs umbra again under Valgrind, which must be installed. That takes some sixty
times as long as rendering once, so take a part: --every 36. Valgrind has no AVX-512; the kernels for AVX2
are measured.

--variants compares what else the paper mentions: the tolerance check, Woo's variant, forgetting at
scanlines, serpentine scanlines, tiles, mailboxes, leaving out the spawner. 'a ray' is the work of all
rendering by ray, 'saved' its share saved over trace, 'object' and 'voxel' the paper's success rates,
'recalled' the share of blocked queries that a memory answered, 'tests' triangle tests a query.

Examples:
  umbra paper --quick
  umbra paper --every 9 --scene drum --backends grid,embree --stats drum.json
  umbra paper --every 9 --scene chair-room --backends grid --variants
  umbra paper --every 9 --scene chair-room --backends cwbvh --instructions";

/// Rebuilds the four scenes of Pearce & Jevans 1991 and prints their Table 2 beside ours
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Paper {
    /// One of the paper's scenes; may be given several times; all four if not given
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(NAMES))]
    scene: Vec<String>,
    /// The engines, a column each; all but brute if not given
    #[arg(long, value_delimiter = ',', value_parser = known::<Backend>())]
    backends: Vec<Backend>,
    /// The triangle test of all engines; each one's own choice if not given
    #[arg(long, value_enum)]
    test: Option<Test>,
    /// Size of the pictures, instead of the paper's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Samples along each side of a pixel, instead of the paper's: 3, and 1 for the drum
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_SAMPLES))]
    samples: Option<u32>,
    /// Renders one scanline of every so many only
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1u32..))]
    every: u32,
    /// Reflections and refractions that a ray may go through
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole(0..=MOST_DEPTH))]
    depth: u8,
    /// Factor on the paper's triangles, from 0.01 to 100
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        default_value_if("quick", "true", "0.05"),
        value_parser = finite::<f64>
    )]
    tessellation: f64,
    /// How often everything is measured; of each piece of a picture the least counts
    #[arg(long, value_name = "N", default_value_t = 3, default_value_if("quick", "true", "1"), value_parser = whole(1usize..))]
    repetitions: usize,
    /// Whether a traversal tests again what was tested from memory
    #[arg(long, value_enum, default_value_t)]
    retest: Retest,
    /// Verdicts that every method asks first, like voxel-occlusion; none if not given
    #[arg(long, default_value_t, hide_default_value = true, value_parser = parse_verdicts)]
    verdicts: VerdictSet,
    /// Compares what else the paper mentions, instead of printing its table
    #[arg(long, conflicts_with_all = ["retest", "verdicts"])]
    variants: bool,
    /// Counts instructions instead of time, by running under Valgrind: the same figures every time
    #[arg(long, conflicts_with = "repetitions")]
    instructions: bool,
    /// Where Callgrind writes: given by the umbra that runs this one under Valgrind
    #[arg(long, hide = true, value_name = "FOLDER", requires = "instructions")]
    callgrind_folder: Option<PathBuf>,
    /// Voxels of the grid along x, y and z, instead of a choice by the number of triangles
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_resolution)]
    grid: Option<[u32; 3]>,
    /// A plain uniform grid, like the paper's: crowded voxels are not divided
    #[arg(long)]
    uniform: bool,
    /// Small pictures of scenes with few triangles, measured once: to see that it works
    #[arg(long)]
    quick: bool,
    /// Writes the table as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

#[derive(Serialize)]
struct Report<'a> {
    scenes: &'a [SceneReport],
    node_bytes: usize,
    storage: &'a [Storage],
}

#[derive(Serialize)]
struct Variants<'a> {
    scenes: &'a [VariantReport],
}

impl Paper {
    fn conditions(&self) -> Conditions {
        let backends = match &self.backends[..] {
            [] => Backend::ALL.into_iter().filter(|&backend| is_offered(backend)).collect(),
            chosen => chosen.to_vec(),
        };
        let mut conditions = Conditions {
            backends,
            test: self.test,
            size: self.size,
            samples: self.samples,
            every: self.every,
            depth: self.depth,
            tessellation: self.tessellation,
            repetitions: self.repetitions,
            plan: Plan { retest: self.retest, verdicts: self.verdicts, ..Method::Trace.into() },
            build: BuildOptions {
                grid: GridOptions {
                    resolution: self.grid,
                    nested: !self.uniform,
                    ..GridOptions::default()
                },
                ..BuildOptions::default()
            },
            callgrind: self.callgrind_folder.clone(),
        };
        if self.quick {
            conditions.size = conditions.size.or(Some((80, 60)));
            conditions.samples = conditions.samples.or(Some(1));
        }
        conditions
    }

    fn scenes(&self) -> impl Iterator<Item = &'static Published> {
        let wanted = |name: &str| self.scene.is_empty() || self.scene.iter().any(|s| s == name);
        TABLE.iter().filter(move |published| wanted(published.scene))
    }

    pub fn run(self) -> Result<(), Failure> {
        let conditions = self.conditions();
        conditions.check(self.scenes())?;
        if self.variants {
            conditions.check_variants(self.scenes())?;
        }
        let options = [("--grid", self.grid.is_some()), ("--uniform", self.uniform)];
        only_over(Backend::Grid, &conditions.backends, &options)?;
        let is_embree = |backend: &Backend| *backend == Backend::Embree;
        if self.retest != Retest::default() && conditions.backends.iter().all(is_embree) {
            return Err(retest_over_embree());
        }
        let outputs: Vec<_> = self.stats.iter().map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[])?;
        if self.instructions && self.callgrind_folder.is_none() {
            return run_under_callgrind();
        }
        // One thread, which is the one whose work is counted.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.map_err(|e| Failure::Input(format!("cannot start a thread: {e}")))?;
        if self.variants {
            return self.compare_variants(&conditions, &pool);
        }
        let mut scenes = Vec::new();
        for published in self.scenes() {
            let progress = Progress::default();
            let report = with_bar(conditions.pixels(published.scene), &progress, || {
                pool.install(|| reproduce(published, &conditions, &progress))
            })?;
            print_beside_files(&format!("{report}\n"), self.stats.is_some())?;
            scenes.push(report);
        }
        print_beside_files(&storage_table(), self.stats.is_some())?;
        if let Some(path) = &self.stats {
            let storage = &storage(NODE_BYTES);
            write_json(path, &Report { scenes: &scenes, node_bytes: NODE_BYTES, storage })?;
        }
        let columns = scenes.iter().flat_map(|scene| &scene.columns);
        agreed(columns.map(|column| (column.agree, column.backend)))
    }

    fn compare_variants(
        &self,
        conditions: &Conditions,
        pool: &rayon::ThreadPool,
    ) -> Result<(), Failure> {
        let mut reports: Vec<VariantReport> = Vec::new();
        for published in self.scenes() {
            let progress = Progress::default();
            let scene = published.scene;
            let of_scene = with_bar(conditions.pixels_of_variants(scene), &progress, || {
                pool.install(|| compare_variants(scene, conditions, &progress))
            })?;
            for report in &of_scene {
                print_beside_files(&format!("{report}\n"), self.stats.is_some())?;
            }
            reports.extend(of_scene);
        }
        if let Some(path) = &self.stats {
            write_json(path, &Variants { scenes: &reports })?;
        }
        agreed(reports.iter().map(|report| (report.agree, report.backend)))
    }
}

/// Verdicts alone: of anything else it is said that memories are none.
fn parse_verdicts(text: &str) -> Result<VerdictSet, String> {
    let names = VerdictKind::ALL.map(VerdictKind::name).join(", ");
    let to_give = format!("give verdicts ({names}), joined by +");
    text.parse().map_err(|error: CombinationError| error.with_advice(&to_give))
}

/// Runs this very command again, under Valgrind.
fn run_under_callgrind() -> Result<(), Failure> {
    let unable = |reason: String| Failure::Input(format!("cannot count instructions: {reason}"));
    let folder = tempfile::tempdir().map_err(|e| unable(format!("no temporary folder: {e}")))?;
    let umbra = std::env::current_exe().map_err(|e| unable(format!("umbra is not found: {e}")))?;
    let [valgrind, options @ ..] = callgrind(folder.path());
    let status = Command::new(valgrind)
        .args(options)
        .arg(umbra)
        .args(std::env::args_os().skip(1))
        .arg("--callgrind-folder")
        .arg(folder.path())
        .status();
    match status.map(|status| status.code()) {
        Ok(Some(0)) => Ok(()),
        Ok(Some(code @ (1 | 2))) => Err(Failure::Reported(code as u8)),
        Ok(_) => {
            let log = std::fs::read_to_string(folder.path().join(LOG)).unwrap_or_default();
            let last = log.lines().last().unwrap_or("it says nothing");
            Err(unable(format!("Valgrind ended early: {last}")))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Err(unable(
            "Valgrind is not installed; install it (Debian, Ubuntu: apt install valgrind), or leave \
             --instructions out: time is measured then"
                .to_owned(),
        )),
        Err(error) => Err(unable(format!("Valgrind does not start: {error}"))),
    }
}

/// Fails if not all methods agreed over one of the backends.
fn agreed(mut reports: impl Iterator<Item = (bool, &'static str)>) -> Result<(), Failure> {
    match reports.find(|(agree, _)| !agree) {
        None => Ok(()),
        Some((_, backend)) => Err(Failure::Comparison(format!(
            "not all methods made the same picture over {backend}"
        ))),
    }
}

/// Whether a column of the table is made for it unasked.
fn is_offered(backend: Backend) -> bool {
    backend != Backend::Brute && backend.is_built_in()
}
