//! Files that are written whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

/// A file in the making.
///
/// It has a temporary name in its folder until [`finish`](Self::finish) renames it; so what was there
/// before is kept until the new one is whole, and dropped before that it leaves nothing. Over a device or
/// a pipe nothing is renamed: bytes go straight there.
pub struct WholeFile(Place);

enum Place {
    /// Not a `NamedTempFile`, whose errors name the temporary file, which nobody knows.
    Renamed {
        file: BufWriter<File>,
        temporary: TempPath,
        path: PathBuf,
    },
    Direct(BufWriter<Box<dyn Write + Send>>),
}

impl WholeFile {
    /// Begins the file that is to be at this path.
    ///
    /// # Errors
    /// What the system said.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path.metadata().is_ok_and(|place| !place.is_file()) {
            return Ok(Self::direct(File::options().write(true).open(path)?));
        }
        // A link stays, and what it points to is replaced.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".umbra-");
        // Temporary files are private by default; this one becomes an ordinary file, so the umask decides.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (file, temporary) = builder.tempfile_in(folder_of(&path))?.into_parts();
        Ok(Self(Place::Renamed { file: BufWriter::new(file), temporary, path }))
    }

    /// Something that is no file, such as standard output.
    #[must_use]
    pub fn direct(writer: impl Write + Send + 'static) -> Self {
        Self(Place::Direct(BufWriter::new(Box::new(writer))))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// What the system said; what was there before is untouched.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {
            Place::Direct(mut writer) => writer.flush(),
            Place::Renamed { file, temporary, path } => {
                let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.sync_all()?;
                temporary.persist(path)?;
                Ok(())
            }
        }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Place::Renamed { file, .. } => file.write(bytes),
            Place::Direct(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Place::Renamed { file, .. } => file.flush(),
            Place::Direct(writer) => writer.flush(),
        }
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// What the system said; what was there before is untouched.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes)?;
    file.finish()
}

/// The folder that a path lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
