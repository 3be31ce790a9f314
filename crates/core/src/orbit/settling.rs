//! Instances without a state are integrated on from the start of their last search, and examined at checkpoints. A motion that
//! settles is searched for again early; one that shows no sign of settling is given up. Very slow motions mostly have lost the
//! tapping state that searches looked for: they are first searched for at the attractive branch's balance, then followed in
//! long steps (`envelope_solver.rs`).

use super::drift::Drift;
use super::envelope_solver::{EnvelopeStart, follow_and_search, is_slow, max_evaluations};
use super::harmonic_balance::attractive_orbit;
use super::initial_guess::{InitialGuess, Unconverged};
use super::period_map::{PeriodMap, transfer_section};
use super::verification::search_and_verify;
use super::{OrbitSolution, continuation, time_integration};
use crate::engine::{Engine, EngineError, Progress, in_double};
use crate::plan::{Plan, SectionState, StartState};
use std::collections::{BTreeMap, HashSet};
use std::f64::consts::TAU;

/// Periods of a checkpoint; the drift of a motion is the mean over them.
const CHECK_PERIODS: u32 = 8;
/// Between checkpoints the slowest mode's free motion decays by this exponent, over at least so many periods. A motion that
/// shows no sign of settling by then may be given up.
const DECAY_EXPONENT: f64 = 2.0;
const MIN_DECAY_PERIODS: u32 = 96;
/// If that takes long, the first searches come after so many periods, and each later one after twice as many.
const FIRST_SEARCH_PERIODS: u32 = 192;
/// Checkpoints a decay apart, at which a motion may be given up. An instance that no search finds by then is integrated to
/// steady state.
const JUDGED_CHECKPOINTS: usize = 4;

/// An instance that is being integrated.
struct Settling {
    left: Unconverged,
    /// Drift at the last checkpoint that judged it.
    drift: Option<Drift>,
    /// Evaluations spent on following it.
    evaluations: u32,
}

/// Integrates these instances, searches for them on the way into `settled`, and returns those without a state.
pub(super) fn settle_and_search(
    plan: &Plan,
    left: Vec<Unconverged>,
    settled: &mut OrbitSolution,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Vec<Unconverged>, EngineError> {
    let mut paces: BTreeMap<u32, Vec<Settling>> = BTreeMap::new();
    for one in left {
        paces.entry(decay_periods(plan, one.instance)).or_default().push(Settling {
            left: one,
            drift: None,
            evaluations: 0,
        });
    }
    let mut walk = CheckpointRun { plan, settled, engine, progress, rest: Vec::new() };
    for (pace, group) in paces {
        walk.settle_group(group, pace)?;
    }
    Ok(walk.rest)
}

/// Periods up to each checkpoint, and whether it gives up motions that have not settled since the last such one.
fn checkpoints(pace: u32) -> Vec<(u32, bool)> {
    let mut all = vec![(0, true)];
    let (mut on, mut gone) = (FIRST_SEARCH_PERIODS, 0);
    while gone + 2 * on <= pace {
        all.push((on, false));
        gone += on + CHECK_PERIODS;
        on *= 2;
    }
    all.push((pace - gone, true));
    all.extend([(pace, true); JUDGED_CHECKPOINTS - 1]);
    all
}

/// Periods between an instance's checkpoints, in steps of half an octave, so that many instances share them.
fn decay_periods(plan: &Plan, instance: u32) -> u32 {
    let driven = plan.driven(instance);
    let rates = driven.kept.modes.iter().map(|mode| mode.damping * mode.omega / driven.free.omega);
    let falls = DECAY_EXPONENT / (TAU * rates.fold(f64::INFINITY, f64::min));
    let halves = (2.0 * (falls / f64::from(MIN_DECAY_PERIODS)).log2()).ceil().clamp(0.0, 40.0);
    (f64::from(MIN_DECAY_PERIODS) * (0.5 * halves).exp2()) as u32
}

/// Instances that go from checkpoint to checkpoint.
struct CheckpointRun<'a> {
    plan: &'a Plan,
    settled: &'a mut OrbitSolution,
    engine: &'a dyn Engine,
    progress: &'a Progress,
    /// Instances that are through and have no state.
    rest: Vec<Unconverged>,
}

