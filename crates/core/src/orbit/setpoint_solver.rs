//! Set-points: the secant method for the gap, with a periodic state at each gap that it tries.

use super::setpoint_continuation::{self, ApproachEnd, MAX_DEPTH_AMPLITUDES};
use super::setpoint_residual::setpoint_residual;
use super::{OrbitSolution, PeriodicState, solve};
use crate::engine::{Engine, EngineError, Finished, Progress, in_double};
use crate::observe::Status;
use crate::plan::{BasisRule, Plan};
use crate::scene::Held;

/// Gaps are tried until the residual is at most this share of the accuracy, and the gap is known to this share of the accuracy
/// in free amplitudes. After the last one the whole accuracy will do.
const SETPOINT_TOL_SHARE: f64 = 0.05;
/// Gaps tried in one run of an instance: as many as halving brackets takes.
const MAX_SECANT_STEPS: u32 = 40;
/// Gaps at which no motion is found before [`hold_setpoint`] gives up.
const MAX_FAILED_GAPS: u32 = 3;
/// A residual above this share of the one before falls too slowly: the bracket is halved.
const SLOW_SECANT: f64 = 0.5;
/// Longest step from one gap to the next, in free amplitudes.
const MAX_GAP_STEP_AMPLITUDES: f64 = 0.05;
/// Largest growth of a step, relative to the one before.
const MAX_GAP_STEP_GROWTH: f64 = 8.0;

/// The first run of a plan with set-points: approaches each from far away, then holds it. The approach uses the smallest
/// bases, and the plan's own where the set-point is not held after that.
pub(super) fn solve_first(
    plan: &mut Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let poorest = BasisRule::shares(plan.policy.poorest);
    let wanted: Vec<(u32, BasisRule)> = plan.stepped().into_iter().map(|i| (i, poorest)).collect();
    let poor = plan.with_bases(&wanted);
    let (mut settled, mut too_deep) = approach_and_hold(plan, &poor, engine, progress)?;
    let richer = |i: &u32| plan.driven(*i).kept.modes != poor.driven(*i).kept.modes;
    let steady = |i: &u32| settled.outcome.results[*i as usize].status.is_steady();
    let astray: Vec<u32> = plan.stepped().into_iter().filter(|i| richer(i) && !steady(i)).collect();
    approach_again(plan, &astray, (&mut settled, &mut too_deep), engine, progress)?;
    settled.outcome.notes.extend(depths(&settled, &too_deep));
    Ok(settled)
}

