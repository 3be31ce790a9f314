//! A pack of instances on its way through a run, whatever its lanes, law and modes: what is compiled once
//! for all of them need not know.

use super::EngineError;
use super::cpu::Resume;
use super::lanes::Family;
use super::law::KernelLaw;
use super::measure::Sums;
use super::station;
use super::track::{Member, Track};
use crate::contact::Law;
use crate::kernel::contact::{Dmt, Hertz, Jkr, Nothing};
use crate::kernel::{Decay, Lane, MODES_MAX, Wave};
use crate::observe::Wants;
use crate::plan::{Plan, Station};
use crate::scene::Run;

/// See [`Track`].
pub(super) trait Walk<E>: Send {
    fn advance(
        &mut self,
        run: &Run,
        periods: u32,
        waves: &[Vec<Wave<E>>],
        decay: Option<&[Decay<E>]>,
        wants: Wants,
    );
    fn sums(&self, run: &Run, steps: u32) -> Vec<Sums>;
    /// Where member `lane` stands.
    fn station(&self, lane: usize) -> Station;
    fn members(&self) -> usize;
    fn done(&self) -> u32;
}

impl<E, L: Lane<Element = E>, I: KernelLaw<L> + Send, const M: usize> Walk<E> for Track<L, I, M> {
    fn advance(
        &mut self,
        run: &Run,
        periods: u32,
        waves: &[Vec<Wave<E>>],
        decay: Option<&[Decay<E>]>,
        wants: Wants,
    ) {
        Track::advance(self, run, periods, waves, decay, wants);
    }

    fn sums(&self, run: &Run, steps: u32) -> Vec<Sums> {
        Track::sums(self, run, steps)
    }

    fn station(&self, lane: usize) -> Station {
        Track::station(self, lane)
    }

    fn members(&self) -> usize {
        Track::members(self)
    }

    fn done(&self) -> u32 {
        self.done
    }
}

type Make<E> = fn(&Plan, &[Member], Option<Resume>, usize) -> Box<dyn Walk<E>>;

/// Something to be done with the kernel that steps one law and number of modes.
pub(super) trait Shape<E> {
    type Output;
    fn with<L, I, const M: usize>(self) -> Self::Output
    where
        L: Lane<Element = E> + 'static,
        I: KernelLaw<L> + Send + Sync + 'static;
}

/// Does it with the lanes of a family for a law and a number of modes.
///
/// # Errors
/// No modes, or more than the kernel can step.
pub(super) fn shaped<F: Family, S: Shape<F::Element>>(
    law: Law,
    modes: usize,
    what: S,
) -> Result<S::Output, EngineError> {
    // Compiled for a few numbers of modes; up to 8 the ones between are filled up with modes at rest, beyond there is
    // one kernel with a loop.
    macro_rules! law {
        (Nothing, $lane:ty) => { Nothing };
        ($law:ident, $lane:ty) => { $law<$lane> };
    }
    macro_rules! modes {
        ($law:ident: wide $($two:literal)*, narrow $($one:literal)*) => {
            match modes {
                0 => Err(EngineError::NoModes),
                $(..=$two => Ok(what.with::<F::Wide, law!($law, F::Wide), $two>()),)*
                $(..=$one => Ok(what.with::<F::Narrow, law!($law, F::Narrow), $one>()),)*
                modes => Err(EngineError::TooManyModes { modes, most: MODES_MAX }),
            }
        };
    }
    // Wide where it was faster (`cargo bench --bench limits`): DMT's attraction, which never ends, is two
    // quotients that wait for each other; the others have more to gain from leaving the law out.
    match law {
        Law::None => modes!(Nothing: wide, narrow 8 24),
        Law::Hertz => modes!(Hertz: wide 1 2, narrow 3 4 6 8 24),
        Law::Dmt => modes!(Dmt: wide 1 2 3 4, narrow 6 8 24),
        Law::Jkr => modes!(Jkr: wide 1 2, narrow 3 4 6 8 24),
    }
}

/// How packs of a class are made: so many instances each.
pub(super) struct Packs<E> {
    pub width: usize,
    make: Make<E>,
}

/// Packs for a law and a number of modes.
struct NewPacks;

impl<E: Lane<Element = E>> Shape<E> for NewPacks {
    type Output = Packs<E>;

    fn with<L, I, const M: usize>(self) -> Packs<E>
    where
        L: Lane<Element = E> + 'static,
        I: KernelLaw<L> + Send + Sync + 'static,
    {
        Packs { width: L::WIDTH, make: boxed::<E, L, I, M> }
    }
}

impl<E: Lane<Element = E>> Packs<E> {
    /// For a law and a number of modes.
    ///
    /// # Errors
    /// No modes, or more than the kernel can step.
    pub fn of<F: Family<Element = E>>(law: Law, modes: usize) -> Result<Self, EngineError> {
        shaped::<F, _>(law, modes, NewPacks)
    }

    /// The pack whose first member is number `first` of its class, at the run's start or where it was saved.
    pub fn make(
        &self,
        plan: &Plan,
        members: &[Member],
        from: Option<Resume>,
        first: usize,
    ) -> Box<dyn Walk<E>> {
        (self.make)(plan, members, from, first)
    }
}

fn boxed<E, L: Lane<Element = E> + 'static, I: KernelLaw<L> + Send + 'static, const M: usize>(
    plan: &Plan,
    members: &[Member],
    from: Option<Resume>,
    first: usize,
) -> Box<dyn Walk<E>> {
    let track: Track<L, I, M> = match from {
        None => Track::new(members, plan.run.start),
        Some(Resume::Saved(saved, done)) => {
            Track::resumed(members, plan.run.start, &saved[first..first + members.len()], done)
        }
        Some(Resume::Stations(stations, instances)) => {
            let here = instances[first..first + members.len()].iter();
            let saved: Vec<_> = here.map(|i| station::saved(plan, *i, &stations[*i as usize])).collect();
            Track::resumed(members, plan.run.start, &saved, 0)
        }
    };
    Box::new(track)
}
