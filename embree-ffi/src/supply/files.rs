//! Recognising an Embree 4 library by its file name.

use std::path::{Path, PathBuf};

/// What the system's own search is asked for.
pub const SYSTEM_NAMES: &[&str] = if cfg!(windows) {
    &["embree4.dll"]
} else if cfg!(target_os = "macos") {
    &["libembree4.dylib", "/usr/local/lib/libembree4.dylib", "/opt/homebrew/lib/libembree4.dylib"]
} else {
    &["libembree4.so.4"]
};

/// The Embree 4 library in `folder`, or in its `lib`, `lib64` or `bin`.
pub fn library_in(folder: &Path) -> Option<PathBuf> {
    ["", "lib", "lib64", "bin"].iter().find_map(|inner| {
        let mut found: Vec<PathBuf> = std::fs::read_dir(folder.join(inner))
            .ok()?
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| {
                path.is_file()
                    && path.file_name().and_then(|name| name.to_str()).is_some_and(is_library)
            })
            .collect();
        // The soname sorts before the full version and after the link for compilers; any of them is the same file.
        found.sort();
        found.into_iter().next_back()
    })
}

/// `libembree4.so.4`, `libembree4-4aef3270.so.4`, `libembree4.4.dylib`, `embree4.dll`.
fn is_library(name: &str) -> bool {
    if cfg!(windows) {
        return name.eq_ignore_ascii_case("embree4.dll");
    }
    let Some(rest) = name.strip_prefix("libembree4") else { return false };
    match cfg!(target_os = "macos") {
        true => rest.ends_with(".dylib"),
        false => rest.ends_with(".so") || rest.contains(".so."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn an_installation_a_wheel_and_a_bare_folder_are_recognised() {
        for inner in ["", "lib", "lib64", "bin"] {
            for name in ["libembree4.so.4", "libembree4-4aef3270.so.4", "libembree4.so"] {
                let folder = tempfile::tempdir().unwrap();
                let place = folder.path().join(inner);
                std::fs::create_dir_all(&place).unwrap();
                assert_eq!(library_in(folder.path()), None);
                std::fs::write(place.join("libembree3.so.3"), "").unwrap();
                std::fs::write(place.join("libtbb.so.12"), "").unwrap();
                assert_eq!(library_in(folder.path()), None);
                std::fs::write(place.join(name), "").unwrap();
                assert_eq!(library_in(folder.path()), Some(place.join(name)));
            }
        }
    }
}
