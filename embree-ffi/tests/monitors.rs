//! Watching and cancelling builds, and panics on the way through Embree.

mod common;

use std::{
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicIsize, AtomicUsize, Ordering::Relaxed},
    },
};

use common::*;
use embree_ffi::{
    Coherence, DeviceConfig, Error, ErrorCode, Lanes, Mesh, RayPacket, SceneBuilder, SceneOptions,
    Verdict,
};

/// A panic without the report on standard error, which is not captured on Embree's threads.
fn quiet_panic(text: &'static str) -> ! {
    resume_unwind(Box::new(text))
}

/// What a panic carried.
fn payload(outcome: std::thread::Result<impl Sized>) -> &'static str {
    outcome
        .err()
        .and_then(|payload| payload.downcast_ref::<&'static str>().copied())
        .expect("it panics with a text")
}

fn code(outcome: Result<impl Sized, Error>) -> ErrorCode {
    match outcome.err() {
        Some(Error::Embree { code, message }) => {
            assert!(
                message.contains("monitor forced termination"),
                "Embree's own words: {message}"
            );
            code
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn memory_is_counted_while_a_scene_lives_and_given_back_after() {
    let device = device();
    let before = device.memory_used();
    let (vertices, triangles) = soup(5000);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    let buffers = device.memory_used();
    assert!(buffers - before >= size_of_val(&*vertices) + size_of_val(&*triangles));
    let scene = builder.commit().unwrap();
    assert!(
        device.memory_used() > buffers + 5000 * 40,
        "a triangle takes some 60 bytes in the tree"
    );
    drop(scene);
    assert_eq!(device.memory_used(), before);
}

#[test]
fn compact_scenes_hold_less_memory() {
    let held = |options| {
        let device = device();
        let _scene = soup_scene(&device, options);
        device.memory_used()
    };
    assert!(held(SceneOptions::default().compact(true)) < held(SceneOptions::default()));
}

#[test]
fn a_memory_monitor_hears_of_every_byte() {
    let heard = Arc::new(AtomicIsize::new(0));
    let ear = heard.clone();
    let monitor = move |bytes| {
        ear.fetch_add(bytes, Relaxed);
        ControlFlow::Continue(())
    };
    let device = device_with(DeviceConfig::default().memory_monitor(monitor));
    let scene = soup_scene(&device, SceneOptions::default());
    assert_eq!(heard.load(Relaxed), device.memory_used() as isize);
    drop(scene);
    drop(device);
    assert_eq!(heard.load(Relaxed), 0);
}

#[test]
fn a_memory_monitor_can_forbid_and_nothing_leaks() {
    let (vertices, triangles) = soup(5000);
    let limit = Arc::new(AtomicIsize::new(isize::MAX));
    let allowed = limit.clone();
    let held = AtomicIsize::new(0);
    let monitor =
        move |bytes: isize| match held.fetch_add(bytes, Relaxed) + bytes > allowed.load(Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
    let device = device_with(DeviceConfig::default().memory_monitor(monitor));
    let before = device.memory_used();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    limit.store(0, Relaxed);
    assert_eq!(code(builder.commit()), ErrorCode::OutOfMemory);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    assert_eq!(code(builder.add(Mesh::new(&vertices, &triangles))), ErrorCode::OutOfMemory);
    drop(builder);
    assert_eq!(device.memory_used(), before);
    limit.store(isize::MAX, Relaxed);
    assert!(
        !soup_scene(&device, SceneOptions::default()).occluded(&up(false)),
        "the device is as good as before"
    );
}

#[test]
fn a_panic_in_a_memory_monitor_comes_out_of_the_call_it_cancelled() {
    let (vertices, triangles) = soup(5000);
    let armed = Arc::new(AtomicBool::new(false));
    let trigger = armed.clone();
    let monitor = move |_| {
        if trigger.load(Relaxed) {
            quiet_panic("in the memory monitor")
        } else {
            ControlFlow::Continue(())
        }
    };
    let device = device_with(DeviceConfig::default().memory_monitor(monitor));
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    armed.store(true, Relaxed);
    assert_eq!(
        payload(catch_unwind(AssertUnwindSafe(|| builder.commit()))),
        "in the memory monitor"
    );
}

#[test]
fn progress_runs_to_the_end() {
    let device = device();
    let (vertices, triangles) = soup(100_000);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    let (calls, hundredths) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let scene = builder.commit_with_progress(|fraction| {
        calls.fetch_add(1, Relaxed);
        hundredths.fetch_max((fraction * 100.0) as usize, Relaxed);
        ControlFlow::Continue(())
    });
    assert!(scene.is_ok());
    assert!(calls.load(Relaxed) > 1);
    assert!(hundredths.load(Relaxed) >= 90, "{hundredths:?} %");
}

#[test]
fn a_cancelled_build_is_an_error_and_leaves_nothing() {
    let device = device();
    let before = device.memory_used();
    let (vertices, triangles) = soup(100_000);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    assert_eq!(
        code(builder.commit_with_progress(|_| ControlFlow::Break(()))),
        ErrorCode::Cancelled
    );
    assert_eq!(device.memory_used(), before);
    assert!(soup_scene(&device, SceneOptions::default()).check().is_ok());
}

#[test]
fn a_panic_in_a_progress_monitor_comes_out_of_commit() {
    let device = device();
    let (vertices, triangles) = soup(100_000);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        builder.commit_with_progress(|_| quiet_panic("in the progress monitor"))
    }));
    assert_eq!(payload(outcome), "in the progress monitor");
    assert_eq!(device.memory_used(), 0);
}

#[test]
fn a_panic_in_a_filter_comes_out_of_the_query_and_the_scene_lives_on() {
    let scene = stack(&device(), &[0.0, 1.0, 2.0], SceneOptions::default().packet_filters(true));
    let calls = AtomicUsize::new(0);
    let panic = |_: &embree_ffi::Hit| -> Verdict {
        calls.fetch_add(1, Relaxed);
        quiet_panic("in the filter")
    };
    let outcome = catch_unwind(AssertUnwindSafe(|| scene.occluded_with(&up(true), panic)));
    assert_eq!(payload(outcome), "in the filter");
    assert_eq!(calls.load(Relaxed), 1, "it is not asked again");
    let outcome = catch_unwind(AssertUnwindSafe(|| scene.intersect_with(&up(true), panic)));
    assert_eq!(payload(outcome), "in the filter");
    let packets = scene.filtered_packets::<4>(Coherence::Coherent).unwrap();
    let (mut packet, lanes): (_, Lanes<4>) = RayPacket::from_rays(&[up(true); 4]);
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        packets.occluded_with(&lanes, &mut packet, |_, hit| panic(hit))
    }));
    assert_eq!(payload(outcome), "in the filter");
    assert_eq!(calls.load(Relaxed), 3);
    assert!(scene.occluded(&up(true)));
}

#[test]
fn a_filter_may_ask_the_scene_itself() {
    let scene = stack(&device(), &[0.0, 1.0], SceneOptions::default());
    let nearest = |hit: &embree_ffi::Hit| match scene.intersect(&up(true)) {
        Some(nearest) if nearest.geometry == hit.geometry => Verdict::Accept,
        _ => Verdict::Reject,
    };
    assert!(scene.occluded_with(&up(true), nearest));
}
