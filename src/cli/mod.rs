//! The command line: one file per command. Results go to standard output, messages to standard error.

mod devices;
mod force;
mod modes;
mod plan;
mod report;
mod run;

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Ensemble sweeps of atomic force microscope dynamics.
#[derive(Parser)]
#[command(version, about, long_about = None, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Explain what is chosen and why
    #[arg(short, long, global = true)]
    verbose: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene and write its results file
    Run(run::RunArgs),
    /// Say what a run would do, without running
    Plan(SceneArgs),
    /// Natural frequencies and each mode's share
    Modes(SceneArgs),
    /// Static force-indentation curves, approach and retraction
    Force(force::ForceArgs),
    /// What could run a scene here
    Devices(devices::DevicesArgs),
    /// Pictures and a page of tables from a results file
    Report(report::ReportArgs),
}

/// A scene file and the form of the answer.
#[derive(Args)]
struct SceneArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
}

/// How much to say on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Voice {
    pub quiet: bool,
    pub verbose: bool,
}

/// Parses the arguments, runs the command and turns its outcome into an exit code.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let voice = Voice { quiet: cli.quiet, verbose: cli.verbose };
    let outcome = match cli.command {
        Command::Run(args) => run::main(&args, voice),
        Command::Plan(args) => plan::main(&args, voice),
        Command::Modes(args) => modes::main(&args, voice),
        Command::Force(args) => force::main(&args, voice),
        Command::Devices(args) => devices::main(&args, voice),
        Command::Report(args) => report::main(&args, voice),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
