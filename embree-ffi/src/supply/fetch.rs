//! Fetching the wheel: pip downloads (it knows its index), Python checks the digest and unpacks, one rename publishes.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

use super::{
    cache::{cache_folder, cache_root},
    wheel::{Platform, WHEEL_VERSION},
};

const UNPACK: &str = include_str!("unpack.py");

/// The library in the cache, fetched first if it is not there. The error is one line.
pub fn fetch(platform: &Platform) -> Result<PathBuf, String> {
    let root = cache_root()
        .ok_or("there is no folder for caches: neither XDG_CACHE_HOME nor a home is set")?;
    fetch_into(&root, platform, &python()?)
}

/// [`fetch`] with everything from outside given. Two of them at once do each other no harm: the later one yields.
pub fn fetch_into(root: &Path, platform: &Platform, python: &Path) -> Result<PathBuf, String> {
    let home = cache_folder(root, platform);
    let library = home.join(platform.library);
    if library.is_file() {
        return Ok(library);
    }
    static DRAFTS: AtomicU32 = AtomicU32::new(0);
    let number = DRAFTS.fetch_add(1, Relaxed);
    let draft = format!("draft-{}-{}-{number}", platform.name, std::process::id());
    let draft = root.join("embree-ffi").join(draft);
    let outcome = fill(&draft, platform, python).and_then(|()| {
        match fs::rename(draft.join("libraries"), &home) {
            Err(error) if !library.is_file() => Err(format!("{}: {error}", home.display())),
            _ => Ok(library),
        }
    });
    let _ = fs::remove_dir_all(&draft);
    outcome
}

fn fill(draft: &Path, platform: &Platform, python: &Path) -> Result<(), String> {
    let libraries = draft.join("libraries");
    fs::create_dir_all(&libraries).map_err(|error| format!("{}: {error}", libraries.display()))?;
    let mut pip = Command::new(python);
    pip.args([
        "-m",
        "pip",
        "download",
        "--quiet",
        "--disable-pip-version-check",
        "--no-input",
        "--no-deps",
    ])
    .args(["--retries", "1", "--timeout", "10", "--only-binary=:all:", "--implementation", "cp"])
    .args(["--python-version", "3.12", "--abi", "cp312", "--platform", platform.pip_tag, "--dest"])
    .arg(draft)
    .arg(format!("embreex=={WHEEL_VERSION}"));
    run("pip download", pip)?;
    let wheel = fs::read_dir(draft)
        .map_err(|error| error.to_string())?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(|path| path.extension().is_some_and(|extension| extension == "whl"))
        .ok_or("pip download left no wheel")?;
    let mut unpack = Command::new(python);
    unpack.args(["-c", UNPACK]).arg(wheel).args([platform.sha256, platform.folder]).arg(&libraries);
    run("unpacking", unpack)?;
    match libraries.join(platform.library).is_file() {
        true => Ok(()),
        false => Err(format!("the wheel holds no {}", platform.library)),
    }
}

/// Runs to success or to the last line of what it complained of.
fn run(what: &str, mut command: Command) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{what}: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let complaint = String::from_utf8_lossy(&output.stderr);
    let lines = || complaint.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines()
        .rfind(|line| line.starts_with("ERROR:"))
        .or_else(|| lines().next_back())
        .unwrap_or("failed");
    Err(format!("{what}: {}", line.trim_start_matches("ERROR: ")))
}

