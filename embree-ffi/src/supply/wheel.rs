//! The one pinned release of the Python wheel that carries Embree, file by file.

/// The release of `embreex` we take; it carries Embree 4.4.0 and TBB.
pub const WHEEL_VERSION: &str = "4.4.0.post1";

/// A system for which there is a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Platform {
    /// Names the folder in the cache.
    pub name: &'static str,
    /// What pip calls it.
    pub pip_tag: &'static str,
    /// Of the wheel for CPython 3.12; the libraries inside do not depend on Python, but the pin does.
    pub sha256: &'static str,
    /// The folder inside the wheel.
    pub folder: &'static str,
    /// The Embree library in that folder; TBB lies beside it.
    pub library: &'static str,
}

const PLATFORMS: [Platform; 4] = [
    Platform {
        name: "linux-x86_64",
        pip_tag: "manylinux_2_28_x86_64",
        sha256: "9ee31b8b40a129620e40e06ae5c0af088b12e5f52c583e43428b87a02786d6bb",
        folder: "embreex.libs",
        library: "libembree4-4aef3270.so.4",
    },
    Platform {
        name: "macos-x86_64",
        pip_tag: "macosx_13_0_x86_64",
        sha256: "1704af3c2e80fc6be4c1637402748ca20fd217980bd641dd3f228f7e09b0a461",
        folder: "embreex/.dylibs",
        library: "libembree4.4.dylib",
    },
    Platform {
        name: "macos-aarch64",
        pip_tag: "macosx_13_0_arm64",
        sha256: "a902809f99ac7a8bf1267a4a207d415a7a7e95a8d2b5e9d443a2cc291b9c1482",
        folder: "embreex/.dylibs",
        library: "libembree4.4.dylib",
    },
    Platform {
        name: "windows-x86_64",
        pip_tag: "win_amd64",
        sha256: "6286204fdcd75465cc458e610319c19dcf898292211755cca13da7248db172ab",
        folder: "embreex.libs",
        library: "embree4.dll",
    },
];

impl Platform {
    /// By the words of `CARGO_CFG_TARGET_OS`, `_ARCH` and `_ENV`.
    pub fn named(os: &str, arch: &str, env: &str) -> Option<Platform> {
        if os == "linux" && env != "gnu" {
            return None;
        }
        PLATFORMS.into_iter().find(|platform| platform.name.split_once('-') == Some((os, arch)))
    }

    /// The platform this very code was compiled for.
    pub fn of_this_program() -> Option<Platform> {
        let env = if cfg!(target_env = "gnu") { "gnu" } else { "" };
        Self::named(std::env::consts::OS, std::env::consts::ARCH, env)
    }
}
