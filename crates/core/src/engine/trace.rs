//! One instance in full: every step of its last periods, for waveforms and for checks.

use super::EngineError;
use super::cpu::decays;
use super::kernel_constants::{begin, constants, force_scale, lever, step_length};
use super::kernel_dispatch::not_stepped;
use super::section_state;
use super::start;
use crate::kernel::{LENGTH, MODES_MAX, Rounding, tracer};
use crate::plan::{Plan, SectionState};
use crate::scene::Start;

/// The steps of an instance from `first` on, at the middle of each step. SI units, f64.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Number of the first step kept; step n is sampled at time (n + 1/2) `step`.
    pub first: u64,
    /// Length of a step, s.
    pub step: f64,
    /// The drive's phase at time 0, rad: the drive is sin(omega t + phase).
    pub phase: f64,
    pub samples: Vec<TraceSample>,
}

/// One step, corrected to fourth order.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceSample {
    /// Tip travel, m.
    pub travel: f64,
    /// Part of it beyond the steady free motion, m.
    pub beyond: f64,
    /// Indentation, m.
    pub indentation: f64,
    /// Mean force over the step, N.
    pub force: f64,
    /// First moment of the force about the middle of the step, time in steps, beyond a 12th of the force's change over it, N.
    /// It tells a force that acts early or late from one that changes evenly.
    pub moment: f64,
    /// Travel of the rod's top beyond its steady free motion by the kept modes, m.
    pub top: f64,
    /// Whether the tip is in contact at the step's end.
    pub touching: bool,
}

/// Steps `instance` through `periods` drive periods and keeps the last `keep` of them.
///
/// It uses the kernel of the run in f64; instances that need no steps are traced with 64 a period. If the instance has a
/// periodic state, `from`, the kept part starts there and nothing before it is stepped.
pub fn trace(
    plan: &Plan,
    instance: usize,
    from: Option<&SectionState>,
    periods: u32,
    keep: u32,
) -> Result<Trace, EngineError> {
    let mut case = plan.case(instance as u32);
    case.steps = case.steps.max(crate::plan::STEPS_MIN);
    let driven = plan.driven(instance as u32);
    let modes = plan.pairs(instance as u32);
    if !(1..=MODES_MAX).contains(&modes) {
        return Err(not_stepped(modes));
    }
    let (member, start) = ((case, driven), plan.run.start);
    let saved = from.map_or_else(
        || begin(&member, start),
        |place| section_state::checkpoint(plan, instance as u32, place),
    );
    let constants: Vec<f64> = constants(&member, &lever(&member, modes), start).collect();
    let state = saved.x[..modes].iter().chain(&saved.u[..modes]).chain([&saved.touching]);
    let mut state: Vec<f64> = state.copied().collect();
    let waves = start::waves::<f64>(case.steps, 1);
    let force = force_scale(driven, case.steps);
    let count = u64::from(case.steps);
    let unkept = u64::from(periods.saturating_sub(keep));
    let step_through = tracer(Rounding::new(false), case.contact.law);
    let mut samples = Vec::with_capacity((count * u64::from(keep.min(periods))) as usize);
    for period in if from.is_some() { unkept } else { 0 }..u64::from(periods) {
        let rows = (start == Start::Rest).then(|| decays(driven, case.steps, period * count, count as usize));
        step_through(modes, &constants, &mut state, &waves[0], rows.as_deref(), &mut |sample| {
            if period < unkept {
                return;
            }
            let top = driven.kept.modes.iter().zip(&sample.x).map(|(mode, x)| mode.top * x);
            samples.push(TraceSample {
                travel: (sample.steady + sample.beyond) * LENGTH,
                beyond: sample.beyond * LENGTH,
                indentation: sample.indentation * LENGTH,
                force: sample.impulse / force,
                moment: -sample.shift / force,
                top: top.sum::<f64>() * LENGTH,
                touching: sample.touching,
            });
        });
    }
    let step = step_length(driven, case.steps);
    Ok(Trace { first: count * unkept, step, phase: start::phase(driven, start), samples })
}

impl Trace {
    /// Time of the first sample kept since the run's start, s.
    pub fn begin(&self) -> f64 {
        (self.first as f64 + 0.5) * self.step
    }

    /// Travel beyond the steady free motion (m) and its rate (m/s), the rod top's part (m) and contact, at `time` s since the
    /// run's start, between the first and the last sample.
    ///
    /// Travel follows a cubic through four samples, so it has the samples' order of accuracy.
    pub fn at(&self, time: f64) -> Between {
        let place = (time - self.begin()) / self.step;
        let last = self.samples.len().saturating_sub(4);
        let base = (place.floor() - 1.0).clamp(0.0, last as f64) as usize;
        let s = place - base as f64;
        let window = &self.samples[base..(base + 4).min(self.samples.len())];
        let (beyond, rate) = cubic(window.iter().map(|sample| sample.beyond), s);
        let (top, _) = cubic(window.iter().map(|sample| sample.top), s);
        // A sample stands for the step around it; the contact at that step's start is that of the sample before.
        let here = (place.round().max(0.0) as usize).min(self.samples.len() - 1);
        let was = self.samples[here.saturating_sub(1)].touching;
        Between {
            beyond,
            rate: rate / self.step,
            top,
            was_touching: was,
            touching: self.samples[here].touching,
        }
    }
}

/// The values of [`Trace::at`] between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// Tip travel beyond the steady free motion, m, and its rate, m/s.
    pub beyond: f64,
    pub rate: f64,
    /// The same for the rod's top, by the kept modes, m.
    pub top: f64,
    /// Contact at the start and at the end of the step around that time.
    pub was_touching: bool,
    pub touching: bool,
}

/// Lagrange's cubic through values at 0, 1, 2, 3 (a lower one through fewer), and its slope.
fn cubic(values: impl Iterator<Item = f64> + Clone, s: f64) -> (f64, f64) {
    let count = values.clone().count();
    let others = |i: usize| (0..count).filter(move |&j| j != i);
    let factor = |i: usize, j: usize| (s - j as f64) / (i as f64 - j as f64);
    let weight = |i: usize| others(i).map(|j| factor(i, j)).product::<f64>();
    let slope = |i: usize| {
        let but = |one: usize| others(i).filter(move |&j| j != one).map(|j| factor(i, j)).product::<f64>();
        others(i).map(|one| but(one) / (i as f64 - one as f64)).sum::<f64>()
    };
    let rate = values.clone().enumerate().map(|(i, value)| slope(i) * value).sum();
    (values.enumerate().map(|(i, value)| weight(i) * value).sum(), rate)
}

#[cfg(test)]
mod tests {
    use super::cubic;

    #[test]
    fn a_cubic_is_met_with_its_slope() {
        let value = |s: f64| 2.0 - s + 3.0 * s * s - 0.5 * s * s * s;
        let slope = |s: f64| -1.0 + 6.0 * s - 1.5 * s * s;
        for s in [-0.3, 0.0, 0.7, 1.5, 2.0, 3.4] {
            let (v, r) = cubic((0..4).map(|i| value(f64::from(i))), s);
            assert!((v - value(s)).abs() < 1e-13 && (r - slope(s)).abs() < 1e-13, "{s}: {v}, {r}");
        }
    }
}
