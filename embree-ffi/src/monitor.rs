//! Watching Embree work: the memory it holds, and how far a build has come. Nothing unwinds into Embree.

use std::{
    any::Any,
    ffi::c_void,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicIsize, Ordering::Relaxed},
    },
};

pub(crate) type MemoryMonitor = Box<dyn Fn(isize) -> ControlFlow<()> + Send + Sync>;
type Panic = Box<dyn Any + Send>;

/// What a device's memory monitor knows.
pub(crate) struct Memory {
    used: AtomicIsize,
    monitor: Option<MemoryMonitor>,
    panic: Mutex<Option<Panic>>,
}

impl Memory {
    pub(crate) fn new(monitor: Option<MemoryMonitor>) -> Self {
        Self { used: AtomicIsize::new(0), monitor, panic: Mutex::new(None) }
    }

    pub(crate) fn used(&self) -> usize {
        usize::try_from(self.used.load(Relaxed)).unwrap_or(0)
    }

    pub(crate) fn take_panic(&self) -> Option<Panic> {
        self.panic.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Called before (`post` false) or after an allocation, and with a negative number around a release.
pub(crate) unsafe extern "C" fn watch_memory(
    memory: *mut c_void,
    bytes: isize,
    post: bool,
) -> bool {
    // SAFETY: the device was given a `Memory` that outlives it, and shares it only by reference.
    let memory = unsafe { &*memory.cast::<Memory>() };
    let go_on = match &memory.monitor {
        None => true,
        Some(monitor) => guarded(&memory.panic, || monitor(bytes)),
    };
    // An allocation refused beforehand does not take place; every other event does.
    if go_on || post || bytes < 0 {
        memory.used.fetch_add(bytes, Relaxed);
    }
    go_on
}

/// What a build's progress monitor needs; it lives while the build runs.
pub(crate) struct Progress<'p> {
    monitor: &'p (dyn Fn(f64) -> ControlFlow<()> + Sync),
    panic: Mutex<Option<Panic>>,
}

impl<'p> Progress<'p> {
    pub(crate) fn new(monitor: &'p (dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Self {
        Self { monitor, panic: Mutex::new(None) }
    }

    pub(crate) fn take_panic(self) -> Option<Panic> {
        self.panic.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(crate) unsafe extern "C" fn watch_progress(progress: *mut c_void, fraction: f64) -> bool {
    // SAFETY: the scene was given a `Progress` that outlives the build, and shares it only by reference.
    let progress = unsafe { &*progress.cast::<Progress>() };
    guarded(&progress.panic, || (progress.monitor)(fraction))
}

/// Whether to go on; the first panic is kept for later and means no.
fn guarded(panic: &Mutex<Option<Panic>>, monitor: impl FnOnce() -> ControlFlow<()>) -> bool {
    match catch_unwind(AssertUnwindSafe(monitor)) {
        Ok(answer) => answer.is_continue(),
        Err(payload) => {
            panic.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(payload);
            false
        }
    }
}
