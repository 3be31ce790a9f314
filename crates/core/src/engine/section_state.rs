//! Between a plan's section states and the kernel's units.

use super::checkpoint::InstanceCheckpoint;
use super::kernel_constants::member;
use super::start;
use crate::kernel::{LENGTH, RunSums};
use crate::plan::{Case, Driven, Plan, SectionState};
use crate::scene::Start;
use std::f64::consts::PI;

/// Where these instances start, if the plan says so.
#[cfg(feature = "gpu")]
pub(super) fn begin(plan: &Plan, instances: &[u32]) -> Option<Vec<InstanceCheckpoint>> {
    let starts = plan.starts.as_ref()?;
    let at = |&instance: &u32| checkpoint(plan, instance, &starts[instance as usize].section);
    Some(instances.iter().map(at).collect())
}

pub(super) fn checkpoint(plan: &Plan, instance: u32, station: &SectionState) -> InstanceCheckpoint {
    let (case, driven) = member(plan, instance);
    let x = station.x.map(|x| x / LENGTH);
    let last = indentation(&case, (driven, plan.run.start), half_step(case.steps), x.iter().sum());
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

/// Cosine and sine of the phase half a step into a period of so many steps.
pub(super) fn half_step(steps: u32) -> (f64, f64) {
    let half = PI / f64::from(steps);
    (half.cos(), half.sin())
}

/// Indentation half a step into a period where the tip is so far beyond its free motion, kernel units.
pub(super) fn indentation(case: &Case, driven: (&Driven, Start), half: (f64, f64), beyond: f64) -> f64 {
    -(rest_indentation(case, driven, half) + beyond)
}

/// How far from the sample free motion is there, kernel units; `half` is [`half_step`] of the case's steps.
pub(super) fn rest_indentation(case: &Case, (driven, start): (&Driven, Start), half: (f64, f64)) -> f64 {
    let (cosine, sine) = start::amplitudes(driven, start);
    (case.gap + (cosine * half.0 + sine * half.1)) / LENGTH
}

/// Puts travels and rates of an instance's `own` modes, in units of so many of the kernel's, by its numbers: those of `all` modes
/// that are stepped, then contact. Tells whether there is contact, and whether all of its own are numbers: beyond f32 counts as none.
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

/// Where an instance was left.
#[cfg(feature = "gpu")]
pub(super) fn section_state(saved: &InstanceCheckpoint) -> SectionState {
    SectionState {
        x: saved.x.map(|x| x * LENGTH),
        u: saved.u.map(|u| u * LENGTH),
        touching: saved.touching > 0.0,
        finite: saved.finite,
    }
}
