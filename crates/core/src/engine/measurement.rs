//! Converts sums over periods to measurements in SI units, and judges whether they can be trusted.

use super::Finished;
use super::kernel_constants::force_scale;
use super::start;
use crate::contact::{Law, Passed};
use crate::kernel::{LENGTH, RunSums};
use crate::observe::{Measured, MeasuredSums, Status, Wants};
use crate::plan::{Case, Driven};
use crate::scene::{Run, Start};
use nalgebra::Complex;

/// One instance's run sums in f64, and whether its state stayed finite.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// False once the state is not finite, or beyond f32's range.
    pub finite: bool,
    periods: f64,
    steps: f64,
    run_sums: RunSums<f64>,
}

/// Stiffness at the deepest indentation, in units of the step, above which a contact lasts fewer than about four steps and the
/// result cannot be trusted.
const UNRESOLVED_SHARE: f64 = 0.7;

/// If the measured periods differ in their contacts, the remaining change may be only this share of what is allowed otherwise.
const UNEVEN_SHARE: f64 = 1e-2;

/// A force that moves the tip by less than this share of its free amplitude is rounding.
const UNFELT_FORCE_SHARE: f64 = 1e-12;

impl Sums {
    /// Run sums over `periods` measured periods of `steps` steps.
    pub fn new(run_sums: RunSums<f64>, finite: bool, periods: u32, steps: u32) -> Self {
        let periods = f64::from(periods);
        Self { finite, periods, steps: periods * f64::from(steps), run_sums }
    }

    /// Largest change (m) of the fundamental, among the latest ones and those into a measured period.
    fn change(&self) -> f64 {
        self.run_sums.changes.iter().copied().fold(self.run_sums.largest, f64::max) * LENGTH
    }
}

/// Bound on the distance (m) of the fundamental from its final value. It follows from its latest change (m) and
/// `least_change`, or else from the slowest kept mode's decay over a period: a geometric series of changes no longer than
/// that.
fn unsettled(change: f64, least_change: Option<f64>, driven: &Driven) -> f64 {
    if let Some(share) = least_change {
        return if change == 0.0 { 0.0 } else { change / share };
    }
    let decay = driven
        .kept
        .modes
        .iter()
        .map(|mode| -(std::f64::consts::TAU * mode.damping * mode.omega / driven.free.omega).exp_m1().abs())
        .map(f64::abs)
        .fold(f64::INFINITY, f64::min);
    if change == 0.0 { 0.0 } else { change / decay.min(1.0) }
}

/// Whether the remaining change is within the requested accuracy, after `contacts` contacts in the measured periods.
///
/// A state with the drive's period has equally many contacts in each of them. A state that touches only in every second period
/// is another one, though its fundamental may hardly show it. So it must be much closer to rest than any other, as a tip is
/// that grazes the sample.
pub(super) fn settled(
    change: f64,
    contacts: f64,
    least_change: Option<f64>,
    driven: &Driven,
    run: &Run,
) -> bool {
    // The scale of accuracy for amplitudes: the free amplitude, or, without a drive, a femtometre.
    let scale = driven.free_amplitude().max(1e-15);
    // A change that is NaN is left to the check of the state.
    let left = unsettled(change, least_change, driven);
    let uneven = contacts % f64::from(run.measure) != 0.0;
    left <= if uneven { UNEVEN_SHARE } else { 1.0 } * run.accuracy * scale || left.is_nan()
}

/// The first period whose fundamental counts: the one before the first judged change. The last four changes and every measured
/// one are judged.
pub(super) fn first_seen(run: &Run) -> u32 {
    run.periods.saturating_sub(run.measure.max(4)).saturating_sub(1)
}

