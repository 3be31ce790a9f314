//! The first two runs of every instance, and the estimate from their difference.

use super::difference_scale::{
    is_fast, remaining_error_factor, remaining_step_error, scaled_difference, scaled_differences,
};
use super::energy_balance::{missed_resonances, work_of_steps};
use super::error_parts::ErrorParts;
use super::missed_compliance::{FoundMotion, missed, missed_travel, truncation_error};
use super::orbit_pair::{self, OrbitPair};
use super::precision_trial;
use super::stencils::Stencils;
use super::step_reduction::{half_steps, quarter_steps};
use crate::engine::{Engine, EngineError, Finished, Progress, in_double};
use crate::observe::Status;
use crate::orbit::{self, OrbitSolution, PeriodicState};
use crate::plan::{BasisRule, Plan, Precision, STEPS_MAX};
use rayon::prelude::*;

/// What the first estimate starts from.
pub(super) struct EstimateInputs<'a> {
    /// The bases of the first run. None if they are the plan's own.
    pub poorer: Option<PoorerBasis>,
    /// Truncation error of each instance, from the sample.
    pub left_out: Vec<f64>,
    pub chosen: &'a precision_trial::PrecisionChoice,
    /// Solved instances around these, from which searches may start. If present, later instances may start from these.
    pub around: Option<Stencils<'a>>,
}

/// The next smaller bases.
pub(super) struct PoorerBasis {
    /// One basis for each instance.
    pub bases: Vec<BasisRule>,
    /// The plan of the first run, still with all its steps. An instance keeps its basis here if a separate run estimates its
    /// truncation error.
    plan: Plan,
}

impl PoorerBasis {
    /// Smaller bases for all instances of a plan.
    pub fn of(plan: &Plan, bases: Vec<BasisRule>) -> Self {
        let stepped = plan.stepped().into_iter().map(|i| (i, bases[i as usize]));
        let wanted: Vec<(u32, BasisRule)> =
            stepped.filter(|(i, smaller)| !needs_basis_run(plan, *i, *smaller)).collect();
        Self { plan: plan.with_bases_alone(&wanted), bases }
    }

    /// The smaller bases of some instances.
    pub fn part(&self, instances: &[u32]) -> Self {
        let bases = instances.iter().map(|i| self.bases[*i as usize]).collect();
        Self { bases, plan: self.plan.part(instances) }
    }
}

impl<'a> EstimateInputs<'a> {
    /// Inputs for instances that are searched for one by one, without neighbours.
    pub fn alone(
        poorer: Option<PoorerBasis>,
        left_out: Vec<f64>,
        chosen: &'a precision_trial::PrecisionChoice,
    ) -> Self {
        Self { poorer, left_out, chosen, around: None }
    }
}

/// The result of the first two runs.
pub(super) struct FirstEstimate {
    /// The plan of the second run.
    pub plan: Plan,
    pub settled: OrbitSolution,
    /// Estimate of each instance.
    pub known: Vec<ErrorParts>,
    /// For each instance, whether it started from its neighbours' states. Empty if none did.
    pub neighbour_started: Vec<bool>,
    /// For each instance, the states from which others may start. Empty if none does.
    pub solved: Vec<OrbitPair>,
}

/// Whether the truncation error of a fast contact needs a run of its own:
///
/// - a contact that is not elastic: its steps follow its oscillators, and a poorer basis has slower ones, so that the errors of
///   steps and basis cancel;
/// - very few oscillators: few steps do not show what these lack;
/// - a force that jumps: it excites all oscillators.
fn needs_basis_run(plan: &Plan, i: u32, smaller: BasisRule) -> bool {
    match smaller {
        BasisRule::Contact { count, elastic, .. } => {
            !elastic || count < plan.policy.first_oscillators || plan.law(i).jumps()
        }
        BasisRule::Shares { .. } => false,
    }
}

