//! Errors of energy that turn the phase of a state.
//!
//! The drive brings to the tip what contact and lever take. An energy that an approximation adds or omits changes what it must
//! bring. A contact holds the tip's amplitude, so the phase turns until the balance is right: at a high quality factor, where
//! the drive brings little, far.

use super::missed_compliance::{FoundMotion, fundamental, lasting_response};
use crate::observe::{Measured, Observable};
use crate::plan::{Plan, Resonance};
use std::f64::consts::{FRAC_2_PI, PI};

/// Error of an instance's phase, on its scale, if the energy `work` (J) is wrong in each period.
///
/// The fundamental of the contact force must bring it, so that its part in phase with the tip's speed changes by
/// work / (pi A), with the tip's amplitude A. The drive, F_0 as a force on the tip, balances this part.
fn phase_error(plan: &Plan, instance: u32, measured: &Measured, work: f64) -> f64 {
    let driven = plan.driven(instance);
    let (amplitude, drive) = (measured.harmonics[0], driven.free.tip / driven.free.compliance);
    if work == 0.0 {
        return 0.0;
    }
    let part = (work / (PI * amplitude * drive.norm())).abs();
    // At the top of a resonance, where the cosine is 0, the phase turns by the root.
    let balance = (drive.arg() + measured.phase.to_radians()).cos().abs().max(part.sqrt());
    part / balance * (amplitude / driven.free_amplitude()).min(1.0)
}

/// Bound on the error of phase, force or travel, whichever is worst and whether requested or not, from the resonant modes that
/// its basis leaves out, by the measured force.
///
/// The n-th harmonic F_n of the contact force moves such a mode, which takes the energy pi n c F_n^2 out of each period; c is
/// its compliance out of phase.
pub(super) fn missed_resonances(plan: &Plan, instance: u32, found: FoundMotion) -> f64 {
    let measured = found.measured;
    let contact = plan.contact(instance);
    let driven = plan.driven(instance);
    let waiting = &driven.kept.waiting;
    if waiting.is_empty() {
        return 0.0;
    }
    let fundamental = fundamental(driven, measured).norm();
    let force = |one: &Resonance| match one.harmonic {
        1.0 => fundamental,
        harmonic => harmonic_bound(measured, harmonic, contact.law.jumps()),
    };
    let taken = |one: &Resonance| PI * one.harmonic * -one.compliance().im * force(one).powi(2);
    let of_phase = phase_error(plan, instance, measured, waiting.iter().map(taken).sum());
    let gives_way = |one: &Resonance| lasting_response(plan, instance, measured, one.harmonic);
    let moved = waiting.iter().map(|one| one.compliance().norm() * force(one) * gives_way(one)).sum::<f64>();
    let stiffness = contact.stiffness(measured.indentation_max.max(0.0), true).abs();
    let largest = measured.force_max.abs().max(measured.force_min.abs());
    let of_force = if largest > 0.0 { stiffness * moved / largest } else { 0.0 };
    let of_travel = found.travel_error(plan, instance, moved);
    let error = of_phase.max(of_force).max(of_travel);
    // A number that nobody measured must not pass for 0.
    if moved.is_nan() || of_phase.is_nan() { f64::INFINITY } else { error }
}

/// Error of an instance's phase from what steps add or take. A contact that loses nothing shows it: its measured dissipation is
/// the steps' alone. 0 under any other contact, without a measured dissipation, or if the phase is not requested.
pub(super) fn work_of_steps(plan: &Plan, instance: u32, measured: &Measured) -> f64 {
    let contact = plan.contact(instance);
    if !contact.is_reversible() || !plan.observables.contains(&Observable::Phase) {
        return 0.0;
    }
    let error = phase_error(plan, instance, measured, measured.dissipation);
    if error.is_finite() { error } else { 0.0 }
}

