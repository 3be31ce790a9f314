//! `afmsweep run`: the main job.

use super::audit;
use super::backend::EngineArgs;
use super::progress::Shown;
use super::signals;
use super::stopped::{Missing, Phase, Stopped};
use super::{Voice, instances, load};
use afmsweep::control::{self, Controlled, Others, Verdict};
use afmsweep::engine::{Outcome, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::plan::Plan;
use afmsweep::record::{self, Facts};
use afmsweep::scene::{Scene, Steady};
use afmsweep::store::{self, Results, Writer};
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
    let mut scene = load(&args.scene)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.scene));
    if [output.clone(), store::partial_path(&output)].iter().any(|path| store::same_file(&args.scene, path)) {
        anyhow::bail!("{} is the scene itself; name another file with -o", output.display());
    }
    let mut writer = Writer::create(&output, &scene.source, args.overwrite)?;
    let start = Instant::now();
    let mut plan = args.engine.plan(&mut scene)?;
    let engine = args.engine.engine(&mut plan, voice)?;
    let unchosen = if plan.precision_open { "nothing to choose it by" } else { "as told" };
    plan.precision_open &= !args.no_estimate && !args.engine.reference();
    let summary = plan.summary(None);
    if voice.verbose {
        voice.say(summary.to_string().trim_end());
    }
    // Told of a folder that somebody named, who may have misspelt it.
    if let Some(folder) = writer.made_folder().filter(|_| args.output.is_some()) {
        voice.say(format_args!("made the folder {}", folder.display()));
    }
    voice.say(format_args!(
        "{}: {}, {:.2e} instance-steps on {}, {}",
        args.scene.display(),
        instances(plan.cases.len()),
        plan.instance_steps() as f64,
        engine.device(),
        if plan.precision_settled().is_none() { "f32 or f64" } else { plan.precision.name() }
    ));
    scene.preset_line().iter().for_each(|line| voice.say(line));
    for line in scene.warnings().iter().chain(&plan.doubts()) {
        voice.say(format_args!("warning: {line}"));
    }
    if progress.stopped() {
        return Err(Stopped::before("planning").into());
    }
    let shown = Shown::start(Arc::clone(&progress), voice);
    let stepping = Instant::now();
    let mut run = match args.no_estimate || args.engine.reference() {
        false => control::run(&plan, engine.as_ref(), &progress)?,
        true if args.engine.reference() => control::by_reference(&plan, &Reference::default(), &progress)?,
        true => control::once(plan, unchosen, engine.as_ref(), &progress)?,
    };
    let mut missing = Missing::of(&run, &progress);
    if run.outcome.results.iter().all(|one| !one.measured.is_any() && one.status == Status::NotRun) {
        return Err(Stopped::before("stepping").into());
    }
    let others = missing.phase((Phase::Branches, run.plan.run.both_branches), &progress, || {
        control::others(&run, &scene.sweep.shape(), engine.as_ref(), &progress).map(Some)
    })?;
    let stepping = stepping.elapsed().as_secs_f64();
    let exact = args.engine.reference();
    let no_audit = args.no_audit || exact;
    let audited = missing
        .phase((Phase::Audit, !no_audit), &progress, || audit::redo(args.audit, &run, stepping, &progress))?;
    drop(shown);
    control::mark(&mut run.outcome, &audited, run.plan.run.accuracy);
    let verdict = Verdict::of(&run, &audited, exact);
    let Controlled { plan, outcome, estimates, found, periods, .. } = &run;

    let facts = Facts {
        device: engine.device(),
        wall_time: start.elapsed().as_secs_f64(),
        rate: if progress.steps() == 0 { 0.0 } else { progress.steps() as f64 / stepping },
        plan: plan.summary(None).json().to_string(),
        arithmetic: run.arithmetic.clone(),
    };
    let mut results = record::results(&scene, plan, outcome, &facts);
    record::error_estimate(&mut results, estimates, &control::basis(plan, !args.no_estimate, exact));
    let request = scene.output.waveforms.as_ref();
    results.waveforms = missing.phase((Phase::Waveforms, request.is_some()), &progress, || {
        request.map(|request| record::waveforms(plan, found, request)).transpose()
    })?;
    if plan.run.steady == Steady::Search {
        record::search(&mut results, plan, &outcome.results, (found, periods), others.as_ref());
    }
    record::audit(&mut results, plan, &audited, &verdict);
    results.attributes.extend(record::complete(&missing.words()));
    signals::held(|| writer.write(&results))?;
    if !missing.nothing() {
        return Err(Stopped::with(&missing, &outcome.results, writer.partial()).into());
    }
    let partial = writer.partial().to_path_buf();
    signals::held(|| writer.finish())
        .with_context(|| format!("the run is whole, but its file stays {}", partial.display()))?;
    for note in &outcome.notes {
        voice.say(format_args!("note: {note}"));
    }
    if plan.run.steady == Steady::Search {
        searched(&run, others.as_ref(), voice);
    }
    close(&scene, plan, outcome, &results, voice);
    precision(&run, voice);
    audit::accuracy(&scene, &run, &verdict, no_audit, voice);
    voice.say(format_args!(
        "wrote {} in {:.2} s ({:.2} s stepping, {:.2e} instance-steps/s)",
        output.display(),
        start.elapsed().as_secs_f64(),
        stepping,
        facts.rate
    ));
    audit::strict(args.strict, &verdict, &output)
}

/// What a search found.
fn searched(run: &Controlled, others: Option<&Others>, voice: Voice) {
    let stepped = run.plan.cases.iter().filter(|case| case.steps > 0).count();
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
