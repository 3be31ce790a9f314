//! A run whose instances begin at their neighbours' states, and what these do not lead to.

use super::begin::Begin;
use super::node::Lead;
use super::{PeriodicState, Settled, beside, searched};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::{Plan, Precision};

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
        let rest = searched(&plan.part(&some), begin, waits, engine, progress)?;
        settled.take(&some, rest);
    }
    Ok((settled, begun))
}

impl Settled {
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
