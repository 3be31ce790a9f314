//! What is known of a run's errors, all told.

use super::AuditedInstance;
use super::instance_flags::InstanceFlags;
use super::journaled_run::JournaledRun;
use crate::engine::EngineError;
use crate::observe::{Observable, Status};
use crate::plan::Plan;
use std::collections::HashSet;

/// Whether what a run calls ok meets the accuracy asked for, as far as estimates and audits tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSummary {
    pub accuracy: f64,
    pub instances: usize,
    /// Instances called ok, and those of them of which neither an estimate nor an audit says how good they are.
    pub ok: usize,
    pub unknown: usize,
    /// Instances marked as above the accuracy, by their estimates or an audit.
    pub not_met: usize,
    /// Instances that were not run.
    pub not_run: usize,
    /// Instances redone by the reference; those that both call ok, and of these those that touch the sample, those above
    /// the accuracy, and those for which the reference itself may be off by more than it.
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
    /// What the run had estimated; NaN where nothing.
    pub estimate: f64,
}

impl ErrorSummary {
    /// Of a run and its audits, once these are marked. `exact`: by the reference engine, whose results stand without
    /// either.
    ///
    /// # Errors
    /// What is kept of a chunk cannot be read.
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

    /// Whether every instance was run, nothing that is known speaks against the results called ok, and something is known of
    /// each.
    pub fn met(&self) -> bool {
        self.not_run == 0 && self.not_met == 0 && self.above == 0 && self.unknown == 0
    }

    /// The verdict in words, for the file and the terminal.
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
        if self.met() {
            parts.push(match self.ok {
                0 => "no instance is called ok".into(),
                ok => format!("nothing above it is known of the {ok} instances called ok"),
            });
        }
        format!("asked for {:e}: {}; audited {}", self.accuracy, parts.join("; "), self.compared)
    }
}

/// What the estimates of a run rest on, or why there are none, in a sentence for the file.
pub fn basis(plan: &Plan, estimated: bool, exact: bool) -> String {
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
        None => "what modes left out cost is in it by a sample of the instances",
    };
    format!("{steps}; {modes}; NaN where an instance had no second run")
}
