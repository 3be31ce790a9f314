//! Continuation to a set-point: the sample moves nearer from far away until the state passes the set-point, as under a slow
//! feedback. Many instances go side by side, each with its own steps.

use super::continuation::{self, branch_end, settled_states};
use super::initial_guess::{CurvePrediction, InitialGuess};
use super::search_batch::{self, BatchSolution};
use super::setpoint_branch::{
    BranchPoint, SETPOINT_OVERSHOOT, SetPointBranch, free_gap, interpolated_point, seeds,
};
use super::setpoint_residual::setpoint_residual;
use super::{PeriodicState, period_map};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::plan::{Plan, Precision, SectionState, StartState};
use crate::scene::ForceBranch;

/// First and shortest step, in free amplitudes. The branch has ended if even the shortest step fails.
const DS_FIRST_AMPLITUDES: f64 = 0.02;
const DS_MIN_AMPLITUDES: f64 = 2e-3;
/// Longest step, as a share of the gap or of the free amplitude.
const DS_MAX_SHARE: f64 = 0.25;
/// Evaluations and new Jacobians that the search of one step may take.
const MAX_EVALUATIONS_AND_JACOBIANS: (u32, u32) = (12, 3);
/// Growth of the step after one that took at most so many periods and Jacobians; a costlier step shrinks.
const DS_GROWTH: [(u32, u32, f64); 3] = [(6, 0, 2.0), (7, 1, 1.4), (12, 1, 1.0)];
const DS_SHRINK_COSTLY: f64 = 0.6;
/// Growth after a step with a close stability check, and shrinkage after a failed one.
const DS_GROWTH_AFTER_CARE: f64 = 1.4;
const DS_SHRINK_FAILED: f64 = 0.25;
/// Steps of an instance, and jumps between branches. A feedback that jumps more often goes in circles.
const MAX_STEPS: u32 = 1000;
const MAX_JUMPS: u32 = 4;
/// Largest depth below the surface, in free amplitudes, if the scene gives none.
pub(super) const MAX_DEPTH_AMPLITUDES: f64 = 100.0;

/// The end of an approach.
pub(super) enum ApproachEnd {
    /// Approximate gap of the set-point, m, and a state near it.
    Met(f64, Box<PeriodicState>),
    /// No gap holds it.
    None,
    /// Stopped before the end.
    NotRun,
}

/// Results of approaches, by instance.
pub(super) struct SetPointApproach {
    pub ends: Vec<ApproachEnd>,
    /// Instances that reached the largest depth without meeting their set-points, and their residuals there.
    pub too_deep: Vec<(u32, f64)>,
    pub periods: Vec<u32>,
    pub notes: Vec<String>,
}

/// Approaches the set-points of all instances of the plan, on an engine that computes in f64.
pub(super) fn approach_setpoints(
    plan: &Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<SetPointApproach, EngineError> {
    let count = plan.len();
    let done = SetPointApproach {
        ends: (0..count).map(|_| ApproachEnd::NotRun).collect(),
        too_deep: Vec::new(),
        periods: vec![0; count],
        notes: Vec::new(),
    };
    let mut all = SetPointContinuation {
        plan: plan.clone().in_precision(Precision::F64),
        engine,
        progress,
        done,
        astray: Vec::new(),
    };
    progress.task("approaching set-points", count as u64);
    let mut left = all.start_free()?;
    while !left.is_empty() && !progress.stopped() {
        left = all.stride(left)?;
        if left.is_empty() {
            left = all.on_the_branches()?;
        }
    }
    Ok(all.done)
}

/// The continuation of all instances.
struct SetPointContinuation<'a> {
    plan: Plan,
    engine: &'a dyn Engine,
    progress: &'a Progress,
    done: SetPointApproach,
    /// Instances that did not meet the requested branch.
    astray: Vec<SetPointBranch>,
}

