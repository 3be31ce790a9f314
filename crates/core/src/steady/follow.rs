//! Curves: periodic states followed from point to point, many curves side by side.

use super::begin::{Along, Begin};
use super::found::alike;
use super::search::{self, Searched};
use super::{Linear, PeriodicState, map, wait};
use crate::engine::{Engine, EngineError, Progress};
use crate::kernel::MODES_MAX;
use crate::plan::{Plan, Station};
use std::collections::BTreeMap;

/// How far the state may move in one stride, in free amplitudes: what moves farther may have left its branch.
const MOVED: f64 = 0.08;
/// Least stride, as a share of the way from a point to the next: where none so short succeeds the branch has ended.
const LEAST: f64 = 1.0 / 64.0;
/// Most evaluations of a stride's search, and slopes taken anew.
const MOST: (u32, u32) = (80, 10);
/// Most strides between two points.
const STRIDES: u32 = 200;
/// A stride's prediction goes no farther than so many of the last strides.
const FARTHEST: f64 = 4.0;

/// The states along the curves of a plan.
pub(super) struct Followed {
    /// By instance: where its search or its waiting begins; none where nothing is known.
    pub states: Vec<Option<PeriodicState>>,
    /// By instance: whether the state was not reached continuously from the point before.
    pub jumps: Vec<bool>,
    /// By instance.
    pub periods: Vec<u32>,
    pub notes: Vec<String>,
}

/// A curve on its way.
#[derive(Default)]
struct Curve {
    /// Its instances in the order in which they are followed.
    points: Vec<u32>,
    /// The last point at which a state is known, and the one before if the branch is the same.
    last: Option<(u32, PeriodicState)>,
    before: Option<(u32, PeriodicState)>,
}

/// A curve between two of its points.
struct Stride {
    /// Its number.
    curve: usize,
    from: u32,
    to: u32,
    /// How far it has come, the state there, and the next stride, as shares of the way.
    reached: f64,
    state: PeriodicState,
    length: f64,
    /// Periods of its searches.
    periods: u32,
}

/// Follows the curves of the plan from their first points, which begin at the free oscillation.
pub(super) fn along(plan: &Plan, engine: &dyn Engine, progress: &Progress) -> Result<Followed, EngineError> {
    let mut all = Following::new(plan, engine, progress);
    let longest = all.curves.iter().map(|curve| curve.points.len()).max().unwrap_or(0);
    progress.task("following curves", plan.len() as u64);
    for number in 0..longest {
        if progress.stopped() {
            break;
        }
        all.step(number)?;
    }
    Ok(all.done)
}

