//! What a run says while it lasts, and of its end.

use crate::cli::backend::say_choice;
use crate::cli::progress_bar::ProgressDisplay;
use crate::cli::{Verbosity, audit_message, instances, values};
use afmsweep::control::JournaledRun;
use afmsweep::engine::{Engine, Progress};
use afmsweep::periodic::SearchFailure;
use afmsweep::plan::Plan;
use afmsweep::scene::Steady;
use afmsweep::store::{StateSet, VariableSource};
use afmsweep::sweep::{EngineChoice, JournaledOutcome};
use afmsweep::{Observer, Scene, Status};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Quantities of which the preset's values are those of nobody's own sample and tip.
const DECIDES: [&str; 2] = ["sample.youngs_modulus", "instrument.tip.radius"];

/// What is said before a run steps, and how far it is then.
pub(super) struct Messages<'a> {
    pub path: &'a Path,
    pub scene: &'a Scene,
    /// A folder that was made for the results.
    pub folder: Option<PathBuf>,
    pub progress: Arc<Progress>,
    pub voice: Verbosity,
    pub shown: Mutex<Option<ProgressDisplay>>,
}

impl Observer for Messages<'_> {
    fn chosen(&self, choice: &EngineChoice) {
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
        let from_preset = self.scene.from_preset();
        let decides = |(path, _): &(String, f64)| DECIDES.contains(&path.as_str());
        let word = if from_preset.iter().any(decides) { "warning: " } else { "" };
        self.scene.preset_line().iter().for_each(|line| voice.say(format_args!("{word}{line}")));
        for line in self.scene.warnings().iter().chain(&plan.doubts()) {
            voice.say(format_args!("warning: {line}"));
        }
        if let Ok(mut shown) = self.shown.lock() {
            *shown = Some(ProgressDisplay::start(Arc::clone(&self.progress), voice));
        }
    }
}

/// What became of a whole run. `unaudited`: nobody wonders why no instance was redone.
///
/// # Errors
/// What is kept of the run cannot be read.
pub(super) fn end(
    scene: &Scene,
    (swept, progress): (&JournaledOutcome, &Progress),
    unaudited: bool,
    voice: Verbosity,
) -> anyhow::Result<()> {
    for note in &swept.run.notes {
        voice.say(format_args!("note: {note}"));
    }
    if swept.run.plan.run.steady == Steady::Search {
        searched(swept, voice)?;
        gave_up(progress, voice);
    }
    close(swept, voice);
    if swept.stepping > LONG {
        hardest(scene, &swept.run, voice)?;
    }
    precision(&swept.run, voice);
    audit_message::accuracy(scene, &swept.run, &swept.verdict, unaudited, voice)
}

/// Stepping of more seconds has its hardest instance named, if that took so large a share of the last runs' steps.
const LONG: f64 = 5.0;
const MUCH: f64 = 0.1;

/// Names the instance that took the most steps, where they are many of all.
fn hardest(scene: &Scene, run: &JournaledRun, voice: Verbosity) -> anyhow::Result<()> {
    let (mut all, mut most) = (0.0, (0.0, 0, 0));
    run.each(&mut |piece| {
        let plan = piece.plan();
        for (n, i) in plan.instances().zip(piece.instances) {
            let work = f64::from(plan.steps(n)) * f64::from(piece.periods(n as usize));
            all += work;
            if work > most.0 {
                most = (work, *i, plan.steps(n));
            }
        }
        ControlFlow::Continue(())
    })?;
    let (work, instance, steps) = most;
    if run.len() > 1 && work > MUCH * all {
        voice.say(format_args!(
            "{:.0} % of the steps were those of instance {instance} ({}), {steps} a period",
            100.0 * work / all,
            values(scene, instance as usize)
        ));
    }
    Ok(())
}

/// Why searches gave up, if some did.
fn gave_up(progress: &Progress, voice: Verbosity) {
    let told = |why: &SearchFailure| match progress.failures(*why) {
        0 => None,
        count => Some(format!("{count} {}", why.name())),
    };
    let told: Vec<String> = SearchFailure::ALL.iter().filter_map(told).collect();
    if !told.is_empty() {
        voice.say(format_args!(
            "searches that gave up, several for some instances: {} (docs/orbits.md)",
            told.join(", ")
        ));
    }
}

