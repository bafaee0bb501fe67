//! `umbra tradeoff`: speed against accuracy, measured, plotted and reported.

use std::path::PathBuf;

use clap::Args;

use super::failure::{Failure, say};
use super::numbers::whole;
use super::options::{ContenderOptions, MOST_DEPTH, MOST_THREADS, load_scene, parse_size, pool};
use super::outputs::{Outputs, check_outputs, print_beside_files};
use super::progress::with_bar;
use crate::measure::contender::{Choice, Contender, Selection};
use crate::measure::tradeoff::{Conditions, Report, csv, measure, page, plot, table};
use crate::render::{MOST_SAMPLES, Progress, Settings};
use crate::shadow::{Combination, Method};

const DETAILS: &str = "\
Three trades in one run: engines with their tests and shadow methods (speed, wrong answers, memory); the
tessellation of curved surfaces, for the built-in scenes that have some; and samples of a pixel. All that is
compared takes turns, so a machine that slows down slows all of them alike; medians are shown, and how far
measurements spread. Wrong is what differs from exact arithmetic on the rays' bits; rays that only touch a
triangle at their end are ties, counted apart.

The default is the whole product of engines, tests, methods and ways to use Embree, and takes minutes;
--quick takes seconds, but its figures are rough. Methods are all memories and all verdicts, one at a time;
ways to use Embree every quality and width of the best instruction set, all but the default without methods.

Exit status: 1 if an `exact` answer was wrong, or answers changed from pass to pass; 2 for bad input.

Examples:
  umbra tradeoff chair-room --quick --html tradeoff.html
  umbra tradeoff drum --html drum.html --svg drum.svg --csv drum.csv --stats drum.json
  umbra tradeoff sponza.glb --backends grid,embree --tests exact,pluecker --methods trace --threads 1";

/// Measures speed against wrong answers, tessellation and samples: table, plot, report
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Tradeoff {
    /// A built-in scene, or an .obj, .glb, .gltf or .toml file
    scene: PathBuf,
    #[command(flatten)]
    contenders: ContenderOptions,
    /// Size of the picture whose shadow rays are answered
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Samples along each side of a pixel: 3 gives 9 samples
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1..=MOST_SAMPLES))]
    samples: u32,
    /// Reflections and refractions that a ray may go through
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole(0..=MOST_DEPTH))]
    depth: u8,
    /// How often everything is measured
    #[arg(long, value_name = "N", value_parser = whole(1usize..))]
    repetitions: Option<usize>,
    /// Threads; all processors if not given
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_THREADS))]
    threads: Option<usize>,
    /// A small picture, measured once, of fewer contenders: to see what it shows
    #[arg(long)]
    quick: bool,
    /// Writes everything measured as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    /// Writes the points of all trades as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Writes the charts as SVG
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Writes a report with charts, tables and pictures: one file that a browser opens without network
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Tradeoff {
    pub fn run(self) -> Result<(), Failure> {
        let Selection { mut contenders, left_out } = self.choice()?.select();
        contenders.retain(|contender| self.is_wanted(contender));
        if contenders.is_empty() {
            return Err(Failure::Input(format!("nothing to measure: {}", left_out.join("; "))));
        }
        let conditions = self.conditions(contenders);
        conditions.check()?;
        let outputs = [&self.stats, &self.csv, &self.svg, &self.html];
        let outputs: Vec<_> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[&self.scene])?;
        let pool = pool(self.threads)?;
        let scene = load_scene(&self.scene, &outputs)?;
        // Of combinations that nobody named, nobody misses those that do not exist.
        for reason in left_out.iter().filter(|_| !self.contenders.methods.is_empty()) {
            say!("umbra: left out: {reason}");
        }
        let progress = Progress::default();
        let report = with_bar(conditions.steps(&scene), &progress, || {
            pool.install(|| measure(&scene, &conditions, &progress))
        })?;
        print_beside_files(&table(&report), !outputs.is_empty())?;
        self.write(&report)?;
        report.failure().map_or(Ok(()), |why| Err(Failure::Comparison(why)))
    }

    fn write(&self, report: &Report) -> Result<(), Failure> {
        let mut outputs = Outputs::default();
        if let Some(path) = &self.stats {
            outputs.add_json(path, report)?;
        }
        let mut add = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
            None => Ok(()),
            Some(path) => outputs.add(path, text().as_bytes()),
        };
        add(&self.csv, &|| csv(report))?;
        add(&self.svg, &|| plot(report))?;
        add(&self.html, &|| page(report, &command_line()))?;
        outputs.finish()
    }

    /// Whether a contender is measured unasked: what stands before Embree gains the same whatever Embree's
    /// variant, so it is measured before the default one.
    fn is_wanted(&self, contender: &Contender) -> bool {
        #[cfg(feature = "embree")]
        let is_default = !self.contenders.embree_variants.is_empty()
            || contender.options.embree == Default::default();
        #[cfg(not(feature = "embree"))]
        let is_default = true;
        is_default
            || !self.contenders.methods.is_empty()
            || contender.method == Combination::default()
    }

    fn conditions(&self, contenders: Vec<Contender>) -> Conditions {
        let (width, height) = self.size.unwrap_or(if self.quick { (160, 120) } else { (400, 300) });
        let settings = Settings {
            width,
            height,
            samples: self.samples,
            depth: self.depth,
            ..Settings::default()
        };
        let conditions = Conditions {
            contenders,
            settings,
            repetitions: self.repetitions.unwrap_or(3),
            tessellations: vec![0.01, 0.03, 0.1, 0.3, 1.0, 3.0],
            reference_tessellation: 10.0,
            samples: vec![1, 2, 3, 4],
            reference_samples: 8,
        };
        if !self.quick {
            return conditions;
        }
        Conditions {
            repetitions: self.repetitions.unwrap_or(1),
            tessellations: vec![0.01, 0.1, 1.0],
            reference_tessellation: 3.0,
            samples: vec![1, 2, 3],
            reference_samples: 6,
            ..conditions
        }
    }

    fn choice(&self) -> Result<Choice, Failure> {
        let mut choice = self.contenders.choice()?;
        if choice.methods.is_empty() {
            choice.methods = match self.quick {
                true => [Method::Trace, Method::VoxelCache].map(Combination::from).to_vec(),
                false => Choice::every_method(),
            };
        }
        #[cfg(feature = "embree")]
        if choice.embree.is_empty() {
            use crate::measure::contender::EmbreeVariant;
            use crate::occlusion::Quality;
            choice.embree = EmbreeVariant::of_best_isa();
            let is_default = |variant: &EmbreeVariant| variant.0.quality == Quality::default();
            choice.embree.retain(|variant| !self.quick || is_default(variant));
        }
        Ok(choice)
    }
}

/// What this process was started with, as one would write it.
fn command_line() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| {
        let argument = argument.display().to_string();
        let is_plain = |c: char| c.is_alphanumeric() || "-_./,=:".contains(c);
        match !argument.is_empty() && argument.chars().all(is_plain) {
            true => argument,
            false => format!("'{}'", argument.replace('\'', r"'\''")),
        }
    });
    std::iter::once("umbra".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}