impl CheckpointRun<'_> {
    /// Runs a group of instances with the same decay periods.
    fn settle_group(&mut self, mut going: Vec<Settling>, pace: u32) -> Result<(), EngineError> {
        if is_slow(pace) {
            going = self.search_attractive(going)?;
        }
        for (on, judged) in checkpoints(pace) {
            let in_time = |one: &Settling| one.left.integrated + on + CHECK_PERIODS <= self.plan.run.periods;
            let (fit, late): (Vec<Settling>, Vec<Settling>) = going.into_iter().partition(in_time);
            self.retire(late);
            if fit.is_empty() || self.progress.stopped() {
                return Ok(());
            }
            going = self.integrate_to_checkpoint(fit, (on, judged))?;
            let (wandering, settling) = going.into_iter().partition(|one| one.left.not_settling);
            self.retire(wandering);
            let follows = is_slow(pace) && (on == 0 || !judged);
            going = if follows { self.follow(settling, pace)? } else { settling };
            if on > 0 {
                going = self.search_from_here(going)?;
            }
        }
        self.retire(going);
        Ok(())
    }

    fn retire(&mut self, some: Vec<Settling>) {
        self.rest.extend(some.into_iter().map(|one| one.left));
    }

    /// Integrates `on` periods and a checkpoint. If `judged`, marks motions that show no sign of settling.
    fn integrate_to_checkpoint(
        &mut self,
        mut going: Vec<Settling>,
        (on, judged): (u32, bool),
    ) -> Result<Vec<Settling>, EngineError> {
        let double = in_double(self.engine);
        let instances: Vec<u32> = going.iter().map(|one| one.left.instance).collect();
        let map = PeriodMap::new(self.plan, &instances, double, self.progress)?;
        self.progress.task("waiting", 0);
        let parts = map.spread(|slots| -> Result<Vec<Vec<SectionState>>, EngineError> {
            let mut tracks: Vec<Vec<SectionState>> = going[slots.start as usize..slots.end as usize]
                .iter()
                .map(|one| vec![one.left.section])
                .collect();
            let lengths = (on > 0).then_some(on).into_iter().chain([1; CHECK_PERIODS as usize]);
            for (n, periods) in lengths.enumerate() {
                let starts: Vec<(u32, SectionState)> = slots
                    .clone()
                    .zip(&tracks)
                    .filter_map(|(slot, track)| Some((slot, *track.last()?)))
                    .collect();
                for (track, end) in tracks.iter_mut().zip(map.after(&starts, periods)?) {
                    if n == 0 && on > 0 {
                        track.clear();
                    }
                    track.extend(end);
                }
            }
            Ok(tracks)
        });
        let mut tracks = Vec::with_capacity(going.len());
        for part in parts {
            tracks.extend(part?);
        }
        let accuracy = self.plan.run.accuracy;
        for (one, track) in going.iter_mut().zip(tracks) {
            // A stopped instance has no states.
            let Some(last) = track.last() else { continue };
            let now = Drift::of(&track, self.plan.driven(one.left.instance).free_amplitude().max(1e-15));
            one.left.not_settling = !last.finite;
            if judged {
                one.left.not_settling |= one.drift.is_some_and(|before| now.is_unsettled(&before, accuracy));
                one.drift = Some(now);
            }
            (one.left.section, one.left.integrated) = (*last, one.left.integrated + on + CHECK_PERIODS);
            self.settled.periods[one.left.instance as usize] += on + CHECK_PERIODS;
        }
        Ok(going)
    }

    /// Follows these instances from their present states; returns those without a periodic state.
    fn follow(&mut self, mut going: Vec<Settling>, pace: u32) -> Result<Vec<Settling>, EngineError> {
        let from = |one: &Settling| EnvelopeStart {
            instance: one.left.instance,
            section: one.left.section,
            decay_periods: pace,
            max_evaluations: max_evaluations(pace).saturating_sub(one.evaluations),
        };
        let from: Vec<EnvelopeStart> = going.iter().map(from).collect();
        let taken = follow_and_search(self.plan, &from, self.settled, self.engine, self.progress)?;
        going.iter_mut().zip(taken).for_each(|(one, taken)| one.evaluations += taken);
        let is_open = |one: &Settling| self.settled.found[one.left.instance as usize].is_none();
        Ok(going.into_iter().filter(is_open).collect())
    }

    /// Searches for these instances from their present states; returns those without a periodic state.
    fn search_from_here(&mut self, going: Vec<Settling>) -> Result<Vec<Settling>, EngineError> {
        let places: Vec<SectionState> = going.iter().map(|one| one.left.section).collect();
        self.search_from(going, InitialGuess::Integrated(&places))
    }

    /// Searches for these instances at the attractive branch's balance; returns those without a periodic state.
    fn search_attractive(&mut self, going: Vec<Settling>) -> Result<Vec<Settling>, EngineError> {
        let (mut balanced, mut places, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        for one in going {
            match attractive_orbit(self.plan, one.left.instance) {
                None => rest.push(one),
                Some(place) => {
                    balanced.push(one);
                    places.push(place);
                }
            }
        }
        rest.extend(self.search_from(balanced, InitialGuess::PointsOnly(&places))?);
        Ok(rest)
    }

    /// The same, from these guesses.
    fn search_from(
        &mut self,
        going: Vec<Settling>,
        begin: InitialGuess,
    ) -> Result<Vec<Settling>, EngineError> {
        let instances: Vec<u32> = going.iter().map(|one| one.left.instance).collect();
        let part = self.plan.part(&instances);
        let all: Vec<u32> = part.instances().collect();
        let (ran, _) = search_and_verify(&part, &all, begin, self.engine, self.progress)?;
        let is_found: Vec<bool> = ran.found.iter().map(Option::is_some).collect();
        self.settled.take(&instances, ran);
        Ok(going.into_iter().zip(is_found).filter(|(_, is_found)| !is_found).map(|(one, _)| one).collect())
    }
}

