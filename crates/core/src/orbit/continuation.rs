//! Continuation along curves: periodic states followed from point to point, many curves side by side.

use super::initial_guess::{CurvePrediction, InitialGuess};
use super::period_map::distance;
use super::search_batch::{self, BatchSolution};
use super::{Jacobian, PeriodicState, period_map, time_integration};
use crate::engine::{Engine, EngineError, Progress};
use crate::kernel::MODES_MAX;
use crate::plan::{Plan, SectionState};
use std::collections::BTreeMap;

/// Largest change of the state in one step, in free amplitudes. A state that moves farther may have left its branch.
const MAX_STATE_CHANGE: f64 = 0.08;
/// Smallest step, as a share of the distance between two points. The branch has ended if even this step fails.
const DS_MIN: f64 = 1.0 / 64.0;
/// Evaluations and new Jacobians that the search of one step may take.
const MAX_EVALUATIONS_AND_JACOBIANS: (u32, u32) = (80, 10);
/// Steps that may be tried between two points.
const MAX_STEPS: u32 = 200;
/// Longest extrapolation, in lengths of the last step. Beyond it a step starts from the last state.
const MAX_EXTRAPOLATION: f64 = 4.0;

/// The states along the curves of a plan.
pub(super) struct CurveStates {
    /// By instance: the start of its search or integration; `None` where no state is known.
    pub states: Vec<Option<PeriodicState>>,
    /// By instance: whether its state was not reached continuously from the point before.
    pub jumps: Vec<bool>,
    /// By instance.
    pub periods: Vec<u32>,
    pub notes: Vec<String>,
}

/// A curve that is being followed.
#[derive(Default)]
struct CurveProgress {
    /// Its instances in the order of continuation.
    points: Vec<u32>,
    /// The last point with a known state, and the point before it if both are on one branch.
    last: Option<(u32, PeriodicState)>,
    before: Option<(u32, PeriodicState)>,
}

/// A step of a curve between two of its points.
struct ContinuationStep {
    /// The curve's number.
    curve: usize,
    from: u32,
    to: u32,
    /// The position reached and the next step, as shares of the distance between the points, and the state there.
    reached: f64,
    state: PeriodicState,
    length: f64,
    /// Periods that its searches took.
    periods: u32,
}

impl ContinuationStep {
    /// A step over the whole distance, before its search.
    fn whole(curve: usize, from: u32, to: u32, state: &PeriodicState) -> Self {
        Self { curve, from, to, reached: 0.0, state: state.clone(), length: 1.0, periods: 0 }
    }
}

