//! The command line: one file per command. Results go to standard output, messages to standard error.

mod audit_message;
pub mod backend;
mod bench;
mod cells;
mod check;
mod cite;
mod devices;
mod explain;
mod export;
pub mod force;
mod glossary;
pub mod infer;
mod init;
mod live;
mod merge;
pub mod modes;
mod peek;
pub mod plan;
mod plan_notice;
mod prepare;
mod progress_bar;
mod report;
pub mod run;
mod sample;
mod schema;
mod shader;
mod shell;
mod signals;
mod slurm;
pub mod stats;
mod stop_message;
mod study;
mod table;

use afmsweep::Error;
use afmsweep::kernel::ROUNDING_VARIABLE;
use afmsweep::report::shown;
use afmsweep::scene::{Scene, SceneError};
use afmsweep::store::Results;
use anyhow::Context;
use clap::{Args, Parser, Subcommand};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use stop_message::Stopped;

/// Reads a scene (TOML: lever, tip, sample, drive, what varies), steps thousands of instances of it side by side, and
/// writes a labelled results file (HDF5): amplitudes, phases, forces, each with its error.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
#[command(after_help = "Examples: afmsweep init > lever.toml\n          afmsweep run lever.toml\n          \
                        afmsweep report results/lever.h5")]
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
    /// Make the choices of a run from all of its instances, for runs of its shares
    Prepare(prepare::PrepareArgs),
    /// Make the results of a run of its shares
    Merge(merge::MergeArgs),
    /// Write the script that runs a scene in shares on a cluster with Slurm
    Slurm(slurm::SlurmArgs),
    /// Say what a run would do, without running
    Plan(plan::PlanArgs),
    /// Natural frequencies and each mode's share; the lever in a fluid
    Modes(modes::ModesArgs),
    /// Static force-indentation curves, approach and retraction
    Force(force::ForceArgs),
    /// What could run a scene here
    Devices(devices::DevicesArgs),
    /// Pictures and a page of tables from a results file
    Report(report::ReportArgs),
    /// A page that computes by itself: sliders in place of a scene's values
    Live(live::LiveArgs),
    /// The points of a scene's samples, as CSV
    Sample(sample::SampleArgs),
    /// How the observables of uncertain samples are distributed, and which parameters decide
    Stats(stats::StatsArgs),
    /// What observed values, or a measured curve, tell of uncertain parameters
    Infer(infer::InferArgs),
    /// The rows of a results file for other programs; what the journal of a run has so far
    Export(export::ExportArgs),
    /// Every engine on a few instances, side by side with the reference
    Check(check::CheckArgs),
    /// The shader (WGSL) that a GPU gets for a scene
    Shader(shader::ShaderArgs),
    /// Speed and error of each engine over the size of the ensemble
    Bench(bench::BenchArgs),
    /// A commented scene to begin with
    Init(init::InitArgs),
    /// What a word of a scene, of a results file or of a message means
    Explain(explain::ExplainArgs),
    /// What to cite for a results file, as BibTeX
    Cite(cite::CiteArgs),
    /// The JSON schema of scene files, for editors
    #[command(after_help = "Example: afmsweep schema > scene.schema.json")]
    Schema,
    /// A script that completes commands and options in a shell
    Completions(shell::CompletionsArgs),
    /// The manual page
    #[command(after_help = "Example: afmsweep man | man -l -")]
    Man,
    /// The seed paper, reproduced and questioned: one command, one page
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

/// Exit codes; a command that was stopped, and `--strict`, have further ones.
const DONE: u8 = 0;
const FAILED: u8 = 1;
const MISUSED: u8 = 2;

/// How much to say on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verbosity {
    pub quiet: bool,
    pub verbose: bool,
}

impl Verbosity {
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
    // In one piece: two runs may write into one log.
    let _ = std::io::stderr().write_all(format!("{line}\n").as_bytes());
}

/// The arguments, the name of the program first.
static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Parses the arguments, the name of the program first, runs the command and gives its exit code. Once in a process:
/// signals are its own then.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = ARGUMENTS.get_or_init(|| arguments.into_iter().collect());
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(asked) => return not_parsed(&asked),
    };
    let voice = Verbosity { quiet: cli.quiet, verbose: cli.verbose };
    if let Some(other) = unknown_rounding() {
        say(format_args!("error: {ROUNDING_VARIABLE} is {}: `once` or `twice` is expected", other.display()));
        return MISUSED;
    }
    let outcome = match cli.command {
        Command::Run(args) => run::main(&args, voice),
        Command::Prepare(args) => prepare::main(&args, voice),
        Command::Merge(args) => merge::main(&args, voice),
        Command::Slurm(args) => slurm::main(&args, voice),
        Command::Plan(args) => plan::main(&args, voice),
        Command::Modes(args) => modes::main(&args),
        Command::Force(args) => force::main(&args),
        Command::Devices(args) => devices::main(&args),
        Command::Report(args) => report::main(&args, voice),
        Command::Live(args) => live::main(&args, voice),
        Command::Sample(args) => sample::main(&args, voice),
        Command::Stats(args) => stats::main(&args, voice),
        Command::Infer(args) => infer::main(&args, voice),
        Command::Export(args) => export::main(&args, voice),
        Command::Check(args) => check::main(&args, voice),
        Command::Shader(args) => shader::main(&args, voice),
        Command::Bench(args) => bench::main(&args, voice),
        Command::Init(args) => init::main(&args),
        Command::Explain(args) => explain::main(&args),
        Command::Cite(args) => cite::main(&args),
        Command::Schema => schema::main(),
        Command::Completions(args) => shell::completions(&args),
        Command::Man => shell::man(),
        Command::Study(args) => study::main(&args, voice),
    };
    match outcome {
        Ok(()) => DONE,
        Err(error) => {
            let scene = match error.downcast_ref::<Error>() {
                Some(Error::Scene(scene)) => Some(scene),
                _ => error.downcast_ref::<SceneError>(),
            };
            match scene {
                Some(scene) => say(scene.render(colour())),
                None => say(format_args!("error: {}", in_full(&error))),
            }
            match error.downcast_ref::<Stopped>() {
                Some(stopped) => stopped.code,
                None if error.is::<audit_message::Missed>() => audit_message::MISSED,
                None => FAILED,
            }
        }
    }
}

