//! The command line: arguments, progress, printing.

mod failure;
mod options;
mod progress;
mod render;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use failure::Failure;

/// Does light reach this point? Exact and fast occlusion queries for triangle scenes.
#[derive(Parser)]
#[command(name = "umbra", version, about, max_term_width = 100, subcommand_required = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Render),
}

/// Runs the command line of this process. Exit status 0: done; 1: a comparison failed; 2: bad input.
#[must_use]
pub fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(Cli { command: Command::Render(render) }) => render.run(),
        Err(error) if !error.use_stderr() => {
            // --help and --version; a closed pipe is no failure.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => Err(Failure::from(error)),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
