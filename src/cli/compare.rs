//! `umbra compare`: the same shadow rays through several engines, and the truth about each.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, say};
use super::numbers::whole;
use super::options::{
    ContenderOptions, MOST_DEPTH, MOST_THREADS, load_scene, note_transparent, parse_size, pool,
};
use super::outputs::{Outputs, check_outputs, print_beside_files};
use super::progress::{with_bar, with_rate};
use crate::measure::compare::{CompareError, Report, compare};
use crate::measure::contender::Selection;
use crate::measure::recording::Recording;
use crate::render::{MOST_SAMPLES, Picture, Progress, Settings, encode_picture};

const DETAILS: &str = "\
All combinations of backends, tests, methods and Embree variants that exist answer the shadow rays of one
picture. The truth is exact arithmetic on the rays' bits. A ray that touches a triangle only at its start or at the
light is a tie: what an f32 test says of it is counted apart.

A wrong answer is explained if it is what the contender claims to compute: for a test of ours, what that test
says of every triangle, with no engine; for Embree's single rays, what lies between two bounds that are
computed bit for bit; for its packets, what rounding can do. Nothing explains a wrong answer of `exact`.

An Embree variant is a name like avx2-high-8-coherent: instruction set (sse2, sse4.2, avx, avx2, avx512), build
quality (low, medium, high), rays at once (1, 4, 8, 16), coherent or not. What is left out is the default:
the best instruction set, medium, 1. `all` is every one that this CPU has. Without --methods the engines stand alone.

Exit status: 1 if an `exact` answer was wrong or a wrong answer is not explained; 2 for bad input.

Examples:
  umbra compare chair-room
  umbra compare sponza.glb --tests exact,pluecker --size 320x240 --difference sponza.png --list sponza.csv
  umbra compare jittered-dense --backends embree --embree-variants all --stats embree.json
  umbra compare drum --backends grid,embree --methods trace,voxel-cache,cache-tree";

/// Compares the answers of engines, tests and methods, ray by ray, with the exact truth
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Compare {
    /// A built-in scene, or an .obj, .glb, .gltf or .toml file
    scene: PathBuf,
    #[command(flatten)]
    contenders: ContenderOptions,
    /// Size of the picture whose shadow rays are compared
    #[arg(long, value_name = "WxH", value_parser = parse_size, default_value = "160x120")]
    size: (u32, u32),
    /// Samples along each side of a pixel: 3 gives 9 samples
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1..=MOST_SAMPLES))]
    samples: u32,
    /// Reflections and refractions that a ray may go through
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole(0..=MOST_DEPTH))]
    depth: u8,
    /// Threads; all processors if not given
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_THREADS))]
    threads: Option<usize>,
    /// Disagreements to print
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = whole(0usize..))]
    show: usize,
    /// Writes every disagreement as CSV: pixel, light, ray and its bits, triangle, exact verdict
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// Writes a picture of where answers are wrong: .png or .exr
    #[arg(long, value_name = "FILE")]
    difference: Option<PathBuf>,
    /// Writes the whole report as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

#[derive(Serialize)]
struct Statistics<'a> {
    notes: &'a [String],
    samples_per_pixel: u32,
    depth: u8,
    threads: usize,
    left_out: &'a [String],
    #[serde(flatten)]
    report: &'a Report,
}

impl Compare {
    pub fn run(self) -> Result<(), Failure> {
        let Selection { contenders, left_out } = self.contenders.choice()?.select();
        if contenders.len() < 2 {
            let reasons = left_out.iter().map(|reason| format!(" ({reason})")).collect::<String>();
            return Err(Failure::Input(format!(
                "{}{reasons}",
                CompareError::Few(contenders.len())
            )));
        }
        let settings = Settings {
            width: self.size.0,
            height: self.size.1,
            samples: self.samples,
            depth: self.depth,
            ..Settings::default()
        };
        settings.check()?;
        let picture = self.difference.as_ref().map(|path| Picture::of(path, 8)).transpose()?;
        let outputs = [&self.list, &self.difference, &self.stats];
        let outputs: Vec<_> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[&self.scene])?;
        let pool = pool(self.threads)?;

        let mut scene = load_scene(&self.scene, &outputs)?;
        note_transparent(&mut scene, "compare");
        Recording::check(&scene, &settings)?;
        for reason in &left_out {
            say!("umbra: left out: {reason}");
        }
        let progress = Progress::default();
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let recording = with_bar(pixels, &progress, || {
            pool.install(|| Recording::of(&scene, &settings, &progress))
        })?;
        let answered = AtomicU64::new(0);
        let done = || (answered.load(Relaxed), answered.load(Relaxed));
        let whole = contenders.len() * recording.queries().len();
        let report = with_rate(Some(whole as u64), done, || {
            pool.install(|| compare(&scene, &recording, &contenders, &answered))
        })?;

        let text = format!("{report}{}", report.listing(self.show));
        print_beside_files(&text, !outputs.is_empty())?;
        let mut outputs = Outputs::default();
        if let Some(path) = &self.list {
            outputs.add(path, report.csv().as_bytes())?;
        }
        if let (Some(path), Some(kind)) = (&self.difference, picture) {
            let picture = report.difference_picture(&recording);
            outputs.add(path, &encode_picture(&picture, 1.0, kind))?;
        }
        if let Some(path) = &self.stats {
            let statistics = Statistics {
                notes: &scene.notes,
                samples_per_pixel: self.samples * self.samples,
                depth: self.depth,
                threads: pool.current_num_threads(),
                left_out: &left_out,
                report: &report,
            };
            outputs.add_json(path, &statistics)?;
        }
        outputs.finish()?;
        conclude(&report)
    }
}

/// Exit status 1 if the comparison failed.
fn conclude(report: &Report) -> Result<(), Failure> {
    report.failure().map_or(Ok(()), |why| Err(Failure::Comparison(why)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::compare::{Claim, Comparison};
    use crate::scene::builtin;

    #[test]
    fn a_wrong_exact_answer_ends_the_command_as_a_failed_comparison() {
        let scene = builtin::draft_at("drum", 0.01).unwrap().finish().unwrap();
        let settings = Settings { width: 8, height: 6, ..Settings::default() };
        let recording = Recording::of(&scene, &settings, &Progress::default()).unwrap();
        let truth: Vec<bool> = recording.queries().iter().map(|query| query.blocked).collect();
        let conclusion = |answers: &[bool]| {
            let mut comparison = Comparison::new(&scene, &recording);
            comparison.enter("it", Claim::Exact, answers);
            conclude(&comparison.finish())
        };
        assert!(conclusion(&truth).is_ok());
        let lies: Vec<bool> = truth.iter().map(|blocked| !blocked).collect();
        assert!(matches!(conclusion(&lies), Err(Failure::Comparison(_))));
    }
}
