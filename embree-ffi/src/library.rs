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
    supply::{self, Candidate, EMBREE_DIR, Platform, SYSTEM_NAMES, Surroundings, Version},
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
    ///
    /// # Errors
    /// If there is none, or none that will do: the line says what to do.
    pub fn load() -> Result<&'static Library, Error> {
        static LIBRARY: OnceLock<Result<Library, Error>> = OnceLock::new();
        LIBRARY.get_or_init(|| Self::find(&surroundings())).as_ref().map_err(Error::clone)
    }

    /// Its version.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// The file it was loaded from, or the bare name the system found it by.
    #[must_use]
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
                Err(_) if !candidate.is_there() => {}
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
        let library =
            unsafe { supply::open(&candidate.path) }.map_err(|error| supply::one_line(&error))?;
        // Never unloaded, whatever comes: its task scheduler may have started threads.
        let library: &'static libloading::Library = Box::leak(Box::new(library));
        // SAFETY: as above.
        let version = unsafe { supply::version_of(library) }?;
        version.check()?;
        // SAFETY: the version says that the functions are those of our header; opening it again adds a reference.
        let api =
            unsafe { supply::open(&candidate.path).and_then(|again| Embree::from_library(again)) };
        let api = api.map_err(|error| supply::one_line(&error))?;
        // SAFETY: this is that function's type.
        let last_error_message = unsafe { library.get(b"rtcGetDeviceLastErrorMessage\0") }
            .map_or(None, |symbol| *symbol);
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
        cached: Platform::of_this_program().and_then(|platform| supply::cached_library(&platform)),
        system: SYSTEM_NAMES,
    }
}

impl std::fmt::Debug for Library {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter
            .debug_struct("Library")
            .field("version", &self.version)
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fs, process::Command};

    /// A library in `folder` that calls itself Embree of the version `number`, and can do nothing else.
    fn impostor(folder: &Path, number: u32) -> PathBuf {
        let source = folder.join("impostor.rs");
        let text = "#[unsafe(no_mangle)] pub extern \"C\" fn rtcNewDevice(_: *const i8) -> usize { 1 }
            #[unsafe(no_mangle)] pub extern \"C\" fn rtcGetDeviceProperty(_: usize, _: i32) -> isize { NUMBER }
            #[unsafe(no_mangle)] pub extern \"C\" fn rtcReleaseDevice(_: usize) {}";
        fs::write(&source, text.replace("NUMBER", &number.to_string())).unwrap();
        let library = folder.join(SYSTEM_NAMES[0]);
        let rustc = env::var_os("RUSTC").unwrap_or("rustc".into());
        let mut compile = Command::new(rustc);
        compile.args(["--edition=2024", "--crate-type=cdylib", "-o"]).arg(&library).arg(&source);
        assert!(compile.status().unwrap().success());
        library
    }

    fn in_folder(folder: &Path) -> Surroundings {
        Surroundings { embree_dir: Some(folder.into()), ..Default::default() }
    }

    fn one_line_of(outcome: Result<Library, Error>) -> String {
        let line = outcome.unwrap_err().to_string();
        assert!(!line.contains('\n'), "{line}");
        line
    }

    #[test]
    fn an_empty_embree_dir_is_told_and_nothing_else_is_tried() {
        let folder = tempfile::tempdir().unwrap();
        let surroundings =
            Surroundings { embree_dir: Some(folder.path().into()), ..surroundings() };
        let line = one_line_of(Library::find(&surroundings));
        assert!(line.starts_with("Embree is missing (EMBREE_DIR is "), "{line}");
    }

    #[test]
    fn without_any_library_the_line_says_why_and_the_three_ways_to_supply_one() {
        let reason = "pip download: no matching release";
        let line = one_line_of(Library::find(&Surroundings {
            reason: Some(reason.into()),
            ..Default::default()
        }));
        assert_eq!(
            line,
            "Embree is missing (pip download: no matching release): set EMBREE_DIR to a folder that holds it, or install \
             Embree 4.3 or later where the system finds libraries, or rebuild where `python3 -m pip` reaches a package \
             index (the build then fetches the wheel embreex)"
        );
    }

    #[test]
    fn embree_4_2_and_5_are_refused_with_the_reason() {
        for (number, reason) in
            [(40_200, "4.3 made RTCHit and RTCRayQueryContext larger"), (50_000, "is too new")]
        {
            let folder = tempfile::tempdir().unwrap();
            impostor(folder.path(), number);
            let line = one_line_of(Library::find(&in_folder(folder.path())));
            assert!(
                line.contains("from EMBREE_DIR is refused: Embree ") && line.contains(reason),
                "{line}"
            );
        }
    }

    #[test]
    fn an_embree_that_lacks_a_function_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        impostor(folder.path(), 40_400);
        let line = one_line_of(Library::find(&in_folder(folder.path())));
        assert!(line.contains("is refused") && line.contains("rtc"), "{line}");
    }

    #[test]
    fn a_file_that_is_no_library_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(SYSTEM_NAMES[0]), "not a library").unwrap();
        assert!(one_line_of(Library::find(&in_folder(folder.path()))).contains("is refused"));
    }

    #[test]
    fn an_old_library_does_not_stand_in_the_way_of_a_good_one() {
        let folder = tempfile::tempdir().unwrap();
        let old = impostor(folder.path(), 40_200);
        let good = Library::load().unwrap_or_else(|error| panic!("{error}")).path().to_owned();
        let surroundings =
            Surroundings { recorded: Some(old), cached: Some(good.clone()), ..Default::default() };
        assert_eq!(Library::find(&surroundings).unwrap().path(), good);
    }

    #[test]
    #[cfg(unix)]
    fn embree_dir_is_taken_before_all_else() {
        let good = Library::load().unwrap_or_else(|error| panic!("{error}")).path().to_owned();
        // A bare name says that the system found it, and not where.
        if !good.is_absolute() {
            eprintln!("*** NOT TESTED: where the system's Embree lies is not known ***");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join(SYSTEM_NAMES[0]);
        std::os::unix::fs::symlink(&good, &link).unwrap();
        let found = Library::find(&Surroundings {
            embree_dir: Some(folder.path().into()),
            ..surroundings()
        })
        .unwrap();
        assert_eq!(found.path(), link);
    }
}
