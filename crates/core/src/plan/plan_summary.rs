//! The plan in words and as JSON.

use super::classes::Shape;
use super::{Driven, Plan, STEPS_MAX, steps};
use crate::scene::Steady;
use crate::units::{Dimension, shown};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt;

/// A summary of a plan.
#[derive(Clone, Debug)]
pub struct PlanSummary {
    json: Value,
    text: String,
}

/// Drives listed one by one; if there are more, the first ones and the last.
const MAX_DRIVES_TOLD: usize = 6;

/// Bytes in memory for an instance apart from the results file: under integration, under search, and with second states, which
/// need the first ones in memory; and the additional bytes for each of the instances processed at a time. From largest
/// resident sets of 100,000 to 10,000,000 instances on the CPU (`tests/python/many.py`).
const BYTES_PER_INSTANCE: u64 = 24;
const BYTES_PER_ORBIT: u64 = 48;
const BYTES_PER_SECOND_ORBIT: u64 = 600;
const BYTES_INTEGRATING: u64 = 500;
const BYTES_SEARCHING: u64 = 1_300;
const INSTANCES_AT_A_TIME: usize = 1 << 17;
/// Bytes of the program itself and its libraries.
const PROGRAM_BYTES: u64 = 25_000_000;

/// No instrument is driven this many times above the lever's first mode.
const DOUBTFUL_FREQUENCY_RATIO: f64 = 100.0;

/// Assumption behind steps and time, whether a scene integrates or searches.
const ESTIMATED: &str = "every instance waited for all periods, once";

impl Plan {
    /// In words and as JSON; `seconds` is the estimated run time, if known.
    pub fn summary(&self, seconds: Option<f64>) -> PlanSummary {
        let classes: Vec<(Shape, usize)> = self.shapes().into_iter().collect();
        let told: Vec<usize> = (0..self.drives.len()).filter(|index| self.tells(*index)).collect();
        PlanSummary { text: self.text(&classes, &told, seconds), json: self.json(&classes, &told, seconds) }
    }

    /// Whether the summary lists a drive.
    fn tells(&self, index: usize) -> bool {
        index < MAX_DRIVES_TOLD || index + 1 == self.drives.len()
    }

    fn text(&self, classes: &[(Shape, usize)], told: &[usize], seconds: Option<f64>) -> String {
        let mut text = format!(
            "{} instance{}, {} driven instrument{}, {} class{}, precision {}{}\n",
            self.len(),
            plural(self.len(), "s"),
            self.drives.len(),
            plural(self.drives.len(), "s"),
            classes.len(),
            plural(classes.len(), "es"),
            self.precision.name(),
            match self.precision_settled() {
                None => ", or by a trial of both, whichever serves",
                Some(_) => "",
            },
        );
        for (place, index) in told.iter().enumerate() {
            if place != *index {
                text += "...\n";
            }
            text += &self.drive_text(*index);
        }
        text += "class  law    modes  steps/period  instances\n";
        for (index, ((steps, law, modes), count)) in classes.iter().enumerate() {
            text += &format!(
                "{index:>5}  {:<5}  {:>5}  {:>12}  {:>9}{}\n",
                law.name(),
                modes,
                steps,
                count,
                if *steps == 0 { "  (never reach the sample: no steps)" } else { "" }
            );
        }
        text += &format!(
            "{} periods, the last {} measured: {:.3e} instance-steps\n",
            self.run.periods,
            self.run.measure,
            self.instance_steps() as f64
        );
        text += &self.searched();
        text += &format!(
            "results {} before compression, memory about {}\n",
            bytes(self.file_bytes()),
            bytes(self.memory_bytes())
        );
        if let Some(seconds) = seconds {
            text += &format!("at most {seconds:.2} s, if every instance takes all of its periods\n");
        }
        text
    }

    fn drive_text(&self, index: usize) -> String {
        let drive = &self.drives[index];
        let kept = &drive.kept;
        let mut text = format!(
            "drive {index}: {:.6} kHz, free amplitude {:.6} nm; {}\n",
            drive.frequency() / 1e3,
            drive.free_amplitude() * 1e9,
            kept.reason
        );
        for mode in &kept.modes {
            let other = if mode.is_static() { "static" } else { "residual" };
            let name = mode.index.map_or(other.to_owned(), |k| format!("mode {}", k + 1));
            let share = mode.inverse_mass / (mode.omega * mode.omega) / kept.flexibility;
            let q = 0.5 / mode.damping;
            text += &format!(
                "  {name:<9} {:>14.6} kHz  Q {:>9}  {:>8.4} % of the tip's flexibility\n",
                mode.omega / TAU / 1e3,
                if q.is_finite() { format!("{q:.1}") } else { "undamped".into() },
                100.0 * share
            );
        }
        text
    }

    fn json(&self, classes: &[(Shape, usize)], told: &[usize], seconds: Option<f64>) -> Value {
        json!({
            "instances": self.len(),
            "precision": self.precision.name(),
            "precision_by_trial": self.precision_settled().is_none(),
            "periods": self.run.periods,
            "measure": self.run.measure,
            "steady": match self.run.steady {
                Steady::Wait => "wait",
                Steady::Search => "search",
            },
            "branches": if self.run.both_branches { "both" } else { "one" },
            "estimate_is_for": ESTIMATED,
            "accuracy": self.run.accuracy,
            "observables": self.observables.iter().map(|one| one.name()).collect::<Vec<_>>(),
            "drives_in_all": self.drives.len(),
            "drives": told.iter().map(|index| self.drive_json(*index)).collect::<Vec<_>>(),
            "classes": classes.iter().map(class_json).collect::<Vec<_>>(),
            "instance_steps": self.instance_steps(),
            "file_bytes": self.file_bytes(),
            "memory_bytes": self.memory_bytes(),
            "estimated_time_s": seconds,
        })
    }

