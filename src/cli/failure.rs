//! Errors as the user sees them: one clear line, and an exit status.

use std::io;
use std::path::Path;
use std::process::ExitCode;

use crate::render::OutputError;
use crate::scene::{SceneError, error::advice};
use crate::whole_file::Unwritable;

/// Prints a line to standard error; that nobody reads it is no failure.
macro_rules! say {
    ($($part:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($part)*);
    }};
}
pub(super) use say;

/// Why a command ended.
#[derive(Debug)]
pub(super) enum Failure {
    /// The input is bad: exit status 2.
    Input(String),
    /// A comparison failed: exit status 1.
    Comparison(String),
    /// Another process of ours failed, has said why, and ended with this status.
    Reported(u8),
    /// Whoever read standard output has seen enough: nothing to say.
    NoReader,
}

impl Failure {
    /// Something that is read cannot be.
    pub fn unreadable(path: &Path, reason: &io::Error) -> Self {
        Self::Input(format!("cannot read {}: {reason}{}", path.display(), advice(reason)))
    }

    /// Something that is written cannot be.
    pub fn unwritable(path: &Path, reason: &io::Error) -> Self {
        let advice = match reason.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "; make room, or name another folder"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "; name another place"
            }
            _ => "",
        };
        Self::Input(format!("cannot write {}: {reason}{advice}", path.display()))
    }

    /// Prints it, and gives the exit status.
    pub fn report(self) -> ExitCode {
        match self {
            Self::Input(message) => {
                // One line, whatever names and files hold.
                say!("umbra: {}", message.replace(char::is_control, " "));
                ExitCode::from(2)
            }
            Self::Comparison(message) => {
                say!("umbra: {message}");
                ExitCode::from(1)
            }
            Self::Reported(status) => ExitCode::from(status),
            Self::NoReader => ExitCode::SUCCESS,
        }
    }
}

impl From<clap::Error> for Failure {
    /// What was wrong with the arguments, in one line: its paragraphs with semicolons between.
    fn from(error: clap::Error) -> Self {
        let text = error.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        let one_line = |paragraph: &str| {
            let line = paragraph.lines().map(str::trim).collect::<Vec<_>>().join(" ");
            line.strip_prefix("Usage: ").map(|usage| format!("usage: {usage}")).unwrap_or(line)
        };
        let paragraphs = text.split("\n\n").map(|paragraph| one_line(paragraph.trim()));
        let wanted = paragraphs.filter(|line| !line.starts_with("For more information"));
        Self::Input(format!("{} (try --help)", wanted.collect::<Vec<_>>().join("; ")))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Unwritable { path, reason } => Self::unwritable(&path, &reason),
            error => Self::Input(error.to_string()),
        }
    }
}

impl From<Unwritable> for Failure {
    fn from(Unwritable { path, reason }: Unwritable) -> Self {
        Self::unwritable(&path, &reason)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Unwritable { path, reason } => Self::unwritable(&path, &reason),
            error @ OutputError::Kind { .. } => Self::Input(error.to_string()),
        }
    }
}

/// Every other library error is an input that could not be used.
macro_rules! input {
    ($($error:ty),+ $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::Input(error.to_string())
            }
        }
    )+};
}

input!(
    crate::occlusion::BackendError,
    crate::shadow::MethodError,
    crate::render::SettingsError,
    crate::measure::MeasureError,
    crate::measure::compare::CompareError,
    crate::measure::recording::TooManyQueries,
);
