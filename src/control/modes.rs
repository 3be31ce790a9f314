//! Modes: by a sample of instances with richer levers.

use super::steps::difference;
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::plan::Plan;
use crate::steady;

/// Most instances of the sample.
const SAMPLE: usize = 64;
/// Levers tried in turn, by the accuracy whose modes they carry relative to the one asked for, and the one
/// that they are held against.
const TRIED: [f64; 3] = [1.0, 0.5, 0.25];
const RICHEST: f64 = 0.1;
/// Share of the accuracy asked for that modes left out may cost.
const SHARE: f64 = 0.7;

/// The plan with the modes it needs.
pub(super) struct Choice {
    pub plan: Plan,
    /// What the modes left out cost each instance: the largest difference that they make to its neighbours in
    /// the sample.
    pub left_out: Vec<f64>,
    /// What the engine had to say of the sample's runs.
    pub notes: Vec<String>,
}

/// Tries levers on a sample of `stepped`, the plan's instances that need steps.
pub(super) fn choose(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Choice, EngineError> {
    let (mut left_out, mut notes) = (vec![0.0; plan.cases.len()], Vec::new());
    let accuracy = plan.run.accuracy;
    let richest = |instances: &[u32]| plan.richer(instances, RICHEST * accuracy);
    let same = |a: &Plan, b: &Plan| a.drives.iter().zip(&b.drives).all(|(a, b)| a.kept.modes == b.kept.modes);
    if plan.run.modes.is_some() || same(plan, &richest(&[])) {
        return Ok(Choice { plan: plan.clone(), left_out, notes });
    }
    // In the classes' order neighbours are alike.
    let classes = plan.classes.iter().filter(|class| class.steps > 0);
    let order: Vec<u32> = classes.flat_map(|class| class.instances.clone()).collect();
    let every = order.len().div_ceil(SAMPLE);
    let sample: Vec<u32> = order.iter().copied().step_by(every).collect();
    let mut run = |plan: &Plan| {
        let outcome = steady::run(plan, &[], engine, progress)?.outcome;
        notes.extend(outcome.notes);
        Ok::<_, EngineError>(outcome.results)
    };
    let truths = run(&richest(&sample))?;
    for factor in TRIED {
        let candidate = |instances: &[u32]| match factor {
            1.0 => plan.only(instances),
            _ => plan.richer(instances, factor * accuracy),
        };
        let results = run(&candidate(&sample))?;
        let differences: Vec<f64> = sample
            .iter()
            .map(|&i| {
                let (a, b) = (&results[i as usize], &truths[i as usize]);
                // What does not repeat has no difference to speak of.
                let ok = a.status == Status::Ok && b.status == Status::Ok;
                if ok { difference(plan, i as usize, a, b) } else { 0.0 }
            })
            .collect();
        if differences.iter().all(|difference| *difference <= SHARE * accuracy) {
            for (place, &i) in order.iter().enumerate() {
                let at = place / every;
                let near = [differences.get(at), differences.get(at + 1)];
                left_out[i as usize] = near.into_iter().flatten().copied().fold(0.0, f64::max);
            }
            return Ok(Choice { plan: candidate(stepped), left_out, notes });
        }
    }
    // The next finer lever is some three times as good as its neighbour.
    stepped.iter().for_each(|i| left_out[*i as usize] = RICHEST * accuracy);
    Ok(Choice { plan: richest(stepped), left_out, notes })
}
