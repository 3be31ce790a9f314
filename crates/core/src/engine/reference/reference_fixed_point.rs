//! The periodic state close to a given one, as a fixed point of the reference's own period map.

use super::step_control::Integrator;
use super::system::{System, far};
use super::{Reference, integrate};
use crate::contact::Contact;
use crate::engine::{EngineError, Finished, Progress};
use crate::kernel::{flown, increments};
use crate::periodic::{FixedPoint, NewtonOptions, PtcNewton, PtcOutcome};
use crate::plan::{Case, Driven, KeptMode, Plan, SectionState};
use crate::scene::{Run, Start};
use nalgebra::{DVector, Dyn};
use std::f64::consts::{PI, TAU};

/// Tolerance on the distance to the periodic state, and the tolerance that is enough, as shares of the requested accuracy; and
/// the least tolerance, in tolerances of the steps.
const NEWTON_TOL_SHARE: f64 = 1e-4;
const FALLBACK_TOL_SHARE: f64 = 1e-2;
const MIN_TOL_OVER_STEP_TOL: f64 = 100.0;
/// Allowed error of the Jacobian due to the steps' tolerance, as a share of the slowest mode's loss in a period; and the least
/// value of that loss.
const JACOBIAN_ERROR_SHARE: f64 = 1e-2;
const MIN_MODE_LOSS: f64 = 1e-5;
/// Finite-difference steps for the Jacobian, in free amplitudes: as the steps allow, and for jumping contacts.
const FD_STEP_SMOOTH: f64 = 1e-5;
const FD_STEP_ROUGH: f64 = 3e-5;
/// A motion of two periods lies on opposite sides of a periodic state at successive starts of a period. It counts as such if
/// its distance shrinks to no less than this share from one to the next.
const ALTERNATION_SHARE: f64 = 0.95;
/// A fixed point with a larger multiplier is unstable. The multiplier of an undamped mode is 1, and differences add some noise.
const UNSTABLE_ABOVE: f64 = 1.1;
/// A mode is next to a harmonic of the drive if its periodic motion exceeds the force's effect in a period by this factor. It
/// is then left to settle by itself, or becomes an unknown.
const RESONANCE_RATIO: f64 = 100.0;
/// Periods before a first and a second search, in which modes that the stepped engine does not keep begin to move; most
/// evaluations of the map; most searches after each, every one with more unknowns; periods measured at the end.
const WARM_UP_PERIODS: [u32; 2] = [4, 12];
const MAX_EVALUATIONS: u32 = 200;
const MAX_SEARCHES: u32 = 4;
const MEASURED_PERIODS: u32 = 4;
/// Modes that a search adds to its unknowns, and the least damping ratio of added ones: undamped modes never settle.
const MAX_WIDENED_MODES: usize = 6;
const MIN_SLOW_DAMPING: f64 = 1e-5;
/// Iterations for a force between a sample and a spring, and the least slope that one divides by: a spring that snaps in has none.
const STATIC_FORCE_ITERATIONS: usize = 20;
const MIN_STATIC_SLOPE: f64 = 0.1;
/// A mode rests if it moves by less than this share of the tolerance in a period: a stiff contact feels it all the same.
const REST_TOL_SHARE: f64 = 1e-2;

