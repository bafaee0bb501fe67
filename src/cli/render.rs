//! `umbra render`: a picture of a scene.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, say};
use super::numbers::{positive, whole};
use super::options::{Built, EngineOptions, MOST_DEPTH, load_scene, parse_size};
use super::outputs::{Outputs, check_outputs};
use super::progress::with_bar;
use super::shadows::ShadowOptions;
use crate::measure::{count, grouped, size};
use crate::render::{
    Film, MOST_SAMPLES, Order, Picture, Progress, Rendered, Settings, Shown, Statistics,
    encode_picture, forecast, render,
};
use crate::scene::{Dropped, Scene, builtin};
use crate::shadow::{LightChoices, Prepared, Settled, VerdictReport};

const DETAILS: &str = "\
A scene without camera or lights gets sensible ones, and the command says so.

Examples:
  umbra render chair-room -o room.png --size 1280x972 --samples 3
  umbra render sponza.glb -o sponza.exr --backend cwbvh --aov --stats sponza.json";

/// Renders a picture of a scene
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Render {
    /// A built-in scene, or an .obj, .glb, .gltf or .toml file
    scene: PathBuf,
    /// The picture to write: .png or .exr
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    engine: EngineOptions,
    #[command(flatten)]
    shadows: ShadowOptions,
    /// Size of the picture
    ///
    /// 640x486 if not given, and the paper's own size for its scenes
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Samples along each side of a pixel: 3 gives 9 samples
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1..=MOST_SAMPLES))]
    samples: u32,
    /// Reflections and refractions that a ray may go through
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole(0..=MOST_DEPTH))]
    depth: u8,
    /// The order in which pixels are rendered
    #[arg(long, value_enum, default_value_t)]
    order: Order,
    /// Bits a channel of a PNG: 8 or 16 (an EXR has floats)
    #[arg(long, value_name = "N", default_value = "8", value_parser = ["8", "16"])]
    bits: String,
    /// Factor from radiance to PNG, as an EXR holds radiance itself; chosen from the picture if the scene says
    /// nothing
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    exposure: Option<f32>,
    /// Also writes pictures of the shadows beside the output: NAME.mask.png (what is in shadow),
    /// NAME.shadows.png (how that was answered) and NAME.cost.png (what it cost)
    #[arg(long)]
    aov: bool,
    /// Shows answers and cost of one light, by its number from 0, instead of all together
    #[arg(long, value_name = "N", requires = "aov", value_parser = whole(0u32..))]
    aov_light: Option<u32>,
    /// Writes all counts and times as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

/// Lights of which it is printed who answered; `--stats` has all.
const SHOWN_LIGHTS: usize = 4;

/// The paper's size of a picture of its scenes; that of most of them for other scenes.
fn default_size(scene: &Path) -> (u32, u32) {
    let Settings { width, height, .. } = Settings::default();
    scene.to_str().and_then(builtin::view).map_or((width, height), |view| (view.width, view.height))
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    triangles: usize,
    opaque_triangles: u32,
    lights: usize,
    dropped: Dropped,
    local_origin: [f64; 3],
    notes: &'a [String],
    backend: &'a str,
    test: &'a str,
    #[serde(flatten)]
    engine_options: &'a EngineOptions,
    memory_limit: Option<u64>,
    shadows: String,
    #[serde(flatten)]
    shadow_options: &'a ShadowOptions,
    verdicts: Vec<Verdict>,
    /// Who answered the queries to each light, if there was a choice.
    choices: Vec<LightChoices>,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    depth: u8,
    order: Order,
    threads: usize,
    exposure: f32,
    backend_bytes: usize,
    shadow_bytes: usize,
    load_seconds: f64,
    build_seconds: f64,
    render_seconds: f64,
    counts: Statistics,
}

/// A picture, and what made it.
struct Made<'a> {
    scene: &'a Scene,
    built: &'a Built,
    shadows: &'a dyn Prepared,
    rendered: &'a Rendered,
    exposure: f32,
    load_seconds: f64,
    render_seconds: f64,
}

/// A verdict: what it took, and what it did.
#[derive(Serialize)]
struct Verdict {
    #[serde(flatten)]
    report: VerdictReport,
    #[serde(flatten)]
    settled: Settled,
}

