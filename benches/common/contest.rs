//! Contenders that answer the shadow queries of a picture in turns.
//!
//! In each round every contender is prepared from nothing, asked once, and asked again; medians of the rounds count.
//! Units of the picture are asked as the renderer cuts them, each by a worker of its own, along the curve through the picture. In one thread, time is that
//! of its processor, so that other programs disturb little; with several, it is that of the clock on the wall.

use std::time::Instant;

use rayon::prelude::*;
use umbra::measure::paper::thread_time;
use umbra::occlusion::Occlusion;
use umbra::render::{Settings, record};
use umbra::scene::Scene;
use umbra::shadow::{Prepared, Trace};

use super::median;
use super::runs::{Run, blocked_by_engine, blocked_by_worker};

/// The shadow queries of a picture, unit by unit.
pub struct Queries {
    units: Vec<Vec<Run>>,
    pub count: usize,
}

impl Queries {
    /// What a picture asks, with an engine for the rays that see.
    pub fn of(scene: &Scene, seeing: &dyn Occlusion, settings: &Settings) -> Self {
        let (mut units, mut count) = (Vec::new(), 0);
        let recorded = record(scene, seeing, &Trace::new(seeing), settings, |unit| {
            count += unit.len();
            units.push(Run::all(&unit));
        });
        recorded.expect("the settings make a picture");
        Self { units, count }
    }
}

/// What answers.
pub enum Answers<'a> {
    /// An engine that is there already.
    Engine(&'a dyn Occlusion),
    /// A shadow method.
    Method(Box<dyn Prepared + 'a>),
}

impl Answers<'_> {
    /// How many queries of a unit are blocked.
    fn blocked_in(&self, unit: &[Run]) -> usize {
        match self {
            Self::Engine(engine) => blocked_by_engine(*engine, unit),
            Self::Method(prepared) => blocked_by_worker(&mut *prepared.worker(), unit),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Engine(engine) => engine.memory(),
            Self::Method(prepared) => prepared.memory(),
        }
    }
}

/// Somebody who takes part.
pub struct Contender<'a> {
    pub name: &'static str,
    /// Seconds spent on it before: an engine's building.
    pub built: f64,
    /// Makes it ready, from nothing.
    pub prepare: Box<dyn Fn() -> Answers<'a> + Sync + 'a>,
}

/// What it cost: nanoseconds of all queries, medians.
#[derive(Clone, Debug)]
pub struct Costs {
    pub name: &'static str,
    pub preparing: f64,
    pub first: f64,
    pub then: f64,
    pub bytes: usize,
    pub blocked: usize,
}

impl Costs {
    /// Preparing and asking once.
    pub fn whole(&self) -> f64 {
        self.preparing + self.first
    }
}

/// Lets all take turns, so many rounds, on so many threads.
pub fn measure(
    contenders: &[Contender<'_>],
    queries: &Queries,
    rounds: usize,
    threads: usize,
) -> Vec<Costs> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let start = Instant::now();
    let now = || match threads {
        1 => thread_time() as f64,
        _ => start.elapsed().as_nanos() as f64,
    };
    let mut all: Vec<Vec<Costs>> = contenders.iter().map(|_| Vec::new()).collect();
    for round in 0..rounds {
        for turn in 0..contenders.len() {
            let which = (turn + round) % contenders.len();
            let Contender { name, built, prepare } = &contenders[which];
            let costs = pool.install(|| {
                let began = now();
                let answers = prepare();
                let prepared = now();
                let pass = || -> usize {
                    queries.units.par_iter().map(|unit| answers.blocked_in(unit)).sum()
                };
                let blocked = pass();
                let asked = now();
                assert_eq!(blocked, pass(), "{name} says now this, now that");
                Costs {
                    name,
                    preparing: built * 1e9 + prepared - began,
                    first: asked - prepared,
                    then: now() - asked,
                    bytes: answers.bytes(),
                    blocked,
                }
            });
            all[which].push(costs);
        }
    }
    let middle =
        |costs: &Vec<Costs>, part: fn(&Costs) -> f64| median(costs.iter().map(part).collect());
    all.iter()
        .map(|costs| Costs {
            preparing: middle(costs, |costs| costs.preparing),
            first: middle(costs, |costs| costs.first),
            then: middle(costs, |costs| costs.then),
            ..costs[0].clone()
        })
        .collect()
}
