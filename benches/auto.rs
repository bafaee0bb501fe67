//! `auto` against the best single method in hindsight: the shadow stage of a picture from nothing, in one thread.
//!
//! `cargo bench --bench auto -- SAMPLES SCENE…`: all methods that `auto` chooses among, and `auto`, answer the shadow queries of
//! each scene, 320 by 240 pixels with SAMPLES×SAMPLES samples, in turns; each is prepared anew in each round. The
//! figures are nanoseconds a query, preparing included (the grid apart, which all have behind them). *Of the best* is
//! `auto` over the cheapest single method; *then* is a second pass, with everything built and learnt.

mod common;

use common::contest::{Answers, Contender, Costs, Queries, measure};
use umbra::occlusion::{Backend, BuildOptions, Test, build};
use umbra::render::{Settings, forecast};
use umbra::scene::{Scene, load};
use umbra::shadow::{Auto, Combination, Method, prepare};

/// Rounds, of which the median counts.
const ROUNDS: usize = 3;

const SINGLE: [&str; 5] = ["trace", "shaft", "shaft+light-buffer", "light-buffer", "cache-tree"];

const USAGE: &str = "cargo bench --bench auto -- SAMPLES SCENE…, like 3 drum chair-room";

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    println!(
        "| scene | queries | {} | auto | of the best | then: best | auto | of the best | auto, MB |",
        SINGLE.join(" | ")
    );
    println!("|{}", " --- |".repeat(SINGLE.len() + 8));
    let Some((samples, scenes)) = arguments.split_first() else {
        // Among all benches, a look at the smallest scene.
        return row(&load("chair-room").expect("it is built in"), 1);
    };
    let samples = samples.parse().expect(USAGE);
    for scene in scenes {
        match load(common::path_of(scene)) {
            Ok(scene) => row(&scene, samples),
            Err(error) => eprintln!("*** NOT MEASURED: {error} ***"),
        }
    }
}

fn row(scene: &Scene, samples: u32) {
    let grid = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default())
        .expect("the grid");
    let grid = &*grid;
    let settings = Settings { width: 320, height: 240, samples, ..Settings::default() };
    let queries = Queries::of(scene, grid, &settings);
    let mut contenders: Vec<Contender<'_>> = SINGLE
        .into_iter()
        .map(|name| {
            let make = move || match name {
                "trace" => Answers::Engine(grid),
                name => {
                    let combination: Combination = name.parse().expect("a method");
                    Answers::Method(prepare(combination, scene, grid).expect("it goes"))
                }
            };
            Contender { name, built: 0.0, prepare: Box::new(make) }
        })
        .collect();
    let auto = move || {
        let auto = Auto::new(Method::Trace, Test::Exact, scene, grid).expect("it goes");
        auto.expecting(forecast(scene, grid, &settings).expect("a picture"))
    };
    let prepare = Box::new(move || Answers::Method(Box::new(auto())));
    contenders.push(Contender { name: "auto", built: 0.0, prepare });
    let costs = measure(&contenders, &queries, ROUNDS, 1);
    let each = |nanoseconds: f64| nanoseconds / queries.count as f64;
    let (auto, single) = costs.split_last().expect("auto is the last");
    for other in single {
        assert_eq!(other.blocked, auto.blocked, "{} differs", other.name);
    }
    let best = |part: fn(&Costs) -> f64| single.iter().map(part).fold(f64::INFINITY, f64::min);
    let then = best(|costs| costs.then);
    let figures: Vec<String> =
        costs.iter().map(|costs| format!("{:.0}", each(costs.whole()))).collect();
    println!(
        "| {} | {} | {} | {:.2} | {:.0} | {:.0} | {:.2} | {:.1} |",
        scene.name,
        queries.count,
        figures.join(" | "),
        auto.whole() / best(Costs::whole),
        each(then),
        each(auto.then),
        auto.then / then,
        auto.bytes as f64 / 1e6
    );
}
