//! What work is measured in: instructions of this thread, counted by Callgrind or by the processor, else
//! the thread's CPU time.
//!
//! The paper counted cycles of an idealised processor with *pixie*, which are the same in every run.
//! Instructions come nearest to that. Times become repeatable by repetition only: see `lockstep`.

#![allow(unsafe_code)]

use std::ffi::{c_int, c_long};
use std::fs::File;
use std::io::{self, Read};
use std::os::fd::FromRawFd;

use serde::Serialize;

use super::callgrind::Callgrind;

/// What a [`Meter`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// Instructions of this thread on Valgrind's simulated processor.
    CallgrindInstructions,
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
            Self::CallgrindInstructions => "instructions counted by Callgrind",
            Self::Instructions => "retired instructions",
            Self::CpuNanoseconds => "nanoseconds of CPU time",
        }
    }
}

/// Counts the work of the thread that made it.
pub enum Meter {
    /// By instructions on Valgrind's simulated processor.
    Callgrind(Callgrind),
    /// By the system's counter of instructions.
    Counter(File),
    /// By the thread's clock.
    Clock,
}

impl Meter {
    /// Starts counting what this thread does, by the system's counter if there is one.
    #[must_use]
    pub fn start() -> Self {
        open_counter().map_or(Self::Clock, Self::Counter)
    }

    /// What is counted.
    #[must_use]
    pub fn unit(&self) -> Unit {
        match self {
            Self::Callgrind(_) => Unit::CallgrindInstructions,
            Self::Counter(_) => Unit::Instructions,
            Self::Clock => Unit::CpuNanoseconds,
        }
    }

    /// The count so far.
    ///
    /// # Errors
    /// If it cannot be read any more.
    pub fn read(&self) -> io::Result<u64> {
        match self {
            Self::Callgrind(callgrind) => callgrind.read(),
            Self::Counter(counter) => read_counter(counter),
            Self::Clock => Ok(thread_time()),
        }
    }
}

fn read_counter(mut counter: &File) -> io::Result<u64> {
    let mut count = [0; 8];
    counter.read_exact(&mut count)?;
    Ok(u64::from_ne_bytes(count))
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

const PROCESS_CPU_TIME: c_int = 2;
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
    let before = read_counter(&counter).ok()?;
    (read_counter(&counter).ok()? > before).then_some(counter)
}

/// Nanoseconds that the calling thread ran.
#[must_use]
pub fn thread_time() -> u64 {
    time(THREAD_CPU_TIME)
}

/// Nanoseconds that all threads of this process ran, together.
#[must_use]
pub fn process_time() -> u64 {
    time(PROCESS_CPU_TIME)
}

fn time(clock: c_int) -> u64 {
    let mut time = TimeSpec::default();
    // SAFETY: the call writes one `timespec`, whose layout on 64-bit systems this is.
    let outcome = unsafe { clock_gettime(clock, &raw mut time) };
    assert_eq!(outcome, 0, "these clocks are to be had since Linux 2.6.12");
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
            let before = meter.read().unwrap();
            std::hint::black_box((0..rounds).fold(0, |sum, n| std::hint::black_box(sum ^ n)));
            *spent = meter.read().unwrap() - before;
        }
        assert!(spent[0] > 0 && spent[1] > 2 * spent[0], "{spent:?} {}", meter.unit().name());
    }
}
