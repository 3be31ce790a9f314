//! The command line: one file per command. Results go to standard output, messages to standard error.

mod audit;
mod backend;
mod bench;
mod check;
mod devices;
mod force;
mod modes;
mod plan;
mod progress;
mod report;
mod run;
mod study;

use afmsweep::report::shown;
use afmsweep::scene::{Scene, SceneError};
use clap::{Args, Parser, Subcommand};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Ensemble sweeps of atomic force microscope dynamics: piezo rod, cantilever, tip and sample.
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
    Plan(plan::PlanArgs),
    /// Natural frequencies and each mode's share
    Modes(SceneArgs),
    /// Static force-indentation curves, approach and retraction
    Force(force::ForceArgs),
    /// What could run a scene here
    Devices(devices::DevicesArgs),
    /// Pictures and a page of tables from a results file
    Report(report::ReportArgs),
    /// Every engine on a few instances, side by side with the reference
    Check(check::CheckArgs),
    /// Speed and error of each engine over the size of the ensemble
    Bench(bench::BenchArgs),
    /// A question answered by one command and one page
    Study(study::StudyArgs),
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

impl Voice {
    /// Says a line on standard error unless silenced.
    pub fn say(self, line: impl std::fmt::Display) {
        if !self.quiet {
            say(line);
        }
    }
}

/// A line on standard error. `eprintln!` would panic where nobody reads it any more (`2>&1 | head`), and
/// a run is worth more than its messages.
fn say(line: impl std::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Parses the arguments, runs the command and turns its outcome into an exit code.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let voice = Voice { quiet: cli.quiet, verbose: cli.verbose };
    let outcome = match cli.command {
        Command::Run(args) => run::main(&args, voice),
        Command::Plan(args) => plan::main(&args, voice),
        Command::Modes(args) => modes::main(&args),
        Command::Force(args) => force::main(&args),
        Command::Devices(args) => devices::main(&args),
        Command::Report(args) => report::main(&args, voice),
        Command::Check(args) => check::main(&args, voice),
        Command::Bench(args) => bench::main(&args, voice),
        Command::Study(args) => study::main(&args, voice),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            match error.downcast_ref::<SceneError>() {
                Some(scene) => say(scene.render(colour())),
                None => say(format_args!("error: {}", in_full(&error))),
            }
            match error.is::<audit::Missed>() {
                true => ExitCode::from(audit::MISSED),
                false => ExitCode::FAILURE,
            }
        }
    }
}

/// An error and its causes on one line; a cause that the text so far tells already is not repeated.
fn in_full(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(|cause| cause.to_string()) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// Colours only on a terminal, and never where NO_COLOR is set.
fn colour() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// `1 instance`, `2 instances`.
fn instances(count: usize) -> String {
    format!("{count} instance{}", if count == 1 { "" } else { "s" })
}

/// `sample Young's modulus 1 GPa, ...` of an instance; nothing without a sweep.
fn values(scene: &Scene, instance: usize) -> String {
    let axes = scene.sweep.axes.iter().zip(scene.sweep.indices(instance));
    let words: Vec<String> = axes
        .map(|(axis, at)| format!("{} {}", axis.long_name, shown(axis.values[at], &axis.units, 4)))
        .collect();
    words.join(", ")
}

/// Reads a scene; its error keeps its place in the file.
fn load(path: &Path) -> anyhow::Result<Scene> {
    Ok(Scene::load(path)?)
}

/// Writes to standard output; a reader that has gone away (`| head`) is no error.
fn print(text: &str) -> anyhow::Result<()> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// JSON with an end of line, on standard output.
fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}