impl Render {
    pub fn run(self) -> Result<(), Failure> {
        let kind = Picture::of(&self.output, if self.bits == "16" { 16 } else { 8 })?;
        let (width, height) = self.size.unwrap_or_else(|| default_size(&self.scene));
        let settings = Settings {
            width,
            height,
            samples: self.samples,
            depth: self.depth,
            order: self.order,
            mask: self.aov,
            answers: self.aov.then_some(Shown { light: self.aov_light }),
            ..Settings::default()
        };
        settings.check()?;
        self.check_kind(kind)?;
        self.engine.check()?;
        self.shadows.check(self.engine.backend, self.order)?;
        let pictures = self.aov.then(|| PICTURES.map(|what| beside(&self.output, what)));
        let outputs = std::iter::once(&self.output).chain(pictures.iter().flatten());
        let outputs: Vec<_> = outputs.chain(&self.stats).map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[&self.scene])?;
        let pool = self.engine.pool()?;
        pool.install(|| self.render(kind, &settings, &outputs))
    }

    /// Refuses what would change nothing in a picture of this kind.
    fn check_kind(&self, kind: Picture) -> Result<(), Failure> {
        let options = [("--bits", self.bits != "8"), ("--exposure", self.exposure.is_some())];
        let given = options.iter().find(|(_, is_given)| *is_given && kind == Picture::OpenExr);
        given.map_or(Ok(()), |(option, _)| {
            Err(Failure::Input(format!(
                "{option}: an EXR holds radiance itself, in floats; leave it out, or name a .png"
            )))
        })
    }

    fn render(&self, kind: Picture, settings: &Settings, outputs: &[&Path]) -> Result<(), Failure> {
        let start = Instant::now();
        let scene = load_scene(&self.scene, outputs)?;
        let load_seconds = start.elapsed().as_secs_f64();
        self.check_light(&scene)?;
        let built = self.engine.build(&scene)?;
        let backend = &*built.backend;
        let start = Instant::now();
        let expected = || forecast(&scene, backend, settings);
        let shadows = &*self.shadows.prepare(&scene, &built, &self.engine, expected)?;
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let progress = Progress::default();
        let rendered =
            with_bar(pixels, &progress, || render(&scene, backend, shadows, settings, &progress))?;
        let render_seconds = start.elapsed().as_secs_f64();
        let exposure =
            self.exposure.or(scene.exposure).unwrap_or_else(|| rendered.film.automatic_exposure());
        let (scene, built, rendered) = (&scene, &built, &rendered);
        let made = Made { scene, built, shadows, rendered, exposure, load_seconds, render_seconds };
        let mut files = self.pictures(kind, &made)?;
        let report = self.report(settings, &made);
        report.say();
        if let Some(stats) = &self.stats {
            files.add_json(stats, &report)?;
        }
        files.finish()
    }

    /// Refuses a light that the scene does not have.
    fn check_light(&self, scene: &Scene) -> Result<(), Failure> {
        match self.aov_light.filter(|&light| light as usize >= scene.lights.len()) {
            None => Ok(()),
            Some(light) => Err(Failure::Input(format!(
                "--aov-light {light}: {} has {}, numbered from 0",
                scene.name,
                count(scene.lights.len() as u64, "light")
            ))),
        }
    }

    /// Writes the picture, and those of the shadows if they were kept; none is in its place yet.
    fn pictures(&self, kind: Picture, made: &Made<'_>) -> Result<Outputs, Failure> {
        let mut files = Outputs::default();
        let Rendered { film, mask, answers, .. } = made.rendered;
        files.add(&self.output, &encode_picture(film, made.exposure, kind))?;
        if let (Some(mask), Some(answers)) = (mask, answers) {
            let films: [Film; PICTURES.len()] =
                [mask.picture(), answers.outcome_picture(), answers.cost_picture()];
            for (film, what) in films.iter().zip(PICTURES) {
                let picture = encode_picture(film, 1.0, Picture::Png8);
                files.add(&beside(&self.output, what), &picture)?;
            }
        }
        Ok(files)
    }

    fn report<'a>(&'a self, settings: &Settings, made: &Made<'a>) -> Report<'a> {
        let &Made { scene, built, shadows, rendered, .. } = made;
        let counts = rendered.statistics;
        let verdict = |report: VerdictReport| Verdict {
            settled: counts.shadows.verdicts[report.verdict.index()],
            report,
        };
        Report {
            scene: &scene.name,
            triangles: scene.triangles.len(),
            opaque_triangles: scene.triangles.opaque_count(),
            lights: scene.lights.len(),
            dropped: scene.dropped,
            local_origin: scene.origin.to_array(),
            notes: &scene.notes,
            backend: self.engine.backend.name(),
            test: self.engine.test().name(),
            engine_options: &self.engine,
            memory_limit: self.engine.most_bytes(),
            shadows: self.shadows.name(),
            shadow_options: &self.shadows,
            verdicts: shadows.verdicts().into_iter().map(verdict).collect(),
            choices: shadows.choices(),
            width: settings.width,
            height: settings.height,
            samples_per_pixel: settings.samples * settings.samples,
            depth: settings.depth,
            order: settings.order,
            threads: rayon::current_num_threads(),
            exposure: made.exposure,
            backend_bytes: built.backend.memory(),
            shadow_bytes: shadows.memory(),
            load_seconds: made.load_seconds,
            build_seconds: built.seconds,
            render_seconds: made.render_seconds,
            counts,
        }
    }
}

impl Report<'_> {
    /// Prints what is worth a line.
    fn say(&self) {
        for Verdict { report, .. } in &self.verdicts {
            for note in &report.notes {
                say!("umbra: {}: {note}", report.verdict);
            }
        }
        let rays = self.counts.rays;
        say!(
            "{}: {}, {} {} {}; {} ({} to lights, {} of them blocked) in {:.2} s: {:.2} million a second; loaded in {:.2} s, built in {:.2} s",
            self.scene,
            size(self.triangles, self.lights),
            self.backend,
            self.test,
            self.shadows,
            count(rays.total(), "ray"),
            grouped(rays.shadow),
            grouped(self.counts.shadows.blocked),
            self.render_seconds,
            rays.total() as f64 / self.render_seconds / 1e6,
            self.load_seconds,
            self.build_seconds,
        );
        for light in self.choices.iter().take(SHOWN_LIGHTS) {
            say!("umbra: {light}");
        }
        if self.choices.len() > SHOWN_LIGHTS {
            let more = count((self.choices.len() - SHOWN_LIGHTS) as u64, "more light");
            say!("umbra: and {more}, see --stats FILE");
        }
    }
}

/// The pictures of the shadows.
const PICTURES: [&str; 3] = ["mask", "shadows", "cost"];

/// The name of a picture that belongs to another: `room.png` and "mask" give `room.mask.png`.
fn beside(path: &Path, what: &str) -> PathBuf {
    path.with_extension(format!("{what}.png"))
}
