//! A sweep from its plan to its results, phase after phase.

use super::begun::Begun;
use super::phase::Missing;
use super::{Audit, Error, Kept, Observer, Phase, Sweep, audit, swept};
use crate::control::{self, Course, Keep, Mark, Ran};
use crate::observe::Status;
use std::time::Instant;

impl Sweep {
    pub(super) fn carried_out<'k>(
        &self,
        observer: &dyn Observer,
        keep: &dyn Keep,
        instances: &dyn Fn(&mut Begun) -> Result<Ran<'k>, Error>,
    ) -> Result<Kept<'k>, Error> {
        let (scene, progress, start) = (&self.scene, &*self.progress, Instant::now());
        let mut begun = self.begun(observer)?;
        let planning = start.elapsed().as_secs_f64();
        let summary = begun.plan.summary(None).json().to_string();
        let stepping = Instant::now();
        let mut run = instances(&mut begun)?;
        let Begun { course, engine, .. } = begun;
        let (exact, estimated) = (course == Course::Reference, course == Course::Controlled);
        let mut missing = Missing::of(&run);
        let is_nothing = |one: &Mark| !one.measured() && one.status() == Status::NotRun;
        if progress.stopped() && run.marks().iter().all(is_nothing) {
            return Err(Error::Stopped(Phase::Stepping));
        }
        let others = missing.phase((Phase::Branches, run.plan.run.both_branches), progress, || {
            let found =
                control::others(&run.gathered()?, &scene.sweep.shape(), keep, engine.as_ref(), progress);
            found.map(|found| (!progress.stopped() || !found.states.is_empty()).then_some(found))
        })?;
        let (stepping, taken) = (stepping.elapsed().as_secs_f64(), progress.steps());
        run.notes.extend(engine.dealt());
        let audit = if exact { Audit::None } else { self.options.audit };
        let audited = missing.phase((Phase::Audit, audit != Audit::None), progress, || {
            audit::redo(audit, &run, stepping, keep, progress)
        })?;
        let accuracy = run.plan.run.accuracy;
        audited.iter().filter(|one| one.above(accuracy)).for_each(|one| run.miss(one.instance));
        let command_line = self.options.command_line.clone();
        let done =
            swept::Done { scene, run, taken, others, audited, exact, estimated, summary, command_line };
        swept::collect(done, (start, planning, stepping), (engine.as_ref(), keep), missing, progress)
    }
}