/// Bound of a harmonic of the contact force, N. Repulsion is a pulse like half a sine, unless its law has jumps (`force_jumps`);
/// attraction counts as if it lasted for no time.
fn harmonic_bound(measured: &Measured, harmonic: f64, force_jumps: bool) -> f64 {
    let repulsion = FRAC_2_PI * measured.force_max.max(0.0) * measured.contact_time;
    let attraction = (repulsion - measured.force_mean).max(0.0);
    let pulse_angle = 2.0 * harmonic * measured.contact_time / measured.contacts.max(1.0);
    let envelope = if force_jumps || pulse_angle <= 1.0 {
        1.0
    } else {
        (pulse_angle * pulse_angle - 1.0).recip().min(1.0)
    };
    2.0 * (repulsion * envelope + attraction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control;
    use crate::control::difference_scale::scaled_difference;
    use crate::control::first_estimate::EstimateInputs;
    use crate::control::{ChunkRun, precision_trial, refinement};
    use crate::engine::{Cpu, Finished, Progress};
    use crate::orbit;
    use crate::plan::BasisRule;
    use crate::test_plans::plan_of;
    use std::f64::consts::TAU;

    fn result(plan: &Plan) -> Finished {
        orbit::solve(plan, &[], &Cpu::default(), &Progress::default()).expect("it runs").outcome.results[0]
    }

    /// Closed form: harmonics of a pulse like half a sine that lasts for a share of the period.
    #[test]
    fn no_harmonic_of_half_a_sine_exceeds_the_bound() {
        let share = 0.13;
        let measured = Measured {
            force_max: 1.0,
            force_mean: FRAC_2_PI * share,
            contact_time: share,
            contacts: 1.0,
            ..Measured::NONE
        };
        let count = 4000;
        for n in 1..30 {
            let sum: f64 = (0..count)
                .map(|k| (f64::from(k) + 0.5) / f64::from(count))
                .map(|x| (PI * x).sin() * (TAU * f64::from(n) * share * (x - 0.5)).cos())
                .sum();
            let harmonic = 2.0 * share * (sum / f64::from(count)).abs();
            let bound = harmonic_bound(&measured, f64::from(n), false);
            assert!(harmonic <= bound * (1.0 + 1e-6), "{n}: {harmonic} {bound}");
            assert!(n > 1 || harmonic > 0.9 * bound);
        }
    }

    /// Truth: the same states with all modes that harmonics meet, from the start. A tap needs them; the tip that hovers 2 nm
    /// higher does not.
    #[test]
    fn faint_modes_join_where_the_force_asks_for_them() {
        let taps = include_str!("../../../../tests/hard/rod_met.toml");
        let hovers = taps.replace("gap = \"17 nm\"", "gap = \"19.9 nm\"");
        let run = |plan: &Plan| -> ChunkRun {
            let (engine, progress) = (Cpu::default(), Progress::default());
            let chosen = precision_trial::choose(plan, &[0], &engine, &progress).expect("nothing is open");
            let first = EstimateInputs::alone(None, vec![0.0], &chosen);
            refinement::run(plan.clone(), &[0], first, &engine, &progress).expect("it runs")
        };
        for (text, joins) in [(taps, true), (&hovers, false)] {
            let plan = plan_of(text);
            let all = plan.clone().with_waiting_modes().with_steps(|steps| 4 * steps);
            let (ours, truth) = (run(&plan), result(&all));
            let error = scaled_difference(&plan, 0, &ours.outcome.results[0], &truth);
            assert_eq!(ours.plan.driven(0).kept.waiting.is_empty(), joins);
            assert!(!plan.driven(0).kept.waiting.is_empty() && all.driven(0).kept.waiting.is_empty());
            assert!(error <= ours.estimates[0].max(1e-4), "{error:e} {:e}", ours.estimates[0]);
            assert!(ours.estimates[0] <= plan.run.accuracy, "{:e}", ours.estimates[0]);
        }
    }

    /// Truth: the refined run. A run that is not refined has the modes from the start.
    #[test]
    fn a_run_without_estimates_has_all_modes() {
        let plan = plan_of(include_str!("../../../../tests/hard/rod_met.toml"));
        let (engine, progress) = (Cpu::default(), Progress::default());
        let ours = control::once(plan.clone(), "", &engine, &progress).expect("it runs");
        assert!(!plan.driven(0).kept.waiting.is_empty() && ours.plan.driven(0).kept.waiting.is_empty());
        let truth = result(&plan.clone().with_waiting_modes().with_steps(|steps| 4 * steps));
        let [error, without] =
            [ours.outcome.results[0], result(&plan)].map(|one| scaled_difference(&plan, 0, &one, &truth));
        assert!(error <= plan.run.accuracy && without > 2.0 * plan.run.accuracy, "{error:e} {without:e}");
    }

    /// Without them the phase is off by as much as the measured force tells, or less.
    #[test]
    fn the_loss_of_faint_modes_is_told_beforehand() {
        let plan = plan_of(include_str!("../../../../tests/hard/rod_met.toml"));
        assert!(matches!(plan.basis_rule(0), BasisRule::Shares { .. }));
        let (without, with) = (result(&plan), result(&plan.clone().with_waiting_modes()));
        let off = scaled_difference(&plan, 0, &without, &with);
        let told = missed_resonances(&plan, 0, FoundMotion::new(&without.measured, None));
        assert!(off <= told && told <= 5.0 * off, "{off:e} {told:e}");
    }

    /// Truth: the same states with 32 times the steps. The contact loses nothing, and the lever rings long.
    #[test]
    fn what_steps_do_shows_in_the_phase_as_told() {
        let text = include_str!("../../../../tests/hard/rod_met.toml").replace("17 nm", "15 nm");
        for ringing in ["2000", "5000", "10000"] {
            let plan =
                plan_of(&text.replace("quality_factor = 2000", &format!("quality_factor = {ringing}")));
            let [few, many] = [64, 2048].map(|steps| result(&plan.clone().with_steps(|_| steps)).measured);
            let off = (few.phase - many.phase).to_radians().abs();
            let told = work_of_steps(&plan, 0, &few);
            assert!(off > 4e-3 && (told / off - 1.0).abs() < 0.3, "{off:e} {told:e}");
            assert!(work_of_steps(&plan, 0, &many) < 1e-2 * told);
        }
    }
}
