//! A run whose instances begin at their neighbours' states, and what these do not lead to.

use super::begin::{Begin, Left};
use super::found::found;
use super::map::apart;
use super::node::{Hint, Lead, Neighbour};
use super::{PeriodicState, Settled, beside, searched};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::plan::{Plan, Precision, Station};

/// Two states that are no farther apart, in free amplitudes, are one.
const SAME: f64 = 1e-3;

/// What becomes of an instance that no neighbour has led to its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// One search; what that does not find is left as not run.
    One,
    /// The same, but that the search is repeated from later places.
    Later,
    /// What searches do not find is waited for, what is not to be searched for not before it has come to rest.
    Waits,
}

/// As [`run`](super::run) with `near`, but that instances with a hint begin where their neighbours lead to, or between these,
/// or where both lead alone; they are searched for where that is no periodic state. Where each neighbour alone may lead to it,
/// that alone is tried. What becomes of those that are not found `patience` says. Which of them began at their neighbours and
/// ended there comes, too.
///
/// # Errors
/// What the engine says.
pub fn from_neighbours(
    plan: &Plan,
    leads: &[Lead],
    (near, patience): (&[Option<&PeriodicState>], Patience),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(Settled, Vec<bool>), EngineError> {
    progress.part();
    let mut settled = beside::all(plan, leads, engine, progress)?;
    let mut led: Vec<u32> = plan.instances().filter(|i| settled.found[*i as usize].is_some()).collect();
    if plan.precision == Precision::F32 {
        // As told: the states are known in f64, and what is measured of them is in f32.
        let unsure = settled.borne_out(plan, &led, engine, progress)?;
        unsure.into_iter().for_each(|i| settled.found[i as usize] = None);
        led.retain(|i| settled.found[*i as usize].is_some());
    }
    settled.by_each(plan, leads, (|lead| matches!(lead, Lead::Each(_)), 1), engine, progress)?;
    settled.between(plan, leads, engine, progress)?;
    settled.by_each(plan, leads, (|lead| matches!(lead, Lead::Hint(_)), 2), engine, progress)?;
    let mut begun = vec![false; plan.len()];
    led.into_iter().for_each(|i| begun[i as usize] = true);
    let rest = |of: fn(&Lead) -> bool| -> Vec<u32> {
        let open = |i: &u32| !begun[*i as usize] && settled.found[*i as usize].is_none();
        plan.instances().filter(|i| open(i) && of(&leads[*i as usize])).collect()
    };
    let others = rest(|lead| matches!(lead, Lead::Hint(_) | Lead::None));
    let waits = patience == Patience::Waits;
    let vain = if waits { rest(|lead| matches!(lead, Lead::Vain)) } else { Vec::new() };
    for (some, aside) in [(others, false), (vain, true)] {
        if some.is_empty() {
            continue;
        }
        let near: Vec<Option<&PeriodicState>> = match near.is_empty() {
            true => Vec::new(),
            false => some.iter().map(|i| near[*i as usize]).collect(),
        };
        let begin = match waits {
            true if aside => Begin::Aside(&near),
            true => Begin::Near(&near),
            false => Begin::Brief(&near),
        };
        let own: Vec<Lead> = some.iter().map(|i| leads[*i as usize].clone()).collect();
        let rest = searched(&plan.part(&some), begin, (&own, patience), engine, progress)?;
        settled.take(&some, rest);
    }
    Ok((settled, begun))
}

impl Settled {
    /// What a search of its own has not found begins, where it has `such` a lead, at each neighbour alone: across the end of a
    /// branch several together lead nowhere, and states are like one of them. It is where most of them lead, `least` or more, if a
    /// search that takes the map's own slope there finds that state, too; nowhere if as many lead to another.
    pub(super) fn by_each(
        &mut self,
        plan: &Plan,
        leads: &[Lead],
        (such, least): (fn(&Lead) -> bool, u32),
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let alone =
            |i: u32| leads.get(i as usize).filter(|lead| such(lead)).map(Lead::alone).unwrap_or_default();
        let lost = |i: &u32| self.found[*i as usize].is_none() && !alone(*i).is_empty();
        let instances: Vec<u32> = plan.instances().filter(lost).collect();
        if instances.is_empty() || progress.stopped() {
            return Ok(());
        }
        let part = plan.part(&instances);
        let each: Vec<Vec<Neighbour>> = instances.iter().map(|i| alone(*i)).collect();
        // The states that an instance's neighbours lead to, and how many lead to each.
        let mut met: Vec<Vec<(Station, u32)>> = vec![Vec::new(); instances.len()];
        let apart = |i: usize, a: &Station, b: &Station| {
            apart(a, b) > SAME * part.driven(i as u32).free_amplitude().max(1e-15)
        };
        for n in 0..each.iter().map(Vec::len).max().unwrap_or(0) {
            let leads: Vec<Lead> = each
                .iter()
                .map(|all| all.get(n).map_or(Lead::None, |one| Hint::alone(*one).into()))
                .collect();
            let led = beside::all(&part, &leads, engine, progress)?;
            for (i, state) in led.found.iter().enumerate() {
                self.periods[instances[i] as usize] += led.periods[i];
                let Some(there) = state.as_ref().map(|state| state.station) else { continue };
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
        let places: Vec<Station> = agreed.iter().filter_map(|i| place(*i)).collect();
        let part = plan.part(&numbers);
        let all: Vec<u32> = part.instances().collect();
        let (mut own, _) = found(&part, &all, Begin::NextTo(&places), engine, progress)?;
        for (n, (i, place)) in agreed.into_iter().zip(&places).enumerate() {
            if own.state(n).is_some_and(|state| apart(i, &state.station, place)) {
                (own.found[n], own.outcome.results[n]) = (None, Finished::NOT_RUN);
            }
        }
        self.take(&numbers, own);
        Ok(())
    }

    /// Searches for instances that a brief search has not found from later places.
    pub(super) fn search_on(
        &mut self,
        plan: &Plan,
        left: Vec<Left>,
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let (numbers, places): (Vec<u32>, Vec<Station>) =
            left.into_iter().map(|one| (one.instance, one.place)).unzip();
        if numbers.is_empty() || progress.stopped() {
            return Ok(());
        }
        let part = plan.part(&numbers);
        let all: Vec<u32> = part.instances().collect();
        let (found, _) = found(&part, &all, Begin::Later(&places), engine, progress)?;
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
