//! A run whose instances begin at their neighbours' states, and what these do not lead to.

use super::begin::Begin;
use super::map::apart;
use super::node::{Hint, Lead};
use super::{PeriodicState, Settled, beside, searched};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::plan::{Plan, Precision};

/// Two states that are no farther apart, in free amplitudes, are one.
const SAME: f64 = 1e-3;

/// As [`run`](super::run) with `near`, but that instances with a hint begin where their neighbours lead to, and are
/// searched for where that is no periodic state; where neighbours were searched for in vain, not before they come to rest.
/// What is not found is waited for if `waits` says so; else it is left as not run, and where neighbours were in vain nothing
/// is tried. Which of them began at their neighbours and ended there comes, too.
///
/// # Errors
/// What the engine says.
pub fn from_neighbours(
    plan: &Plan,
    leads: &[Lead],
    (near, waits): (&[Option<&PeriodicState>], bool),
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
    let mut begun = vec![false; plan.len()];
    led.into_iter().for_each(|i| begun[i as usize] = true);
    let rest: Vec<u32> = plan.instances().filter(|i| !begun[*i as usize]).collect();
    let vain = |i: &u32| matches!(leads[*i as usize], Lead::Vain);
    let (mut vain, others): (Vec<u32>, Vec<u32>) = rest.into_iter().partition(vain);
    vain.retain(|_| waits);
    for (some, aside) in [(others, false), (vain, true)] {
        if some.is_empty() {
            continue;
        }
        let near: Vec<Option<&PeriodicState>> = match near.is_empty() {
            true => Vec::new(),
            false => some.iter().map(|i| near[*i as usize]).collect(),
        };
        let begin = if aside { Begin::Aside(&near) } else { Begin::Near(&near) };
        let own: Vec<Lead> = some.iter().map(|i| leads[*i as usize].clone()).collect();
        let rest = searched(&plan.part(&some), begin, (&own, waits), engine, progress)?;
        settled.take(&some, rest);
    }
    Ok((settled, begun))
}

impl Settled {
    /// What a search of its own has not found begins at either of the nearest two on its line: across the end of a branch both
    /// together lead nowhere, and states are like one of the two. What both lead to in different ways is left alone.
    pub(super) fn by_one_of_two(
        &mut self,
        plan: &Plan,
        leads: &[Lead],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let ends = |i: u32| leads.get(i as usize)?.hint().filter(|hint| hint.own.is_none())?.nearest_two();
        let lost = |i: &u32| self.found[*i as usize].is_none() && ends(*i).is_some();
        let instances: Vec<u32> = plan.instances().filter(lost).collect();
        if instances.is_empty() || progress.stopped() {
            return Ok(());
        }
        let part = plan.part(&instances);
        let from = |n: usize| {
            let lead = |i: &u32| ends(*i).map_or(Lead::None, |two| Lead::Hint(Hint::alone(two[n])));
            let leads: Vec<Lead> = instances.iter().map(lead).collect();
            beside::all(&part, &leads, engine, progress)
        };
        let (mut one, mut other) = (from(0)?, from(1)?);
        one.outcome.notes.append(&mut other.outcome.notes);
        for place in 0..instances.len() {
            one.periods[place] += other.periods[place];
            let both = one.found[place].as_ref().zip(other.found[place].as_ref());
            let differ = both.is_some_and(|(one, other)| {
                let amplitude = part.driven(place as u32).free_amplitude().max(1e-15);
                apart(&one.station, &other.station) > SAME * amplitude
            });
            if differ {
                (one.found[place], one.outcome.results[place]) = (None, Finished::NOT_RUN);
            } else if one.found[place].is_none() {
                one.found[place] = other.found[place].take();
                one.outcome.results[place] = other.outcome.results[place];
            }
        }
        self.take(&instances, one);
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