/// What the environment says of rounding, if that means nothing.
fn unknown_rounding() -> Option<OsString> {
    std::env::var_os(ROUNDING_VARIABLE).filter(|told| told != "once" && told != "twice")
}

/// Arguments that are wrong, code 2; or the help or version that was asked for, which is an answer like any other.
fn not_parsed(asked: &clap::Error) -> u8 {
    use std::io::Write;
    let printed = asked.print().and_then(|()| std::io::stdout().flush());
    match printed {
        _ if asked.use_stderr() => MISUSED,
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            say(format_args!("error: cannot write to standard output: {error}"));
            FAILED
        }
        _ => DONE,
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

/// Whether errors are coloured here.
fn colour() -> bool {
    let variable = |name| std::env::var_os(name);
    coloured(std::io::stderr().is_terminal(), variable("TERM"), variable("NO_COLOR"))
}

/// Colours only on a terminal that knows them, and never where NO_COLOR is set.
fn coloured(terminal: bool, kind: Option<OsString>, no_color: Option<OsString>) -> bool {
    let dumb = kind.is_some_and(|kind| kind == "dumb");
    terminal && !dumb && no_color.is_none_or(|value| value.is_empty())
}

/// `1 instance`, `2 instances`.
fn instances(count: usize) -> String {
    counted(count, "instance")
}

/// `1 portion`, `2 portions`.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// `sample Young's modulus 1 GPa, ...` of an instance; nothing without a sweep.
fn values(scene: &Scene, instance: usize) -> String {
    let axes = scene.sweep.axes.iter().zip(scene.sweep.indices(instance));
    let words: Vec<String> = axes
        .map(|(axis, at)| match axis.words.get(at) {
            Some(word) => word.clone(),
            None => format!("{} {}", axis.long_name, shown(axis.values[at], &axis.units, 4)),
        })
        .collect();
    words.join(", ")
}

/// What stands for a scene that comes on standard input, and what it is called.
const STANDARD_INPUT: (&str, &str) = ("-", "stdin.toml");

/// Reads a scene, `-` from standard input; its error keeps its place in the file.
fn load(path: &Path) -> anyhow::Result<Scene> {
    match path == Path::new(STANDARD_INPUT.0) {
        true => {
            let text = std::io::read_to_string(std::io::stdin()).context("cannot read standard input")?;
            Ok(Scene::parse(Path::new(STANDARD_INPUT.1), &text)?)
        }
        false => Ok(Scene::load(path)?),
    }
}

/// The scene that results were made from: as written or, where a file that it names is not there any more or may have changed,
/// with every value.
fn scene_in(path: &Path, results: &Results) -> anyhow::Result<Scene> {
    let told = |name| Scene::parse(path, results.text(name).unwrap_or_default());
    let scene = match told("scene") {
        Ok(scene) if scene.base.contact.table.is_none() => Ok(scene),
        // A table of forces may have changed since; the resolved scene has its numbers.
        read => told("scene_resolved").or(read),
    };
    scene.with_context(|| format!("the scene in {}", path.display()))
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

/// Writes to a file, or to standard output where none is named.
fn write(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    let Some(path) = path else { return print(text) };
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// JSON with an end of line, on standard output.
fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

#[cfg(test)]
mod tests {
    /// TERM=dumb is the terminal's word (terminfo), NO_COLOR the user's (no-color.org).
    #[test]
    fn colours_are_for_terminals_that_know_them() {
        let coloured = |terminal, kind: &str, no_color: Option<&str>| {
            super::coloured(terminal, Some(kind.into()), no_color.map(Into::into))
        };
        assert!(coloured(true, "xterm-256color", None) && coloured(true, "xterm", Some("")));
        assert!(super::coloured(true, None, None));
        assert!(!coloured(true, "dumb", None) && !coloured(true, "xterm", Some("1")));
        assert!(!coloured(false, "xterm", None));
    }
}
