//! Who takes part: Embree in all its ways, and ours over the grid.

use std::hint::black_box;
use std::rc::Rc;
use std::sync::Arc;

use umbra::geometry::Triangles;
use umbra::measure::paper::process_time;
use umbra::occlusion::{Embree, EmbreeOptions, Occlusion, PacketWidth, Quality, Test};
use umbra::render::{Settings, forecast};
use umbra::scene::Scene;
use umbra::shadow::{Auto, Combination, Method, Prepared, Shadows, prepare};

use super::common::by_place::{ByPlace, Sorted};
use super::common::runs::{Run, blocked_by_engine, blocked_by_worker};
use super::table::Figures;

/// Who runs with umbra's grid behind: by the names of the command line.
const OURS: [&str; 5] = ["trace", "light-buffer", "shaft", "shaft+light-buffer", AUTO];
const AUTO: &str = "auto";

/// Everything is prepared so many times, and the least time counts; but not again after so many nanoseconds.
const PREPARATIONS: usize = 3;
const PATIENCE: u64 = 2_000_000_000;

/// What Embree builds.
const BUILDS: [(&str, bool, Quality); 4] = [
    ("default", false, Quality::Medium),
    ("default high", false, Quality::High),
    ("default low", false, Quality::Low),
    ("robust", true, Quality::Medium),
];

/// How it is asked: packets, whether as coherent ones, and which rays are sorted by place before.
const WAYS: [(&str, PacketWidth, bool, Option<Sorted>); 8] = [
    ("single", PacketWidth::One, false, None),
    ("8 coherent", PacketWidth::Eight, true, None),
    ("16 coherent", PacketWidth::Sixteen, true, None),
    ("16", PacketWidth::Sixteen, false, None),
    ("16 coherent sorted", PacketWidth::Sixteen, true, Some(Sorted::All)),
    ("16 sorted", PacketWidth::Sixteen, false, Some(Sorted::All)),
    ("16 coherent sorted where apart", PacketWidth::Sixteen, true, Some(Sorted::Apart)),
    ("16 sorted where apart", PacketWidth::Sixteen, false, Some(Sorted::Apart)),
];

/// What was made, and the least nanoseconds that making it took.
pub fn least<T>(mut make: impl FnMut() -> T) -> (T, u64) {
    let (mut made, mut best, mut all) = (None, u64::MAX, 0);
    for _ in 0..PREPARATIONS {
        drop(made.take());
        let start = process_time();
        made = Some(make());
        let nanoseconds = process_time() - start;
        best = best.min(nanoseconds);
        all += nanoseconds;
        if all > PATIENCE {
            break;
        }
    }
    (made.expect("it was made at least once"), best)
}

/// A structure of Embree's, and how it is asked.
pub struct Built {
    quality: Quality,
    ways: Vec<(String, Embree, Option<Sorted>)>,
    nanoseconds: u64,
}

/// Embree over what is opaque, as shafts are, built and asked in each way that this CPU has; in robust mode and low quality without
/// sorted rays, to keep the race short.
pub fn embrees(scene: &Scene) -> Vec<Built> {
    let opaque = (0..scene.triangles.opaque_count()).map(|id| scene.triangles.get(id));
    let opaque = Arc::new(Triangles::from_iter(opaque));
    let build = |(mode, robust, quality)| {
        let options = EmbreeOptions { quality, ..EmbreeOptions::default() };
        let (made, nanoseconds) = least(|| Embree::new(opaque.clone(), robust, options));
        let made = made.ok()?;
        let ways = WAYS.iter().filter_map(|&(way, width, coherent, sorted)| {
            if (robust || quality == Quality::Low) && sorted.is_some() {
                return None;
            }
            // 16-wide kernels need AVX-512.
            let asked = made.with_packets(width, coherent).ok()?;
            Some((format!("{mode} {way}"), asked, sorted))
        });
        Some(Built { quality, ways: ways.collect(), nanoseconds })
    };
    BUILDS.into_iter().filter_map(build).collect()
}

impl Built {
    /// One for each way.
    pub fn racers<'a>(&'a self) -> Vec<Racer<'a>> {
        let racer = |(name, embree, sorted): &'a (String, Embree, Option<Sorted>)| {
            let kind = match *sorted {
                None => Kind::Embree(embree, self.quality),
                Some(sorted) => Kind::Sorted(embree, sorted, ByPlace::default()),
            };
            Racer::new(name.clone(), kind, self.nanoseconds)
        };
        self.ways.iter().map(racer).collect()
    }
}

