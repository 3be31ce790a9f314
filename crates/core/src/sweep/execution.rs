//! Executes a sweep from its plan to its results, phase by phase.

use super::planned_sweep::PlannedSweep;
use super::sweep_phase::MissingPhases;
use super::{Audit, Error, JournaledOutcome, Observer, Sweep, SweepPhase, audit_budget, sweep_outcome};
use crate::clock::Instant;
use crate::control::{self, ChunkJournal, Course, InstanceFlags, JournaledRun};
use crate::observe::Status;

impl Sweep {
    pub(super) fn execute<'k>(
        &self,
        observer: &dyn Observer,
        keep: &dyn ChunkJournal,
        instances: &dyn Fn(&mut PlannedSweep) -> Result<JournaledRun<'k>, Error>,
    ) -> Result<JournaledOutcome<'k>, Error> {
        let (scene, progress, start) = (&self.scene, &*self.progress, Instant::now());
        let mut begun = self.begun(observer)?;
        let planning = start.elapsed().as_secs_f64();
        let summary = begun.plan.summary(None).json().to_string();
        let stepping = Instant::now();
        let mut run = instances(&mut begun)?;
        let PlannedSweep { course, engine, .. } = begun;
        let (exact, estimated) = (course == Course::Reference, course == Course::Controlled);
        let mut missing = MissingPhases::of(&run);
        let is_nothing = |one: &InstanceFlags| !one.measured() && one.status() == Status::NotRun;
        if progress.stopped() && run.marks().iter().all(is_nothing) {
            return Err(Error::Stopped(SweepPhase::Stepping));
        }
        let others = missing.phase((SweepPhase::Branches, run.plan.run.both_branches), progress, || {
            let found = control::second_orbits(
                &run.gathered()?,
                &scene.sweep.shape(),
                keep,
                engine.as_ref(),
                progress,
            );
            found.map(|found| (!progress.stopped() || !found.orbits.is_empty()).then_some(found))
        })?;
        let (stepping, taken) = (stepping.elapsed().as_secs_f64(), progress.steps());
        run.notes.extend(engine.dealt());
        let audit = if exact { Audit::None } else { self.options.audit };
        let audited = missing.phase((SweepPhase::Audit, audit != Audit::None), progress, || {
            audit_budget::redo(audit, &run, stepping, keep, progress)
        })?;
        let accuracy = run.plan.run.accuracy;
        audited.iter().filter(|one| one.above(accuracy)).for_each(|one| run.miss(one.instance));
        let command_line = self.options.command_line.clone();
        let done = sweep_outcome::PhaseResults {
            scene,
            run,
            taken,
            others,
            audited,
            exact,
            estimated,
            summary,
            command_line,
        };
        sweep_outcome::collect(done, (start, planning, stepping), (engine.as_ref(), keep), missing, progress)
    }
}
