//! An Embree device: the choice of kernels and threads, and the owner of all memory.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    ffi::{CStr, CString, c_char, c_void},
    fmt,
    ops::ControlFlow,
    panic::resume_unwind,
    ptr::{null_mut, without_provenance_mut},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering::Relaxed},
    },
};

use crate::{
    Error, ErrorCode, Library,
    bindings::{RTCDevice, RTCDeviceProperty, RTCError},
    monitor::{Memory, MemoryMonitor, watch_memory},
};

/// The instruction set whose kernels are to be used. It decides speed and, in the last bits, the arithmetic:
/// [`Avx2`](Isa::Avx2) and [`Avx512`](Isa::Avx512) fuse multiplications with additions, the others do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Isa {
    /// SSE2, which every x86-64 has.
    Sse2,
    /// SSE4.2
    Sse42,
    /// AVX
    Avx,
    /// AVX2 with FMA
    Avx2,
    /// AVX-512 F, CD, DQ, BW and VL
    Avx512,
}

impl Isa {
    /// All of them, oldest first.
    pub const ALL: [Isa; 5] = [Isa::Sse2, Isa::Sse42, Isa::Avx, Isa::Avx2, Isa::Avx512];

    /// Whether this processor has it. On processors that are not x86 none is.
    #[must_use]
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Isa::Sse2 => true,
            Isa::Sse42 => is_x86_feature_detected!("sse4.2"),
            Isa::Avx => is_x86_feature_detected!("avx"),
            Isa::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            Isa::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512cd")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512vl")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        false
    }

    /// Embree's word for it. A word it does not know would silently mean SSE2; hence the enumeration.
    fn word(self) -> &'static str {
        match self {
            Isa::Sse2 => "sse2",
            Isa::Sse42 => "sse4.2",
            Isa::Avx => "avx",
            Isa::Avx2 => "avx2",
            Isa::Avx512 => "avx512",
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(self.word())
    }
}

/// What a [`Device`] is to be like. The default is Embree's choice in everything.
#[derive(Default)]
pub struct DeviceConfig {
    isa: Option<Isa>,
    threads: usize,
    memory_monitor: Option<MemoryMonitor>,
}

impl DeviceConfig {
    /// Use the kernels for `isa` instead of the best this processor has.
    #[must_use]
    pub fn isa(mut self, isa: Isa) -> Self {
        self.isa = Some(isa);
        self
    }

    /// Build with at most this many threads; 0 is all. Queries run on the thread that asks.
    ///
    /// Embree's threads are shared by all devices of the process: the largest number asked for by a living one counts.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self
    }

    /// Be told of every allocation (bytes > 0) and release (bytes < 0), from any thread, several at once.
    ///
    /// [`ControlFlow::Break`] on an allocation cancels the build at hand with [`ErrorCode::OutOfMemory`]; on a release it
    /// means nothing. A panic cancels likewise, and goes on from the next call that looks for errors of this device. That is the
    /// one that was cancelled, unless several threads use the device at once: then it may be another's, and the one that was
    /// cancelled reports an error.
    #[must_use]
    pub fn memory_monitor(
        mut self,
        monitor: impl Fn(isize) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> Self {
        self.memory_monitor = Some(Box::new(monitor));
        self
    }

    fn words(&self) -> CString {
        let mut words = Vec::new();
        if self.threads > 0 {
            words.push(format!("threads={}", self.threads));
        }
        if let Some(isa) = self.isa {
            words.push(format!("isa={}", isa.word()));
        }
        CString::new(words.join(",")).expect("no word holds a zero byte")
    }
}

/// An Embree device. Cloning gives another handle to the same one; scenes keep theirs alive.
#[derive(Clone)]
pub struct Device(Arc<DeviceOwner>);

struct DeviceOwner {
    library: &'static Library,
    raw: RTCDevice,
    /// Its number, which no other device of the process has had.
    number: usize,
    memory: Arc<Memory>,
}

// SAFETY: Embree's devices may be used and released from any thread, and several at once.
unsafe impl Send for DeviceOwner {}
// SAFETY: as above.
unsafe impl Sync for DeviceOwner {}

impl Drop for DeviceOwner {
    fn drop(&mut self) {
        // SAFETY: the only reference we hold. Scenes hold this owner, so they are gone, and `memory` outlives this call.
        unsafe { self.library.api.rtcReleaseDevice(self.raw) }
    }
}

impl Device {
    /// Makes a device of the process's [`Library`].
    ///
    /// # Errors
    /// If there is no library that will do, this processor lacks the instruction set, or Embree makes no device.
    pub fn new(config: DeviceConfig) -> Result<Self, Error> {
        static DEVICES: AtomicUsize = AtomicUsize::new(0);
        let library = Library::load()?;
        if let Some(isa) = config.isa.filter(|isa| !isa.is_available()) {
            return Err(Error::UnsupportedIsa(isa));
        }
        // SAFETY: the words end in a zero byte.
        let raw = unsafe { library.api.rtcNewDevice(config.words().as_ptr()) };
        if raw.is_null() {
            return Err(creation_error(library));
        }
        let number = DEVICES.fetch_add(1, Relaxed);
        let memory = Arc::new(Memory::new(config.memory_monitor));
        // SAFETY: the device is alive; `memory` has its own place on the heap until after the device is gone, and the number is
        // only read as a number.
        unsafe {
            let number = without_provenance_mut(number);
            library.api.rtcSetDeviceErrorFunction(raw, Some(remember_message), number);
            let memory = Arc::as_ptr(&memory).cast_mut().cast();
            library.api.rtcSetDeviceMemoryMonitorFunction(raw, Some(watch_memory), memory);
        }
        Ok(Self(Arc::new(DeviceOwner { library, raw, number, memory })))
    }

