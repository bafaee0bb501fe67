//! What work is measured in: instructions retired by this thread, where the system counts them, else
//! the thread's CPU time.
//!
//! The paper counted cycles of an idealised processor with *pixie*, which are the same in every run.
//! Instructions come nearest to that. Elsewhere, only repetition makes times repeatable: see `lockstep`.

#![allow(unsafe_code)]

use std::ffi::{c_int, c_long};
use std::fs::File;
use std::io::Read;
use std::os::fd::FromRawFd;

use serde::Serialize;

/// What a [`Meter`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// Instructions of this thread, those of the system apart.
    Instructions,
    /// Nanoseconds that this thread ran.
    CpuNanoseconds,
}

impl Unit {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Instructions => "retired instructions",
            Self::CpuNanoseconds => "nanoseconds of CPU time",
        }
    }
}

/// Counts the work of the thread that made it.
pub struct Meter {
    /// The counter of the system, if there is one.
    instructions: Option<File>,
}

impl Meter {
    /// Starts counting what this thread does.
    #[must_use]
    pub fn start() -> Self {
        Self { instructions: open_counter() }
    }

    /// What is counted.
    #[must_use]
    pub fn unit(&self) -> Unit {
        match self.instructions {
            Some(_) => Unit::Instructions,
            None => Unit::CpuNanoseconds,
        }
    }

    /// The count so far.
    ///
    /// # Panics
    /// If the system stops counting.
    #[must_use]
    pub fn read(&self) -> u64 {
        match &self.instructions {
            Some(counter) => read_counter(counter).expect("the counter was read before"),
            None => thread_time(),
        }
    }
}

fn read_counter(mut counter: &File) -> Option<u64> {
    let mut count = [0; 8];
    counter.read_exact(&mut count).ok()?;
    Some(u64::from_ne_bytes(count))
}

/// The first version of the system's `perf_event_attr`.
#[repr(C)]
#[derive(Default)]
struct Attributes {
    kind: u32,
    size: u32,
    config: u64,
    sample_period: u64,
    sample_type: u64,
    read_format: u64,
    flags: u64,
    wakeup_events: u32,
    breakpoint_type: u32,
    config1: u64,
}

const HARDWARE: u32 = 0;
const INSTRUCTIONS: u64 = 1;
const EXCLUDE_KERNEL: u64 = 1 << 5;
const EXCLUDE_HYPERVISOR: u64 = 1 << 6;
const CLOSE_ON_EXEC: c_long = 1 << 3;

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
const PERF_EVENT_OPEN: Option<c_long> = Some(298);
#[cfg(all(target_os = "linux", target_arch = "aarch64"))]
const PERF_EVENT_OPEN: Option<c_long> = Some(241);
#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"))))]
const PERF_EVENT_OPEN: Option<c_long> = None;

#[repr(C)]
#[derive(Default)]
struct TimeSpec {
    seconds: i64,
    nanoseconds: c_long,
}

const THREAD_CPU_TIME: c_int = 3;

unsafe extern "C" {
    fn syscall(number: c_long, ...) -> c_long;
    fn clock_gettime(clock: c_int, time: *mut TimeSpec) -> c_int;
}

/// A counter of the calling thread's instructions, if the system has one and it counts.
fn open_counter() -> Option<File> {
    let number = PERF_EVENT_OPEN?;
    let attributes = Attributes {
        kind: HARDWARE,
        size: size_of::<Attributes>() as u32,
        config: INSTRUCTIONS,
        flags: EXCLUDE_KERNEL | EXCLUDE_HYPERVISOR,
        ..Attributes::default()
    };
    let (this_thread, any_processor, no_group): (c_long, c_long, c_long) = (0, -1, -1);
    // SAFETY: the call reads `size` bytes of the attributes, which live until it returns.
    let descriptor = unsafe {
        let attributes: *const Attributes = &raw const attributes;
        syscall(number, attributes, this_thread, any_processor, no_group, CLOSE_ON_EXEC)
    };
    let descriptor = c_int::try_from(descriptor).ok().filter(|&descriptor| descriptor >= 0)?;
    // SAFETY: the system just opened it, and nobody else knows it.
    let counter = unsafe { File::from_raw_fd(descriptor) };
    // Some virtual machines hand out counters that stand still.
    let before = read_counter(&counter)?;
    (read_counter(&counter)? > before).then_some(counter)
}

/// Nanoseconds that the calling thread ran.
#[must_use]
pub fn thread_time() -> u64 {
    let mut time = TimeSpec::default();
    // SAFETY: the call writes one `timespec`, whose layout on 64-bit systems this is.
    let outcome = unsafe { clock_gettime(THREAD_CPU_TIME, &raw mut time) };
    assert_eq!(outcome, 0, "the thread's clock is to be had since Linux 2.6.12");
    time.seconds as u64 * 1_000_000_000 + time.nanoseconds as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_meter_counts_work() {
        let meter = Meter::start();
        let mut spent = [0, 0];
        for (spent, rounds) in spent.iter_mut().zip([1_000_000u64, 8_000_000]) {
            let before = meter.read();
            std::hint::black_box((0..rounds).fold(0, |sum, n| std::hint::black_box(sum ^ n)));
            *spent = meter.read() - before;
        }
        assert!(spent[0] > 0 && spent[1] > 2 * spent[0], "{spent:?} {}", meter.unit().name());
    }
}
