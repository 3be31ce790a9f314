//! What a sweep leaves: its results, and what is known of them.

use super::phase::Missing;
use super::{Error, Phase};
use crate::control::{self, Audited, Controlled, Keep, Others, Verdict};
use crate::engine::{Engine, Progress};
use crate::record::{self, Facts};
use crate::scene::{Scene, Steady};
use crate::store::Results;
use std::time::Instant;

/// A sweep that was run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Swept {
    /// Everything that a results file holds.
    pub results: Results,
    /// What is known of the errors.
    pub verdict: Verdict,
    /// The run itself: plan, measurements, estimates, periodic states.
    pub run: Controlled,
    /// Second periodic states, where the scene asks for them.
    pub others: Option<Others>,
    /// Where the contact laws are used outside their assumptions, in words.
    pub warnings: Vec<String>,
    /// What was not done because the run was stopped: nothing of a whole run.
    pub missing: Vec<Phase>,
    /// Instance-steps taken: trials, searches and estimates among them, audits not.
    pub steps_taken: u64,
    /// Planning, s: instruments, drives, contacts, the choice of an engine.
    pub planning: f64,
    /// Stepping, s, and instance-steps per second of it.
    pub stepping: f64,
    pub rate: f64,
}

/// What the phases of a run have left.
pub(super) struct Done<'a> {
    pub scene: &'a Scene,
    pub run: Controlled,
    /// Instance-steps of it and of the second states.
    pub taken: u64,
    pub others: Option<Others>,
    pub audited: Vec<Audited>,
    /// By the reference engine.
    pub exact: bool,
    pub estimated: bool,
    /// The first plan, as JSON.
    pub summary: String,
    pub command_line: String,
}

/// Results of the phases, waveforms last. `start`: when the run began, and the seconds of its planning and stepping.
pub(super) fn collect(
    done: Done,
    (start, planning, stepping): (Instant, f64, f64),
    (engine, keep): (&dyn Engine, &dyn Keep),
    mut missing: Missing,
    progress: &Progress,
) -> Result<Swept, Error> {
    let Done { scene, run, taken, others, audited, exact, estimated, summary, command_line } = done;
    let verdict = Verdict::of(&run, &audited, exact);
    let Controlled { plan, results: finished, estimates, found, periods, .. } = &run;
    let facts = Facts {
        device: engine.device(),
        wall_time: start.elapsed().as_secs_f64(),
        steps_taken: taken,
        rate: if taken == 0 { 0.0 } else { taken as f64 / stepping },
        neighbour_started: run.neighbour_started(),
        plan: summary,
        command_line,
        arithmetic: run.arithmetic.clone(),
    };
    let mut results = record::results(scene, plan, finished, &facts);
    record::error_estimate(&mut results, estimates, &control::basis(plan, estimated, exact));
    let request = scene.output.waveforms.as_ref();
    results.waveforms = missing.phase((Phase::Waveforms, request.is_some()), progress, || {
        // Of a run that was stopped they would be begun anew.
        let request = request.filter(|_| !progress.stopped());
        request.map(|request| record::waveforms_kept(plan, found, request, keep)).transpose()
    })?;
    if plan.run.steady == Steady::Search {
        record::search(&mut results, plan, finished, (found, periods), others.as_ref());
        record::jumps(&mut results, &run.jumps);
    }
    record::audit(&mut results, plan, &audited, &verdict);
    results.attributes.extend(record::complete(&missing.words()));
    let warnings = record::warning_lines(scene, plan, finished, &results);
    let (rate, steps_taken) = (facts.rate, taken);
    Ok(Swept {
        results,
        verdict,
        others,
        warnings,
        missing: missing.0,
        steps_taken,
        planning,
        stepping,
        rate,
        run,
    })
}
