//! The cache that outlives `cargo clean`.

use std::{
    env,
    path::{Path, PathBuf},
};

use super::wheel::{Platform, WHEEL_VERSION};

/// The user's folder for caches, by the custom of the system.
pub fn cache_root() -> Option<PathBuf> {
    let folder =
        |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    folder("XDG_CACHE_HOME").or_else(|| {
        if cfg!(windows) {
            folder("LOCALAPPDATA")
        } else if cfg!(target_os = "macos") {
            folder("HOME").map(|home| home.join("Library/Caches"))
        } else {
            folder("HOME").map(|home| home.join(".cache"))
        }
    })
}

/// The folder for one platform's libraries under `root`.
pub fn cache_folder(root: &Path, platform: &Platform) -> PathBuf {
    root.join("embree-ffi").join(format!("embreex-{WHEEL_VERSION}-{}", platform.name))
}

/// Where the fetched library lies, or will.
pub fn cache_path(platform: &Platform) -> Option<PathBuf> {
    Some(cache_folder(&cache_root()?, platform).join(platform.library))
}

/// The fetched library, if it is there. The folder appears in one rename, so what is there is whole.
pub fn cached_library(platform: &Platform) -> Option<PathBuf> {
    cache_path(platform).filter(|path| path.is_file())
}
