//! Modes: by a sample of instances with richer levers.

use super::steps::difference;
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::plan::Plan;

/// Most instances of the sample.
const SAMPLE: usize = 64;
/// Levers tried in turn, by the accuracy whose modes they carry relative to the one asked for, and the one
/// that they are held against.
const TRIED: [f64; 3] = [1.0, 0.5, 0.25];
const RICHEST: f64 = 0.1;
/// Share of the accuracy asked for that modes left out may cost.
const SHARE: f64 = 0.7;

/// The plan with the modes it needs, and what those left out cost each instance: the largest difference that
/// they make to its neighbours in the sample.
pub(super) fn choose(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(Plan, Vec<f64>), EngineError> {
    let mut left_out = vec![0.0; plan.cases.len()];
    let accuracy = plan.run.accuracy;
    let richest = |instances: &[u32]| plan.richer(instances, RICHEST * accuracy);
    let same = |a: &Plan, b: &Plan| a.drives.iter().zip(&b.drives).all(|(a, b)| a.kept.modes == b.kept.modes);
    if plan.run.modes.is_some() || same(plan, &richest(&[])) {
        return Ok((plan.clone(), left_out));
    }
    // In the classes' order neighbours are alike.
    let classes = plan.classes.iter().filter(|class| class.steps > 0);
    let order: Vec<u32> = classes.flat_map(|class| class.instances.clone()).collect();
    let every = order.len().div_ceil(SAMPLE);
    let sample: Vec<u32> = order.iter().copied().step_by(every).collect();
    let run = |plan: &Plan| {
        progress.foresee(plan.instance_steps());
        engine.run(plan, progress).map(|outcome| outcome.results)
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
            return Ok((candidate(stepped), left_out));
        }
    }
    // The next finer lever is some three times as good as its neighbour.
    stepped.iter().for_each(|i| left_out[*i as usize] = RICHEST * accuracy);
    Ok((richest(stepped), left_out))
}
