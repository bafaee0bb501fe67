//! The shadow stage, preparation included, against the best Embree, in one thread.
//!
//! `cargo bench --bench race -- SAMPLES SCENE…` renders each scene with SAMPLES×SAMPLES samples a pixel, and
//! hands the shadow queries of each part of the picture to all racers in turn, as the renderer asks them: light by
//! light, tile by tile. Embree runs in every way that was ever the fastest: single rays and packets, coherent or
//! not, default and robust, medium and high quality; the best one is the measure. Times are of this thread's CPU, so
//! what else the machine does disturbs all alike; the ratio to the best Embree is given for the whole, and its
//! quartiles over the parts without preparation.

use std::time::Instant;

use umbra::geometry::Ray;
use umbra::measure::paper::thread_time;
use umbra::occlusion::{
    Backend, BuildOptions, Embree, EmbreeOptions, Occlusion, PacketWidth, Quality, Tally, Test,
    build,
};
use umbra::render::{RecordedQuery, Settings, record};
use umbra::scene::{Scene, builtin, load};
use umbra::shadow::{
    Answer, Auto, Combination, Method, Prepared, ShadowQuery, Shadows, Trace, prepare,
};

/// Queries of a part.
const PART: usize = 100_000;

/// Who runs with umbra's grid behind: by the names of the command line.
const OURS: [&str; 5] = ["trace", "light-buffer", "shaft", "shaft+light-buffer", "auto"];

const USAGE: &str = "cargo bench --bench race -- SAMPLES SCENE…, like 3 drum chair-room";

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let Some((samples, scenes)) = arguments.split_first() else {
        // Among all benches, a look at the smallest scene.
        return race(&load("chair-room").expect("it is built in"), 1);
    };
    let samples = samples.parse().expect(USAGE);
    for scene in scenes {
        match load(scene) {
            Ok(scene) => race(&scene, samples),
            Err(error) => eprintln!("*** NOT MEASURED: {error} ***"),
        }
    }
}

/// Embree, in one of its ways.
fn embrees(scene: &Scene) -> Vec<(String, Embree, f64)> {
    let mut ways = Vec::new();
    for (robust, quality) in
        [(false, Quality::Medium), (false, Quality::High), (true, Quality::Medium)]
    {
        for (width, coherent) in [
            (PacketWidth::One, false),
            (PacketWidth::Eight, true),
            (PacketWidth::Sixteen, true),
            (PacketWidth::Sixteen, false),
        ] {
            let start = Instant::now();
            let options = EmbreeOptions { quality, width, coherent, ..EmbreeOptions::default() };
            // 16-wide kernels need AVX-512.
            let Ok(embree) = Embree::new(scene.triangles.clone(), robust, options) else {
                continue;
            };
            let mode = if robust { "robust" } else { "default" };
            let coherence = if coherent { " coherent" } else { "" };
            let name = format!("embree {mode} {quality:?} {width:?}{coherence}").to_lowercase();
            ways.push((name, embree, start.elapsed().as_secs_f64()));
        }
    }
    ways
}

/// One of umbra's ways, made ready.
fn ready<'a>(
    name: &str,
    scene: &'a Scene,
    grid: &'a dyn Occlusion,
    settings: &Settings,
) -> Box<dyn Prepared + 'a> {
    const FITS: &str = "it goes with the grid";
    if name == "auto" {
        let samples = settings.width * settings.height * settings.samples.pow(2);
        let expected = u64::from(samples) * scene.lights.len() as u64;
        let auto = Auto::new(Method::Trace, Test::Exact, scene, grid).expect(FITS);
        return Box::new(auto.expecting(expected));
    }
    let combination: Combination = name.parse().expect("a method");
    prepare(combination, scene, grid).expect(FITS)
}

struct Racer<'a> {
    name: String,
    kind: Kind<'a>,
    /// Seconds of preparation, and nanoseconds in each part.
    prepared: f64,
    parts: Vec<u64>,
    blocked: u64,
}

enum Kind<'a> {
    Embree(&'a Embree),
    Umbra(&'a dyn Prepared, Box<dyn Shadows + 'a>),
}

impl Racer<'_> {
    fn run(&mut self, runs: &[(usize, Vec<ShadowQuery>, Vec<Ray>)]) {
        let mut blocked = Vec::new();
        let mut answers = Vec::new();
        let start = thread_time();
        let mut count = 0;
        for (light, queries, rays) in runs {
            match &mut self.kind {
                Kind::Embree(embree) => {
                    blocked.clear();
                    blocked.resize(rays.len(), false);
                    embree.occluded_many(rays, &mut blocked, &mut Tally::default());
                    count += blocked.iter().filter(|blocked| **blocked).count();
                }
                Kind::Umbra(_, shadows) => {
                    answers.clear();
                    answers.resize(queries.len(), Answer::default());
                    shadows.answer(*light, queries, &mut answers);
                    count += answers.iter().filter(|answer| answer.blocked).count();
                }
            }
        }
        self.parts.push(thread_time() - start);
        self.blocked += count as u64;
    }

    fn nanoseconds(&self) -> f64 {
        self.prepared * 1e9 + self.parts.iter().sum::<u64>() as f64
    }

    fn is_embree(&self) -> bool {
        matches!(self.kind, Kind::Embree(_))
    }
}

