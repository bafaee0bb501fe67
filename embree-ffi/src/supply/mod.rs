//! Where the Embree library comes from: a folder the user names, the system, or a pinned Python wheel kept in a cache.
//!
//! Plain `std` and `libloading` only, because the build script compiles these files too.
//! Each side uses its half: the build script [`fetch`]es, the crate only looks.
#![allow(dead_code, unused_imports)]

mod cache;
mod fetch;
mod files;
mod version;
mod wheel;

pub use cache::{cache_path, cached_library};
pub use fetch::fetch;
pub use files::{SYSTEM_NAMES, library_in};
pub use version::{Version, is_suitable, one_line, version_of};
pub use wheel::{Platform, WHEEL_VERSION};

/// The folder of an Embree installation, or of the library itself. When set, nothing else is looked at.
pub const EMBREE_DIR: &str = "EMBREE_DIR";

/// The three ways out, for the end of every "not found".
pub const REMEDY: &str = "set EMBREE_DIR to a folder that holds it, or install Embree 4.3 or later where the system finds \
    libraries, or rebuild where `python3 -m pip` reaches a package index (the build then fetches the wheel embreex)";

/// What the loader is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Candidate {
    /// A full path, or a bare name for the system's search.
    pub path: std::path::PathBuf,
    /// How we came by it, for messages.
    pub origin: &'static str,
}

impl Candidate {
    /// Whether there is such a file, or the system's search finds one.
    pub fn is_there(&self) -> bool {
        if !is_bare(&self.path) {
            return self.path.is_file();
        }
        // SAFETY: a library of this name is taken to be Embree. It is unloaded only if nothing of it was used.
        unsafe { open(&self.path) }.is_ok()
    }
}

fn is_bare(path: &std::path::Path) -> bool {
    path.components().count() == 1
}

/// Where to look, in order. Taken as values so that every case can be tried without touching the environment.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    /// `EMBREE_DIR` as it is now.
    pub embree_dir: Option<std::path::PathBuf>,
    /// What the build script settled on; a bare name when it was the system's.
    pub recorded: Option<std::path::PathBuf>,
    /// Why the build script settled on nothing.
    pub reason: Option<String>,
    /// The fetched library, if it is there.
    pub cached: Option<std::path::PathBuf>,
    /// Names for the system's search.
    pub system: &'static [&'static str],
}

impl Surroundings {
    /// The libraries to try, best first, or one line that says what is missing.
    pub fn candidates(&self) -> Result<Vec<Candidate>, String> {
        if let Some(folder) = &self.embree_dir {
            return match library_in(folder) {
                Some(path) => Ok(vec![Candidate { path, origin: "EMBREE_DIR" }]),
                None => Err(format!(
                    "EMBREE_DIR is {}, which holds no Embree 4 library",
                    folder.display()
                )),
            };
        }
        let mut found = Vec::new();
        if let Some(path) = &self.recorded {
            let bare = is_bare(path);
            if bare || path.is_file() {
                found.push(Candidate {
                    path: path.clone(),
                    origin: if bare { "the system" } else { "the build" },
                });
            }
        }
        found.extend(
            self.cached.iter().map(|path| Candidate { path: path.clone(), origin: "the cache" }),
        );
        found.extend(
            self.system.iter().map(|name| Candidate { path: name.into(), origin: "the system" }),
        );
        Ok(found)
    }
}

/// Loads the library at `path` with the folder it lies in searched for what it needs in turn (TBB).
///
/// # Safety
/// Loading runs the library's initialisers: it must be what its name says.
pub unsafe fn open(path: &std::path::Path) -> Result<libloading::Library, libloading::Error> {
    #[cfg(windows)]
    if path.is_absolute() {
        use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library};
        // SAFETY: the caller vouches for the library.
        return unsafe { Library::load_with_flags(path, LOAD_WITH_ALTERED_SEARCH_PATH) }
            .map(Into::into);
    }
    // SAFETY: the caller vouches for the library. On Linux and macOS the wheel's library names its own folder for TBB.
    unsafe { libloading::Library::new(path) }
}
