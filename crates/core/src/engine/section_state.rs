//! Converts a plan's section states to and from the kernel's units.

use super::checkpoint::InstanceCheckpoint;
use super::kernel_constants::member;
use super::start;
use crate::kernel::{LENGTH, MODES_MAX, RunSums};
use crate::plan::{Case, Driven, Plan, SectionState};
use crate::scene::Start;
use std::f64::consts::PI;

/// Checkpoints at the plan's starts of these instances, if it sets them.
#[cfg(feature = "gpu")]
pub(super) fn begin(plan: &Plan, instances: &[u32]) -> Option<Vec<InstanceCheckpoint>> {
    let starts = plan.starts.as_ref()?;
    let at = |&instance: &u32| checkpoint(plan, instance, &starts[instance as usize].section);
    Some(instances.iter().map(at).collect())
}

pub(super) fn checkpoint(plan: &Plan, instance: u32, station: &SectionState) -> InstanceCheckpoint {
    let (case, driven) = member(plan, instance);
    let x = station.x.map(|x| x / LENGTH);
    let beyond = x[..driven.kept.modes.len().min(MODES_MAX)].iter().sum();
    let last = indentation(&case, (driven, plan.run.start), half_step(case.steps), beyond);
    let touching = f64::from(u8::from(station.touching));
    InstanceCheckpoint {
        x,
        u: station.u.map(|u| u / LENGTH),
        touching,
        last: [last; 2],
        touched: touching,
        run_sums: RunSums::new(),
        finite: station.finite,
    }
}

/// Cosine and sine of the phase half a step into a period of `steps` steps.
pub(super) fn half_step(steps: u32) -> (f64, f64) {
    let half = PI / f64::from(steps);
    (half.cos(), half.sin())
}

/// Indentation half a step into a period, where the tip is `beyond` its free motion, kernel units.
pub(super) fn indentation(case: &Case, driven: (&Driven, Start), half: (f64, f64), beyond: f64) -> f64 {
    -(rest_indentation(case, driven, half) + beyond)
}

/// Distance of free motion from the sample there, kernel units; `half` is [`half_step`] of the case's steps.
pub(super) fn rest_indentation(case: &Case, (driven, start): (&Driven, Start), half: (f64, f64)) -> f64 {
    let (cosine, sine) = start::amplitudes(driven, start);
    (case.gap + (cosine * half.0 + sine * half.1)) / LENGTH
}

/// Writes travels and rates of an instance's `own` modes, times `unit`, from its kernel numbers: those of `all` stepped modes,
/// then contact. Returns whether it touches, and whether its own numbers are finite, that is within f32's range.
pub(super) fn put(
    (own, all): (usize, usize),
    number: impl Fn(usize) -> f64,
    (x, u): (&mut [f64], &mut [f64]),
    unit: f64,
) -> (bool, bool) {
    let mut finite = true;
    for k in 0..own {
        (x[k], u[k]) = (number(k) * unit, number(all + k) * unit);
        finite &= (number(k) as f32).is_finite() && (number(all + k) as f32).is_finite();
    }
    (number(2 * all) > 0.0, finite)
}

/// The section state of a checkpoint.
#[cfg(feature = "gpu")]
pub(super) fn section_state(saved: &InstanceCheckpoint) -> SectionState {
    SectionState {
        x: saved.x.map(|x| x * LENGTH),
        u: saved.u.map(|u| u * LENGTH),
        touching: saved.touching > 0.0,
        finite: saved.finite,
    }
}