/// Approaches the set-points of these instances once more, with the plan's own steps and bases.
fn approach_again(
    plan: &mut Plan,
    astray: &[u32],
    (settled, too_deep): (&mut OrbitSolution, &mut Vec<(u32, f64)>),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(), EngineError> {
    if !astray.is_empty() && !progress.stopped() {
        let far: Vec<f64> = astray.iter().map(|i| plan.ensemble.gap(plan.id(*i))).collect();
        let mut part = plan.part(astray).with_gaps(&far);
        let own = part.clone();
        let (again, deeper) = approach_and_hold(&mut part, &own, engine, progress)?;
        too_deep.retain(|(i, _)| astray.binary_search(i).is_err());
        too_deep.extend(deeper.into_iter().map(|(place, miss)| (astray[place as usize], miss)));
        plan.take_gaps(astray, &part);
        settled.take(astray, again);
    }
    Ok(())
}

/// A note on the residuals of set-points that are not met down to the largest depth.
fn depths(settled: &OrbitSolution, too_deep: &[(u32, f64)]) -> Option<String> {
    let is_lost = |(i, _): &&(u32, f64)| settled.outcome.results[*i as usize].status == Status::NoSetpoint;
    let lost: Vec<f64> = too_deep.iter().filter(is_lost).map(|(_, miss)| *miss).collect();
    let (least, most) = (lost.iter().copied().reduce(f64::min)?, lost.iter().copied().reduce(f64::max)?);
    Some(format!(
        "{} set-points are not met as deep below the surface as they are looked for ([approach] deepest, {MAX_DEPTH_AMPLITUDES} free amplitudes \
         without it). There they are still missed by {least:.3} to {most:.3}, as shares of the free amplitude or of the force, or \
         in radians",
        lost.len(),
    ))
}

/// Approaches the plan's set-points with the plan `by` of the same instances, then holds them. Also returns those that were
/// not met down to the largest depth.
fn approach_and_hold(
    plan: &mut Plan,
    by: &Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(OrbitSolution, Vec<(u32, f64)>), EngineError> {
    let double = in_double(engine);
    let approached = setpoint_continuation::approach_setpoints(by, double, progress)?;
    let mut gaps: Vec<f64> = plan.cases().map(|case| case.gap).collect();
    let mut states: Vec<Option<PeriodicState>> = vec![None; plan.len()];
    let mut reached = Vec::new();
    for (i, end) in approached.ends.into_iter().enumerate() {
        match end {
            ApproachEnd::Met(gap, state) => {
                (gaps[i], states[i]) = (gap, Some(*state));
                reached.push(i as u32);
            }
            ApproachEnd::None => {
                gaps[i] = f64::NAN;
                reached.push(i as u32);
            }
            ApproachEnd::NotRun => {}
        }
    }
    *plan = plan.clone().with_gaps(&gaps);
    let near: Vec<Option<&PeriodicState>> = states.iter().map(Option::as_ref).collect();
    let mut settled = hold(plan, &reached, &near, engine, progress)?;
    settled.periods.iter_mut().zip(&approached.periods).for_each(|(all, some)| *all += some);
    settled.outcome.notes.splice(0..0, approached.notes);
    Ok((settled, approached.too_deep))
}

/// Runs a plan with set-points again, from gaps and states that held them with other steps or levers. A set-point that is not
/// held near there, or was not held before, is approached anew.
pub(super) fn hold_again(
    plan: &mut Plan,
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let all: Vec<u32> = plan.instances().collect();
    let mut settled = hold(plan, &all, near, engine, progress)?;
    let is_lost = |i: &u32| settled.outcome.results[*i as usize].status == Status::NoSetpoint;
    let lost: Vec<u32> = plan.stepped().into_iter().filter(is_lost).collect();
    approach_again(plan, &lost, (&mut settled, &mut Vec::new()), engine, progress)?;
    Ok(settled)
}

/// The result of an instance whose set-point no gap holds.
pub const NO_SETPOINT: Finished = Finished { status: Status::NoSetpoint, ..Finished::NOT_RUN };

/// Holds the set-points of these instances, and writes the gaps that do so to the plan.
fn hold(
    plan: &mut Plan,
    instances: &[u32],
    near: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let mut gaps: Vec<f64> = plan.cases().map(|case| case.gap).collect();
    let mut all = OrbitSolution::not_run(plan);
    // An instance that feels no sample cannot hold a set-point.
    let none = |i: &&u32| gaps[**i as usize].is_nan() || plan.steps(**i) == 0;
    let (lost, held): (Vec<u32>, Vec<u32>) = instances.iter().partition(none);
    for i in lost {
        (gaps[i as usize], all.outcome.results[i as usize]) = (f64::NAN, NO_SETPOINT);
    }
    let state = |i: u32| near.get(i as usize).copied().flatten();
    let tolerance = SETPOINT_TOL_SHARE * plan.run.accuracy;
    let slope = |i: u32| state(i).and_then(|state| state.gap_slope);
    let begin = |i: u32| GapIterate::new(i, gaps[i as usize], slope(i), tolerance);
    let mut left: Vec<GapIterate> = held.into_iter().map(begin).collect();
    for number in 1..=MAX_SECANT_STEPS {
        if left.is_empty() || progress.stopped() {
            break;
        }
        let (tried, places): (Vec<u32>, Vec<f64>) = left.iter().map(|one| (one.instance, one.gap)).unzip();
        let part = plan.part(&tried).with_gaps(&places);
        let states: Vec<Option<&PeriodicState>> =
            tried.iter().map(|i| all.found[*i as usize].as_deref().or_else(|| state(*i))).collect();
        let mut now = solve(&part, &states, engine, progress)?;
        all.outcome.notes.append(&mut now.outcome.notes);
        let mut next = Vec::new();
        for (place, mut one) in left.into_iter().enumerate() {
            let (i, finished) = (one.instance as usize, now.outcome.results[place]);
            (gaps[i], all.outcome.results[i]) = (one.gap, finished);
            all.periods[i] += now.periods[place];
            all.found[i] = now.found.get_mut(place).and_then(Option::take);
            if !finished.status.is_steady() {
                continue;
            }
            let missed = setpoint_residual(&part, place as u32, &finished);
            one.learn(missed);
            all.found[i].iter_mut().for_each(|state| state.gap_slope = one.slope);
            let error = one.error(missed, part.driven(place as u32).free_amplitude());
            if error <= tolerance {
                continue;
            }
            if number < MAX_SECANT_STEPS {
                one.advance(&part, place as u32, missed, &finished);
                next.push(one);
            } else if error > plan.run.accuracy {
                (gaps[i], all.outcome.results[i], all.found[i]) = (f64::NAN, NO_SETPOINT, None);
            }
        }
        left = next;
    }
    // An instance whose iteration was stopped holds nothing yet.
    left.iter().for_each(|one| all.outcome.results[one.instance as usize] = Finished::NOT_RUN);
    *plan = plan.clone().with_gaps(&gaps);
    Ok(all)
}

/// Holds the set-point of the only instance of a plan, with the motion that `solve` finds at a gap, from the plan's gap on.
/// `tolerance` is that of the residual, and of the gap in free amplitudes. None where `solve` finds no motion, not even nearer to
/// the gap before.
///
/// # Errors
/// Those of `solve`.
pub fn hold_setpoint(
    plan: &Plan,
    tolerance: f64,
    solve: impl Fn(&Plan) -> Result<Option<Finished>, EngineError>,
) -> Result<Option<Finished>, EngineError> {
    let mut one = GapIterate::new(0, plan.case(0).gap, None, tolerance);
    let mut failed = 0;
    for _ in 0..MAX_SECANT_STEPS {
        let at = plan.clone().with_gaps(&[one.gap]);
        let Some(finished) = solve(&at)?.filter(|found| found.status.is_steady()) else {
            let Some((gap, _)) = one.before.filter(|_| failed < MAX_FAILED_GAPS) else { return Ok(None) };
            (one.gap, failed) = (0.5 * (one.gap + gap), failed + 1);
            continue;
        };
        let missed = setpoint_residual(&at, 0, &finished);
        one.learn(missed);
        if one.error(missed, at.driven(0).free_amplitude()) <= tolerance {
            return Ok(Some(finished));
        }
        one.advance(&at, 0, missed, &finished);
    }
    Ok(Some(NO_SETPOINT))
}

/// An instance whose gap is an unknown.
struct GapIterate {
    instance: u32,
    gap: f64,
    /// Of the residual, and of the gap in free amplitudes.
    tolerance: f64,
    /// The slope of the residual over the gap, 1/m, if it is known.
    slope: Option<f64>,
    /// The gap before, and its residual.
    before: Option<(f64, f64)>,
    /// The smallest gap known to be too large, and the largest one known to be too small.
    too_far: f64,
    too_near: f64,
}

impl GapIterate {
    fn new(instance: u32, gap: f64, slope: Option<f64>, tolerance: f64) -> Self {
        let (too_far, too_near) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { instance, gap, tolerance, slope, before: None, too_far, too_near }
    }

    /// Learns from the residual at its gap. One that is no number teaches nothing.
    fn learn(&mut self, missed: f64) {
        if missed.is_nan() {
            return;
        }
        let secant = |(gap, other): (f64, f64)| (missed - other) / (self.gap - gap);
        self.slope = self.before.map_or(self.slope, |before| Some(secant(before)));
        self.slope = self.slope.filter(|slope| slope.is_finite() && *slope > 0.0);
        match missed > 0.0 {
            true => self.too_far = self.too_far.min(self.gap),
            false => self.too_near = self.too_near.max(self.gap),
        }
    }

    /// The bracket around the gap that is looked for, m; infinite as long as there is none.
    fn bracket(&self) -> f64 {
        let width = self.too_far - self.too_near;
        if width > 0.0 { width } else { f64::INFINITY }
    }

    /// The residual, or the error of the gap in free amplitudes, by the slope or by the bracket: whichever is larger.
    fn error(&self, missed: f64, amplitude: f64) -> f64 {
        if missed.is_nan() {
            return f64::INFINITY;
        }
        let by_slope = self.slope.map_or(f64::INFINITY, |slope| missed.abs() / slope);
        missed.abs().max(by_slope.min(self.bracket()) / amplitude)
    }

    /// Moves to the next gap: by the secant, by an estimated slope, or to the middle of the bracket where these leave it or
    /// are slow.
    fn advance(&mut self, part: &Plan, i: u32, missed: f64, finished: &Finished) {
        let amplitude = part.driven(i).free_amplitude();
        let likely = match part.setpoint(i).map(|setpoint| setpoint.held) {
            // The tip follows its sample and presses only a little more.
            Some(Held::Force(_)) => 0.15 / finished.measured.indentation_max.max(1e-3 * amplitude),
            _ => 1.0 / amplitude,
        };
        let most = match self.before {
            Some((gap, _)) => {
                (MAX_GAP_STEP_GROWTH * (self.gap - gap).abs()).min(MAX_GAP_STEP_AMPLITUDES * amplitude)
            }
            None => MAX_GAP_STEP_AMPLITUDES * amplitude,
        };
        let step = match self.slope {
            Some(slope) => -missed / slope,
            // Shorter ones tell no slope: what the residual changes by is noise.
            None => -missed.signum() * (missed.abs() / likely).max(self.tolerance * amplitude),
        };
        let step = step.clamp(-most, most);
        let is_slow = self.before.is_some_and(|(_, other)| missed.abs() > SLOW_SECANT * other.abs());
        self.before = Some((self.gap, missed));
        self.gap += step;
        let (low, high) = (self.too_near, self.too_far);
        let is_inside = low < self.gap && self.gap < high;
        if self.bracket().is_finite() && (self.slope.is_none() || is_slow || !is_inside) {
            self.gap = 0.5 * (low + high);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::Measured;
    use crate::test_plans::plan_of;

    /// Truth: the gap of an amplitude that falls steeply, of which nothing is found a little below that gap.
    #[test]
    fn a_set_point_is_held_next_to_gaps_without_a_motion() {
        let plan = plan_of(include_str!("../../../../scenes/set_point.toml")).part(&[0]);
        let free = plan.driven(0).free_amplitude();
        let Some(Held::Amplitude(share)) = plan.setpoint(0).map(|setpoint| setpoint.held) else {
            panic!("the scene holds an amplitude")
        };
        let truth = plan.case(0).gap - 0.01 * free;
        let motion = |at: &Plan, lowest: f64| {
            let gap = at.case(0).gap;
            let mut measured = Measured { gap, ..Measured::NONE };
            measured.harmonics[0] = share * free + 3.0 * (gap - truth);
            Ok((gap > lowest).then_some(Finished { measured, status: Status::Ok }))
        };
        let near = hold_setpoint(&plan, 1e-6, |at| motion(at, truth - 1e-3 * free)).unwrap().unwrap();
        assert!((near.measured.gap - truth).abs() < 1e-6 * free, "{} {truth}", near.measured.gap);
        let none = hold_setpoint(&plan, 1e-6, |at| motion(at, plan.case(0).gap)).unwrap();
        assert!(none.is_none());
    }
}