    /// The library it belongs to.
    #[must_use]
    pub fn library(&self) -> &'static Library {
        self.0.library
    }

    /// Bytes Embree holds for this device now: buffers and acceleration structures of its scenes.
    #[must_use]
    pub fn memory_used(&self) -> usize {
        self.0.memory.used()
    }

    /// What this device and its library were built for.
    #[must_use]
    pub fn properties(&self) -> DeviceProperties {
        let has = |property| self.0.library.property(self.0.raw, property) != 0;
        DeviceProperties {
            native_packets_of_4: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED),
            native_packets_of_8: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED),
            native_packets_of_16: has(
                RTCDeviceProperty::RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED,
            ),
            ray_masks: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED),
            filters: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED),
            backface_culling: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED),
            ignores_invalid_rays: has(
                RTCDeviceProperty::RTC_DEVICE_PROPERTY_IGNORE_INVALID_RAYS_ENABLED,
            ),
            always_compact: has(RTCDeviceProperty::RTC_DEVICE_PROPERTY_COMPACT_POLYS_ENABLED),
        }
    }

    pub(crate) fn raw(&self) -> RTCDevice {
        self.0.raw
    }

    /// The first error this thread met on this device since the last look. Goes on with a memory monitor's panic, whichever
    /// thread's it was: Embree calls the monitor on threads of its own, and does not say for which build.
    pub(crate) fn take_error(&self) -> Result<(), Error> {
        // SAFETY: the device is alive.
        let code = unsafe { self.0.library.api.rtcGetDeviceError(self.0.raw) };
        let message = MESSAGES.with_borrow_mut(|messages| messages.remove(&self.0.number));
        if let Some(payload) = self.0.memory.take_panic() {
            resume_unwind(payload);
        }
        match code {
            RTCError::RTC_ERROR_NONE => Ok(()),
            code => {
                let (code, message) = (ErrorCode::from_raw(code), message.unwrap_or_default());
                Err(Error::Embree { code, message })
            }
        }
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter
            .debug_struct("Device")
            .field("memory_used", &self.memory_used())
            .finish_non_exhaustive()
    }
}

/// What a device and its library were built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceProperties {
    /// Kernels for 4 rays at once.
    pub native_packets_of_4: bool,
    /// Kernels for 8 rays at once; they need AVX.
    pub native_packets_of_8: bool,
    /// Kernels for 16 rays at once; they need AVX-512.
    pub native_packets_of_16: bool,
    /// Masks are obeyed. Always so: a library without is refused.
    pub ray_masks: bool,
    /// Filters are called. Always so: a library without is refused.
    pub filters: bool,
    /// Triangles block from one side only. Not the default of Embree's build.
    pub backface_culling: bool,
    /// Rays with NaN or infinities are dropped instead of traced.
    pub ignores_invalid_rays: bool,
    /// Every scene is compact.
    pub always_compact: bool,
}

thread_local! {
    /// By the number of a device, Embree's words for its first error on this thread since the last look: of that, Embree keeps the code. It
    /// reports where the failing call was made.
    static MESSAGES: RefCell<BTreeMap<usize, String>> = const { RefCell::new(BTreeMap::new()) };
}

unsafe extern "C" fn remember_message(device: *mut c_void, _: RTCError, message: *const c_char) {
    if !message.is_null() {
        // SAFETY: Embree passes a string that ends in a zero byte.
        let message = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
        // Not while the thread is being torn down: then nobody will ask.
        let _ = MESSAGES.try_with(|messages| {
            messages.borrow_mut().entry(device.addr()).or_insert(message);
        });
    }
}

/// Why `rtcNewDevice` made none; there is no device to ask, so Embree keeps it with the thread.
fn creation_error(library: &Library) -> Error {
    // SAFETY: a null device is allowed here, and means this thread. The message stays until the next error.
    unsafe {
        let code = ErrorCode::from_raw(library.api.rtcGetDeviceError(null_mut()));
        let message = library
            .last_error_message
            .map(|last| last(null_mut()))
            .filter(|message| !message.is_null());
        let message = message.map(|message| CStr::from_ptr(message).to_string_lossy().into_owned());
        Error::Embree { code, message: message.unwrap_or_else(|| "no device".into()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bindings::RTCGeometryType;

    #[test]
    fn of_several_errors_the_first_of_each_device_is_told_with_its_own_words() {
        let api = &Library::load().unwrap_or_else(|error| panic!("{error}")).api;
        let device = || Device::new(DeviceConfig::default()).unwrap();
        let no_geometry = |device: &Device| {
            // SAFETY: the device is alive, and Embree refuses what it does not know.
            unsafe { api.rtcNewGeometry(device.raw(), RTCGeometryType(99)) };
        };
        let no_property = |device: &Device| {
            // SAFETY: as above.
            unsafe { api.rtcGetDeviceProperty(device.raw(), RTCDeviceProperty(9999)) };
        };
        let alone = |refused: &dyn Fn(&Device)| {
            let device = device();
            refused(&device);
            device.take_error().unwrap_err()
        };
        let (geometry, property) = (alone(&no_geometry), alone(&no_property));
        assert_ne!(geometry, property);
        let (first, second) = (device(), device());
        no_geometry(&first);
        no_property(&second);
        no_property(&first);
        no_geometry(&second);
        assert_eq!(first.take_error(), Err(geometry));
        assert_eq!(second.take_error(), Err(property));
        assert_eq!((first.take_error(), second.take_error()), (Ok(()), Ok(())));
    }
}