impl SetPointContinuation<'_> {
    /// Starts all instances far from the sample, at the state that the free oscillation settles to.
    fn start_free(&mut self) -> Result<Vec<SetPointBranch>, EngineError> {
        let stepped = self.plan.stepped();
        let free: Vec<u32> = self.plan.instances().filter(|i| self.plan.steps(*i) == 0).collect();
        free.into_iter().for_each(|i| self.end(i, ApproachEnd::None));
        let starts = |i: &u32| (*i, free_gap(&self.plan, *i), continuation::free_orbit(&self.plan, *i));
        let starts: Vec<(u32, f64, PeriodicState)> = stepped.iter().map(starts).collect();
        let measure_points = self.settle(&starts)?;
        let mut begun = Vec::new();
        for ((instance, ..), place) in starts.into_iter().zip(measure_points) {
            let amplitude = self.plan.driven(instance).free_amplitude();
            match (place, self.plan.setpoint(instance)) {
                (Some(last), Some(setpoint)) => begun.push(SetPointBranch {
                    instance,
                    setpoint,
                    last,
                    before: None,
                    step: DS_FIRST_AMPLITUDES * amplitude,
                    steps: 0,
                    jumps: 0,
                    other: None,
                    set: false,
                    careful: false,
                    unsure: false,
                }),
                _ if self.progress.stopped() => {}
                _ => self.end(instance, ApproachEnd::None),
            }
        }
        Ok(begun)
    }

    /// One step of each instance. Returns those that continue.
    fn stride(&mut self, mut going: Vec<SetPointBranch>) -> Result<Vec<SetPointBranch>, EngineError> {
        let gaps: Vec<f64> = going.iter().map(SetPointBranch::next_gap).collect();
        let instances: Vec<u32> = going.iter().map(|one| one.instance).collect();
        let part = self.plan.part(&instances).with_gaps(&gaps);
        let places: Vec<SectionState> = (0..).zip(&going).map(|(i, one)| one.predicted(&part, i)).collect();
        let states: Vec<Option<&PeriodicState>> = going.iter().map(|one| Some(&one.last.state)).collect();
        let lightly: Vec<bool> = going.iter().map(|one| !one.careful).collect();
        let begin = InitialGuess::CurvePoints(CurvePrediction {
            states: &states,
            places: &places,
            max_evaluations: MAX_EVALUATIONS_AND_JACOBIANS,
            accept_unverified: &lightly,
        });
        let BatchSolution { mut found, periods, notes, .. } =
            search_batch::solve_batches(&part, &part.by_class(), begin, self.engine, self.progress)?;
        self.done.notes.extend(notes);
        for ((i, one), predicted) in (0..).zip(&mut going).zip(&places) {
            self.done.periods[one.instance as usize] += periods[i as usize];
            let follows = |found: &PeriodicState| one.is_followed_by(&part, i, found, predicted);
            let mut state = found[i as usize].take().filter(|found| follows(found));
            one.unsure = false;
            if let Some(met) = state.as_mut().filter(|_| !one.careful) {
                // A multiplier from an updated Jacobian that is not below 1 needs a close check.
                one.unsure = met.floquet.multiplier.is_nan() || met.floquet.multiplier >= 1.0;
                met.floquet = PeriodicState::unknown(met.steps, &met.basis).floquet;
            }
            found[i as usize] = state.filter(|_| !one.unsure);
        }
        let reached = self.places(&part, found)?;
        let (mut left_over, mut ended) = (Vec::new(), Vec::new());
        for ((mut one, place), i) in going.into_iter().zip(reached).zip(0..) {
            one.steps += 1;
            let shortest = DS_MIN_AMPLITUDES * part.driven(i).free_amplitude();
            match place {
                Some(place) => left_over.extend(self.accept(one, place, periods[i as usize])),
                None if one.unsure || one.step > shortest => {
                    let share = if one.unsure { 1.0 } else { DS_SHRINK_FAILED };
                    one.step = (share * one.step).max(shortest);
                    one.careful = true;
                    left_over.push(one);
                }
                None => ended.push(one),
            }
        }
        left_over.extend(self.jump(ended)?);
        Ok(left_over)
    }

    /// Takes instances whose branch has ended to the states they settle to, by search or by integration.
    fn jump(&mut self, ended: Vec<SetPointBranch>) -> Result<Vec<SetPointBranch>, EngineError> {
        let start = |one: &SetPointBranch| (one.instance, one.next_gap(), branch_end(one.last.state.clone()));
        let starts: Vec<_> = ended.iter().map(start).collect();
        let mut going = Vec::new();
        for (mut one, place) in ended.into_iter().zip(self.settle(&starts)?) {
            let jumped = place.as_ref().is_some_and(|place| !one.is_near(&self.plan, &place.state));
            one.jumps += u32::from(jumped);
            match place.filter(|_| one.jumps <= MAX_JUMPS && one.steps < MAX_STEPS) {
                None if self.progress.stopped() => {}
                // The branch continues although no search finds it here, and it has passed the set-point.
                Some(place) if !jumped && one.last.miss * place.miss <= 0.0 => {
                    going.extend(self.accept(one, place, 0));
                }
                Some(last) => {
                    one.step = DS_FIRST_AMPLITUDES * self.plan.driven(one.instance).free_amplitude();
                    (one.last, one.before) = (last, None);
                    going.push(one);
                }
                None => self.end_or_retry(one),
            }
        }
        Ok(going)
    }

    /// Restarts instances that went astray on the requested branch, wherever its closed form leads to a state.
    fn on_the_branches(&mut self) -> Result<Vec<SetPointBranch>, EngineError> {
        let mut left = std::mem::take(&mut self.astray);
        let mut going = Vec::new();
        for (share, away) in seeds() {
            if left.is_empty() || self.progress.stopped() {
                break;
            }
            let seeds: Vec<(f64, SectionState)> =
                left.iter().map(|one| one.seed(&self.plan, share, away)).collect();
            let instances: Vec<u32> = left.iter().map(|one| one.instance).collect();
            let gaps: Vec<f64> = seeds.iter().map(|(gap, _)| *gap).collect();
            let stations: Vec<SectionState> = seeds.into_iter().map(|(_, station)| station).collect();
            let part = self.plan.part(&instances).with_gaps(&gaps);
            let begin = InitialGuess::Points(&stations);
            let BatchSolution { found, periods, notes, .. } =
                search_batch::solve_batches(&part, &part.by_class(), begin, self.engine, self.progress)?;
            self.done.notes.extend(notes);
            instances.iter().zip(periods).for_each(|(i, some)| self.done.periods[*i as usize] += some);
            let places = self.places(&part, found)?;
            let mut rest = Vec::new();
            for (mut one, place) in left.into_iter().zip(places) {
                match place.filter(|place| place.branch == one.setpoint.branch) {
                    Some(last) => {
                        one.step = DS_FIRST_AMPLITUDES * self.plan.driven(one.instance).free_amplitude();
                        (one.last, one.before, one.steps, one.jumps) = (last, None, 0, MAX_JUMPS);
                        going.push(one);
                    }
                    None => rest.push(one),
                }
            }
            left = rest;
        }
        if !self.progress.stopped() {
            left.into_iter().for_each(|one| self.end_or_retry(one));
        }
        Ok(going)
    }

    /// Takes a step to `place` in `periods` periods: ends the approach past the set-point, else chooses the next step.
    fn accept(
        &mut self,
        mut one: SetPointBranch,
        place: BranchPoint,
        periods: u32,
    ) -> Option<SetPointBranch> {
        let amplitude = self.plan.driven(one.instance).free_amplitude();
        if one.last.miss * place.miss <= 0.0 {
            let met = interpolated_point(&one.last, &place);
            if one.setpoint.branch.is_none_or(|branch| place.branch == Some(branch)) {
                self.end(one.instance, ApproachEnd::Met(met.0, Box::new(met.1)));
            } else {
                one.other = one.other.or(Some(met));
                self.end_or_retry(one);
            }
            return None;
        }
        let slope = 2 * self.plan.pairs(one.instance) as u32;
        let quick = |(most, slopes, _): &&(u32, u32, f64)| periods <= most + slopes * slope;
        let quick = DS_GROWTH.iter().find(quick).map_or(DS_SHRINK_COSTLY, |(.., next)| *next);
        let next = if one.careful { DS_GROWTH_AFTER_CARE } else { quick };
        let shortest = DS_MIN_AMPLITUDES * amplitude;
        one.careful = false;
        one.step = (next * one.step).clamp(shortest, DS_MAX_SHARE * amplitude.max(place.gap.abs()));
        let before = std::mem::replace(&mut one.last, place);
        let slope = (one.last.miss - before.miss) / (one.last.gap - before.gap);
        if slope > 0.0 {
            one.step = one.step.min((SETPOINT_OVERSHOOT * one.last.miss.abs() / slope).max(shortest));
        }
        one.before = Some(before);
        // The sample pushes a soft lever down, so gaps may become negative.
        let surface = self.plan.case(one.instance).gap.min(0.0);
        let lowest = surface - one.setpoint.deepest.unwrap_or(MAX_DEPTH_AMPLITUDES * amplitude);
        let highest = free_gap(&self.plan, one.instance) + amplitude;
        if (lowest..=highest).contains(&one.last.gap) && one.steps < MAX_STEPS {
            return Some(one);
        }
        if one.last.gap < lowest {
            self.done.too_deep.push((one.instance, one.last.miss));
        }
        self.end_or_retry(one);
        None
    }

    /// Ends a failed approach. One that asks for a branch is tried once more on that branch; else another branch is better than
    /// none.
    fn end_or_retry(&mut self, one: SetPointBranch) {
        if one.setpoint.branch.is_some() && !one.set {
            self.astray.push(SetPointBranch { set: true, ..one });
            return;
        }
        let end = one.other.map_or(ApproachEnd::None, |(gap, state)| ApproachEnd::Met(gap, Box::new(state)));
        self.end(one.instance, end);
    }

    fn end(&mut self, instance: u32, end: ApproachEnd) {
        self.done.ends[instance as usize] = end;
        self.progress.done(1);
    }

    /// The states to which these instances settle, at these gaps, from these states.
    fn settle(
        &mut self,
        starts: &[(u32, f64, PeriodicState)],
    ) -> Result<Vec<Option<BranchPoint>>, EngineError> {
        if starts.is_empty() || self.progress.stopped() {
            return Ok(vec![None; starts.len()]);
        }
        let instances: Vec<u32> = starts.iter().map(|(i, ..)| *i).collect();
        let gaps: Vec<f64> = starts.iter().map(|(_, gap, _)| *gap).collect();
        let part = self.plan.part(&instances).with_gaps(&gaps);
        let from: Vec<&PeriodicState> = starts.iter().map(|(.., state)| state).collect();
        let BatchSolution { found, periods, notes, .. } =
            settled_states(&part, &from, self.engine, self.progress)?;
        self.done.notes.extend(notes);
        instances.iter().zip(periods).for_each(|(i, some)| self.done.periods[*i as usize] += some);
        self.places(&part, found)
    }

    /// The residuals and branches of the states found of `part`.
    fn places(
        &mut self,
        part: &Plan,
        found: Vec<Option<Box<PeriodicState>>>,
    ) -> Result<Vec<Option<BranchPoint>>, EngineError> {
        let known: Vec<u32> = part.instances().filter(|i| found[*i as usize].is_some()).collect();
        let results = measured(part, &known, &found, self.engine, self.progress)?;
        let mut places = vec![None; part.len()];
        for (i, result) in known.into_iter().zip(results) {
            let Some(state) = &found[i as usize] else { continue };
            let miss = setpoint_residual(part, i, &result);
            let force = result.measured.force_mean;
            let branch = match force {
                force if force < 0.0 => Some(ForceBranch::Attractive),
                force if force > 0.0 => Some(ForceBranch::Repulsive),
                _ => None,
            };
            let place = BranchPoint { gap: part.case(i).gap, state: (**state).clone(), miss, branch };
            places[i as usize] = Some(place).filter(|_| miss.is_finite());
        }
        Ok(places)
    }
}

/// Measures a period of each of these instances, from the states found of them.
fn measured(
    part: &Plan,
    known: &[u32],
    found: &[Option<Box<PeriodicState>>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    if known.is_empty() {
        return Ok(Vec::new());
    }
    let start = |i: &u32| {
        let place = found[*i as usize].as_deref();
        StartState::from(
            place.map_or(SectionState::FREE, |state| period_map::transfer_section(part, *i, state)),
        )
    };
    let mut plan = part.part(known).starting_at(known.iter().map(start).collect());
    (plan.run.periods, plan.run.measure) = (2, 1);
    progress.foresee(plan.instance_steps());
    Ok(engine.run(&plan, progress)?.results)
}
