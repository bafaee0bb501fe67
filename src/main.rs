//! The command line of umbra.

fn main() -> std::process::ExitCode {
    umbra::cli::main()
}
