//! What a run says while it lasts, for Python to fetch: its threads never wait for Python's.

use crate::exception::plain;
use crate::key_paths::keyed_line;
use afmsweep::cli::backend;
use afmsweep::control::JournaledRun;
use afmsweep::engine::{Engine, ProgressPhase};
use afmsweep::plan::Plan;
use afmsweep::scene::{Address, PRESET};
use afmsweep::sweep::{EngineChoice, JournaledOutcome};
use afmsweep::units::shown;
use afmsweep::{Observer, Scene, Status};
use std::ops::ControlFlow;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Messages by their kind (`warning`, `info`, `debug`), and how far the run is.
#[derive(Default)]
pub struct PythonObserver {
    messages: Mutex<Vec<(&'static str, String)>>,
    phase: Mutex<Option<ProgressPhase>>,
    /// Name and text of the scene, for places in it.
    scene: OnceLock<(String, String)>,
}

/// What a scene of one's own says: the preset's values are of another sample.
const OWN: [&str; 2] = ["approach.gap", "sample.youngs_modulus"];

impl PythonObserver {
    fn say(&self, kind: &'static str, text: &str) {
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        let text = match self.scene.get() {
            Some((name, source)) => keyed_line(text, name, source),
            None => text.to_owned(),
        };
        messages.push((kind, plain(&text)));
    }

    /// The messages since the last call.
    pub fn fetched(&self) -> Vec<(&'static str, String)> {
        std::mem::take(&mut *self.messages.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Name and share of the present phase, if it is another one or further than at the last call.
    pub fn progressed(&self) -> Option<(String, Option<f64>)> {
        let phase = self.phase.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        Some((phase.name, phase.share))
    }

    /// What the scene and its samples leave in doubt.
    pub fn begin(&self, scene: &Scene) {
        let _ = self.scene.set((scene.path.display().to_string(), scene.source.to_string()));
        self.of_preset(scene).iter().for_each(|line| self.say("warning", line));
        scene.warnings().iter().for_each(|line| self.say("warning", line));
        scene.preset_line().iter().for_each(|line| self.say("info", line));
    }

    /// A word about values of the preset that a scene hardly means.
    fn of_preset(&self, scene: &Scene) -> Option<String> {
        let one = |(path, value): &(String, f64)| {
            let known = OWN.contains(&path.as_str()).then(|| Address::find(path)).flatten()?;
            Some(format!("{path} = {}", shown(*value, known.quantity.dimension)))
        };
        let values: Vec<String> = scene.from_preset().iter().filter_map(one).collect();
        let meant = values.is_empty() || scene.source.contains(PRESET);
        (!meant).then(|| format!("not given, so the preset's of 2005: {}", values.join(", ")))
    }

    /// What became of the run.
    pub fn end(&self, swept: &JournaledOutcome) {
        let run = &swept.run;
        swept.warnings.iter().for_each(|line| self.say("warning", line));
        self.statuses(run);
        run.notes.iter().for_each(|note| self.say("info", note));
        self.say("info", &format!("precision: {}: {}", run.plan.precision.name(), run.reason));
        self.say("info", &swept.verdict.words());
    }

    fn statuses(&self, run: &JournaledRun) {
        for status in Status::ALL.into_iter().filter(|status| *status != Status::Ok) {
            let count = run.count(status);
            if count > 0 {
                let word = status.meaning().replace('_', " ");
                let reason = status.reason();
                self.say("warning", &format!("{count} of {} instances marked {word}: {reason}", run.len()));
            }
        }
    }
}

impl Observer for PythonObserver {
    fn chosen(&self, choice: &EngineChoice) {
        let (line, is_detail) = backend::told(choice);
        self.say(if is_detail { "debug" } else { "info" }, &line);
    }

    fn planned(&self, plan: &Plan, engine: &dyn Engine) {
        let (count, steps) = (plan.len(), plan.instance_steps() as f64);
        self.say("info", &format!("{count} instances, {steps:.2e} instance-steps on {}", engine.device()));
        plan.doubts().iter().for_each(|line| self.say("warning", line));
    }

    fn progress(&self, stage: &ProgressPhase) -> ControlFlow<()> {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner) = Some(stage.clone());
        ControlFlow::Continue(())
    }
}