/// Periods of each instance whose state a search found, not integration after it.
pub(super) fn periods_of_found(run: &JournaledRun) -> anyhow::Result<Vec<u32>> {
    let mut all = Vec::new();
    run.each(&mut |piece| {
        let found = piece.multipliers().into_iter().enumerate().filter(|(_, one)| !one.is_nan());
        all.extend(found.map(|(n, _)| piece.periods(n)));
        ControlFlow::Continue(())
    })?;
    Ok(all)
}

/// What a search found.
fn searched(swept: &JournaledOutcome, voice: Verbosity) -> anyhow::Result<()> {
    let JournaledOutcome { run, others, .. } = swept;
    let stepped = run.marks().iter().filter(|mark| mark.stepped()).count();
    let without = run.count(Status::NoSetpoint);
    let mut spent = periods_of_found(run)?;
    spent.sort_unstable();
    let middle = spent
        .get(spent.len() / 2)
        .map_or(String::new(), |count| format!(", {count} periods each in the middle"));
    voice.say(format_args!(
        "search: periodic states of {} of {}{middle}; {} waited for{}",
        spent.len(),
        instances(stepped),
        stepped - spent.len() - without,
        if without > 0 {
            format!("; {without} without a gap that holds the set-point")
        } else {
            String::new()
        }
    ));
    let started = run.neighbour_started();
    if started > 0.0 {
        voice.say(format_args!(
            "neighbours: {:.1} % of the instances began at their neighbours' states (--cold searches each by itself)",
            100.0 * started
        ));
    }
    branches(swept, voice)?;
    if let Some(others) = others {
        let ways = match others.grid {
            true => format!(
                "{} from rest, {} of {} searches from neighbours, {} along the gap",
                others.from_rest, others.followed, others.tried, others.along_gap
            ),
            false => format!("{} from rest, {} along the gap", others.from_rest, others.along_gap),
        };
        let count = instances(others.orbits.len());
        voice
            .say(format_args!("branches: {count} with a second periodic state (group other_branch): {ways}"));
    }
    Ok(())
}

/// Where the states found are on different branches, how many are on each: they lie side by side in one picture then.
fn branches(swept: &JournaledOutcome, voice: Verbosity) -> anyhow::Result<()> {
    let Some((place, flags)) = swept.frame.flag_named("branch") else { return Ok(()) };
    let numbers = swept.numbers();
    let data = numbers.flags(StateSet::First, place)?;
    let count = |code| data.iter().filter(|one| **one == code).count();
    let counts = (1u8..=u8::MAX).zip(flags.meanings.iter().skip(1)).map(|(code, word)| (count(code), word));
    let told: Vec<String> =
        counts.filter(|one| one.0 > 0).map(|(count, word)| format!("{count} {word}")).collect();
    if told.len() > 1 {
        voice.say(format_args!(
            "branch: the states are on different ones, {} (flag branch; report --branch shows one of them)",
            told.join(" and ")
        ));
    }
    Ok(())
}

/// In which precision it ran, and why.
fn precision(run: &JournaledRun, voice: Verbosity) {
    let other = run.in_other_precision();
    let rest = match other {
        0 => String::new(),
        _ => format!("; {} went on in f64, which it did not bring to the accuracy", instances(other)),
    };
    voice.say(format_args!("precision: {}: {}{rest}", run.plan.precision.name(), run.reason));
}

/// What a user should know of the run: doubtful instances and doubtful contacts.
fn close(swept: &JournaledOutcome, voice: Verbosity) {
    for status in Status::ALL {
        let count = swept.run.count(status);
        if count > 0 && status != Status::Ok {
            voice.say(format_args!(
                "{count} of {} marked {}: {}",
                instances(swept.run.len()),
                status.meaning().replace('_', " "),
                status.reason()
            ));
        }
    }
    swept.warnings.iter().for_each(|line| voice.say(format_args!("warning: {line}")));
}
