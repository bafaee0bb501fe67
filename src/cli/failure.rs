//! Errors as the user sees them: one clear line, and an exit status.

use std::process::ExitCode;

/// Why a command ended.
#[derive(Debug)]
pub(super) enum Failure {
    /// The input is bad: exit status 2.
    Input(String),
}

impl Failure {
    /// Prints it, and gives the exit status.
    pub fn report(self) -> ExitCode {
        match self {
            Self::Input(message) => {
                eprintln!("umbra: {message}");
                ExitCode::from(2)
            }
        }
    }
}

impl From<clap::Error> for Failure {
    /// What was wrong with the arguments, in one line.
    fn from(error: clap::Error) -> Self {
        let text = error.to_string();
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let wanted = lines.filter(|line| !line.starts_with("For more information"));
        let line = wanted.collect::<Vec<_>>().join(" ");
        Self::Input(format!("{} (try --help)", line.strip_prefix("error: ").unwrap_or(&line)))
    }
}

/// Every library error is an input that could not be used.
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
    crate::scene::SceneError,
    crate::occlusion::BackendError,
    crate::shadow::MethodError,
    crate::render::SettingsError,
    crate::render::OutputError,
);