/// Runs `stepped`, the instances that need steps, with a quarter of the plan's steps, then all with half of them. If the
/// bases differ, the difference contains both errors. If it is too large for a fast contact, a third run tells them apart.
pub(super) fn run(
    plan: &Plan,
    stepped: &[u32],
    EstimateInputs { poorer, left_out, around, .. }: EstimateInputs,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<FirstEstimate, EngineError> {
    let mut fine = half_steps(plan.clone());
    let mut coarse = quarter_steps(match &poorer {
        None => plan.part(stepped),
        Some(poorer) => poorer.plan.part(stepped),
    });
    let (mut rough, mut settled, neighbour_started) =
        coarse_and_fine(&mut coarse, &mut fine, stepped, around.as_ref(), (engine, progress))?;
    let kept = keep_curves(&mut settled, stepped, &rough, progress);
    settled.outcome.notes.splice(0..0, rough.outcome.notes.iter().cloned());
    if !rough.jumps.is_empty() {
        settled.jumps = vec![false; plan.len()];
        stepped.iter().zip(&rough.jumps).for_each(|(i, jump)| settled.jumps[*i as usize] = *jump);
        let near = orbit::scatter(&rough.found, stepped, plan.len());
        settled.outcome.notes.extend(moved(&fine, &settled, &near, engine, progress)?);
        orbit::locate_jumps(&fine, &mut settled.jumps, &settled.found);
    }
    let begin = |(i, of_modes): (u32, f64)| {
        let most_steps = (fine.steps(i) << plan.policy.doublings).min(STEPS_MAX);
        ErrorParts { most_steps, ..ErrorParts::of_modes(of_modes) }
    };
    let known = fine.instances().zip(left_out).map(begin).collect();
    let solved = match around.is_some() {
        true => solved(plan.len(), stepped, (&coarse, &mut rough), (&fine, &settled)),
        false => Vec::new(),
    };
    let mut begun = FirstEstimate { plan: fine, settled, known, neighbour_started, solved };
    let apart =
        scaled_differences(&begun.plan, stepped, &rough.outcome.results, &begun.settled.outcome.results);
    for ((place, rough), apart) in coarse.instances().zip(&rough.outcome.results).zip(apart) {
        let i = stepped[place as usize];
        let same_basis = coarse.driven(place).kept.modes == begun.plan.driven(i).kept.modes;
        let of_both = rough.status == Status::Ok && !same_basis;
        let left = remaining(&begun.plan, i, of_both, coarse.steps(place));
        // A first run that was cut short gives no estimate.
        let told =
            rough.status != Status::NotRun || begun.settled.outcome.results[i as usize].status != Status::Ok;
        let known = &mut begun.known[i as usize];
        known.of_steps = if told { left * apart } else { f64::INFINITY };
        known.unsplit = of_both.then_some(apart);
    }
    kept.into_iter().for_each(|i| begun.known[i as usize].of_steps = f64::NAN);
    begun.add_measured(stepped);
    if let Some(PoorerBasis { bases, .. }) = &poorer {
        begun.tell_fast_bases(plan, stepped, bases, (engine, progress))?;
        begun.split_fast(plan, stepped, &rough.outcome.results, (engine, progress))?;
    }
    Ok(begun)
}

/// Share of the difference between the first two runs that remains in the second one's error.
fn remaining(plan: &Plan, i: u32, of_both: bool, coarser: u32) -> f64 {
    if of_both { remaining_error_factor(plan, i) } else { remaining_step_error(plan, i, coarser) }
}

/// Runs `stepped` with the coarse plan, then all instances with the fine plan. The last result says which instances started
/// from their neighbours' states.
fn coarse_and_fine(
    coarse: &mut Plan,
    fine: &mut Plan,
    stepped: &[u32],
    around: Option<&Stencils>,
    (engine, progress): (&dyn Engine, &Progress),
) -> Result<(OrbitSolution, OrbitSolution, Vec<bool>), EngineError> {
    let Some(around) = around else {
        let rough = orbit::solve_first(coarse, engine, progress)?;
        let near = orbit::scatter(&rough.found, stepped, fine.len());
        fine.take_gaps(stepped, coarse);
        let settled = orbit::solve_again(fine, &near, engine, progress)?;
        return Ok((rough, settled, Vec::new()));
    };
    // Time integration belongs to the second run. Only an instance that settles there gets its first run afterwards.
    let (leads, patience) = (around.first_run(stepped), around.on_failure());
    let (mut rough, _) = orbit::solve_from_neighbours(coarse, &leads, (&[], patience[0]), engine, progress)?;
    let near = orbit::scatter(&rough.found, stepped, fine.len());
    let leads = around.second_run(&near);
    let (settled, mut begun) =
        orbit::solve_from_neighbours(fine, &leads, (&near, patience[1]), engine, progress)?;
    if around.all_start_from_neighbours() {
        begun = settled.found.iter().map(Option::is_some).collect();
    }
    let settles = |place: &u32| {
        let fine = &settled.outcome.results[stepped[*place as usize] as usize];
        rough.outcome.results[*place as usize].status == Status::NotRun && fine.status.is_steady()
    };
    let late: Vec<u32> = coarse.instances().filter(settles).collect();
    if !late.is_empty() && !progress.stopped() {
        let numbers: Vec<u32> = late.iter().map(|place| stepped[*place as usize]).collect();
        let near = orbit::gather(&settled.found, &numbers);
        rough.take(&late, orbit::solve(&coarse.part(&late), &near, engine, progress)?);
    }
    Ok((rough, settled, begun))
}

/// The states from which others may start, for each of `count` instances, from both runs.
fn solved(
    count: usize,
    stepped: &[u32],
    (coarse, rough): (&Plan, &mut OrbitSolution),
    (fine, settled): (&Plan, &OrbitSolution),
) -> Vec<OrbitPair> {
    let mut all = vec![OrbitPair::Unknown; count];
    for (place, i) in coarse.instances().zip(stepped) {
        let (p, n) = (place as usize, *i as usize);
        all[n] = orbit_pair::orbit_pairs(
            (coarse, place, &rough.outcome.results[p], rough.found.get_mut(p).and_then(Option::take)),
            (fine, *i, &settled.outcome.results[n], settled.state(n)),
        );
    }
    all
}

/// A message about jumps that another number of steps puts at another point.
fn moved(
    fine: &Plan,
    settled: &OrbitSolution,
    before: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Option<String>, EngineError> {
    let all = settled.jumps.iter().filter(|jump| **jump).count();
    if all == 0 || progress.stopped() {
        return Ok(None);
    }
    let double = in_double(engine);
    let plan = fine.clone().in_precision(Precision::F64);
    let moved = orbit::jumps_moved(&plan, &settled.jumps, (before, &settled.found), double, progress)?;
    Ok((moved > 0).then(|| {
        format!(
            "with other numbers of steps {moved} of {all} jumps stand at another point: finer [run] accuracy tells where"
        )
    }))
}

/// Keeps the points that the first run reached, with status not_run, if curves were stopped before their second run. Returns
/// their instances.
fn keep_curves(
    settled: &mut OrbitSolution,
    stepped: &[u32],
    rough: &OrbitSolution,
    progress: &Progress,
) -> Vec<u32> {
    let mut kept = Vec::new();
    if rough.jumps.is_empty() || !progress.stopped() {
        return kept;
    }
    for (i, first) in stepped.iter().zip(&rough.outcome.results) {
        let result = &mut settled.outcome.results[*i as usize];
        if !result.measured.is_any() && first.measured.is_any() {
            *result = Finished { status: Status::NotRun, ..*first };
            kept.push(*i);
        }
    }
    kept
}

impl FirstEstimate {
    /// Adds the errors that the measurements of the second run tell: of travel that no oscillator makes, of contacts shorter than
    /// planned, of resonant modes left out, of work that steps do.
    fn add_measured(&mut self, stepped: &[u32]) {
        let of = |i: &u32| {
            let plan = &self.plan;
            let found = FoundMotion::of_run(&self.settled, *i);
            (
                missed_travel(plan, *i, found),
                missed(plan, *i, found.measured),
                missed_resonances(plan, *i, found),
                work_of_steps(plan, *i, found.measured),
            )
        };
        let all: Vec<(f64, f64, f64, f64)> = stepped.par_iter().map(of).collect();
        for (i, (of_travel, missed, of_resonances, of_work)) in stepped.iter().zip(all) {
            let known = &mut self.known[*i as usize];
            known.of_modes = (known.of_modes + of_travel).max(missed);
            known.of_resonances = of_resonances;
            // Without a first run it stays unknown.
            if of_work > known.of_steps {
                known.of_steps = of_work;
            }
        }
    }

    /// Results of another run of these instances by `plan`, which starts from their states.
    fn third_run(
        &self,
        mut plan: Plan,
        instances: &[u32],
        (engine, progress): (&dyn Engine, &Progress),
    ) -> Result<Vec<Finished>, EngineError> {
        let near = orbit::gather(&self.settled.found, instances);
        Ok(orbit::solve_again(&mut plan, &near, engine, progress)?.outcome.results)
    }

    /// Runs fast contacts whose first difference is too large again, with the bases of the second run and the steps of the first
    /// (`rough`). That splits the difference into steps and bases.
    fn split_fast(
        &mut self,
        plan: &Plan,
        stepped: &[u32],
        rough: &[Finished],
        with: (&dyn Engine, &Progress),
    ) -> Result<(), EngineError> {
        let aim = plan.policy.aim * plan.run.accuracy;
        let open = |(_, i): &(&Finished, u32)| {
            let known = &self.known[*i as usize];
            known.unsplit.is_some() && is_fast(plan, *i) && known.error() > aim
        };
        let (rough, fast): (Vec<&Finished>, Vec<u32>) =
            rough.iter().zip(stepped.iter().copied()).filter(open).unzip();
        if fast.is_empty() || with.1.stopped() {
            return Ok(());
        }
        let coarse = quarter_steps(plan.part(&fast));
        let steps: Vec<u32> = coarse.instances().map(|place| coarse.steps(place)).collect();
        let third = self.third_run(coarse, &fast, with)?;
        for (((i, rough), third), steps) in fast.into_iter().zip(rough).zip(&third).zip(steps) {
            // A run without a result tells nothing.
            if third.status != Status::Ok {
                continue;
            }
            let (plan, fine, known) =
                (&self.plan, &self.settled.outcome.results[i as usize], &mut self.known[i as usize]);
            let of_bases = scaled_difference(plan, i, rough, third);
            known.of_modes = truncation_error(plan, i, of_bases, FoundMotion::of_run(&self.settled, i));
            let of_steps = remaining_step_error(plan, i, steps) * scaled_difference(plan, i, third, fine);
            known.of_steps = of_steps.max(work_of_steps(plan, i, &fine.measured));
            known.unsplit = None;
        }
        Ok(())
    }

    /// Runs fast contacts again with smaller bases and the same steps, if the first difference says nothing of their bases or the
    /// first run failed: the difference is their truncation error.
    fn tell_fast_bases(
        &mut self,
        plan: &Plan,
        stepped: &[u32],
        bases: &[BasisRule],
        with: (&dyn Engine, &Progress),
    ) -> Result<(), EngineError> {
        let results = &self.settled.outcome.results;
        let poorer = |i: &u32| {
            let ok = results[*i as usize].status == Status::Ok;
            let untold =
                self.known[*i as usize].unsplit.is_none() && bases[*i as usize] != plan.basis_rule(*i);
            ok && is_fast(plan, *i) && untold
        };
        let fast: Vec<u32> = stepped.iter().copied().filter(poorer).collect();
        if fast.is_empty() {
            return Ok(());
        }
        let wanted: Vec<(u32, BasisRule)> = fast.iter().map(|i| (*i, bases[*i as usize])).collect();
        let few = self.plan.with_bases_alone(&wanted).part(&fast);
        let poor = self.third_run(few, &fast, with)?;
        let apart = scaled_differences(&self.plan, &fast, &poor, results);
        for (i, apart) in fast.into_iter().zip(apart) {
            let found = FoundMotion::of_run(&self.settled, i);
            // A run that was cut short gives no estimate.
            self.known[i as usize].of_modes = match with.1.stopped() {
                true => f64::INFINITY,
                false => truncation_error(&self.plan, i, apart, found),
            };
        }
        Ok(())
    }
}
