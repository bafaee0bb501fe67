//! What grows, and who is asked.

use std::time::Instant;

use umbra::measure::paper::process_time;
use umbra::occlusion::{
    Backend, BuildOptions, Embree, EmbreeOptions, Occlusion, PacketWidth, Test, build,
};
use umbra::render::Settings;
use umbra::scene::{Scene, builtin};
use umbra::shadow::{Auto, Combination, Method, prepare};

use crate::common::contest::{Answers, Contender, Costs, Queries, measure};
use crate::common::{lights, roomy};

/// Seconds that a contender may take for a round of a point; then it is left out of greater ones.
const PATIENCE: f64 = 20.0;

/// A curve.
pub struct Curve {
    pub name: &'static str,
    /// What the horizontal axis shows.
    pub axis: &'static str,
    /// Measures it, so many rounds a point.
    pub measure: fn(usize) -> Vec<Point>,
}

pub const ALL: [Curve; 4] = [
    Curve { name: "triangles", axis: "triangles →", measure: triangles },
    Curve { name: "lights", axis: "lights →", measure: more_lights },
    Curve { name: "samples", axis: "samples a pixel →", measure: samples },
    Curve { name: "threads", axis: "threads →", measure: threads },
];

/// What all cost where something has grown to `x`.
pub struct Point {
    pub scene: String,
    pub x: usize,
    pub queries: usize,
    pub costs: Vec<Costs>,
}

/// Who takes part in the curves.
pub const CONTENDERS: [&str; 6] =
    ["grid trace", "shaft", "light-buffer", "auto", "embree single", "embree 16 coherent"];

/// The engines over a scene, and the seconds that building them took.
struct Engines {
    grid: (Box<dyn Occlusion>, f64),
    embree: (Embree, f64),
    /// The same in packets of 16; none if this CPU has no such kernels.
    packets: Option<Embree>,
}

/// What was made, and the seconds that it took: of the processor, if one thread answers, else by the clock on the wall, as
/// answering is timed too.
fn timed<T>(threads: usize, make: impl FnOnce() -> T) -> (T, f64) {
    let (wall, processor) = (Instant::now(), process_time());
    let made = make();
    let seconds = match threads {
        1 => (process_time() - processor) as f64 * 1e-9,
        _ => wall.elapsed().as_secs_f64(),
    };
    (made, seconds)
}

impl Engines {
    fn over(scene: &Scene, threads: usize) -> Self {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let grid = timed(threads, || {
                let options = BuildOptions::default();
                build(Backend::Grid, Test::Exact, &scene.triangles, &options).expect("the grid")
            });
            // The default mode is the faster one.
            let embree = timed(threads, || {
                let options = EmbreeOptions::default();
                Embree::new(scene.triangles.clone(), false, options).expect("Embree")
            });
            let packets = embree.0.with_packets(PacketWidth::Sixteen, true).ok();
            if packets.is_none() {
                eprintln!("*** NOT MEASURED: packets of 16, which need AVX-512 ***");
            }
            Self { grid, embree, packets }
        })
    }

    fn contenders<'a>(
        &'a self,
        scene: &'a Scene,
        count: usize,
        out: &[&str],
    ) -> Vec<Contender<'a>> {
        let (grid, embree) = (&*self.grid.0, &self.embree.0);
        let method = move |combination: Combination| -> Box<dyn Fn() -> Answers<'a> + Sync + 'a> {
            Box::new(move || {
                Answers::Method(
                    prepare(roomy(combination), scene, grid).expect("it goes with the grid"),
                )
            })
        };
        let made: Vec<Option<Contender<'a>>> = CONTENDERS
            .map(|name| {
                let (built, prepare): (f64, Box<dyn Fn() -> Answers<'a> + Sync + 'a>) = match name {
                    "grid trace" => (self.grid.1, Box::new(move || Answers::Engine(grid))),
                    "auto" => {
                        let make = move || {
                            let auto = Auto::new(Method::Trace, Test::Exact, scene, grid);
                            auto.expect("it goes").expecting(count as u64)
                        };
                        (self.grid.1, Box::new(move || Answers::Method(Box::new(make()))))
                    }
                    "embree single" => (self.embree.1, Box::new(move || Answers::Engine(embree))),
                    "embree 16 coherent" => {
                        let packets = self.packets.as_ref()?;
                        (self.embree.1, Box::new(move || Answers::Engine(packets)))
                    }
                    name => (0.0, method(name.parse().expect("a method"))),
                };
                (!out.contains(&name)).then_some(Contender { name, built, prepare })
            })
            .into_iter()
            .collect();
        made.into_iter().flatten().collect()
    }
}