/// A Python that answers, by any of its usual names.
pub fn python() -> Result<PathBuf, String> {
    ["python3", "python", "py"]
        .into_iter()
        .find(|name| {
            let asked = Command::new(name).args(["-c", "import zipfile, hashlib, pip"]).output();
            asked.is_ok_and(|output| output.status.success())
        })
        .map(PathBuf::from)
        .ok_or_else(|| "there is no Python 3 with pip".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An interpreter that never gets anywhere, as pip without a network.
    #[cfg(unix)]
    fn stub(folder: &Path, script: &str) -> PathBuf {
        use std::os::unix::fs::PermissionsExt;
        let path = folder.join("python-stub");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    fn linux() -> Platform {
        Platform::named("linux", "x86_64", "gnu").unwrap()
    }

    #[test]
    #[cfg(unix)]
    fn without_a_network_the_reason_is_one_line_and_nothing_is_left_behind() {
        let root = tempfile::tempdir().unwrap();
        let tools = tempfile::tempdir().unwrap();
        let python = stub(
            tools.path(),
            "echo 'WARNING: retrying' >&2; echo 'ERROR: no matching release' >&2; echo >&2; exit 1",
        );
        let reason = fetch_into(root.path(), &linux(), &python).unwrap_err();
        assert_eq!(reason, "pip download: no matching release");
        assert_eq!(fs::read_dir(root.path().join("embree-ffi")).unwrap().count(), 0);
    }

    #[test]
    #[cfg(unix)]
    fn a_full_cache_needs_no_python() {
        let root = tempfile::tempdir().unwrap();
        let home = cache_folder(root.path(), &linux());
        fs::create_dir_all(&home).unwrap();
        fs::write(home.join(linux().library), "").unwrap();
        let found = fetch_into(root.path(), &linux(), Path::new("/nonexistent/python")).unwrap();
        assert_eq!(found, home.join(linux().library));
    }

    #[test]
    #[cfg(unix)]
    fn a_wheel_with_another_digest_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let tools = tempfile::tempdir().unwrap();
        // "Downloads" a forged wheel; everything else goes to the real Python.
        let real = python().unwrap();
        let script = format!(
            "if [ \"$1\" = -m ]; then for a; do [ \"$p\" = --dest ] && echo forged > \"$a/embreex.whl\"; p=$a; done; exit 0; fi\nexec {} \"$@\"",
            real.display()
        );
        let reason = fetch_into(root.path(), &linux(), &stub(tools.path(), &script)).unwrap_err();
        assert!(reason.starts_with("unpacking: the wheel's sha256 is "), "{reason}");
        assert!(!cache_folder(root.path(), &linux()).exists());
    }

    #[test]
    #[cfg(unix)]
    fn two_builds_at_once_fetch_one_whole_cache() {
        let root = tempfile::tempdir().unwrap();
        let tools = tempfile::tempdir().unwrap();
        let real = python().unwrap();
        let wheel = tools.path().join("forged.whl");
        let make = "import sys, zipfile, hashlib
with zipfile.ZipFile(sys.argv[1], 'w') as wheel:
    wheel.writestr('embreex.libs/libembree4-4aef3270.so.4', 'embree')
    wheel.writestr('embreex.libs/libtbb.so.12', 'tbb')
    wheel.writestr('embreex/other.py', 'other')
print(hashlib.sha256(open(sys.argv[1], 'rb').read()).hexdigest(), end='')";
        let made = Command::new(&real).args(["-c", make]).arg(&wheel).output().unwrap();
        let sha256 = String::from_utf8(made.stdout).unwrap();
        let platform = Platform { sha256: sha256.leak(), ..linux() };
        let script = format!(
            "if [ \"$1\" = -m ]; then for a; do [ \"$p\" = --dest ] && d=$a; p=$a; done; \
             sleep 0.2; cp {} \"$d\"; exit 0; fi\nexec {} \"$@\"",
            wheel.display(),
            real.display()
        );
        let stub = stub(tools.path(), &script);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    let library = fetch_into(root.path(), &platform, &stub).unwrap();
                    assert_eq!(fs::read_to_string(library).unwrap(), "embree");
                });
            }
        });
        let left: Vec<_> = fs::read_dir(root.path().join("embree-ffi"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        assert_eq!(left, [cache_folder(root.path(), &platform)], "no draft is left");
        assert_eq!(fs::read_dir(&left[0]).unwrap().count(), 2, "the libraries and nothing else");
    }
}
