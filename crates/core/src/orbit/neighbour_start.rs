//! A run whose instances begin at their neighbours' states, and what these do not lead to.

use super::initial_guess::{InitialGuess, Unconverged};
use super::period_map::distance;
use super::stencil::{Stencil, StencilPoint, StencilStart};
use super::verification::search_and_verify;
use super::{OrbitSolution, PeriodicState, quasi_newton, search_or_integrate};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::plan::{Plan, Precision, SectionState};

/// Two states that are no farther apart, in free amplitudes, are one.
const SAME_STATE_TOL: f64 = 1e-3;

/// What becomes of an instance that no neighbour has led to its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFailure {
    /// One search; what that does not find is left as not run.
    Skip,
    /// The same, but that the search is repeated from later places.
    RetryLater,
    /// What searches do not find is integrated to steady state, what is not to be searched for not before it has come to rest.
    Integrate,
}

/// As [`run`](super::solve) with `near`, but that instances with a hint begin where their neighbours lead to, or between these,
/// or where both lead alone; they are searched for where that is no periodic state. Where each neighbour alone may lead to it,
/// that alone is tried. What becomes of those that are not found `patience` says. Which of them began at their neighbours and
/// ended there comes, too.
///
/// # Errors
/// What the engine says.
pub fn solve_from_neighbours(
    plan: &Plan,
    leads: &[StencilStart],
    (near, patience): (&[Option<&PeriodicState>], OnFailure),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(OrbitSolution, Vec<bool>), EngineError> {
    progress.part();
    let mut settled = quasi_newton::correct(plan, leads, engine, progress)?;
    let mut led: Vec<u32> = plan.instances().filter(|i| settled.found[*i as usize].is_some()).collect();
    if plan.precision == Precision::F32 {
        // As told: the states are known in f64, and what is measured of them is in f32.
        let unsure = settled.confirm_by_residual(plan, &led, engine, progress)?;
        unsure.into_iter().for_each(|i| settled.found[i as usize] = None);
        led.retain(|i| settled.found[*i as usize].is_some());
    }
    settled.vote_of_neighbours(
        plan,
        leads,
        (|lead| matches!(lead, StencilStart::EachPoint(_)), 1),
        engine,
        progress,
    )?;
    settled.restart_at_midpoints(plan, leads, engine, progress)?;
    settled.vote_of_neighbours(
        plan,
        leads,
        (|lead| matches!(lead, StencilStart::Stencil(_)), 2),
        engine,
        progress,
    )?;
    let mut begun = vec![false; plan.len()];
    led.into_iter().for_each(|i| begun[i as usize] = true);
    let rest = |of: fn(&StencilStart) -> bool| -> Vec<u32> {
        let open = |i: &u32| !begun[*i as usize] && settled.found[*i as usize].is_none();
        plan.instances().filter(|i| open(i) && of(&leads[*i as usize])).collect()
    };
    let others = rest(|lead| matches!(lead, StencilStart::Stencil(_) | StencilStart::None));
    let waits = patience == OnFailure::Integrate;
    let vain = if waits { rest(|lead| matches!(lead, StencilStart::Skip)) } else { Vec::new() };
    for (some, aside) in [(others, false), (vain, true)] {
        if some.is_empty() {
            continue;
        }
        let near: Vec<Option<&PeriodicState>> = match near.is_empty() {
            true => Vec::new(),
            false => some.iter().map(|i| near[*i as usize]).collect(),
        };
        let begin = match waits {
            true if aside => InitialGuess::StatesOrDefer(&near),
            true => InitialGuess::States(&near),
            false => InitialGuess::StatesOnce(&near),
        };
        let own: Vec<StencilStart> = some.iter().map(|i| leads[*i as usize].clone()).collect();
        let rest = search_or_integrate(&plan.part(&some), begin, (&own, patience), engine, progress)?;
        settled.take(&some, rest);
    }
    Ok((settled, begun))
}

impl OrbitSolution {
    /// What a search of its own has not found begins, where it has `such` a lead, at each neighbour alone: across the end of a
    /// branch several together lead nowhere, and states are like one of them. It is where most of them lead, `least` or more, if a
    /// search that takes the map's own Jacobian there finds that state, too; nowhere if as many lead to another.
    pub(super) fn vote_of_neighbours(
        &mut self,
        plan: &Plan,
        leads: &[StencilStart],
        (such, least): (fn(&StencilStart) -> bool, u32),
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let alone = |i: u32| {
            leads.get(i as usize).filter(|lead| such(lead)).map(StencilStart::alone).unwrap_or_default()
        };
        let lost = |i: &u32| self.found[*i as usize].is_none() && !alone(*i).is_empty();
        let instances: Vec<u32> = plan.instances().filter(lost).collect();
        if instances.is_empty() || progress.stopped() {
            return Ok(());
        }
        let part = plan.part(&instances);
        let each: Vec<Vec<StencilPoint>> = instances.iter().map(|i| alone(*i)).collect();
        // The states that an instance's neighbours lead to, and how many lead to each.
        let mut met: Vec<Vec<(SectionState, u32)>> = vec![Vec::new(); instances.len()];
        let apart = |i: usize, a: &SectionState, b: &SectionState| {
            distance(a, b) > SAME_STATE_TOL * part.driven(i as u32).free_amplitude().max(1e-15)
        };
        for n in 0..each.iter().map(Vec::len).max().unwrap_or(0) {
            let leads: Vec<StencilStart> = each
                .iter()
                .map(|all| all.get(n).map_or(StencilStart::None, |one| Stencil::alone(*one).into()))
                .collect();
            let led = quasi_newton::correct(&part, &leads, engine, progress)?;
            for (i, state) in led.found.iter().enumerate() {
                self.periods[instances[i] as usize] += led.periods[i];
                let Some(there) = state.as_ref().map(|state| state.section) else { continue };
                match met[i].iter_mut().find(|(other, _)| !apart(i, other, &there)) {
                    Some((_, led)) => *led += 1,
                    None => met[i].push((there, 1)),
                }
            }
            self.outcome.notes.extend(led.outcome.notes);
        }
        let place = |i: usize| {
            let most = met[i].iter().map(|(_, led)| *led).max().filter(|most| *most >= least)?;
            let mut all = met[i].iter().filter(|(_, led)| *led == most);
            let (place, _) = all.next()?;
            all.next().is_none().then_some(*place)
        };
        let agreed: Vec<usize> = (0..instances.len()).filter(|i| place(*i).is_some()).collect();
        let numbers: Vec<u32> = agreed.iter().map(|i| instances[*i]).collect();
        let places: Vec<SectionState> = agreed.iter().filter_map(|i| place(*i)).collect();
        let part = plan.part(&numbers);
        let all: Vec<u32> = part.instances().collect();
        let (mut own, _) =
            search_and_verify(&part, &all, InitialGuess::PointsOnly(&places), engine, progress)?;
        for (n, (i, place)) in agreed.into_iter().zip(&places).enumerate() {
            if own.state(n).is_some_and(|state| apart(i, &state.section, place)) {
                (own.found[n], own.outcome.results[n]) = (None, Finished::NOT_RUN);
            }
        }
        self.take(&numbers, own);
        Ok(())
    }

    /// Searches for instances that a brief search has not found from later places.
    pub(super) fn retry_later(
        &mut self,
        plan: &Plan,
        left: Vec<Unconverged>,
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let (numbers, places): (Vec<u32>, Vec<SectionState>) =
            left.into_iter().map(|one| (one.instance, one.section)).unzip();
        if numbers.is_empty() || progress.stopped() {
            return Ok(());
        }
        let part = plan.part(&numbers);
        let all: Vec<u32> = part.instances().collect();
        let (found, _) = search_and_verify(&part, &all, InitialGuess::Retry(&places), engine, progress)?;
        self.take(&numbers, found);
        Ok(())
    }

    /// Takes in another run, of these instances alone.
    pub fn take(&mut self, instances: &[u32], mut other: Self) {
        for (place, i) in instances.iter().map(|i| *i as usize).enumerate() {
            self.outcome.results[i] = other.outcome.results[place];
            self.periods[i] += other.periods[place];
            self.found[i] = other.found.get_mut(place).and_then(Option::take);
        }
        self.outcome.notes.extend(other.outcome.notes);
    }
}
