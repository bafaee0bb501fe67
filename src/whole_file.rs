//! Files that are written whole or not at all.

use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

/// How many links may lead to a file, as on Linux.
const MOST_LINKS: usize = 40;

/// A file in the making.
///
/// It has no name until it is whole, or where the system has no such files a temporary one in its folder; so what
/// was there before is kept until the new one is whole, and dropped before that it leaves nothing. A process that is
/// killed leaves nothing either, but where the temporary name was needed. Over a device or a pipe nothing is renamed:
/// bytes go straight there.
pub struct WholeFile {
    /// As messages name it.
    path: PathBuf,
    content: Content,
}

enum Content {
    /// Not a `NamedTempFile`, whose errors name the temporary file, which nobody knows.
    Renamed {
        file: BufWriter<File>,
        temporary: Option<TempPath>,
        place: PathBuf,
    },
    Direct(BufWriter<Box<dyn Write + Send>>),
}

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {reason}", path = path.display())]
pub struct Unwritable {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    #[source]
    pub reason: io::Error,
}

impl fmt::Debug for WholeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WholeFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl WholeFile {
    /// Begins the file that is to be at this path.
    ///
    /// # Errors
    /// What the system said.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path.metadata().is_ok_and(|place| !place.is_file()) {
            return Ok(Self::direct(path, File::options().write(true).open(path)?));
        }
        // A link stays, and what it points to is replaced.
        let place = place_of(path);
        let (file, temporary) = match nameless::create(folder_of(&place)) {
            Some(file) => (file, None),
            None => {
                // An ordinary file: who may read it, the umask decides. What the system says is given as it is, without
                // the temporary name.
                let made = temporary().make_in(folder_of(&place), |name| File::create_new(name))?;
                let (file, temporary) = made.into_parts();
                (file, Some(temporary))
            }
        };
        // Who may read what was there may read what comes, and nobody else.
        if let Ok(before) = place.metadata() {
            file.set_permissions(before.permissions())?;
        }
        let content = Content::Renamed { file: BufWriter::new(file), temporary, place };
        Ok(Self { path: path.to_owned(), content })
    }

    /// A file with this content, not in its place yet.
    ///
    /// # Errors
    /// If it cannot be begun, or its content not be written.
    pub fn with(
        path: &Path,
        content: impl FnOnce(&mut Self) -> io::Result<()>,
    ) -> Result<Self, Unwritable> {
        let write = || {
            let mut file = Self::create(path)?;
            content(&mut file)?;
            Ok(file)
        };
        write().map_err(|reason| Unwritable { path: path.to_owned(), reason })
    }

    /// Something that is no file, such as standard output, by the name that messages give it.
    #[must_use]
    pub fn direct(name: impl Into<PathBuf>, writer: impl Write + Send + 'static) -> Self {
        let content = Content::Direct(BufWriter::new(Box::new(writer)));
        Self { path: name.into(), content }
    }

    /// Everything is on the disk, so that no more than a name is missing.
    fn settle(&mut self) -> io::Result<()> {
        self.flush()?;
        match &self.content {
            Content::Renamed { file, .. } => file.get_ref().sync_all(),
            Content::Direct(_) => Ok(()),
        }
    }

    /// Gives a nameless file a temporary name: only what has a name can replace another file.
    fn name(&mut self) -> io::Result<()> {
        if let Content::Renamed { file, temporary: name @ None, place } = &mut self.content {
            let named = temporary()
                .make_in(folder_of(place), |name| nameless::link(file.get_ref(), name))?;
            *name = Some(named.into_temp_path());
        }
        Ok(())
    }

    /// Puts the file in its place.
    fn appear(&mut self) -> io::Result<()> {
        match &mut self.content {
            Content::Renamed { temporary, place, .. } => {
                temporary.take().map_or(Ok(()), |temporary| Ok(temporary.persist(place)?))
            }
            Content::Direct(_) => Ok(()),
        }
    }
}

/// Puts files in their places once all of them are whole: what can go wrong before that, a full disk above all, leaves
/// what was there before.
///
/// # Errors
/// The first that cannot be written.
pub fn finish_all(mut files: Vec<WholeFile>) -> Result<(), Unwritable> {
    for step in [WholeFile::settle, WholeFile::name, WholeFile::appear] {
        for file in &mut files {
            step(file).map_err(|reason| Unwritable { path: file.path.clone(), reason })?;
        }
    }
    Ok(())
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.content {
            Content::Renamed { file, .. } => file.write(bytes),
            Content::Direct(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.content {
            Content::Renamed { file, .. } => file.flush(),
            Content::Direct(writer) => writer.flush(),
        }
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// What the system said; what was there before is untouched.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    WholeFile::with(path, |file| file.write_all(bytes))
        .and_then(|file| finish_all(vec![file]))
        .map_err(|unwritable| unwritable.reason)
}

/// How temporary names are made.
fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".umbra-");
    builder
}

/// Files without a name: nothing is left of them, however the process ends.
#[cfg(target_os = "linux")]
mod nameless {
    use std::{fs::File, io, os::fd::AsRawFd, path::Path};

    use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, open};

    /// Where such a file can be found in order to give it a name.
    const DESCRIPTORS: &str = "/proc/self/fd";

    /// A new file; none where the folder cannot have such.
    pub fn create(folder: &Path) -> Option<File> {
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        let file = open(folder, flags, Mode::from_raw_mode(0o666)).ok()?;
        Path::new(DESCRIPTORS).is_dir().then(|| file.into())
    }

    /// Gives it a name.
    pub fn link(file: &File, name: &Path) -> io::Result<()> {
        let descriptor = format!("{DESCRIPTORS}/{}", file.as_raw_fd());
        Ok(linkat(CWD, descriptor, CWD, name, AtFlags::SYMLINK_FOLLOW)?)
    }
}

/// No other system has them.
#[cfg(not(target_os = "linux"))]
mod nameless {
    use std::{fs::File, io, path::Path};

    pub fn create(_: &Path) -> Option<File> {
        None
    }

    pub fn link(_: &File, _: &Path) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Where a file is or will be, however it is named and whatever links lead there.
pub(crate) fn place_of(path: &Path) -> PathBuf {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        if let Ok(place) = place.canonicalize() {
            return place;
        }
        // A link to what is not there yet.
        let Ok(target) = place.read_link() else { break };
        place = folder_of(&place).join(target);
    }
    match (folder_of(&place).canonicalize(), place.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => place,
    }
}

/// The folder that a path lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