/// The periodic state of an instance close to `station`, where a stepped engine was at a period's start. `None` if no state is
/// found, or if the motion, which takes two periods, passes the state on alternate sides. Many times cheaper than
/// [`super::solve`], which integrates to it; but it does not tell whether integration would end there.
///
/// # Errors
/// An instance that the plan does not have, a tolerance out of range, a tip that no mode moves.
pub fn solve_near(
    plan: &Plan,
    instance: usize,
    station: &SectionState,
    options: &Reference,
    progress: &Progress,
) -> Result<Option<Finished>, EngineError> {
    let (case, driven) = options.checked(plan, instance)?;
    let system = System::new(&case, driven, Start::Steady, options.model, far(options.tolerance));
    if system.modes() == 0 {
        return Err(EngineError::NoModes);
    }
    let (all, slow) = unknowns(&system, &case, driven, station);
    let remembers = case.contact.law.has_hysteresis();
    let (scale, accuracy) = (system.length(), plan.run.accuracy);
    let step = if remembers { FD_STEP_ROUGH } else { FD_STEP_SMOOTH };
    let lost = least_lost(&system, driven, &slow);
    let aim = (NEWTON_TOL_SHARE * accuracy).max(MIN_TOL_OVER_STEP_TOL * options.tolerance);
    let walk = Integrator::new(system, options.tolerance.min(JACOBIAN_ERROR_SHARE * step * lost));
    let mut map = Map { walk, remembers, touching: station.touching, slow, before: all.clone(), after: all };
    let options = NewtonOptions {
        scale,
        tolerance: aim,
        fallback_tolerance: FALLBACK_TOL_SHARE * accuracy,
        fd_step: step,
        central_fd_step: None,
        jacobian_columns: None,
        max_evaluations: MAX_EVALUATIONS,
        start_is_close: true,
        reuse_jacobian: false,
        stable_below_fd: 0.99,
        stable_below: 0.99,
        // The multipliers of undamped modes that the stepped engine does not keep are 1.
        require_stable: false,
    };
    let Some(found) = map.find(options, progress) else {
        return Ok(None);
    };
    map.begin(&map.with_slow(&map.after, &found.state));
    // The first period has no predecessor, and the second one's change is not judged.
    let run = Run {
        periods: MEASURED_PERIODS + 2,
        measure: MEASURED_PERIODS,
        start: Start::Steady,
        ..plan.run.clone()
    };
    let case = Case { least_change: Some(found.spectrum.sigma_min), ..case };
    Ok(Some(integrate(&mut map.walk, (&run, plan.wants), &case, driven, progress)))
}

/// The section state as unknowns at the period's very start, half a step earlier, and the indices of the section state's own
/// modes. The reference's other modes share the travel of its other oscillators as they would bend under a static force:
/// otherwise a tip held in contact would begin beside the sample. Modes that the section state has as means over a step bend
/// under the force there.
fn unknowns(
    system: &System,
    case: &Case,
    driven: &Driven,
    station: &SectionState,
) -> (DVector<f64>, Vec<usize>) {
    let modes = system.modes();
    let half = PI / (driven.free.omega * f64::from(case.steps));
    let is_mean = |k: usize| driven.kept.stored_share(&driven.kept.modes[k], 2.0 * half) != 1.0;
    let mut state = DVector::zeros(system.remembered());
    let mut slow = Vec::new();
    let (mut others, mut springs) = (Vec::new(), Vec::new());
    let mut rest: Vec<usize> = (0..driven.kept.modes.len()).collect();
    let at_start = |k: usize, omega: f64, damping: f64| {
        let [x, u] = flown(-omega * half, damping, [station.x[k], station.u[k]]);
        [x, u * omega / driven.free.omega]
    };
    for (place, index) in system.indices.iter().enumerate() {
        let (omega, damping) = system.oscillator(place);
        // Oscillators that are not modes correspond by equal frequency.
        let same = |mode: &KeptMode| {
            mode.index == *index && (index.is_some() || (mode.omega - omega).abs() < 1e-9 * omega)
        };
        let Some(k) = driven.kept.modes.iter().position(same) else {
            others.push(place);
            continue;
        };
        match is_mean(k) {
            true => springs.push(place),
            false => [state[place], state[modes + place]] = at_start(k, omega, damping),
        }
        rest.retain(|other| *other != k);
        slow.extend([place, modes + place]);
    }
    let (means, rest): (Vec<usize>, Vec<usize>) = rest.into_iter().partition(|k| is_mean(*k));
    let [rest_x, rest_u] = rest
        .into_iter()
        .map(|k| at_start(k, driven.kept.modes[k].omega, driven.kept.modes[k].damping))
        .fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    let given_way: f64 = means.into_iter().map(|k| driven.kept.modes[k].flexibility()).sum();
    let bends = given_way + springs.iter().map(|place| system.flexibility_of(*place)).sum::<f64>();
    let held = -(case.gap + driven.free_amplitude() + state.rows(0, modes).sum() + rest_x);
    let force = static_force(&case.contact, held, station.touching, bends);
    springs.into_iter().for_each(|place| state[place] = system.flexibility_of(place) * force);
    let whole: f64 = others.iter().map(|place| system.flexibility_of(*place)).sum();
    for place in others.into_iter().filter(|_| whole > 0.0) {
        let share = system.flexibility_of(place) / whole;
        state[place] = share * (rest_x + given_way * force);
        state[modes + place] = share * rest_u;
    }
    // The law's memory does not change in the half step: it is that of the period's very start.
    let kept = driven.kept.modes.len();
    for (place, number) in
        (2 * modes..state.len()).zip([station.x, station.u].map(|all| all.get(kept).copied().unwrap_or(0.0)))
    {
        state[place] = number;
        slow.push(place);
    }
    (state, slow)
}

