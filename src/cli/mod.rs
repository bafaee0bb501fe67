//! The command line: arguments, progress, printing.

mod failure;
mod options;
mod progress;
mod query;
mod render;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use failure::Failure;

/// Does light reach this point? Exact and fast occlusion queries for triangle scenes.
#[derive(Parser)]
#[command(name = "umbra", version, about, max_term_width = 100, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Render),
    Query(query::Query),
}

/// Runs the command line of this process. Exit status 0: done; 1: a comparison failed; 2: bad input.
#[must_use]
pub fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(Cli { command: Command::Render(render) }) => render.run(),
        Ok(Cli { command: Command::Query(query) }) => query.run(),
        Err(error) => match error.kind() {
            // A closed pipe is no failure.
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
                let _ = error.print();
                return ExitCode::SUCCESS;
            }
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                let _ = error.print();
                return ExitCode::from(2);
            }
            _ => Err(Failure::from(error)),
        },
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