/// How many of the jumps that a run with other steps met, with the states `before`, stand elsewhere by this plan's steps, with
/// which states were `found`: the branch has ended before, or goes on to the point that is marked.
///
/// # Errors
/// What the engine says.
pub fn jumps_moved(
    plan: &Plan,
    jumps: &[bool],
    (before, found): (&[Option<&PeriodicState>], &[Option<Box<PeriodicState>>]),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<usize, EngineError> {
    let mut all = Following::new(plan, engine, progress);
    let (mut going, mut moved) = (Vec::new(), 0);
    for (curve, one) in all.curves.iter().enumerate() {
        for pair in one.points.windows(2).filter(|pair| jumps[pair[1] as usize]) {
            let (from, to) = (pair[0], pair[1]);
            let Some(last) = before[from as usize] else { continue };
            match found[from as usize].as_deref().filter(|state| near(plan, from, state, last, MOVED)) {
                Some(state) => {
                    let state = state.clone();
                    going.push(Stride { curve, from, to, reached: 0.0, state, length: 1.0, periods: 0 });
                }
                None => moved += 1,
            }
        }
    }
    let tried = going.len();
    progress.task("jumps", tried as u64);
    Ok(moved + tried - all.strides(going)?.len())
}

/// Puts marks of jumps where this plan's states jump: a mark between two that are near each other goes to the nearest point that is
/// far from the one before it and has none. Where there is no such point, a slow passage by the end of a branch, cut short,
/// has looked like a jump.
pub fn place_jumps(plan: &Plan, jumps: &mut [bool], found: &[Option<Box<PeriodicState>>]) {
    let state = |i: u32| found.get(i as usize)?.as_deref();
    let joined = |pair: &[u32]| Some(near(plan, pair[1], state(pair[1])?, state(pair[0])?, MOVED));
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

/// The plan's curves, each with its points in their order.
fn curves(plan: &Plan) -> Vec<Curve> {
    let mut by_number: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    if let Some(curves) = plan.ensemble.curves {
        for i in plan.stepped() {
            let (curve, place) = curves.place(plan.id(i));
            by_number.entry(curve).or_default().push((place, i));
        }
    }
    let curve = |mut points: Vec<(u32, u32)>| {
        points.sort_unstable();
        Curve { points: points.into_iter().map(|(_, i)| i).collect(), ..Curve::default() }
    };
    by_number.into_values().map(curve).collect()
}

/// Curves while they are followed.
struct Following<'a> {
    plan: &'a Plan,
    engine: &'a dyn Engine,
    progress: &'a Progress,
    curves: Vec<Curve>,
    done: Followed,
}

impl<'a> Following<'a> {
    /// The plan's curves before their first points.
    fn new(plan: &'a Plan, engine: &'a dyn Engine, progress: &'a Progress) -> Self {
        let count = plan.len();
        let done = Followed {
            states: vec![None; count],
            jumps: vec![false; count],
            periods: vec![0; count],
            notes: Vec::new(),
        };
        Self { plan, engine, progress, curves: curves(plan), done }
    }

    /// Takes every curve that is long enough to its point of this number.
    fn step(&mut self, number: usize) -> Result<(), EngineError> {
        let (mut going, mut starts) = (Vec::new(), Vec::new());
        for (n, curve) in self.curves.iter().enumerate() {
            let Some(&to) = curve.points.get(number) else { continue };
            match &curve.last {
                Some((from, state)) => going.push(Stride {
                    curve: n,
                    from: *from,
                    to,
                    reached: 0.0,
                    state: state.clone(),
                    length: 1.0,
                    periods: 0,
                }),
                None => starts.push((n, to, free(self.plan, to), 0)),
            }
        }
        let ended = self.strides(going)?;
        starts.extend(ended.into_iter().map(|one| (one.curve, one.to, left(one.state), one.periods)));
        self.wherever(starts)
    }

    /// Strides to the next points, shorter where a whole one leads nowhere. Where even the shortest does, the branch has
    /// ended: these come back.
    fn strides(&mut self, mut left: Vec<Stride>) -> Result<Vec<Stride>, EngineError> {
        let mut ended = Vec::new();
        for _ in 0..STRIDES {
            if left.is_empty() || self.progress.stopped() {
                break;
            }
            let share = |one: &Stride| (one.reached + one.length).min(1.0);
            let pairs: Vec<(u32, u32, f64)> = left.iter().map(|one| (one.from, one.to, share(one))).collect();
            let part = self.plan.between(&pairs);
            let places: Vec<Station> = (0..).zip(&left).map(|(i, one)| self.place(&part, i, one)).collect();
            let Searched { found, periods, .. } = self.search(&part, &left, &places)?;
            let mut rest = Vec::new();
            for ((i, mut one), found) in (0..).zip(left).zip(found) {
                one.periods += periods[i as usize];
                match found.filter(|found| near(&part, i, found, &one.state, MOVED)) {
                    Some(found) if share(&one) >= 1.0 => {
                        self.arrive(one.curve, one.to, *found, false, one.periods);
                        continue;
                    }
                    Some(found) => (one.reached, one.state) = (share(&one), *found),
                    None => one.length *= 0.5,
                }
                if one.length < LEAST { ended.push(one) } else { rest.push(one) }
            }
            left = rest;
        }
        ended.extend(left);
        Ok(ended)
    }

    /// Where a stride, instance `i` of its plan, looks for its end: a whole one by the secant through the last two points,
    /// a shorter one where it stands.
    fn place(&self, part: &Plan, i: u32, one: &Stride) -> Station {
        let here = map::own(part, i, &one.state);
        let before = self.curves[one.curve].before.as_ref().filter(|_| one.length >= 1.0);
        let Some((first, before)) = before else { return here };
        let strides = ratio(self.plan, *first, one.from, one.to);
        beyond(here, &map::own(part, i, before), strides)
    }

    /// Where waiting at these points would lead from these states: searched for as that does, or waited for.
    fn wherever(&mut self, starts: Vec<(usize, u32, PeriodicState, u32)>) -> Result<(), EngineError> {
        if starts.is_empty() || self.progress.stopped() {
            return Ok(());
        }
        let to: Vec<u32> = starts.iter().map(|(_, i, ..)| *i).collect();
        let part = self.plan.part(&to);
        let places: Vec<&PeriodicState> = starts.iter().map(|(_, _, state, _)| state).collect();
        let Searched { mut found, periods, notes, .. } =
            wherever(&part, &places, self.engine, self.progress)?;
        self.done.notes.extend(notes);
        for (place, (n, i, state, before)) in starts.iter().enumerate() {
            let Some(found) = found[place].take() else { continue };
            let new = self.curves[*n].last.is_none();
            let jumped = !new && !near(&part, place as u32, &found, state, MOVED);
            self.arrive(*n, *i, *found, jumped, before + periods[place]);
        }
        Ok(())
    }

    /// Searches next to these places, and nowhere else.
    fn search(
        &mut self,
        part: &Plan,
        strides: &[Stride],
        places: &[Station],
    ) -> Result<Searched, EngineError> {
        let all: Vec<u32> = part.instances().collect();
        let states: Vec<Option<&PeriodicState>> = strides.iter().map(|one| Some(&one.state)).collect();
        let begin = Begin::Along(Along { states: &states, places, most: MOST, lightly: &[] });
        let mut searched = search::all(part, &alike(part, &all), begin, self.engine, self.progress)?;
        self.done.notes.append(&mut searched.notes);
        Ok(searched)
    }

    /// A curve has come to its next point.
    fn arrive(&mut self, curve: usize, point: u32, state: PeriodicState, jumped: bool, periods: u32) {
        let i = point as usize;
        let curve = &mut self.curves[curve];
        curve.before = curve.last.replace((point, state.clone())).filter(|_| !jumped);
        self.done.states[i] = Some(state);
        (self.done.jumps[i], self.done.periods[i]) = (jumped, periods);
        self.progress.done(1);
    }
}

/// The free oscillation of an instance.
pub(super) fn free(plan: &Plan, i: u32) -> PeriodicState {
    waited_for(plan, i, Station::free(plan, i))
}

/// What is known of a state that was not searched for.
pub(super) fn waited_for(plan: &Plan, i: u32, station: Station) -> PeriodicState {
    PeriodicState { station, ..PeriodicState::unknown(plan.steps(i), &plan.driven(i).kept) }
}

/// The last state of a branch that has ended, which is not to be searched on: its slope leads nowhere.
pub(super) fn left(state: PeriodicState) -> PeriodicState {
    PeriodicState { linear: Linear::Unknown, ..state }
}

/// How many times the way from the first to the second of these points it is from the second to the third.
fn ratio(plan: &Plan, first: u32, second: u32, third: u32) -> f64 {
    let place = |i: u32| {
        let free = &plan.driven(i).free;
        [plan.case(i).gap, free.omega, free.level]
    };
    let [a, b, c] = [first, second, third].map(place);
    let along = (0..3).find(|n| a[*n] != b[*n]);
    let ratio = along.map_or(0.0, |n| (c[n] - b[n]) / (b[n] - a[n]));
    if ratio > 0.0 && ratio <= FARTHEST { ratio } else { 0.0 }
}

/// Whether the state of instance `i` is within so many free amplitudes of another; in gaps where that is more and the free
/// oscillation does not feel the sample.
fn near(plan: &Plan, i: u32, found: &PeriodicState, other: &PeriodicState, most: f64) -> bool {
    let amplitude = plan.driven(i).free_amplitude();
    let scale = if plan.is_free(i) { amplitude.max(plan.case(i).gap) } else { amplitude };
    apart(&map::own(plan, i, found), &map::own(plan, i, other)) <= most * scale
}

/// Where the way from `there` to `here` leads after so many more of it.
pub(super) fn beyond(here: Station, there: &Station, strides: f64) -> Station {
    let mut station = here;
    for k in 0..MODES_MAX {
        station.x[k] += strides * (here.x[k] - there.x[k]);
        station.u[k] += strides * (here.u[k] - there.u[k]);
    }
    station
}

/// How far two places of an instance are apart, m.
pub(super) fn apart(a: &Station, b: &Station) -> f64 {
    let square = |k: usize| (a.x[k] - b.x[k]).powi(2) + (a.u[k] - b.u[k]).powi(2);
    (0..MODES_MAX).map(square).sum::<f64>().sqrt()
}

/// Where waiting would lead each instance of a plan from its state: searched for as that does, or waited for.
pub(super) fn wherever(
    plan: &Plan,
    from: &[&PeriodicState],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Searched, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    let places: Vec<Option<&PeriodicState>> = from.iter().map(|state| Some(*state)).collect();
    let mut searched = search::all(plan, &alike(plan, &all), Begin::Followed(&places), engine, progress)?;
    let lost: Vec<u32> = all.into_iter().filter(|i| searched.found[*i as usize].is_none()).collect();
    if !lost.is_empty() && !progress.stopped() {
        let begin = |i: &u32| map::own(plan, *i, from[*i as usize]).into();
        let waiting = plan.part(&lost).starting_at(lost.iter().map(begin).collect());
        let waited = wait::run(&waiting, engine, progress)?;
        for (n, i) in lost.iter().enumerate() {
            searched.periods[*i as usize] += waited.periods[n];
            let end = waited.outcome.ends.get(n).and_then(Option::as_deref).filter(|end| end.finite);
            searched.found[*i as usize] = end.map(|end| Box::new(waited_for(plan, *i, *end)));
        }
    }
    Ok(searched)
}
