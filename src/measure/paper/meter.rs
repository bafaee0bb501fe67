//! What work is measured in: instructions of this thread, counted by Callgrind or by the processor, else
//! the thread's CPU time.
//!
//! The paper counted cycles of an idealised processor with *pixie*, which are the same in every run.
//! Instructions come nearest to that. Times become repeatable by repetition only: see `lockstep`.

use std::fs::File;
use std::io::{self, Read};

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
        counter::open().map_or(Self::Clock, Self::Counter)
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

/// Nanoseconds that the calling thread ran. They are known on Linux; elsewhere it is the time that went by.
#[must_use]
pub fn thread_time() -> u64 {
    clock::thread()
}

/// Nanoseconds that all threads of this process ran, together. They are known on Linux; elsewhere it is the time that went by.
#[must_use]
pub fn process_time() -> u64 {
    clock::process()
}

#[cfg(target_os = "linux")]
mod clock {
    use rustix::time::{ClockId, clock_gettime};

    pub fn thread() -> u64 {
        time(ClockId::ThreadCPUTime)
    }

    pub fn process() -> u64 {
        time(ClockId::ProcessCPUTime)
    }

    fn time(clock: ClockId) -> u64 {
        let time = clock_gettime(clock);
        time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
    }
}

#[cfg(not(target_os = "linux"))]
mod clock {
    use std::{sync::LazyLock, time::Instant};

    /// When it was first asked.
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);

    pub fn thread() -> u64 {
        START.elapsed().as_nanos() as u64
    }

    pub use thread as process;
}

/// The system's counter of instructions.
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod counter {
    use std::ffi::{c_int, c_long};
    use std::fs::File;
    use std::os::fd::FromRawFd;

    use super::read_counter;

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
    const PERF_EVENT_OPEN: c_long = if cfg!(target_arch = "x86_64") { 298 } else { 241 };

    unsafe extern "C" {
        fn syscall(number: c_long, ...) -> c_long;
    }

    /// A counter of the calling thread's instructions, if there is one and it counts.
    pub fn open() -> Option<File> {
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
            syscall(
                PERF_EVENT_OPEN,
                attributes,
                this_thread,
                any_processor,
                no_group,
                CLOSE_ON_EXEC,
            )
        };
        let descriptor = c_int::try_from(descriptor).ok().filter(|&descriptor| descriptor >= 0)?;
        // SAFETY: the system just opened it, and nobody else knows it.
        let counter = unsafe { File::from_raw_fd(descriptor) };
        // Some virtual machines hand out counters that stand still.
        let before = read_counter(&counter).ok()?;
        (read_counter(&counter).ok()? > before).then_some(counter)
    }
}

/// We know none elsewhere.
#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"))))]
mod counter {
    pub fn open() -> Option<std::fs::File> {
        None
    }
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