/// Instances to integrate to steady state.
pub(super) struct Integration {
    pub instances: Vec<u32>,
    pub periods: u32,
    /// Initial states; `None` for those of the scene.
    pub starts: Option<Vec<SectionState>>,
    /// Whether later searches may start at their ends.
    pub ends_are_states: bool,
}

/// The last integrations: instances free of the sample, and if the run `waits`, those without a state. Instances in `left`
/// continue from their present states; those that show no sign of settling are only measured.
pub(super) fn integrations(
    plan: &Plan,
    begin: InitialGuess,
    left: Vec<Unconverged>,
    waits: bool,
    settled: &OrbitSolution,
) -> Vec<Integration> {
    let elsewhere: HashSet<u32> = left.iter().map(|one| one.instance).collect();
    let unfound = |i: u32| waits && settled.found[i as usize].is_none() && !elsewhere.contains(&i);
    let anew: Vec<u32> = plan.instances().filter(|i| plan.steps(*i) == 0 || unfound(*i)).collect();
    let starts = match begin {
        InitialGuess::CurveStates(near) => {
            let start = |i: &u32| {
                near[*i as usize].map_or(SectionState::free(plan, *i), |one| transfer_section(plan, *i, one))
            };
            Some(anew.iter().map(start).collect())
        }
        _ => None,
    };
    let ends_are_states = starts.is_some();
    let mut all = vec![Integration { instances: anew, periods: plan.run.periods, starts, ends_are_states }];
    let mut groups: BTreeMap<u32, (Vec<u32>, Vec<SectionState>)> = BTreeMap::new();
    for one in left {
        // At least the measured periods run, however few are left.
        let left = if one.not_settling { 0 } else { plan.run.periods.saturating_sub(one.integrated) };
        let periods = left.max(plan.run.measure + 1);
        let group = groups.entry(periods).or_default();
        group.0.push(one.instance);
        group.1.push(one.section);
    }
    all.extend(groups.into_iter().map(|(periods, (instances, places))| Integration {
        instances,
        periods,
        starts: Some(places),
        ends_are_states: false,
    }));
    all
}

impl OrbitSolution {
    /// Integrates some instances and takes over their results.
    pub(super) fn integrate(
        &mut self,
        plan: &Plan,
        wait: Integration,
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if wait.instances.is_empty() || progress.stopped() {
            return Ok(());
        }
        let mut part = plan.part(&wait.instances);
        part.run.periods = wait.periods;
        if let Some(starts) = wait.starts {
            part = part.starting_at(starts.into_iter().map(StartState::from).collect());
        }
        let mut ran = time_integration::integrate(&part, engine, progress)?;
        // Later points of the curve start from this state.
        let state = |(place, i): (usize, &u32)| {
            let end = ran.outcome.ends.get(place)?.as_deref().filter(|_| wait.ends_are_states)?;
            let steady = ran.outcome.results[place].status.is_steady() && plan.steps(*i) > 0;
            steady.then(|| Box::new(continuation::integrated_orbit(plan, *i, *end)))
        };
        ran.found = wait.instances.iter().enumerate().map(state).collect();
        self.take(&wait.instances, ran);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Outcome;
    use crate::test_plans::plan_of;

    /// Checkpoints may have taken all but a few periods.
    #[test]
    fn what_is_waited_for_can_be_measured() {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 100 }]
            [drive]
            on = "tip"
            frequency = "300 kHz"
            free_amplitude = "20 nm"
            [approach]
            gap = "15 nm"
            [run]
            periods = 300
            measure = 20
        "#;
        let plan = plan_of(text);
        let outcome = Outcome::of(&plan);
        let settled = OrbitSolution { outcome, found: vec![None], periods: vec![0], jumps: Vec::new() };
        for (waited, wanders, periods) in
            [(297, false, 21), (300, false, 21), (100, false, 200), (300, true, 21)]
        {
            let left = vec![Unconverged {
                instance: 0,
                section: SectionState::FREE,
                integrated: waited,
                not_settling: wanders,
            }];
            let all = integrations(&plan, InitialGuess::States(&[]), left, true, &settled);
            assert_eq!(all.last().map(|wait| wait.periods), Some(periods), "{waited} waited");
        }
    }

    /// A motion is judged after the slowest mode's decay; searches come sooner if that is long.
    #[test]
    fn searches_come_sooner_than_judgement() {
        assert_eq!(checkpoints(96), [(0, true), (96, true), (96, true), (96, true), (96, true)]);
        assert_eq!(checkpoints(784)[..4], [(0, true), (192, false), (584, true), (784, true)]);
        for pace in [96, 383, 384, 8688, 69_511, 1_000_000_000] {
            let all = checkpoints(pace);
            let judged = all.iter().skip(1).position(|look| look.1).expect("it is judged");
            let until: u32 = all[1..=judged + 1].iter().map(|look| look.0 + CHECK_PERIODS).sum();
            assert_eq!(until, pace + CHECK_PERIODS);
            assert!(all[judged + 2..].iter().all(|look| *look == (pace, true)));
        }
    }
}
