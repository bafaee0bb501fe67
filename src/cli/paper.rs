//! `umbra paper`: Table 2 of the paper beside ours.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::options::{check_outputs, parse_size, print, write_json};
use super::progress::with_bar;
use crate::measure::paper::{
    Conditions, NODE_BYTES, Published, SceneReport, Storage, TABLE, reproduce, storage,
    storage_table,
};
use crate::occlusion::{Backend, Test};
use crate::render::Progress;
use crate::scene::builtin::NAMES;
use crate::shadow::{Method, Plan, Retest};

const DETAILS: &str = "\
Everything runs in one thread; the pictures are the paper's unless a size is given. The whole table
takes an hour; --quick takes seconds, but its rates and gains are those of other pictures.

Examples:
  umbra paper --quick
  umbra paper --scene drum --backends grid,embree --stats drum.json";

/// Rebuilds the four scenes of Pearce & Jevans 1991 and prints their Table 2 beside ours
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Paper {
    /// One of the paper's scenes; may be given several times; all four if not given
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(NAMES))]
    scene: Vec<String>,
    /// The engines, a column each; all but brute if not given
    #[arg(long, value_enum, value_delimiter = ',')]
    backends: Vec<Backend>,
    /// The triangle test of all engines; each one's own choice if not given
    #[arg(long, value_enum)]
    test: Option<Test>,
    /// Size of the pictures, instead of the paper's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Samples along each side of a pixel, instead of the paper's 3
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Reflections and refractions that a ray may go through
    #[arg(long, value_name = "N", default_value_t = 5)]
    depth: u8,
    /// Factor on the paper's triangles
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    tessellation: f64,
    /// How often everything is measured; of each scanline the least counts
    #[arg(long, value_name = "N", default_value_t = 3)]
    repetitions: usize,
    /// Whether a traversal tests again what was tested from memory
    #[arg(long, value_enum, default_value_t)]
    retest: Retest,
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
            depth: self.depth,
            tessellation: self.tessellation,
            repetitions: self.repetitions,
            plan: Plan { retest: self.retest, ..Method::Trace.into() },
        };
        if self.quick {
            conditions.size = conditions.size.or(Some((80, 60)));
            conditions.samples = conditions.samples.or(Some(1));
            conditions.tessellation *= 0.05;
            conditions.repetitions = 1;
        }
        conditions
    }

    fn scenes(&self) -> impl Iterator<Item = &'static Published> {
        let wanted = |name: &str| self.scene.is_empty() || self.scene.iter().any(|s| s == name);
        TABLE.iter().filter(move |published| wanted(published.scene))
    }

    pub fn run(self) -> Result<(), Failure> {
        let conditions = self.conditions();
        conditions.check()?;
        let outputs: Vec<_> = self.stats.iter().map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[])?;
        // One thread, which is the one whose work is counted.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.map_err(|e| Failure::Input(format!("cannot start a thread: {e}")))?;
        let mut scenes = Vec::new();
        for published in self.scenes() {
            let progress = Progress::default();
            let report = with_bar(conditions.pixels(published.scene), &progress, || {
                pool.install(|| reproduce(published, &conditions, &progress))
            })?;
            print(&format!("{report}\n"))?;
            scenes.push(report);
        }
        print(&storage_table())?;
        if let Some(path) = &self.stats {
            let storage = &storage(NODE_BYTES);
            write_json(path, &Report { scenes: &scenes, node_bytes: NODE_BYTES, storage })?;
        }
        match scenes.iter().flat_map(|scene| &scene.columns).find(|column| !column.agree) {
            None => Ok(()),
            Some(column) => Err(Failure::Comparison(format!(
                "not all methods made the same picture over {}",
                column.backend
            ))),
        }
    }
}

/// Whether a column of the table is made for it unasked.
fn is_offered(backend: Backend) -> bool {
    match backend {
        Backend::Grid | Backend::Bvh2 | Backend::Cwbvh => true,
        Backend::Embree => cfg!(feature = "embree"),
        Backend::Brute => false,
    }
}
