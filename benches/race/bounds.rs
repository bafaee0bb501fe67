//! What a shadow query costs at least, whoever answers it by a test: measured on this machine.
//!
//! One test of a ray and eight triangles from the nearest cache, by the cheapest arithmetic, and reading the query from memory.
//! The greater of the two is the bound, as a processor may do both at once. Whoever proves many queries at once may go
//! below the first.

use std::fmt;
use std::hint::black_box;
use std::sync::Arc;

use glam::Vec3;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::measure::paper::process_time;
use umbra::occlusion::{Backend, BuildOptions, Tally, Test, WIDTH, build};
use umbra::shadow::{Path, ShadowQuery};

/// Groups of eight triangles: 9 KiB of corners.
const EIGHTS: usize = 32;

/// Rays that miss all of them.
const RAYS: usize = 2000;

/// Bytes of queries that are read: more than a core has of any cache.
const STREAM: usize = 512 << 20;

/// Rounds, of which the fastest counts.
const ROUNDS: usize = 9;

/// Nanoseconds a query.
pub struct Bounds {
    /// By the cheapest test.
    test: f64,
    exact: f64,
    stream: f64,
}

impl Bounds {
    /// The greater one.
    pub fn query(&self) -> f64 {
        self.test.max(self.stream)
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { test, exact, stream } = self;
        let bytes = size_of::<ShadowQuery>();
        write!(
            f,
            "Lower bounds: {test:.1} ns for the cheapest test of a ray and {WIDTH} triangles from the nearest cache (exact: {exact:.1}), {stream:.1} ns to read a query of {bytes} bytes from memory ({:.1} GB/s).",
            bytes as f64 / stream
        )
    }
}

/// The least nanoseconds of some rounds.
fn least(mut work: impl FnMut()) -> f64 {
    let rounds = (0..ROUNDS).map(|_| {
        let start = process_time();
        work();
        process_time() - start
    });
    rounds.min().unwrap_or_default() as f64
}

/// Measures all of them.
pub fn measure() -> Bounds {
    let tests = [Test::Moller, Test::Pluecker, Test::Watertight].map(nanoseconds_of);
    let exact = nanoseconds_of(Test::Exact);
    Bounds { test: tests.into_iter().fold(exact, f64::min), exact, stream: stream() }
}

/// A ray among triangles that it misses, by brute force.
fn nanoseconds_of(test: Test) -> f64 {
    let fan = (0..EIGHTS * WIDTH).map(|number| {
        let turn = number as f32 * 0.01;
        let [x, y] = [2.0 + turn.cos(), 2.0 + turn.sin()];
        [[x, y, 1.0], [x + 0.1, y, 1.0], [x, y + 0.1, 1.0]].map(Vec3::from_array) as Triangle
    });
    let triangles = Arc::new(fan.collect::<Triangles>());
    let brute = build(Backend::Brute, test, &triangles, &BuildOptions::default());
    let brute = brute.expect("brute force needs nothing");
    let ray = |number: usize| {
        let origin = Vec3::new(0.001 * number as f32, 0.0, 0.0);
        Ray::between(origin, Vec3::new(0.0, 0.1, 2.0))
    };
    let rays: Vec<Ray> = (0..RAYS).map(ray).collect();
    let mut blocked = vec![false; RAYS];
    let nanoseconds = least(|| brute.occluded_many(&rays, &mut blocked, &mut Tally::default()));
    assert!(blocked.iter().all(|blocked| !blocked), "all are missed");
    nanoseconds / (EIGHTS * RAYS) as f64
}

/// Reading queries one after the other.
fn stream() -> f64 {
    let ray = Ray::between(Vec3::ZERO, Vec3::ONE);
    let queries =
        vec![ShadowQuery { ray, path: Path::EYE, spawner: 1 }; STREAM / size_of::<ShadowQuery>()];
    let nanoseconds = least(|| {
        let sum = queries.iter().fold(0u32, |sum, query| sum.wrapping_add(query.spawner));
        black_box(sum);
    });
    nanoseconds / queries.len() as f64
}