/// Measurements of an instance that was stepped.
pub(super) fn finish(sums: &Sums, case: &Case, driven: &Driven, run: &Run, wants: Wants) -> Finished {
    if !sums.finite {
        return Finished { measured: Measured::NONE, status: Status::NonFinite };
    }
    let run_sums = &sums.run_sums;
    let phase = start::phase(driven, run.start);
    let (cosine, sine) = start::amplitudes(driven, run.start);
    let mut measured = Measured { gap: case.gap, ..Measured::NONE };
    let scale = 2.0 / sums.steps * LENGTH;
    for n in 0..wants.harmonics {
        let free = if n == 0 { (cosine, sine) } else { (0.0, 0.0) };
        let travel = start::phasor(
            free.0 + scale * run_sums.cosine[n],
            free.1 + scale * run_sums.sine[n],
            n + 1,
            phase,
        );
        measured.harmonics[n] = travel.norm();
        if n == 0 {
            fundamental(&mut measured, travel, driven);
        }
    }
    let force = force_scale(driven, case.steps);
    let summed = MeasuredSums {
        sums: run_sums.sums,
        periods: sums.periods,
        span: sums.steps,
        force,
        length: LENGTH,
        bending: driven.free.bending,
    };
    measured.take_sums(Some(&summed), wants);
    if wants.extremes {
        let passed = passed(run_sums, force);
        (measured.force_min, measured.force_max) = case.contact.law().forces(&passed);
        // Contact begins at the surface: a contact between two steps is no shallower, though both may be outside.
        let shallowest = if run_sums.sums.begun > 0.0 { 0.0 } else { f64::NEG_INFINITY };
        // A force that remembers may form and break without contact.
        let touched = match case.contact.law {
            Law::HystereticSum => run_sums.sums.time > 0.0,
            _ => passed.touched,
        };
        measured.indentation_max = if touched { passed.deepest.max(shallowest) } else { f64::NAN };
    }
    let status = judge(sums, case, driven, run, force);
    // The numbers of a free oscillation are known in closed form.
    match status {
        Status::Ok if wants.energy && run.start == Start::Steady && is_free(&measured, case, driven) => {
            finish_free(case.gap, driven, wants)
        }
        _ => Finished { measured, status },
    }
}

/// Whether a steady state beyond the reach of its free oscillation is just that: the sample's force is only rounding.
fn is_free(measured: &Measured, case: &Case, driven: &Driven) -> bool {
    let amplitude = driven.free_amplitude();
    let force = UNFELT_FORCE_SHARE * amplitude / driven.free.compliance.norm();
    case.contact.is_out_of_reach(amplitude, case.gap)
        && measured.force_mean.abs() <= force
        && measured.virial.abs().max(measured.dissipation.abs()) <= force * amplitude
}

/// Measurements of an instance that stays free of the sample: its free motion.
pub(super) fn finish_free(gap: f64, driven: &Driven, wants: Wants) -> Finished {
    let mut measured = Measured { gap, ..Measured::NONE };
    measured.harmonics[..wants.harmonics].fill(0.0);
    measured.harmonics[0] = driven.free_amplitude();
    fundamental(&mut measured, driven.free.tip, driven);
    measured.take_sums(None, wants);
    if wants.extremes {
        (measured.force_min, measured.force_max) = (0.0, 0.0);
    }
    Finished { measured, status: Status::Ok }
}

/// Sets all that follows from the fundamental of the tip's travel, except its amplitude.
pub(super) fn fundamental(measured: &mut Measured, travel: Complex<f64>, driven: &Driven) {
    let deflection = driven.free.deflection(travel);
    measured.phase = lag(travel.arg());
    (measured.deflection_amplitude, measured.deflection_phase) = (deflection.norm(), lag(deflection.arg()));
    measured.free_phase = lag(driven.free.angle);
    measured.frequency_shift = driven.free.frequency_shift(travel);
}

/// Lag behind the drive's sine of a phasor with this argument (rad), degree, 0 to below 360.
pub(crate) fn lag(angle: f64) -> f64 {
    let lag = (-angle.to_degrees()).rem_euclid(360.0);
    // The remainder of a tiny negative number rounds up to the whole turn, and -0 is no phase.
    if lag < 360.0 { lag + 0.0 } else { 0.0 }
}

fn judge(sums: &Sums, case: &Case, driven: &Driven, run: &Run, force: f64) -> Status {
    let deepest = sums.run_sums.sums.deepest * LENGTH;
    // A viscous contact is as stiff as its force changes within a step; of one that relaxes the stiffness is that at once.
    let steps =
        case.contact.viscous_time() * driven.free.omega / std::f64::consts::TAU * f64::from(case.steps);
    let stiffness = case.contact.stiffness(deepest, true) * (1.0 + steps);
    if deepest > 0.0 && stiffness * force * LENGTH > UNRESOLVED_SHARE {
        return Status::OutOfRange;
    }
    if !settled(sums.change(), sums.run_sums.sums.begun, case.least_change, driven, run) {
        return Status::NotSteady;
    }
    Status::Ok
}

/// Extremes and contact events of the tip's motion.
fn passed(run_sums: &RunSums<f64>, force: f64) -> Passed {
    let sums = &run_sums.sums;
    Passed {
        deepest: sums.deepest * LENGTH,
        highest: sums.highest * LENGTH,
        held: sums.held * LENGTH,
        touched: sums.time > 0.0 || sums.begun > 0.0,
        apart: sums.apart > 0.0,
        let_go: sums.ended > 0.0,
        forces: (sums.weakest / force, sums.strongest / force),
    }
}