/// Force (N) at the indentation `held` (m) less what a spring of the flexibility `bends` (m/N) gives way.
fn static_force(contact: &Contact, held: f64, touching: bool, bends: f64) -> f64 {
    let mut force = 0.0;
    if bends > 0.0 {
        for _ in 0..STATIC_FORCE_ITERATIONS {
            let depth = held - bends * force;
            let miss = contact.force(depth, touching) - force;
            force += miss / (1.0 + bends * contact.stiffness(depth, touching)).max(MIN_STATIC_SLOPE);
        }
    }
    force
}

/// Share of its amplitude that the slowest of these modes loses in a period by itself.
fn least_lost(system: &System, driven: &Driven, slow: &[usize]) -> f64 {
    let loss = |place: &usize| {
        let (omega, damping) = system.oscillator(*place);
        -(-TAU * damping * omega / driven.free.omega).exp_m1()
    };
    let kept = slow.iter().filter(|place| **place < system.modes());
    kept.map(loss).fold(1.0, f64::min).max(MIN_MODE_LOSS)
}

/// One period of the reference, as a map of the modes that the stepped engine keeps. The others, faster and of small share,
/// are carried along.
struct Map {
    walk: Integrator,
    /// Whether contact depends on the past, and its value at a period's start.
    remembers: bool,
    touching: bool,
    /// Indices of the kept modes among the unknowns.
    slow: Vec<usize>,
    /// All unknowns at the start of the last period that continued the motion, and at its end.
    before: DVector<f64>,
    after: DVector<f64>,
}

impl Map {
    /// Searches for the periodic state once the modes that are not kept have begun to move; `None` if it is unstable or the
    /// motion passes it on alternate sides.
    fn find(&mut self, options: NewtonOptions, progress: &Progress) -> Option<FixedPoint<Dyn>> {
        let (mut found, mut passed) = (None, Vec::new());
        for periods in WARM_UP_PERIODS {
            for _ in 0..periods {
                if progress.stopped() {
                    return None;
                }
                self.go_on(&self.slow_part(&self.after))?;
                passed.push(self.after.clone());
            }
            let warm = self.after.clone();
            found = self.at_rest(options, progress);
            if found.is_some() {
                break;
            }
            // Modes that the stepped engine does not keep may still ring for long: a second search includes more of them, and
            // starts later.
            self.after = warm;
            let more: Vec<usize> = self.others().take(MAX_WIDENED_MODES).collect();
            self.widen(&more);
        }
        let least = 10.0 * options.tolerance * options.scale;
        found.filter(|found| {
            found.spectrum.multiplier < UNSTABLE_ABOVE && !self.alternates(&passed, &found.state, least)
        })
    }

    /// The fixed point at which the modes that are not unknowns are at rest, too. Those that are not become unknowns.
    fn at_rest(&mut self, options: NewtonOptions, progress: &Progress) -> Option<FixedPoint<Dyn>> {
        let least = REST_TOL_SHARE * options.tolerance * options.scale;
        for _ in 0..MAX_SEARCHES {
            let found = self.search(options, progress)?;
            let before = self.after.clone();
            self.go_on(&found.state)?;
            let moved = |place: &usize| (self.after[*place] - before[*place]).abs();
            let mut moving: Vec<usize> = self.others().filter(|place| moved(place) > least).collect();
            if moving.is_empty() {
                return Some(found);
            }
            moving.sort_by(|a, b| moved(b).total_cmp(&moved(a)));
            moving.truncate(MAX_WIDENED_MODES);
            self.widen(&moving);
        }
        None
    }

    /// Damped modes that are not among the unknowns, those first that the tip force moves most.
    fn others(&self) -> impl Iterator<Item = usize> {
        let system = &self.walk.system;
        (0..system.modes())
            .filter(|place| system.oscillator(*place).1 > MIN_SLOW_DAMPING && !self.slow.contains(place))
    }

    fn widen(&mut self, more: &[usize]) {
        let modes = self.walk.system.modes();
        self.slow.extend(more.iter().flat_map(|place| [*place, modes + place]));
    }