fn race(scene: &Scene, samples: u32) {
    let defaults = Settings::default();
    let (width, height) = builtin::view(&scene.name)
        .map_or((defaults.width, defaults.height), |view| (view.width, view.height));
    let settings = Settings { width, height, samples, ..defaults };
    let grid = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default())
        .expect("the grid");
    let embrees = embrees(scene);
    let ours: Vec<(&str, Box<dyn Prepared + '_>, f64)> = OURS
        .iter()
        .map(|&name| {
            let start = Instant::now();
            let prepared = ready(name, scene, &*grid, &settings);
            (name, prepared, start.elapsed().as_secs_f64())
        })
        .collect();
    let racer = |name: String, kind, prepared| Racer {
        name,
        kind,
        prepared,
        parts: Vec::new(),
        blocked: 0,
    };
    let mut racers: Vec<Racer> = Vec::new();
    for (name, embree, seconds) in &embrees {
        racers.push(racer(name.clone(), Kind::Embree(embree), *seconds));
    }
    for (name, prepared, seconds) in &ours {
        let kind = Kind::Umbra(&**prepared, prepared.worker());
        racers.push(racer(format!("umbra {name}"), kind, *seconds));
    }

    let mut part: Vec<RecordedQuery> = Vec::new();
    let (mut queries, mut turn) = (0, 0);
    let mut run = |part: &mut Vec<RecordedQuery>| {
        let runs: Vec<(usize, Vec<ShadowQuery>, Vec<Ray>)> = part
            .chunk_by(|a, b| a.light == b.light)
            .map(|run| {
                let queries: Vec<ShadowQuery> = run.iter().map(|recorded| recorded.query).collect();
                let rays = queries.iter().map(|query| query.ray).collect();
                (run[0].light as usize, queries, rays)
            })
            .collect();
        let count = racers.len();
        for place in 0..count {
            racers[(place + turn) % count].run(&runs);
        }
        queries += part.len();
        turn += 1;
        part.clear();
    };
    let seeing: &dyn Occlusion = embrees.first().map_or(&*grid, |(_, embree, _)| embree);
    let recorded = record(scene, seeing, &Trace::new(seeing), &settings, |unit| {
        part.extend(unit);
        if part.len() >= PART {
            run(&mut part);
        }
    });
    recorded.expect("the settings are good");
    run(&mut part);
    report(scene, &settings, queries, &racers);
}

fn report(scene: &Scene, settings: &Settings, queries: usize, racers: &[Racer]) {
    println!(
        "{}: {} triangles, {} lights, {}x{}, {} samples a pixel, {queries} shadow queries",
        scene.name,
        scene.triangles.len(),
        scene.lights.len(),
        settings.width,
        settings.height,
        settings.samples * settings.samples
    );
    let best = racers
        .iter()
        .filter(|racer| racer.is_embree())
        .min_by(|a, b| a.nanoseconds().total_cmp(&b.nanoseconds()));
    println!(
        "  {:38}{:>12}{:>12}{:>12}{:>8}  quartiles        blocked",
        "", "prepared ms", "ns a query", "with prep.", "ratio"
    );
    for racer in racers {
        let Racer { name, prepared, parts, blocked, kind } = racer;
        let lazily = match kind {
            Kind::Umbra(prepared, _) => {
                prepared.verdicts().iter().map(|report| report.bytes).sum::<usize>()
            }
            Kind::Embree(embree) => embree.memory(),
        };
        let spent = parts.iter().sum::<u64>() as f64;
        let ratio = best.map_or(f64::NAN, |best| best.nanoseconds() / racer.nanoseconds());
        let mut ratios: Vec<f64> = best.map_or(Vec::new(), |best| {
            best.parts.iter().zip(parts).map(|(best, this)| *best as f64 / *this as f64).collect()
        });
        ratios.sort_by(f64::total_cmp);
        let quartile = |quarter: usize| {
            ratios.get((ratios.len().saturating_sub(1)) * quarter / 4).copied().unwrap_or(f64::NAN)
        };
        println!(
            "  {name:38}{:12.1}{:12.1}{:12.1}{ratio:8.2}  {:.2} {:.2} {:.2}  {blocked:10}  {:.1} MB",
            prepared * 1e3,
            spent / queries as f64,
            racer.nanoseconds() / queries as f64,
            quartile(1),
            quartile(2),
            quartile(3),
            lazily as f64 / 1e6
        );
    }
}