/// One of ours, made ready.
pub struct Ready<'a> {
    name: &'static str,
    prepared: Box<dyn Prepared + 'a>,
    nanoseconds: u64,
    rehearsal: Option<Rehearsal<'a>>,
}

/// Prepares what somebody may prepare while he answers.
type Rehearsal<'a> = Rc<dyn Fn() + 'a>;

/// All of ours, over the grid.
pub fn ours<'a>(
    scene: &'a Scene,
    grid: &'a dyn Occlusion,
    settings: &Settings,
    every: usize,
) -> Vec<Ready<'a>> {
    const FITS: &str = "it goes with the grid";
    let combination = move |name: &str| {
        let combination: Combination = name.parse().expect("a method");
        prepare(combination, scene, grid).expect(FITS)
    };
    let make = |name: &str| -> Box<dyn Prepared + 'a> {
        if name != AUTO {
            return combination(name);
        }
        let auto = Auto::new(Method::Trace, Test::Exact, scene, grid).expect(FITS);
        let queries = forecast(scene, grid, settings).expect("a picture");
        Box::new(auto.expecting(queries / every as u64))
    };
    let ready = |name| {
        let (prepared, nanoseconds) = least(|| make(name));
        let rehearse = move || drop(least(|| combination("shaft")));
        let rehearsal = (name == AUTO).then(|| Rc::new(rehearse) as Rehearsal<'a>);
        Ready { name, prepared, nanoseconds, rehearsal }
    };
    OURS.into_iter().map(ready).collect()
}

impl Ready<'_> {
    pub fn racer(&self) -> Racer<'_> {
        let kind = Kind::Ours(&*self.prepared, self.prepared.worker());
        let rehearsal = self.rehearsal.clone();
        Racer { rehearsal, ..Racer::new(self.name.to_owned(), kind, self.nanoseconds) }
    }
}

/// Somebody who answers, and what that took so far.
pub struct Racer<'a> {
    name: String,
    kind: Kind<'a>,
    /// Nanoseconds of preparation, and in each part.
    prepared: u64,
    parts: Vec<u64>,
    blocked: usize,
    rehearsal: Option<Rehearsal<'a>>,
}

enum Kind<'a> {
    Embree(&'a Embree, Quality),
    Sorted(&'a Embree, Sorted, ByPlace),
    Ours(&'a dyn Prepared, Box<dyn Shadows + 'a>),
}

impl<'a> Racer<'a> {
    fn new(name: String, kind: Kind<'a>, prepared: u64) -> Self {
        Self { name, kind, prepared, parts: Vec::new(), blocked: 0, rehearsal: None }
    }

    /// Answers a part. Who asks has just written the queries: so they are read once before time is taken, and come from a near
    /// cache, whoever ran before.
    ///
    /// Before the first one, who prepares while he answers rehearses that, whether he will do it or not. All others have
    /// been prepared up to three times by then, and the least counts; the first time may take thrice as long, in memory
    /// that no program has used for long.
    pub fn run(&mut self, runs: &[Run]) {
        if let Some(rehearse) = self.rehearsal.take() {
            rehearse();
        }
        let mut spent = 0;
        for run in runs {
            match self.kind {
                Kind::Ours(..) => drop(black_box(run.queries.clone())),
                Kind::Embree(..) | Kind::Sorted(..) => drop(black_box(run.rays.clone())),
            }
            let run = std::slice::from_ref(run);
            let start = process_time();
            let blocked = match &mut self.kind {
                Kind::Embree(embree, _) => blocked_by_engine(*embree, run),
                Kind::Sorted(embree, sorted, by_place) => by_place.blocked(*embree, *sorted, run),
                Kind::Ours(_, worker) => blocked_by_worker(&mut **worker, run),
            };
            spent += process_time() - start;
            self.blocked += blocked;
        }
        self.parts.push(spent);
    }

    /// What it took.
    pub fn figures(self) -> Figures {
        let bytes = match &self.kind {
            Kind::Embree(embree, _) | Kind::Sorted(embree, ..) => embree.memory(),
            Kind::Ours(prepared, _) => prepared.memory(),
        };
        let sorted = matches!(self.kind, Kind::Sorted(..));
        let low = matches!(self.kind, Kind::Embree(_, Quality::Low));
        Figures {
            embree: !matches!(self.kind, Kind::Ours(..)),
            sorted,
            low,
            name: self.name,
            prepared: self.prepared,
            parts: self.parts,
            blocked: self.blocked,
            bytes,
        }
    }
}
