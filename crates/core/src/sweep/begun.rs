//! A sweep between its plan and its results: what is chosen for it, and how its instances are taken to their ends.

#[cfg(feature = "hdf5")]
use super::Keeper;
use super::{Error, Phase, Prepared, Sweep};
#[cfg(feature = "hdf5")]
use crate::control::Division;
use crate::control::{self, Choices, Course, Keep, Ran};
use crate::engine::Engine;
use crate::plan::Plan;

/// A sweep that is planned.
pub(super) struct Begun<'a> {
    pub sweep: &'a Sweep,
    pub course: Course,
    pub plan: Plan,
    pub engine: Box<dyn Engine>,
}

impl Begun<'_> {
    /// What is chosen for it.
    pub fn chosen(&self) -> Result<Prepared, Error> {
        let Sweep { scene, options, progress, .. } = self.sweep;
        let why = if options.precision.is_some() { "as told" } else { "nothing to choose it by" };
        let chosen = match self.course {
            Course::Once => Some(Choices::untried(&self.plan, Course::Once, self.engine.as_ref(), why)),
            _ => control::choose(&self.plan, self.course, self.engine.as_ref(), progress)?,
        };
        let mut choices = chosen.ok_or(Error::Stopped(Phase::Stepping))?;
        choices.portion = options.portion.unwrap_or(choices.portion);
        Ok(Prepared::new(scene, options, (self.engine.device(), self.engine.kind()), choices))
    }

    /// The instances, by choices that were made before or that are made now.
    pub fn of_all<'k>(&mut self, keep: &'k dyn Keep) -> Result<Ran<'k>, Error> {
        let sweep = self.sweep;
        match &sweep.prepared {
            Some(prepared) => {
                self.check(prepared, false)?;
                self.by(prepared, keep)
            }
            None => {
                let chosen = self.chosen()?;
                self.by(&chosen, keep)
            }
        }
    }

    fn check(&self, prepared: &Prepared, anyway: bool) -> Result<(), Error> {
        prepared.check(&self.sweep.scene, &self.sweep.options, &self.engine.kind(), anyway)
    }

    /// By these choices. The plan goes into what becomes of it: nothing is left of it here.
    pub fn by<'k>(&mut self, prepared: &Prepared, keep: &'k dyn Keep) -> Result<Ran<'k>, Error> {
        let nothing = self.plan.part(&[]);
        let plan = std::mem::replace(&mut self.plan, nothing);
        let (engine, progress) = (self.engine.as_ref(), &*self.sweep.progress);
        Ok(control::carry_out(plan, &prepared.choices, keep, engine, progress)?)
    }

    /// The choices in a journal, which the run's own are to be.
    #[cfg(feature = "hdf5")]
    pub fn given<'k>(&self, keeper: &'k Keeper) -> Result<&'k Prepared, Error> {
        let none = || Error::Prepared { what: "the journal holds no choices".into() };
        keeper.prepared().ok_or_else(none)
    }

    /// The instances, by way of a journal.
    #[cfg(feature = "hdf5")]
    pub fn kept<'k>(&mut self, keeper: &'k Keeper) -> Result<Ran<'k>, Error> {
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
            (None, None) => chosen.insert(self.chosen()?),
        };
        keeper.begin(prepared, &self.sweep.options.command_line)?;
        let missing = keeper.missing_shares(&Division::of(&self.plan, &prepared.choices, keeper.shares()));
        if !missing.is_empty() {
            return Err(Error::Missing { shares: missing });
        }
        let run = self.by(prepared, keeper);
        match keeper.failure() {
            Some(failure) => Err(failure),
            None => run,
        }
    }
}