/// Rounds of each point, and those who have been too slow so far.
struct Out {
    rounds: usize,
    slow: Vec<&'static str>,
}

impl Out {
    fn new(rounds: usize) -> Self {
        Self { rounds, slow: Vec::new() }
    }

    /// Measures a point with those who are still in.
    fn point(
        &mut self,
        scene: &Scene,
        x: usize,
        engines: &Engines,
        settings: &Settings,
        threads: usize,
    ) -> Point {
        let queries = Queries::of(scene, &engines.embree.0, settings);
        let contenders = engines.contenders(scene, queries.count, &self.slow);
        let costs = measure(&contenders, &queries, self.rounds, threads);
        let ours: Vec<usize> = costs
            .iter()
            .filter(|costs| !costs.name.starts_with("embree"))
            .map(|costs| costs.blocked)
            .collect();
        assert!(ours.windows(2).all(|pair| pair[0] == pair[1]), "ours differ: {costs:?}");
        println!("{} {x}: {} queries", scene.name, queries.count);
        for cost in &costs {
            let each = |nanoseconds: f64| nanoseconds / queries.count as f64;
            println!(
                "  {:20} {:10.1} ns a query built, {:10.1} with building, {:8.1} MB",
                cost.name,
                each(cost.then),
                each(cost.whole()),
                cost.bytes as f64 / 1e6
            );
            if cost.first + cost.then > PATIENCE * 1e9 {
                println!("*** {} is left out from here on: too slow ***", cost.name);
                self.slow.push(cost.name);
            }
        }
        Point { scene: scene.name.clone(), x, queries: queries.count, costs }
    }
}

fn settings(width: u32, height: u32, samples: u32) -> Settings {
    Settings { width, height, samples, ..Settings::default() }
}

/// Finer and finer tessellations, about threefold each.
fn triangles(rounds: usize) -> Vec<Point> {
    const STEPS: [f64; 7] = [1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7];
    let mut points = Vec::new();
    for name in ["chair-room", "jittered-dense"] {
        let usual = builtin::triangle_count(name, 1.0).expect("it is built in") as f64;
        let mut out = Out::new(rounds);
        for wanted in STEPS {
            let made = builtin::draft_at(name, wanted / usual).and_then(|draft| draft.finish());
            let scene = match made {
                Ok(scene) => scene,
                Err(error) => {
                    println!("*** {name} ends before {wanted:.0} triangles: {error} ***");
                    break;
                }
            };
            let engines = Engines::over(&scene, 1);
            let (count, settings) = (scene.triangles.len(), settings(160, 120, 1));
            points.push(out.point(&scene, count, &engines, &settings, 1));
        }
    }
    points
}

/// More and more lights under the ceiling of the chair room.
fn more_lights(rounds: usize) -> Vec<Point> {
    let mut out = Out::new(rounds);
    [1, 4, 16, 64, 256]
        .into_iter()
        .map(|count| {
            let mut draft = builtin::draft("chair-room").expect("it is built in");
            draft.lights = lights::lattice(&draft.lights, count);
            let scene = draft.finish().expect("it is whole");
            let engines = Engines::over(&scene, 1);
            out.point(&scene, count, &engines, &settings(96, 72, 1), 1)
        })
        .collect()
}

/// 1 to 64 samples a pixel.
fn samples(rounds: usize) -> Vec<Point> {
    let mut points = Vec::new();
    for name in ["chair-room", "jittered-sparse"] {
        let scene = builtin::draft(name).and_then(|draft| draft.finish().ok()).expect("built in");
        let engines = Engines::over(&scene, 1);
        let mut out = Out::new(rounds);
        for side in [1, 2, 4, 8] {
            let samples = (side * side) as usize;
            points.push(out.point(&scene, samples, &engines, &settings(96, 72, side), 1));
        }
    }
    points
}

/// 1 thread to as many as there are processors, by the clock on the wall.
fn threads(rounds: usize) -> Vec<Point> {
    let scene = builtin::draft("chair-room").and_then(|draft| draft.finish().ok());
    let scene = scene.expect("it is built in");
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let mut out = Out::new(rounds);
    let doubled = std::iter::successors(Some(1), |threads| Some(2 * threads));
    let mut steps: Vec<usize> = doubled.take_while(|&threads| threads < all).collect();
    steps.push(all);
    steps
        .into_iter()
        .map(|threads| {
            let engines = Engines::over(&scene, threads);
            out.point(&scene, threads, &engines, &settings(320, 240, 2), threads)
        })
        .collect()
}
