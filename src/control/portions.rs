//! Many instances, portion by portion.

use super::{Arithmetic, Controlled, PORTION, precision, steps};
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress};
use crate::plan::Plan;
use crate::steady::PeriodicState;

/// [`steps::run`] for `all` the plan's instances, a portion of them at a time.
pub(super) fn run(
    plan: Plan,
    all: &[u32],
    (left_out, chosen): (Vec<f64>, &precision::Choice),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    let count = plan.cases.len();
    let mut whole = Controlled {
        outcome: Outcome { results: vec![Finished::NOT_RUN; count], ends: Vec::new(), notes: Vec::new() },
        estimates: vec![0.0; count],
        left_out: left_out.clone(),
        found: Vec::new(),
        periods: vec![0; count],
        arithmetic: chosen.arithmetic(count),
        plan,
    };
    for portion in all.chunks(PORTION) {
        if progress.stopped() {
            break;
        }
        let part = whole.plan.part(portion);
        let every: Vec<u32> = (0..portion.len() as u32).collect();
        let stepped: Vec<u32> = every.iter().copied().filter(|n| part.cases[*n as usize].steps > 0).collect();
        let left_out = portion.iter().map(|i| left_out[*i as usize]).collect();
        whole.take(portion, steps::run(part, (&every, &stepped), (left_out, chosen), engine, progress)?);
    }
    whole.plan = whole.plan.only(all);
    Ok(whole)
}

impl Controlled {
    /// Takes in what became of a portion.
    fn take(&mut self, portion: &[u32], part: Self) {
        let Arithmetic { of, .. } = part.arithmetic;
        if !part.found.is_empty() && self.found.is_empty() {
            self.found = vec![None; self.plan.cases.len()];
        }
        for (place, found) in portion.iter().zip(part.found) {
            // Nobody goes on from it with other steps.
            let kept =
                |state: Box<PeriodicState>| Box::new(PeriodicState { slope: Box::default(), ..*state });
            self.found[*place as usize] = found.map(kept);
        }
        for (n, place) in portion.iter().enumerate() {
            let i = *place as usize;
            self.plan.cases[i].steps = part.plan.cases[n].steps;
            self.outcome.results[i] = part.outcome.results[n];
            self.estimates[i] = part.estimates[n];
            self.periods[i] = part.periods[n];
            self.arithmetic.of[i] = of[n];
        }
        self.outcome.notes.extend(part.outcome.notes);
    }
}