    /// What a search changes about these numbers; empty if the scene integrates.
    fn searched(&self) -> String {
        if self.run.steady == Steady::Wait {
            return String::new();
        }
        let second = match self.run.both_branches {
            true => "; a second state of each is searched for on top",
            false => "",
        };
        format!(
            "periodic states are searched for: steps and time are told as if {ESTIMATED}; a search mostly takes 25 to \
             250 periods, and what it does not find waits all {}{second}\n",
            self.run.periods
        )
    }

    fn drive_json(&self, index: usize) -> Value {
        let drive = &self.drives[index];
        let kept = &drive.kept;
        let modes: Vec<Value> = kept
            .modes
            .iter()
            .map(|mode| {
                let q = 0.5 / mode.damping;
                json!({
                    "mode": mode.index.map(|k| k + 1),
                    "frequency_hz": mode.omega / TAU,
                    "quality_factor": q.is_finite().then_some(q),
                    "tip_share": mode.inverse_mass / (mode.omega * mode.omega) / kept.flexibility,
                })
            })
            .collect();
        json!({
            "drive": index,
            "frequency_hz": drive.frequency(),
            "level": drive.free.level,
            "free_amplitude_m": drive.free_amplitude(),
            "tip_flexibility_m_per_n": kept.flexibility,
            "residual_share": kept.residual_share,
            "residual_kept": kept.residual_kept,
            "reason": kept.reason,
            "modes": modes,
            "elements": { "rod": drive.instrument.rod_elements, "beam": drive.instrument.beam_elements, "order": drive.instrument.order },
            "eigen_residual": drive.instrument.residual,
        })
    }

    /// Bytes of the numbers in the results file before compression, without force curves and texts.
    pub fn file_bytes(&self) -> u64 {
        let columns: usize = self.observables.iter().map(|one| one.width()).sum();
        // Tabor's parameter, steps, status, law and warnings besides the observables.
        let each = 8 * (columns as u64 + 1) + 4 + 3;
        let waveforms = self.waveforms.as_ref().map_or(0, |request| {
            let samples = u64::from(request.samples_per_period) * u64::from(request.periods);
            8 * samples * (1 + 4 * request.instances.len() as u64)
        });
        each * self.len() as u64 + waveforms
    }

    /// Upper bound on the bytes in memory of a run by the program: the program, plans of the scene and of repeated runs, a few
    /// numbers of each instance, a list's columns, and the results file with these. A run by the library also holds all its
    /// results.
    pub fn memory_bytes(&self) -> u64 {
        let (held, at_a_time) = match self.run.steady {
            Steady::Wait => (BYTES_PER_INSTANCE, BYTES_INTEGRATING),
            Steady::Search if self.run.both_branches => (BYTES_PER_SECOND_ORBIT, BYTES_SEARCHING),
            Steady::Search => (BYTES_PER_ORBIT, BYTES_SEARCHING),
        };
        let portions = at_a_time * self.len().min(INSTANCES_AT_A_TIME) as u64;
        // The number of the sample is a column, too.
        let columns = 8 * (self.ensemble.columns as u64 + u64::from(self.ensemble.columns > 0));
        PROGRAM_BYTES + (held + 2 * columns) * self.len() as u64 + portions + self.file_bytes()
    }

    /// Doubts about a plan that can run, one line each: drives that are too slow for the modes they excite, or far above them.
    pub fn doubts(&self) -> Vec<String> {
        let most = self.run.steps_per_period.map_or(STEPS_MAX, |steps| steps.max(STEPS_MAX));
        let needed = |drive: &&Driven| steps::needed_by_modes(&drive.kept, drive.free.omega);
        let above = |drive: &&Driven| drive.frequency() / drive.instrument.lever_frequency;
        let hertz = |frequency| shown(frequency, Dimension::Frequency);
        let mut lines = Vec::new();
        if let Some(drive) = self.drives.iter().find(|drive| needed(drive) > f64::from(most)) {
            lines.push(format!(
                "a drive of {} is too slow for a lever of {}: its modes need {:.1e} steps in each \
                 period, and at most {most} are taken; give drive.frequency above {}",
                hertz(drive.frequency()),
                hertz(drive.instrument.lever_frequency),
                needed(&drive),
                hertz(drive.frequency() * needed(&drive) / f64::from(most))
            ));
        }
        if let Some(drive) = self.drives.iter().find(|drive| above(drive) > DOUBTFUL_FREQUENCY_RATIO) {
            lines.push(format!(
                "a drive of {} is {:.1e} times above the lever's first mode, {}, which hardly follows it; \
                 check drive.frequency",
                hertz(drive.frequency()),
                above(&drive),
                hertz(drive.instrument.lever_frequency)
            ));
        }
        lines
    }
}

fn class_json(((steps, law, modes), count): &(Shape, usize)) -> Value {
    json!({
        "law": law.name(),
        "modes": modes,
        "steps_per_period": steps,
        "instances": count,
    })
}

fn plural(count: usize, ending: &'static str) -> &'static str {
    if count == 1 { "" } else { ending }
}

fn bytes(count: u64) -> String {
    match count {
        0..10_000 => format!("{count} B"),
        10_000..10_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        _ => format!("{:.1} MB", count as f64 / 1e6),
    }
}

impl PlanSummary {
    /// SI units, names with units.
    pub fn json(&self) -> &Value {
        &self.json
    }
}

impl fmt::Display for PlanSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
