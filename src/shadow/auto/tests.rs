//! Who prepares what, and when.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::*;
use crate::occlusion::{Backend, BuildOptions, build};
use crate::scene::builtin;
use crate::shadow::Method;

/// Tests with `auto` by a clock, when queries have taken so long that something is worth preparing.
fn when_something_is_worth_it(clock: impl Fn() -> u64 + Send + Sync, test: impl FnOnce(&Auto<'_>)) {
    let scene = builtin::draft_at("jittered-dense", 0.02).unwrap().finish().unwrap();
    let engine =
        build(Backend::Brute, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap();
    let auto = Auto::with_clock(Method::Trace, Test::Exact, &scene, &*engine, clock).unwrap();
    let choice = Choice::again(0);
    let (light, place, queries, nanoseconds, building) = (0, 0, 256.0, 1e9, 0.0);
    auto.observe(&Observation { light, place, choice, queries, nanoseconds, building });
    assert!(auto.worth_preparing().is_some());
    test(&auto);
}

#[test]
fn what_two_threads_find_worth_it_is_prepared_once() {
    let ticks = AtomicUsize::new(0);
    when_something_is_worth_it(
        || ticks.fetch_add(1, Relaxed) as u64,
        |auto| {
            while auto.worth_preparing().is_some() {
                auto.prepare_what_is_worth_it();
            }
            let paid = ticks.load(Relaxed);
            assert!(paid > 0);
            // A thread that asked before the other had its turn, and has its own now.
            auto.prepare_what_is_worth_it();
            assert_eq!(ticks.load(Relaxed), paid, "no second price");
        },
    );
}

#[test]
fn a_panic_while_something_is_prepared_does_not_keep_others_from_it() {
    let ticks = AtomicUsize::new(0);
    when_something_is_worth_it(
        || {
            let tick = ticks.fetch_add(1, Relaxed);
            assert!(tick > 0, "the clock fails once");
            tick as u64
        },
        |auto| {
            let attempt = || auto.prepare_what_is_worth_it();
            assert!(catch_unwind(AssertUnwindSafe(attempt)).is_err());
            let worth_it = auto.worth_preparing();
            auto.prepare_what_is_worth_it();
            assert_ne!(auto.worth_preparing(), worth_it, "it is prepared");
        },
    );
}