    /// The fixed point close to the end of the last period.
    fn search(&mut self, options: NewtonOptions, progress: &Progress) -> Option<FixedPoint<Dyn>> {
        let mut search = PtcNewton::new(self.slow_part(&self.after), options);
        while search.verdict().is_none() {
            let states: Vec<_> = search.ask().collect();
            if progress.stopped() {
                return None;
            }
            let values: Vec<_> = match states.as_slice() {
                [state] => vec![self.go_on(state)],
                many => many.iter().map(|state| self.aside(state)).collect(),
            };
            search.tell(&values);
        }
        match search.verdict() {
            Some(PtcOutcome::Converged(found)) => Some((**found).clone()),
            _ => None,
        }
    }

    fn slow_part(&self, all: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(self.slow.len(), self.slow.iter().map(|place| all[*place]))
    }

    fn with_slow(&self, all: &DVector<f64>, slow: &DVector<f64>) -> DVector<f64> {
        let mut state = all.clone();
        self.slow.iter().zip(slow.iter()).for_each(|(place, value)| state[*place] = *value);
        state
    }

    fn begin(&mut self, state: &DVector<f64>) {
        let size = state.len();
        self.walk.y[..size].copy_from_slice(state.as_slice());
        let system = &mut self.walk.system;
        let delta = system.indentation_of(0.0, state.as_slice()).0;
        system.branch = match self.remembers {
            true => system.force.branch_after(delta, self.touching),
            false => system.force.branch_at(delta),
        };
    }

    /// All unknowns a period later.
    fn period(&mut self, state: &DVector<f64>) -> Option<DVector<f64>> {
        self.begin(state);
        let finite = self.walk.period(0, None);
        let same = !self.remembers || self.walk.system.past() == self.touching;
        (finite && same).then(|| DVector::from_column_slice(&self.walk.y[..state.len()]))
    }

    /// A period from these kept modes; the others continue from the last period.
    fn go_on(&mut self, slow: &DVector<f64>) -> Option<DVector<f64>> {
        self.before = self.with_slow(&self.after, slow);
        let end = self.period(&self.before.clone())?;
        self.after = self.settled(&self.before, &end);
        Some(self.slow_part(&end))
    }

    /// The end of a period, with the modes that are not unknowns at the state where they would settle if every period acted on
    /// them like this one. The contact force hardly depends on them. Undamped modes never settle.
    fn settled(&self, start: &DVector<f64>, end: &DVector<f64>) -> DVector<f64> {
        let system = &self.walk.system;
        let (modes, mut settled) = (system.modes(), end.clone());
        for place in (0..modes).filter(|place| !self.slow.contains(place)) {
            let (omega, damping) = system.oscillator(place);
            if damping <= MIN_SLOW_DAMPING {
                continue;
            }
            let ratio = omega / system.omega;
            let state = |all: &DVector<f64>| [all[place], all[modes + place] / ratio];
            let [m00, m01, m10, m11] = increments(TAU * ratio, damping);
            let ([x, u], [begun_x, begun_u]) = (state(end), state(start));
            // The mode's own change in a period must balance the push.
            let pushed = [
                x - begun_x - (m00 * begun_x + m01 * begun_u),
                u - begun_u - (m10 * begun_x + m11 * begun_u),
            ];
            let determinant = m00 * m11 - m01 * m10;
            if determinant.abs().sqrt() * RESONANCE_RATIO < 1.0 {
                continue;
            }
            settled[place] = (m01 * pushed[1] - m11 * pushed[0]) / determinant;
            settled[modes + place] = (m10 * pushed[0] - m00 * pushed[1]) / determinant * ratio;
        }
        settled
    }

    /// Whether the last two periods lie on opposite sides of this state, farther from it than `least` (m), and do not approach
    /// it.
    fn alternates(&self, passed: &[DVector<f64>], state: &DVector<f64>, least: f64) -> bool {
        let [.., before, last] = passed else { return false };
        let [before, last] = [before, last].map(|one| self.slow_part(one) - state);
        let (far, farther) = (before.norm(), last.norm());
        farther > least
            && farther > ALTERNATION_SHARE * far
            && before.dot(&last) < -ALTERNATION_SHARE * far * farther
    }

    /// A period from these kept modes, with the others as at the start of the last period: for differences.
    fn aside(&mut self, slow: &DVector<f64>) -> Option<DVector<f64>> {
        let end = self.period(&self.with_slow(&self.before, slow))?;
        Some(self.slow_part(&end))
    }
}
