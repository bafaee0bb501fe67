//! Settles where Embree comes from, and never fails: without Embree the crate still builds, and says so when asked.

#[path = "src/supply/mod.rs"]
mod supply;

use std::{env, path::Path};

use supply::{EMBREE_DIR, Platform, SYSTEM_NAMES};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/supply");
    for name in [EMBREE_DIR, "XDG_CACHE_HOME", "HOME", "LOCALAPPDATA"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    match settle() {
        Ok(library) => {
            println!("cargo:rustc-env=EMBREE_FFI_LIBRARY={library}");
            println!("cargo:rustc-env=EMBREE_FFI_REASON=");
            if env::var_os("CARGO_FEATURE_WITNESS").is_some() {
                lay_out_for_the_linker(Path::new(&library));
            }
        }
        Err(reason) => {
            println!("cargo:rustc-env=EMBREE_FFI_LIBRARY=");
            println!("cargo:rustc-env=EMBREE_FFI_REASON={reason}");
            println!("cargo:warning=embree-ffi builds without Embree: {reason}");
        }
    }
}

/// A path, or a bare name for the system's search; else one line of why not.
fn settle() -> Result<String, String> {
    if let Some(folder) = env::var_os(EMBREE_DIR).filter(|folder| !folder.is_empty()) {
        println!("cargo:rerun-if-changed={}", Path::new(&folder).display());
        let surroundings =
            supply::Surroundings { embree_dir: Some(folder.into()), ..Default::default() };
        return Ok(surroundings.candidates()?[0].path.display().to_string());
    }
    if env::var("HOST") == env::var("TARGET")
        && let Some(name) = SYSTEM_NAMES.iter().find(|name| supply::is_suitable(Path::new(name)))
    {
        return Ok(name.to_string());
    }
    let target = |what: &str| env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default();
    let platform = Platform::named(&target("OS"), &target("ARCH"), &target("ENV"))
        .ok_or("there is no wheel of it for this target")?;
    if let Some(path) = supply::cached_library(&platform) {
        return Ok(watched(&path));
    }
    fetched(&platform).inspect_err(|_| {
        // A path that never exists makes cargo run us every time: so a failed fetch is tried anew.
        println!("cargo:rerun-if-changed=there-is-no-embree");
    })
}

fn fetched(platform: &Platform) -> Result<String, String> {
    if env::var("CARGO_NET_OFFLINE").is_ok_and(|word| word == "true")
        || env::var_os("DOCS_RS").is_some()
    {
        return Err("it is not in the cache, and this build is offline".into());
    }
    supply::fetch(platform).map(|path| watched(&path))
}

/// Cargo runs us again when the file is gone: so a deleted cache is refilled.
fn watched(library: &Path) -> String {
    println!("cargo:rerun-if-changed={}", library.display());
    library.display().to_string()
}

/// For the witness test only: `embree4-sys` links with `-lembree4`, so a folder must hold the library under that name.
fn lay_out_for_the_linker(library: &Path) {
    #[cfg(unix)]
    if let (Some(folder), Some(out)) =
        (library.parent().filter(|_| library.is_absolute()), env::var_os("OUT_DIR"))
    {
        let out = Path::new(&out).join("link");
        let _ = std::fs::create_dir_all(&out);
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let _ = std::os::unix::fs::symlink(entry.path(), out.join(entry.file_name()));
        }
        let name = if cfg!(target_os = "macos") { "libembree4.dylib" } else { "libembree4.so" };
        let _ = std::os::unix::fs::symlink(library, out.join(name));
        println!("cargo:rustc-link-search=native={}", out.display());
    }
    #[cfg(not(unix))]
    let _ = library;
}