/// Follows the plan's curves. Each first point starts at the free oscillation.
pub(super) fn continue_curves(
    plan: &Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<CurveStates, EngineError> {
    let mut all = Continuation::new(plan, engine, progress);
    let longest = all.curves.iter().map(|curve| curve.points.len()).max().unwrap_or(0);
    progress.task("following curves", plan.len() as u64);
    for number in 0..longest {
        if progress.stopped() {
            break;
        }
        all.advance(number)?;
    }
    Ok(all.done)
}

/// Counts the jumps that move under this plan's steps. A run with other steps met `jumps` and the states `before`; this plan's
/// states are `found`. A jump has moved if the branch ends before it, or continues to the marked point.
///
/// # Errors
/// Returns the engine's error.
pub fn jumps_moved(
    plan: &Plan,
    jumps: &[bool],
    (before, found): (&[Option<&PeriodicState>], &[Option<Box<PeriodicState>>]),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<usize, EngineError> {
    let mut all = Continuation::new(plan, engine, progress);
    let (mut going, mut moved) = (Vec::new(), 0);
    for (curve, one) in all.curves.iter().enumerate() {
        for pair in one.points.windows(2).filter(|pair| jumps[pair[1] as usize]) {
            let (from, to) = (pair[0], pair[1]);
            let Some(last) = before[from as usize] else { continue };
            match found[from as usize]
                .as_deref()
                .filter(|state| is_near(plan, from, state, last, MAX_STATE_CHANGE))
            {
                Some(state) => going.push(ContinuationStep::whole(curve, from, to, state)),
                None => moved += 1,
            }
        }
    }
    let tried = going.len();
    progress.task("jumps", tried as u64);
    Ok(moved + tried - all.steps(going)?.len())
}

/// Moves marks of jumps to where this plan's states jump. A mark between two states that are near each other goes to the
/// nearest unmarked point that is far from the one before it. If there is none, the mark was a slow passage by the end of a
/// branch, cut short, and is removed.
pub fn locate_jumps(plan: &Plan, jumps: &mut [bool], found: &[Option<Box<PeriodicState>>]) {
    let state = |i: u32| found.get(i as usize)?.as_deref();
    let joined =
        |pair: &[u32]| Some(is_near(plan, pair[1], state(pair[1])?, state(pair[0])?, MAX_STATE_CHANGE));
    for curve in curves(plan) {
        let pairs: Vec<(u32, Option<bool>)> =
            curve.points.windows(2).map(|pair| (pair[1], joined(pair))).collect();
        for (n, (i, is_joined)) in pairs.iter().enumerate() {
            if !jumps[*i as usize] || *is_joined != Some(true) {
                continue;
            }
            let open = pairs
                .iter()
                .enumerate()
                .filter(|(_, (i, joined))| *joined == Some(false) && !jumps[*i as usize]);
            let nearest = open.min_by_key(|(m, _)| m.abs_diff(n)).map(|(_, (i, _))| *i as usize);
            jumps[*i as usize] = false;
            nearest.into_iter().for_each(|i| jumps[i] = true);
        }
    }
}

/// The plan's curves, each with its points in order.
fn curves(plan: &Plan) -> Vec<CurveProgress> {
    let mut by_number: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    if let Some(curves) = plan.ensemble.curves {
        for i in plan.stepped() {
            let (curve, place) = curves.place(plan.id(i));
            by_number.entry(curve).or_default().push((place, i));
        }
    }
    let curve = |mut points: Vec<(u32, u32)>| {
        points.sort_unstable();
        CurveProgress { points: points.into_iter().map(|(_, i)| i).collect(), ..CurveProgress::default() }
    };
    by_number.into_values().map(curve).collect()
}

/// The continuation of all curves.
struct Continuation<'a> {
    plan: &'a Plan,
    engine: &'a dyn Engine,
    progress: &'a Progress,
    curves: Vec<CurveProgress>,
    done: CurveStates,
}

impl<'a> Continuation<'a> {
    /// The plan's curves before their first points.
    fn new(plan: &'a Plan, engine: &'a dyn Engine, progress: &'a Progress) -> Self {
        let count = plan.len();
        let done = CurveStates {
            states: vec![None; count],
            jumps: vec![false; count],
            periods: vec![0; count],
            notes: Vec::new(),
        };
        Self { plan, engine, progress, curves: curves(plan), done }
    }

    /// Takes every curve that is long enough to its point of this number.
    fn advance(&mut self, number: usize) -> Result<(), EngineError> {
        let (mut going, mut starts) = (Vec::new(), Vec::new());
        for (n, curve) in self.curves.iter().enumerate() {
            let Some(&to) = curve.points.get(number) else { continue };
            match &curve.last {
                Some((from, state)) => going.push(ContinuationStep::whole(n, *from, to, state)),
                None => starts.push((n, to, free_orbit(self.plan, to), 0)),
            }
        }
        let ended = self.steps(going)?;
        starts.extend(ended.into_iter().map(|one| (one.curve, one.to, branch_end(one.state), one.periods)));
        self.settle(starts)
    }

    /// Steps to the next points, and halves a step that fails. Returns the curves whose shortest step fails: their branch has
    /// ended.
    fn steps(&mut self, mut left: Vec<ContinuationStep>) -> Result<Vec<ContinuationStep>, EngineError> {
        let mut ended = Vec::new();
        for _ in 0..MAX_STEPS {
            if left.is_empty() || self.progress.stopped() {
                break;
            }
            let share = |one: &ContinuationStep| (one.reached + one.length).min(1.0);
            let pairs: Vec<(u32, u32, f64)> = left.iter().map(|one| (one.from, one.to, share(one))).collect();
            let part = self.plan.between(&pairs);
            let places: Vec<SectionState> =
                (0..).zip(&left).map(|(i, one)| self.predicted(&part, i, one)).collect();
            let BatchSolution { found, periods, .. } = self.search(&part, &left, &places)?;
            let mut rest = Vec::new();
            for ((i, mut one), found) in (0..).zip(left).zip(found) {
                one.periods += periods[i as usize];
                match found.filter(|found| is_near(&part, i, found, &one.state, MAX_STATE_CHANGE)) {
                    Some(found) if share(&one) >= 1.0 => {
                        self.accept(one.curve, one.to, *found, false, one.periods);
                        continue;
                    }
                    Some(found) => (one.reached, one.state) = (share(&one), *found),
                    None => one.length *= 0.5,
                }
                if one.length < DS_MIN { ended.push(one) } else { rest.push(one) }
            }
            left = rest;
        }
        ended.extend(left);
        Ok(ended)
    }

    /// The predictor of a step, which is instance `i` of `part`. A whole step extrapolates the secant through the last two
    /// points; a shorter one starts from its last state.
    fn predicted(&self, part: &Plan, i: u32, one: &ContinuationStep) -> SectionState {
        let here = period_map::transfer_section(part, i, &one.state);
        let before = self.curves[one.curve].before.as_ref().filter(|_| one.length >= 1.0);
        let Some((first, before)) = before else { return here };
        let strides = ratio(self.plan, *first, one.from, one.to);
        extrapolated(here, &period_map::transfer_section(part, i, before), strides)
    }

    /// Finds the states to which the motion from these states settles, by search or by integration.
    fn settle(&mut self, starts: Vec<(usize, u32, PeriodicState, u32)>) -> Result<(), EngineError> {
        if starts.is_empty() || self.progress.stopped() {
            return Ok(());
        }
        let to: Vec<u32> = starts.iter().map(|(_, i, ..)| *i).collect();
        let part = self.plan.part(&to);
        let places: Vec<&PeriodicState> = starts.iter().map(|(_, _, state, _)| state).collect();
        let BatchSolution { mut found, periods, notes, .. } =
            settled_states(&part, &places, self.engine, self.progress)?;
        self.done.notes.extend(notes);
        for (place, (n, i, state, before)) in starts.iter().enumerate() {
            let Some(found) = found[place].take() else { continue };
            let new = self.curves[*n].last.is_none();
            let jumped = !new && !is_near(&part, place as u32, &found, state, MAX_STATE_CHANGE);
            self.accept(*n, *i, *found, jumped, before + periods[place]);
        }
        Ok(())
    }

    /// Searches near these predictions only.
    fn search(
        &mut self,
        part: &Plan,
        strides: &[ContinuationStep],
        places: &[SectionState],
    ) -> Result<BatchSolution, EngineError> {
        let states: Vec<Option<&PeriodicState>> = strides.iter().map(|one| Some(&one.state)).collect();
        let begin = InitialGuess::CurvePoints(CurvePrediction {
            states: &states,
            places,
            max_evaluations: MAX_EVALUATIONS_AND_JACOBIANS,
            accept_unverified: &[],
        });
        let mut searched =
            search_batch::solve_batches(part, &part.by_class(), begin, self.engine, self.progress)?;
        self.done.notes.append(&mut searched.notes);
        Ok(searched)
    }

    /// Records that a curve has reached its next point.
    fn accept(&mut self, curve: usize, point: u32, state: PeriodicState, jumped: bool, periods: u32) {
        let i = point as usize;
        let curve = &mut self.curves[curve];
        curve.before = curve.last.replace((point, state.clone())).filter(|_| !jumped);
        self.done.states[i] = Some(state);
        (self.done.jumps[i], self.done.periods[i]) = (jumped, periods);
        self.progress.done(1);
    }
}

/// The free oscillation of an instance.
pub(super) fn free_orbit(plan: &Plan, i: u32) -> PeriodicState {
    integrated_orbit(plan, i, SectionState::free(plan, i))
}

/// The state of an instance that no search has found: its Jacobian and multiplier are unknown.
pub(super) fn integrated_orbit(plan: &Plan, i: u32, station: SectionState) -> PeriodicState {
    PeriodicState { section: station, ..PeriodicState::unknown(plan.steps(i), &plan.driven(i).kept) }
}

/// The last state of a branch that has ended, without its Jacobian, which leads nowhere.
pub(super) fn branch_end(state: PeriodicState) -> PeriodicState {
    PeriodicState { jacobian: Jacobian::Unknown, ..state }
}

/// The distance from the second to the third point over that from the first to the second; 0 beyond `MAX_EXTRAPOLATION`.
fn ratio(plan: &Plan, first: u32, second: u32, third: u32) -> f64 {
    let place = |i: u32| {
        let free = &plan.driven(i).free;
        [plan.case(i).gap, free.omega, free.level]
    };
    let [a, b, c] = [first, second, third].map(place);
    let along = (0..3).find(|n| a[*n] != b[*n]);
    let ratio = along.map_or(0.0, |n| (c[n] - b[n]) / (b[n] - a[n]));
    if ratio > 0.0 && ratio <= MAX_EXTRAPOLATION { ratio } else { 0.0 }
}

/// Whether two states of instance `i` are within `most` free amplitudes of each other. The unit is the gap where that is
/// larger and the free oscillation does not feel the sample.
fn is_near(plan: &Plan, i: u32, found: &PeriodicState, other: &PeriodicState, most: f64) -> bool {
    let amplitude = plan.driven(i).free_amplitude();
    let scale = if plan.is_free(i) { amplitude.max(plan.case(i).gap) } else { amplitude };
    distance(&period_map::transfer_section(plan, i, found), &period_map::transfer_section(plan, i, other))
        <= most * scale
}

/// Extrapolates the step from `there` to `here` by `strides` times its length.
pub(super) fn extrapolated(here: SectionState, there: &SectionState, strides: f64) -> SectionState {
    let mut station = here;
    for k in 0..MODES_MAX {
        station.x[k] += strides * (here.x[k] - there.x[k]);
        station.u[k] += strides * (here.u[k] - there.u[k]);
    }
    station
}

/// Finds the states to which each instance's motion settles, by search. Where that fails, the state is where integration ends,
/// settled or not: the point's own run tells its status.
pub(super) fn settled_states(
    plan: &Plan,
    from: &[&PeriodicState],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<BatchSolution, EngineError> {
    let places: Vec<Option<&PeriodicState>> = from.iter().map(|state| Some(*state)).collect();
    let mut searched = search_batch::solve_batches(
        plan,
        &plan.by_class(),
        InitialGuess::CurveStates(&places),
        engine,
        progress,
    )?;
    let lost: Vec<u32> = plan.instances().filter(|i| searched.found[*i as usize].is_none()).collect();
    if !lost.is_empty() && !progress.stopped() {
        let begin = |i: &u32| period_map::transfer_section(plan, *i, from[*i as usize]).into();
        let waiting = plan.part(&lost).starting_at(lost.iter().map(begin).collect());
        let waited = time_integration::integrate(&waiting, engine, progress)?;
        for (n, i) in lost.iter().enumerate() {
            searched.periods[*i as usize] += waited.periods[n];
            let end = waited.outcome.ends.get(n).and_then(Option::as_deref).filter(|end| end.finite);
            searched.found[*i as usize] = end.map(|end| Box::new(integrated_orbit(plan, *i, *end)));
        }
    }
    Ok(searched)
}
