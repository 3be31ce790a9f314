//! A sweep between its plan and its results: its choices, and the runs of its instances.

#[cfg(feature = "hdf5")]
use super::RunJournal;
use super::{Error, Recipe, Sweep, SweepPhase};
#[cfg(feature = "hdf5")]
use crate::control::Chunking;
use crate::control::{self, Choices, ChunkJournal, Course, JournaledRun};
use crate::engine::Engine;
use crate::plan::Plan;

/// A planned sweep.
pub(super) struct PlannedSweep<'a> {
    pub sweep: &'a Sweep,
    pub course: Course,
    pub plan: Plan,
    pub engine: Box<dyn Engine>,
}

impl PlannedSweep<'_> {
    /// Makes its choices.
    pub fn recipe(&self) -> Result<Recipe, Error> {
        let Sweep { scene, options, progress, .. } = self.sweep;
        let why = if options.precision.is_some() { "as told" } else { "nothing to choose it by" };
        let chosen = match self.course {
            Course::Once => Some(Choices::untried(&self.plan, Course::Once, self.engine.as_ref(), why)),
            _ => control::choose(&self.plan, self.course, self.engine.as_ref(), progress)?,
        };
        let mut choices = chosen.ok_or(Error::Stopped(SweepPhase::Stepping))?;
        choices.portion = options.portion.unwrap_or(choices.portion);
        Ok(Recipe::new(scene, options, (self.engine.device(), self.engine.kind()), choices))
    }

    /// Runs the instances with earlier choices or new ones.
    pub fn run_all<'k>(&mut self, keep: &'k dyn ChunkJournal) -> Result<JournaledRun<'k>, Error> {
        let sweep = self.sweep;
        match &sweep.prepared {
            Some(prepared) => {
                self.check(prepared, false)?;
                self.run_by(prepared, keep)
            }
            None => {
                let chosen = self.recipe()?;
                self.run_by(&chosen, keep)
            }
        }
    }

    fn check(&self, prepared: &Recipe, anyway: bool) -> Result<(), Error> {
        prepared.check(&self.sweep.scene, &self.sweep.options, &self.engine.kind(), anyway)
    }

    /// Runs with these choices. This consumes the plan.
    pub fn run_by<'k>(
        &mut self,
        prepared: &Recipe,
        keep: &'k dyn ChunkJournal,
    ) -> Result<JournaledRun<'k>, Error> {
        let nothing = self.plan.part(&[]);
        let plan = std::mem::replace(&mut self.plan, nothing);
        let (engine, progress) = (self.engine.as_ref(), &*self.sweep.progress);
        Ok(control::run_chunks(plan, &prepared.choices, keep, engine, progress)?)
    }

    /// The choices in a journal.
    #[cfg(feature = "hdf5")]
    pub fn journal_recipe<'k>(&self, keeper: &'k RunJournal) -> Result<&'k Recipe, Error> {
        let none = || Error::Prepared { what: "the journal holds no choices".into() };
        keeper.prepared().ok_or_else(none)
    }

    /// Runs the instances with a journal.
    #[cfg(feature = "hdf5")]
    pub fn run_journaled<'k>(&mut self, keeper: &'k RunJournal) -> Result<JournaledRun<'k>, Error> {
        let (chosen, sweep) = (&mut None, self.sweep);
        let prepared = match (keeper.prepared(), &sweep.prepared) {
            (Some(ours), Some(told)) if !ours.is_of_one_run_with(told) => {
                let what = "the journal is of a run with other choices than those given".into();
                return Err(Error::Prepared { what });
            }
            (Some(given), _) | (None, Some(given)) => {
                self.check(given, keeper.anyway())?;
                given
            }
            (None, None) => chosen.insert(self.recipe()?),
        };
        keeper.begin(prepared, &self.sweep.options.command_line)?;
        let missing = keeper.missing_shares(&Chunking::of(&self.plan, &prepared.choices, keeper.shares()));
        if !missing.is_empty() {
            return Err(Error::Missing { shares: missing });
        }
        let run = self.run_by(prepared, keeper);
        match keeper.failure() {
            Some(failure) => Err(failure),
            None => run,
        }
    }
}
