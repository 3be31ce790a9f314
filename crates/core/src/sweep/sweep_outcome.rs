//! The outcome of a sweep: its results, and summaries of them.

use super::sweep_phase::MissingPhases;
use super::{Error, SweepPhase};
use crate::clock::Instant;
use crate::control::{
    self, Arithmetic, AuditedInstance, ChunkJournal, ErrorSummary, JournaledRun, RunResult, SecondOrbits,
};
use crate::engine::{Engine, EngineError, Progress};
use crate::record::{self, Facts, FileFrame, LawWarnings, RecordVariables};
use crate::scene::Scene;
use crate::store::Results;

/// A finished sweep, with all its results in memory.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SweepOutcome {
    /// Everything that a results file holds.
    pub results: Results,
    /// A summary of the errors.
    pub verdict: ErrorSummary,
    /// The run itself: plan, measurements, estimates, periodic states.
    pub run: RunResult,
    /// Second periodic states, if the scene requests them.
    pub others: Option<SecondOrbits>,
    /// Messages about contact laws used outside their assumptions.
    pub warnings: Vec<String>,
    /// Phases that a stop has cut off. Empty for a whole run.
    pub missing: Vec<SweepPhase>,
    /// Instance-steps taken, with trials, searches and estimates but without audits.
    pub steps_taken: u64,
    /// Planning, s: instruments, drives, contacts, the choice of an engine.
    pub planning: f64,
    /// Stepping, s, and instance-steps per second of it.
    pub stepping: f64,
    pub rate: f64,
}

/// A finished sweep whose chunks stay in storage; memory holds a few bytes for each instance. See [`SweepOutcome`].
#[non_exhaustive]
pub struct JournaledOutcome<'k> {
    /// Contents of the results file except the numbers over all instances.
    pub frame: FileFrame,
    warned: LawWarnings,
    pub verdict: ErrorSummary,
    /// The run itself.
    pub run: JournaledRun<'k>,
    pub others: Option<SecondOrbits>,
    pub warnings: Vec<String>,
    pub missing: Vec<SweepPhase>,
    pub steps_taken: u64,
    pub planning: f64,
    pub stepping: f64,
    pub rate: f64,
}

impl JournaledOutcome<'_> {
    /// The numbers over all instances, read from storage one variable at a time.
    pub fn numbers(&self) -> RecordVariables<'_> {
        RecordVariables::of_run(&self.frame, (&self.run, &self.warned), self.others.as_ref())
    }

    /// The results file in memory. `path` serves only for messages.
    ///
    /// # Errors
    /// Stored chunks cannot be read.
    #[cfg(feature = "hdf5")]
    pub fn laid_out(&self, path: &std::path::Path) -> Result<crate::store::Hdf5Image, Error> {
        let results = &self.frame.results;
        let scene = results.text("scene").unwrap_or_default();
        Ok(crate::store::laid_out(results, &self.numbers(), scene, path)?)
    }

    /// Loads everything into memory.
    ///
    /// # Errors
    /// Stored chunks cannot be read.
    pub fn gathered(self) -> Result<SweepOutcome, Error> {
        let unread = |unread: crate::store::Unread| EngineError::Unread { why: unread.0 };
        let results = self.frame.results.clone().with_numbers(&self.numbers()).map_err(unread)?;
        let run = self.run.gathered()?;
        let Self { verdict, others, warnings, missing, steps_taken, planning, stepping, rate, .. } = self;
        Ok(SweepOutcome {
            results,
            verdict,
            run,
            others,
            warnings,
            missing,
            steps_taken,
            planning,
            stepping,
            rate,
        })
    }
}

/// What the phases of a run have produced.
pub(super) struct PhaseResults<'k, 's> {
    pub scene: &'s Scene,
    pub run: JournaledRun<'k>,
    /// Instance-steps of the run and of the second states.
    pub taken: u64,
    pub others: Option<SecondOrbits>,
    pub audited: Vec<AuditedInstance>,
    /// Whether the reference engine made the run.
    pub exact: bool,
    pub estimated: bool,
    /// The first plan, as JSON.
    pub summary: String,
    pub command_line: String,
}

/// Adds waveforms and spectra to the phases' results. The second argument: start, seconds of planning and stepping.
pub(super) fn collect<'k>(
    done: PhaseResults<'k, '_>,
    (start, planning, stepping): (Instant, f64, f64),
    (engine, keep): (&dyn Engine, &dyn ChunkJournal),
    mut missing: MissingPhases,
    progress: &Progress,
) -> Result<JournaledOutcome<'k>, Error> {
    let PhaseResults { scene, run, taken, others, audited, exact, estimated, summary, command_line } = done;
    let verdict = ErrorSummary::of(&run, &audited, exact)?;
    let facts = Facts {
        device: engine.device(),
        wall_time: start.elapsed().as_secs_f64(),
        steps_taken: taken,
        rate: if taken == 0 { 0.0 } else { taken as f64 / stepping },
        neighbour_started: run.neighbour_started(),
        plan: summary,
        command_line,
        arithmetic: Arithmetic {
            of: run.marks().iter().map(|mark| mark.precision()).collect(),
            rounding: run.rounding,
            reason: run.reason.clone(),
        },
    };
    let warned = record::warned(scene, &run)?;
    let mut frame = record::frame(scene, (&run.plan, &warned), &facts);
    frame.estimated(control::estimate_comment(&run.plan, estimated, exact));
    let request = scene.output.waveforms.as_ref();
    frame.results.waveforms = missing.phase((SweepPhase::Waveforms, request.is_some()), progress, || {
        // After a stop they would start from scratch.
        let request = request.filter(|_| !progress.stopped());
        request.map(|request| record::waveforms_kept(&run, request, keep)).transpose()
    })?;
    let listed = scene.output.spectra.as_deref();
    frame.results.spectra = missing.phase((SweepPhase::Spectra, listed.is_some()), progress, || {
        let listed = listed.filter(|_| !progress.stopped());
        listed.map(|instances| record::spectra_of_run(&run, instances)).transpose()
    })?;
    frame.searched(&run.plan, run.curves, others.is_some());
    record::audit(&mut frame.results, &run.plan, &audited, &verdict);
    frame.results.attributes.extend(record::complete(&missing.words()));
    let warnings = warned.lines(scene, &run)?;
    let (rate, steps_taken) = (facts.rate, taken);
    Ok(JournaledOutcome {
        frame,
        warned,
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
