//! The Embree library in this process: found once, checked once, kept for good.

use std::{
    env,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use crate::{
    Error,
    bindings::{Embree, RTCDevice, RTCDeviceProperty, RTCGetDeviceLastErrorMessageFunction},
    layout,
    supply::{self, Candidate, EMBREE_DIR, Surroundings, Version},
};

/// A loaded Embree of an accepted version and build.
pub struct Library {
    pub(crate) api: Embree,
    /// Since 4.3.3.
    pub(crate) last_error_message: RTCGetDeviceLastErrorMessageFunction,
    version: Version,
    path: PathBuf,
}

impl Library {
    /// The process's Embree. The first call finds it (`EMBREE_DIR`, what the build found, the cache, the system) and checks
    /// it; all later calls give the same answer.
    pub fn load() -> Result<&'static Library, Error> {
        static LIBRARY: OnceLock<Result<Library, Error>> = OnceLock::new();
        LIBRARY.get_or_init(|| Self::find(&surroundings())).as_ref().map_err(Error::clone)
    }

    /// Its version.
    pub fn version(&self) -> Version {
        self.version
    }

    /// The file it was loaded from, or the bare name the system found it by.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The first candidate that will do. One that is there and refused is worse news than one that is not there.
    fn find(surroundings: &Surroundings) -> Result<Library, Error> {
        let candidates = surroundings.candidates().map_err(|reason| Error::Missing { reason })?;
        let mut refusal = None;
        for candidate in candidates {
            match Self::open(&candidate) {
                Ok(library) => return Ok(library),
                // The system's search knows no file: that is "not found".
                Err(_) if candidate.is_bare() && !candidate.is_loadable() => {}
                Err(reason) => {
                    let Candidate { path, origin } = candidate;
                    refusal.get_or_insert(Error::Refused { path, origin, reason });
                }
            }
        }
        let reason = surroundings.reason.clone().filter(|reason| !reason.is_empty());
        let reason = reason.unwrap_or_else(|| "it is no longer where the build found it".into());
        Err(refusal.unwrap_or(Error::Missing { reason }))
    }

    fn open(candidate: &Candidate) -> Result<Library, String> {
        // SAFETY: a file of this name in a place the user or the system set aside for libraries is taken to be Embree.
        let library = unsafe { supply::open(&candidate.path) }.map_err(|error| supply::one_line(&error))?;
        // Never unloaded, whatever comes: its task scheduler may have started threads.
        let library: &'static libloading::Library = Box::leak(Box::new(library));
        // SAFETY: as above.
        let version = unsafe { supply::version_of(library) }?;
        version.check()?;
        // SAFETY: the version says that the functions are those of our header; opening it again adds a reference.
        let api = unsafe { supply::open(&candidate.path).and_then(|again| Embree::from_library(again)) };
        let api = api.map_err(|error| supply::one_line(&error))?;
        // SAFETY: this is that function's type.
        let last_error_message = unsafe { library.get(b"rtcGetDeviceLastErrorMessage\0") }.map_or(None, |symbol| *symbol);
        layout::check(&api)?;
        Ok(Library { api, last_error_message, version, path: candidate.path.clone() })
    }

    pub(crate) fn property(&self, device: RTCDevice, property: RTCDeviceProperty) -> isize {
        // SAFETY: the caller's device is alive.
        unsafe { self.api.rtcGetDeviceProperty(device, property) }
    }
}

/// What the build recorded, and the environment as it is now.
fn surroundings() -> Surroundings {
    let some = |text: &str| Some(text.to_owned()).filter(|text| !text.is_empty());
    Surroundings {
        embree_dir: env::var_os(EMBREE_DIR).filter(|folder| !folder.is_empty()).map(PathBuf::from),
        recorded: some(env!("EMBREE_FFI_LIBRARY")).map(PathBuf::from),
        reason: some(env!("EMBREE_FFI_REASON")),
    }
}
