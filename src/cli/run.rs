//! `afmsweep run`: the main job.

use super::progress::{Shown, on_interrupt};
use super::{Voice, load};
use afmsweep::engine::{Cpu, Engine, Outcome, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::plan::{Plan, Precision};
use afmsweep::record::{self, Facts};
use afmsweep::scene::Scene;
use afmsweep::store::{Results, Writer};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

#[derive(clap::Args)]
pub struct RunArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Results file [default: results/<scene>.h5]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace whatever file stands at the output
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

/// Which engine runs it, and how.
#[derive(clap::Args)]
pub struct EngineArgs {
    /// Engine; auto takes the best there is
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// Arithmetic of the inner loop
    #[arg(long, value_enum, default_value_t = PrecisionArg::F64)]
    precision: PrecisionArg,
    /// Steps per drive period for every instance, in place of the plan's choice
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1_000_000))]
    steps_per_period: Option<u32>,
    /// Threads of the CPU engine [default: all cores]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
}

fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=1024) => Ok(threads),
        _ => Err("expected a whole number from 1 to 1024".into()),
    }
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Backend {
    Auto,
    Cpu,
    /// Adaptive, order 8, contact events located: slow, for checks
    Reference,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum PrecisionArg {
    F32,
    F64,
}

impl EngineArgs {
    /// The engine asked for.
    pub fn engine(&self) -> Box<dyn Engine> {
        match self.backend {
            Backend::Auto | Backend::Cpu => Box::new(Cpu { threads: self.threads }),
            Backend::Reference => Box::new(Reference { threads: self.threads, ..Reference::default() }),
        }
    }

    /// The scene's plan with these arguments put in.
    pub fn plan(&self, scene: &mut Scene) -> anyhow::Result<Plan> {
        if self.steps_per_period.is_some() {
            scene.run.steps_per_period = self.steps_per_period;
        }
        let precision = match self.precision {
            PrecisionArg::F32 => Precision::F32,
            PrecisionArg::F64 => Precision::F64,
        };
        Plan::new(scene, precision).with_context(|| format!("{}", scene.path.display()))
    }
}

/// `results/<scene>.h5`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    let mut name = stem.to_owned();
    name.push(".h5");
    Path::new("results").join(name)
}

/// Whether two paths lead to one file; a file that is not there is no other's.
fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

pub fn main(args: &RunArgs, voice: Voice) -> anyhow::Result<()> {
    let mut scene = load(&args.scene)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.scene));
    if same_file(&args.scene, &output) {
        anyhow::bail!("{} is the scene itself; name another file with -o", output.display());
    }
    let mut writer = Writer::create(&output, &scene.source, args.overwrite)?;
    let start = Instant::now();
    let plan = args.engine.plan(&mut scene)?;
    let engine = args.engine.engine();
    let summary = plan.summary(None);
    if voice.verbose {
        voice.say(summary.to_string().trim_end());
    }
    voice.say(format_args!(
        "{}: {}, {:.2e} instance-steps on {}, {}",
        args.scene.display(),
        instances(plan.cases.len()),
        plan.instance_steps() as f64,
        engine.device(),
        plan.precision.name()
    ));
    let progress = Arc::new(Progress::default());
    on_interrupt(&progress);
    let shown = Shown::start(Arc::clone(&progress), plan.instance_steps(), voice);
    let stepping = Instant::now();
    let outcome = engine.run(&plan, &progress)?;
    let stepping = stepping.elapsed().as_secs_f64();
    drop(shown);

    let facts = Facts {
        device: engine.device(),
        wall_time: start.elapsed().as_secs_f64(),
        rate: if progress.steps() == 0 { 0.0 } else { progress.steps() as f64 / stepping },
        plan: summary.json().to_string(),
    };
    // Ctrl-C after the last instance came too late to spoil anything.
    let whole = outcome.results.iter().all(|one| one.status != Status::NotRun);
    let mut results = record::results(&scene, &plan, &outcome, &facts);
    if let Some(request) = scene.output.waveforms.as_ref().filter(|_| whole) {
        results.waveforms = Some(record::waveforms(&plan, request)?);
    }
    writer.write(&results)?;
    if !whole {
        anyhow::bail!(
            "interrupted: {} of {} instances are in {}; run the scene again for a whole file",
            outcome.results.iter().filter(|one| one.status != Status::NotRun).count(),
            plan.cases.len(),
            writer.partial().display()
        );
    }
    writer.finish()?;
    close(&scene, &plan, &outcome, &results, voice);
    voice.say(format_args!(
        "wrote {} in {:.2} s ({:.2} s stepping, {:.2e} instance-steps/s)",
        output.display(),
        start.elapsed().as_secs_f64(),
        stepping,
        facts.rate
    ));
    Ok(())
}

/// What a user should know of the run: doubtful instances and doubtful contacts.
fn close(scene: &Scene, plan: &Plan, outcome: &Outcome, results: &Results, voice: Voice) {
    for status in Status::ALL {
        let count = outcome.results.iter().filter(|one| one.status == status).count();
        if count > 0 && status != Status::Ok {
            voice.say(format_args!(
                "{count} of {} marked {}: {}",
                instances(outcome.results.len()),
                status.meaning().replace('_', " "),
                advice(status)
            ));
        }
    }
    for line in record::warning_lines(scene, plan, outcome, results) {
        voice.say(format_args!("warning: {line}"));
    }
}

fn instances(count: usize) -> String {
    format!("{count} instance{}", if count == 1 { "" } else { "s" })
}

fn advice(status: Status) -> &'static str {
    match status {
        Status::Ok => "nothing to do",
        Status::NotSteady => {
            "the response still changes by more than the accuracy asked for; more [run] periods settle it if every mode that rings has a quality factor and the tapping has a steady state"
        }
        Status::Sensitive => "a tiny change of the start moves the result",
        Status::NonFinite => "values ran out of the range of numbers; more steps per period may help",
        Status::OutOfRange => "a contact lasts only a few steps; raise [run] steps_per_period",
        Status::NotRun => "the run ended before them",
    }
}
