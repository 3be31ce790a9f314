//! `afmsweep run`: the main job.

use super::audit;
use super::backend::{EngineArgs, say_choice};
use super::progress::Shown;
use super::signals;
use super::stopped::Stopped;
use super::{Voice, instances, load};
use afmsweep::control::Controlled;
use afmsweep::engine::{Engine, Progress};
use afmsweep::plan::Plan;
use afmsweep::scene::Steady;
use afmsweep::store::{self, Writer};
use afmsweep::sweep::Choice;
use afmsweep::{Audit, Error, Observer, Scene, Status, Swept};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
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
    /// Run each instance once as planned: no error estimates, no refinement where they are too large
    #[arg(long)]
    no_estimate: bool,
    /// Instances to redo with the reference engine after the run [default: as many as a tenth of the run's time allows, or
    /// 0.25 s, and at least one that touches the sample]
    #[arg(long, value_name = "N", conflicts_with = "no_audit", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    audit: Option<u32>,
    /// Redo none
    #[arg(long)]
    no_audit: bool,
    /// End with exit code 3 where an estimate or an audit misses the accuracy asked for, or nothing is known of a result
    /// that is called ok; the file is whole all the same
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

/// `results/<scene>.h5`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    let mut name = stem.to_owned();
    name.push(".h5");
    Path::new("results").join(name)
}

pub fn main(args: &RunArgs, voice: Voice) -> anyhow::Result<()> {
    let progress = Arc::new(Progress::default());
    signals::listen(&progress, voice);
    let scene = load(&args.scene)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.scene));
    if [output.clone(), store::partial_path(&output)].iter().any(|path| store::same_file(&args.scene, path)) {
        anyhow::bail!("{} is the scene itself; name another file with -o", output.display());
    }
    let mut writer = Writer::create(&output, &scene.source, args.overwrite)?;
    let start = Instant::now();
    // Told of a folder that somebody named, who may have misspelt it.
    let folder = writer.made_folder().filter(|_| args.output.is_some()).map(Path::to_path_buf);
    let audit = match args.audit {
        _ if args.no_audit => Audit::None,
        Some(count) => Audit::Instances(count),
        None => Audit::Auto,
    };
    let sweep = args.engine.sweep(scene)?.estimate(!args.no_estimate).audit(audit).watched_by(&progress);
    let told =
        Told { path: &args.scene, scene: sweep.scene(), folder, progress, voice, shown: Mutex::default() };
    let swept = sweep.run_with(&told);
    drop(told);
    let swept = match swept {
        Err(Error::Stopped(phase)) => return Err(Stopped::before(phase).into()),
        other => other?,
    };
    signals::held(|| writer.write(&swept.results))?;
    let outcome = &swept.run.outcome;
    if !swept.missing.is_empty() {
        return Err(Stopped::with(&swept.missing, &outcome.results, writer.partial()).into());
    }
    let partial = writer.partial().to_path_buf();
    signals::held(|| writer.finish())
        .with_context(|| format!("the run is whole, but its file stays {}", partial.display()))?;
    for note in &outcome.notes {
        voice.say(format_args!("note: {note}"));
    }
    if swept.run.plan.run.steady == Steady::Search {
        searched(&swept, voice);
    }
    close(&swept, voice);
    precision(&swept.run, voice);
    audit::accuracy(
        sweep.scene(),
        &swept.run,
        &swept.verdict,
        args.no_audit || args.engine.reference(),
        voice,
    );
    voice.say(format_args!(
        "wrote {} in {:.2} s ({:.2} s stepping, {:.2e} instance-steps/s)",
        output.display(),
        start.elapsed().as_secs_f64(),
        swept.stepping,
        swept.rate
    ));
    audit::strict(args.strict, &swept.verdict, &output)
}

/// What is said before a run steps, and how far it is then.
struct Told<'a> {
    path: &'a Path,
    scene: &'a Scene,
    /// A folder that was made for the results.
    folder: Option<PathBuf>,
    progress: Arc<Progress>,
    voice: Voice,
    shown: Mutex<Option<Shown>>,
}

impl Observer for Told<'_> {
    fn chosen(&self, choice: &Choice) {
        say_choice(choice, self.voice);
    }

    fn planned(&self, plan: &Plan, engine: &dyn Engine) {
        let voice = self.voice;
        if voice.verbose {
            voice.say(plan.summary(None).to_string().trim_end());
        }
        if let Some(folder) = &self.folder {
            voice.say(format_args!("made the folder {}", folder.display()));
        }
        voice.say(format_args!(
            "{}: {}, {:.2e} instance-steps on {}, {}",
            self.path.display(),
            instances(plan.len()),
            plan.instance_steps() as f64,
            engine.device(),
            if plan.precision_settled().is_none() { "f32 or f64" } else { plan.precision.name() }
        ));
        self.scene.preset_line().iter().for_each(|line| voice.say(line));
        for line in self.scene.warnings().iter().chain(&plan.doubts()) {
            voice.say(format_args!("warning: {line}"));
        }
        if let Ok(mut shown) = self.shown.lock() {
            *shown = Some(Shown::start(Arc::clone(&self.progress), voice));
        }
    }
}

/// What a search found.
fn searched(swept: &Swept, voice: Voice) {
    let Swept { run, others, .. } = swept;
    let stepped = run.plan.cases().filter(|case| case.steps > 0).count();
    let mut spent: Vec<u32> = run
        .found
        .iter()
        .zip(&run.periods)
        .filter(|(found, _)| found.is_some())
        .map(|(_, count)| *count)
        .collect();
    spent.sort_unstable();
    let middle = spent
        .get(spent.len() / 2)
        .map_or(String::new(), |count| format!(", {count} periods each in the middle"));
    voice.say(format_args!(
        "search: periodic states of {} of {}{middle}; {} waited for",
        spent.len(),
        instances(stepped),
        stepped - spent.len()
    ));
    if let Some(others) = others {
        let ways = match others.grid {
            true => format!(
                "{} from rest, {} of {} searches from neighbours",
                others.from_rest, others.followed, others.tried
            ),
            false => "searched for from rest; no grid whose neighbours could be followed".into(),
        };
        let count = instances(others.states.len());
        voice
            .say(format_args!("branches: {count} with a second periodic state (group other_branch): {ways}"));
    }
}

/// In which precision it ran, and why.
fn precision(run: &Controlled, voice: Voice) {
    let (plan, arithmetic) = (&run.plan, &run.arithmetic);
    let other = arithmetic.of.iter().filter(|one| **one != plan.precision).count();
    let rest = match other {
        0 => String::new(),
        _ => format!("; {} went on in f64, which it did not bring to the accuracy", instances(other)),
    };
    voice.say(format_args!("precision: {}: {}{rest}", plan.precision.name(), arithmetic.reason));
}

/// What a user should know of the run: doubtful instances and doubtful contacts.
fn close(swept: &Swept, voice: Voice) {
    let results = &swept.run.outcome.results;
    for status in Status::ALL {
        let count = results.iter().filter(|one| one.status == status).count();
        if count > 0 && status != Status::Ok {
            voice.say(format_args!(
                "{count} of {} marked {}: {}",
                instances(results.len()),
                status.meaning().replace('_', " "),
                advice(status)
            ));
        }
    }
    swept.warnings.iter().for_each(|line| voice.say(format_args!("warning: {line}")));
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
        Status::NotRun => "the run was stopped before they were done",
        Status::AccuracyNotMet => {
            "their error is estimated, or was found by an audit, above the accuracy asked for (error_estimate, group audit)"
        }
    }
}
