//! Motions that need thousands of periods to settle are followed by their envelope, in steps of many periods.

use super::OrbitSolution;
use super::initial_guess::InitialGuess;
use super::period_map::{PeriodMap, section, section_numbers};
use super::tolerances;
use super::verification::search_and_verify;
use crate::engine::{
    Engine, EngineError, JacobianStart, PeriodJacobian, ProfileSection, Progress, in_double,
};
use crate::kernel::Room;
use crate::periodic::{Envelope, EnvelopeEnd, EnvelopeOptions};
use crate::plan::{Plan, SectionState};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Motions that decay within fewer periods are faster to integrate.
const MIN_DECAY_PERIODS: u32 = 384;
/// Evaluations for an instance: the first number, or, if more, the decay periods over the second; each takes a few periods.
const MAX_EVALUATIONS: (u32, u32) = (96, 16);

/// Whether motions with these decay periods are followed.
pub(super) fn is_slow(pace: u32) -> bool {
    pace >= MIN_DECAY_PERIODS
}

/// Evaluations allowed for an instance with these decay periods.
pub(super) fn max_evaluations(pace: u32) -> u32 {
    MAX_EVALUATIONS.0.max(pace / MAX_EVALUATIONS.1)
}

/// An instance to be followed.
pub(super) struct EnvelopeStart {
    /// Number in the plan.
    pub instance: u32,
    pub section: SectionState,
    /// Periods in which free motion decays.
    pub decay_periods: u32,
    /// Evaluations that remain.
    pub max_evaluations: u32,
}

/// Follows these instances and searches where they settle; writes the states it finds to `settled`. Returns the evaluations of
/// each instance: 0 on an engine without Jacobians.
pub(super) fn follow_and_search(
    plan: &Plan,
    from: &[EnvelopeStart],
    settled: &mut OrbitSolution,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Vec<u32>, EngineError> {
    let double = in_double(engine);
    let part = plan.part(&from.iter().map(|one| one.instance).collect::<Vec<u32>>());
    let all: Vec<u32> = part.instances().collect();
    let map = PeriodMap::new(&part, &all, double, progress)?;
    let mut taken = vec![0; from.len()];
    if !map.tells_jacobians() {
        return Ok(taken);
    }
    let mut places: Vec<Option<SectionState>> = vec![None; from.len()];
    for some in map.spread(|slots| follow(&map, from, slots)) {
        for (slot, envelope) in some? {
            let (i, one) = (slot as usize, &from[slot as usize]);
            taken[i] = envelope.evaluations();
            settled.periods[one.instance as usize] += taken[i];
            let rests = envelope.came() == Some(EnvelopeEnd::Settled);
            places[i] = rests.then(|| section(envelope.state().as_slice(), one.section.touching));
        }
    }
    settled.outcome.notes.extend(map.notes());
    let rested = || (0..).zip(&places).filter_map(|(i, place)| Some((i, (*place)?)));
    let (resting, places): (Vec<u32>, Vec<SectionState>) = rested().unzip();
    let part = part.part(&resting);
    let all: Vec<u32> = part.instances().collect();
    let (ran, _) = search_and_verify(&part, &all, InitialGuess::PointsOnly(&places), engine, progress)?;
    let instances: Vec<u32> = resting.iter().map(|i| from[*i as usize].instance).collect();
    settled.take(&instances, ran);
    Ok(taken)
}

/// Follows these slots to their ends. Returns each with its number.
fn follow(
    map: &PeriodMap,
    from: &[EnvelopeStart],
    slots: Range<u32>,
) -> Result<Vec<(u32, Envelope)>, EngineError> {
    let begin = |slot: u32| {
        let EnvelopeStart { section: place, decay_periods: pace, max_evaluations: most, .. } =
            from[slot as usize];
        let modes = map.plan.pairs(slot);
        let told = EnvelopeOptions {
            scale: tolerances::scale(map.plan, slot),
            decay_periods: pace,
            max_evaluations: most,
        };
        (slot, Envelope::new(DVector::from_column_slice(&section_numbers(&place, modes)), told))
    };
    let mut all: Vec<(u32, Envelope)> = slots.map(begin).collect();
    let mut room = Room::default();
    loop {
        let mut open: Vec<_> = all.iter_mut().filter(|(_, one)| one.came().is_none()).collect();
        if open.is_empty() || map.progress.stopped() {
            break;
        }
        let touching = |slot: u32| from[slot as usize].section.touching;
        let start = |(slot, one): &&mut (u32, Envelope)| JacobianStart {
            instance: *slot,
            station: section(one.ask().as_slice(), touching(*slot)),
            least: 0.0,
        };
        let starts: Vec<JacobianStart> = open.iter().map(start).collect();
        let sloped = map.after_with_jacobian(&starts, &mut room)?;
        map.progress.timed(ProfileSection::Algebra, || {
            for ((slot, one), end) in open.iter_mut().zip(sloped) {
                // An end is usable if it is finite and in the same contact as the start.
                let remembers = map.plan.law(*slot).has_hysteresis();
                let same = |end: &SectionState| !remembers || end.touching == touching(*slot);
                let useful = end.filter(|sloped| sloped.end.finite && same(&sloped.end));
                one.tell(useful.map(|PeriodJacobian { end, slope }| {
                    let numbers = slope.len().isqrt();
                    let state = DVector::from_column_slice(&section_numbers(&end, numbers / 2));
                    (state, DMatrix::from_column_slice(numbers, numbers, &slope))
                }));
            }
        });
    }
    Ok(all)
}
