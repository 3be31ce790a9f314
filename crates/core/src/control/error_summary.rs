//! A summary of a run's errors.

use super::AuditedInstance;
use super::instance_flags::InstanceFlags;
use super::journaled_run::JournaledRun;
use crate::engine::EngineError;
use crate::observe::{Observable, Status};
use crate::plan::Plan;
use std::collections::HashSet;

/// Whether instances that are ok meet the requested accuracy, as far as estimates and audits show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSummary {
    pub accuracy: f64,
    pub instances: usize,
    /// Number of instances that are ok, and number of these with neither an estimate nor an audit.
    pub ok: usize,
    pub unknown: usize,
    /// Number of instances marked as above the accuracy, by estimates or an audit.
    pub not_met: usize,
    /// Number of instances that were not run.
    pub not_run: usize,
    /// Number of instances that the reference redid; of these, those that both call ok; of those, the ones that touch the
    /// sample, the ones above the accuracy, and the ones for which the reference's own error may exceed it.
    pub audited: usize,
    pub compared: usize,
    pub touching: usize,
    pub above: usize,
    pub blind: usize,
    pub worst: Option<WorstInstance>,
}

/// The largest error that an audit found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstInstance {
    pub instance: u32,
    pub error: f64,
    pub observable: Option<Observable>,
    /// The run's estimate. NaN if there is none.
    pub estimate: f64,
}

impl ErrorSummary {
    /// Summarises a run whose audits are already marked. `exact`: the reference engine made the run, so it needs neither
    /// estimate nor audit.
    ///
    /// # Errors
    /// A stored chunk cannot be read.
    pub fn of(run: &JournaledRun, audited: &[AuditedInstance], exact: bool) -> Result<Self, EngineError> {
        let accuracy = run.plan.run.accuracy;
        let compared = || audited.iter().filter(|one| one.worst.is_some());
        let redone: HashSet<u32> = compared().map(|one| one.instance).collect();
        let told = |i: u32, mark: &InstanceFlags| {
            exact || !mark.stepped() || mark.estimated() || redone.contains(&i)
        };
        let unknown =
            (0..).zip(run.marks()).filter(|(i, mark)| mark.status() == Status::Ok && !told(*i, mark));
        let largest =
            compared().max_by(|a, b| a.worst.partial_cmp(&b.worst).unwrap_or(std::cmp::Ordering::Equal));
        let worst = |one: &AuditedInstance| {
            Ok::<_, EngineError>(WorstInstance {
                instance: one.instance,
                error: one.worst.unwrap_or(f64::NAN),
                observable: one.worst_place().and_then(|place| run.plan.observables.get(place).copied()),
                estimate: run.some(&[one.instance])?.estimates[0],
            })
        };
        Ok(Self {
            accuracy,
            instances: run.len(),
            ok: run.count(Status::Ok),
            unknown: unknown.count(),
            not_met: run.count(Status::AccuracyNotMet),
            not_run: run.count(Status::NotRun),
            audited: audited.len(),
            compared: compared().count(),
            touching: compared().filter(|one| one.touches()).count(),
            above: compared().filter(|one| one.above(accuracy)).count(),
            blind: compared().filter(|one| one.truncation > accuracy).count(),
            worst: largest.map(worst).transpose()?,
        })
    }

    /// Whether every instance was run, some are ok, each of these has an estimate or an audit, and no known error is above the
    /// accuracy.
    pub fn met(&self) -> bool {
        self.ok > 0 && self.not_run == 0 && self.not_met == 0 && self.above == 0 && self.unknown == 0
    }

    /// The verdict as text, for the file and the terminal.
    pub fn words(&self) -> String {
        let mut parts = Vec::new();
        if self.not_run > 0 {
            parts.push(format!("{} of {} instances were not run", self.not_run, self.instances));
        }
        if self.not_met > 0 {
            parts.push(format!(
                "{} of {} instances are marked accuracy_not_met",
                self.not_met, self.instances
            ));
        }
        if self.above > 0 {
            parts
                .push(format!("{} of {} audits are above the accuracy asked for", self.above, self.compared));
        }
        if self.unknown > 0 {
            parts.push(format!("{} instances called ok were neither estimated nor audited", self.unknown));
        }
        if self.ok == 0 {
            parts.push("no instance is called ok".into());
        }
        if self.met() {
            parts.push(format!("nothing above it is known of the {} instances called ok", self.ok));
        }
        format!("asked for {:e}: {}; audited {}", self.accuracy, parts.join("; "), self.compared)
    }
}

/// A sentence for the file on how a run's estimates were made, or why there are none.
pub fn estimate_comment(plan: &Plan, estimated: bool, exact: bool) -> String {
    if exact {
        return "NaN: nothing is estimated of the reference engine, whose steps keep to a tolerance of their own".into();
    }
    if !estimated {
        return "NaN: nothing was estimated, as the run was told to".into();
    }
    let steps = match plan.run.steps_per_period {
        Some(_) => "by a second run with half, or twice, the steps that the scene prescribes",
        None => {
            "by two runs with different numbers of steps, the first with a poorer basis where one was tried"
        }
    };
    let modes = match plan.run.modes {
        Some(_) => "what other modes than the prescribed ones would do is not in it",
        None if plan.run.steps_per_period.is_some() => {
            "what modes left out cost is in it by a sample of the instances, or by their flexibility where they are too fast \
             for those steps"
        }
        None => {
            "what modes left out cost is in it by a sample of the instances, by the measured contact and, for fast contacts, by a \
             run of their own"
        }
    };
    format!("{steps}; {modes}; NaN where an instance had no second run")
}
