//! The command line: arguments, progress, printing.

mod certify;
mod compare;
mod extremes;
mod failure;
mod lists;
mod numbers;
mod options;
mod outputs;
mod paper;
mod progress;
mod query;
mod render;
mod scene;
mod shadows;
mod tradeoff;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::Failure;

const DETAILS: &str = "\
A scene is a built-in one (jittered-sparse, jittered-dense, drum, chair-room), an .obj, a .glb or .gltf,
or a .toml that puts meshes, materials, lights and a camera together.

Exit status: 0 done; 1 a comparison failed; 2 bad input, and nothing was written.

Examples:
  umbra render chair-room -o room.png
  umbra compare chair-room
  umbra compare sponza.glb --tests exact,pluecker
  umbra query chair-room --rays rays.csv -o blocked.csv
  umbra tradeoff chair-room --html tradeoff.html
  umbra tradeoff sponza.glb --quick
  umbra extremes --cases grazing,slivers
  umbra paper --quick
  umbra certify --seconds 60
  umbra scene drum -o drum.glb";

/// Does light reach this point? Exact and fast occlusion queries for triangle scenes.
#[derive(Parser)]
#[command(name = "umbra", version, about, max_term_width = 100, arg_required_else_help = true, after_help = DETAILS)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Render),
    Compare(compare::Compare),
    Query(query::Query),
    Tradeoff(tradeoff::Tradeoff),
    Paper(paper::Paper),
    Certify(certify::Certify),
    Extremes(extremes::Extremes),
    Scene(scene::SceneFile),
}

/// Reads the command line of this process. A negative number is a value, of which its option says what to give
/// instead, and no option of its own.
fn parse() -> Result<Cli, clap::Error> {
    let negative = |argument: Arg| {
        let takes_values = argument.get_action().takes_values();
        if takes_values { argument.allow_negative_numbers(true) } else { argument }
    };
    let command = Cli::command().mut_subcommands(|command| command.mut_args(negative));
    Cli::from_arg_matches(&command.try_get_matches()?)
}

/// Runs the command line of this process. Exit status 0: done; 1: a comparison failed; 2: bad input.
#[must_use]
pub fn main() -> ExitCode {
    let outcome = match parse() {
        Ok(Cli { command: Command::Render(render) }) => render.run(),
        Ok(Cli { command: Command::Compare(compare) }) => compare.run(),
        Ok(Cli { command: Command::Query(query) }) => query.run(),
        Ok(Cli { command: Command::Tradeoff(tradeoff) }) => tradeoff.run(),
        Ok(Cli { command: Command::Paper(paper) }) => paper.run(),
        Ok(Cli { command: Command::Certify(certify) }) => certify.run(),
        Ok(Cli { command: Command::Extremes(extremes) }) => extremes.run(),
        Ok(Cli { command: Command::Scene(scene) }) => scene.run(),
        Err(error) => match error.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
                let printed = error.print().and_then(|()| io::stdout().flush());
                printed.map_err(|reason| outputs::unprinted(&reason))
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
