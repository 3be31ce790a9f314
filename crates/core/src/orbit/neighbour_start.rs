//! Searches that start from the states of neighbours, and the fallbacks where these fail.

use super::initial_guess::{InitialGuess, Unconverged};
use super::period_map::distance;
use super::stencil::{Stencil, StencilPoint, StencilStart};
use super::verification::search_and_verify;
use super::{OrbitSolution, PeriodicState, quasi_newton, search_or_integrate};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::{Plan, Precision, SectionState};

/// Two states within this distance, in free amplitudes, are the same.
const SAME_STATE_TOL: f64 = 1e-3;

/// What happens to an instance whose neighbours have not led to its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFailure {
    /// Searches only: an instance that none finds stays without a state, for a later step of the sweep.
    LeaveUnsolved,
    /// The same, with repeated searches from later states of the motion.
    RetryLater,
    /// What searches do not find settles, is searched for on the way, and is integrated to steady state at last. For
    /// [`StencilStart::Postponed`] the searches begin only on the way, except from harmonic balance.
    SettleThenIntegrate,
}

/// Tries, for an instance with a [`StencilStart::Stencil`]: the interpolated state, the midpoint of its two nearest
/// neighbours, each of them alone, then a search as in [`solve`](super::solve) with `near`. For [`StencilStart::EachPoint`] it
/// tries each neighbour alone and nothing else. `on_failure` says what happens to the rest. Also returns, by instance, whether
/// the interpolated start led to its state.
///
/// # Errors
/// Returns the engine's error.
pub fn solve_from_neighbours(
    plan: &Plan,
    leads: &[StencilStart],
    (near, on_failure): (&[Option<&PeriodicState>], OnFailure),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(OrbitSolution, Vec<bool>), EngineError> {
    progress.part();
    let mut settled = quasi_newton::correct(plan, leads, engine, progress)?;
    let mut led: Vec<u32> = plan.instances().filter(|i| settled.found[*i as usize].is_some()).collect();
    if plan.precision == Precision::F32 {
        // The states are known in f64, but measured in f32 as the plan asks.
        let unsure = settled.confirm_by_residual(plan, &led, engine, progress)?;
        unsure.into_iter().for_each(|i| settled.drop_state(i));
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
    let waits = on_failure == OnFailure::SettleThenIntegrate;
    let vain = if waits { rest(|lead| matches!(lead, StencilStart::Postponed)) } else { Vec::new() };
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
        let rest = search_or_integrate(&plan.part(&some), begin, (&own, on_failure), engine, progress)?;
        settled.take(&some, rest);
    }
    Ok((settled, begun))
}

impl OrbitSolution {
    /// Starts instances that have no state, and `such` a lead, from each neighbour alone: across the end of a branch an
    /// interpolated start fails, but the state resembles one of theirs. The state that most neighbours lead to, `least` or
    /// more and without a tie, counts if a search with the map's own Jacobian there finds it, too.
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
        // By instance: the states that its neighbours lead to, and how many lead to each.
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
                own.drop_state(n as u32);
            }
        }
        self.take(&numbers, own);
        Ok(())
    }

    /// Repeats, from later states of the motion, the searches of instances that the first one has not found.
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

    /// Takes over the results of another run, of these instances alone.
    pub fn take(&mut self, instances: &[u32], mut other: Self) {
        for (place, i) in instances.iter().map(|i| *i as usize).enumerate() {
            self.outcome.results[i] = other.outcome.results[place];
            self.periods[i] += other.periods[place];
            self.found[i] = other.found.get_mut(place).and_then(Option::take);
        }
        self.outcome.notes.extend(other.outcome.notes);
    }
}
