//! The periodic state of one instance as an initial guess for another's.

use super::PeriodicState;
use super::period_map::{distance, transfer_section};
use crate::kernel::MODES_MAX;
use crate::plan::{Driven, KeptMode, Plan, SectionState};
use nalgebra::Complex;
use std::f64::consts::{FRAC_PI_2, PI};

/// A transfer error of more free amplitudes than this means another state.
const MAX_TRANSFER_MISS: f64 = 0.5;

/// Transfers the tip's motion at a neighbour to instance `to`. Phase behind the drive stays the same. The amplitude changes by
/// the difference of the gaps, so that the tip comes as close to the sample; it never exceeds both the neighbour's and the
/// free amplitude. Modes correspond by equal frequency, or else by number; a mode that the neighbour lacks moves freely.
///
/// `from` is the plan with the neighbour's drive and gap, its number there, and its state.
pub fn transfer_orbit(from: (&Plan, u32, &PeriodicState), plan: &Plan, to: u32) -> SectionState {
    let (plan_there, number, state) = from;
    let (there, here) = (plan_there.case(number), plan.case(to));
    let (driven_there, driven) = (plan_there.driven(number), plan.driven(to));
    // Section states lie half a step after the top of the free swing.
    let (before, now) = (section_angle(driven_there, state.steps), section_angle(driven, here.steps));
    let late = Complex::from_polar(1.0, now - before);
    let modes = &state.basis.modes;
    let count = modes.len().min(MODES_MAX);
    let whole = |k: usize| {
        let stretch = driven_there.free.omega / modes[k].omega;
        modal_phasor(driven_there, &modes[k], before)
            + Complex::new(state.section.u[k] / stretch, state.section.x[k])
    };
    let size: f64 = (0..count).map(whole).sum::<Complex<f64>>().norm();
    let most = size.max(driven.free_amplitude());
    let factor = match size > 0.0 {
        true => ((size + here.gap - there.gap) / size).clamp(0.0, most / size),
        false => 1.0,
    };
    let mut station = SectionState {
        touching: state.section.touching && here.contact.law.has_hysteresis(),
        ..SectionState::FREE
    };
    for (k, mode) in driven.kept.modes.iter().enumerate().take(MODES_MAX) {
        let alike = |other: &KeptMode| other.omega == mode.omega;
        let stands = |other: &KeptMode| other.corresponds(mode);
        let same = modes[..count].iter().position(alike).or_else(|| modes[..count].iter().position(stands));
        let Some(j) = same else { continue };
        let stretch = driven.free.omega / mode.omega;
        let beyond = whole(j) * late * factor - modal_phasor(driven, mode, now);
        (station.x[k], station.u[k]) = (beyond.im, beyond.re * stretch);
    }
    // The sample remembers what the neighbour's does.
    if there.contact.law.has_memory() && here.contact.law.has_memory() {
        let (own, other) = (driven.kept.modes.len(), modes.len());
        if own.max(other) < MODES_MAX {
            (station.x[own], station.u[own]) = (state.section.x[other], state.section.u[other]);
        }
    }
    station
}

/// Like [`transfer_orbit`], corrected by the transfer error one step earlier: `before` are states beyond `from`, and the one
/// with the smallest error counts. This is the better guess along a branch that bends, as before pull-off.
pub fn transfer_orbit_corrected(
    from: (&Plan, u32, &PeriodicState),
    before: &[(u32, PeriodicState)],
    plan: &Plan,
    to: u32,
) -> SectionState {
    let mut station = transfer_orbit(from, plan, to);
    let (plan_there, number, state) = from;
    if plan_there.driven(number).kept.modes != plan.driven(to).kept.modes {
        return station;
    }
    let here = transfer_section(plan_there, number, state);
    let missed = |(other, state): &(u32, PeriodicState)| {
        transfer_orbit((plan_there, *other, state), plan_there, number)
    };
    let nearest = before.iter().map(missed).min_by(|a, b| distance(a, &here).total_cmp(&distance(b, &here)));
    let most = MAX_TRANSFER_MISS * plan_there.driven(number).free_amplitude();
    if let Some(there) = nearest.filter(|there| distance(there, &here) < most) {
        for k in 0..MODES_MAX {
            station.x[k] += here.x[k] - there.x[k];
            station.u[k] += here.u[k] - there.u[k];
        }
    }
    station
}

/// Phase of the drive at the section, where an instance's periods begin.
pub(super) fn section_angle(driven: &Driven, steps: u32) -> f64 {
    FRAC_PI_2 - driven.free.angle + PI / f64::from(steps)
}

/// A mode's part of the free motion at that phase: the imaginary part is its travel, the real part its rate over the drive's
/// angular frequency.
fn modal_phasor(driven: &Driven, mode: &KeptMode, angle: f64) -> Complex<f64> {
    let Some(index) = mode.index else { return Complex::ZERO };
    driven.free.mode(index) * Complex::from_polar(1.0, angle) * driven.instrument.modes[index].tip
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::Jacobian;
    use crate::periodic::Floquet;
    use crate::test_plans::plan_of;
    use std::sync::Arc;

    fn bistable() -> Plan {
        let text = include_str!("../../../../scenes/bistable.toml");
        plan_of(text)
    }

    fn state(plan: &Plan, steps: u32) -> PeriodicState {
        let mut station = SectionState::FREE;
        (station.x[0], station.u[0]) = (-1e-9, 5e-10);
        PeriodicState {
            section: station,
            floquet: Floquet { multiplier: 0.9, sigma_min: 0.1 },
            steps,
            basis: Arc::clone(&plan.driven(8).kept),
            jacobian: Jacobian::Unknown,
            gap_slope: None,
        }
    }

    #[test]
    fn to_itself_a_state_is_carried_as_it_is() {
        let plan = bistable();
        let state = state(&plan, plan.steps(8));
        let station = transfer_orbit((&plan, 8, &state), &plan, 8);
        assert!((station.x[0] + 1e-9).abs() < 1e-21 && (station.u[0] - 5e-10).abs() < 1e-21, "{station:?}");
    }

    /// The gap is a quarter of a nanometre wider, and so is the swing.
    #[test]
    fn at_a_wider_gap_the_tip_comes_as_close() {
        let plan = bistable();
        let state = state(&plan, plan.steps(9));
        let station = transfer_orbit((&plan, 8, &state), &plan, 9);
        let amplitude = plan.drives[0].free_amplitude();
        let size = |station: &SectionState| {
            let angle = PI / f64::from(plan.steps(9));
            (station.x[0] + amplitude * angle.cos()).hypot(station.u[0] - amplitude * angle.sin())
        };
        let wider = plan.case(9).gap - plan.case(8).gap;
        assert!((size(&station) - size(&state.section) - wider).abs() < 1e-3 * wider, "{station:?}");
    }
}
