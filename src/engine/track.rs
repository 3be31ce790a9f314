//! One instance on its way through a run.

use super::law::KernelLaw;
use super::measure::Sums;
use super::start;
use crate::kernel::{Case, Decay, Flow, LENGTH, Lane, State, Tally, Wave, increments, period};
use crate::observe::Wants;
use crate::plan::{CasePlan, Driven};
use crate::scene::{Run, Start};
use std::f64::consts::TAU;

/// An instance's constants, its state, and what has been measured so far.
pub(super) struct Track<L, I, const M: usize> {
    case: Case<L, I, M>,
    state: State<L, M>,
    tally: Tally<L>,
    sums: Sums,
    /// Drive periods done.
    pub done: u32,
    /// False once a value is no number any more.
    pub finite: bool,
}

/// A lane that holds one instance and can be read back.
pub(super) trait Scalar: Lane + Into<f64> + Send + Sync {}
impl Scalar for f32 {}
impl Scalar for f64 {}

/// Length of a step, s.
pub(super) fn step_length(driven: &Driven, steps: u32) -> f64 {
    TAU / (driven.free.omega * f64::from(steps))
}

/// Impulse per N: h^2 times the tip's mobility, in units of length.
pub(super) fn force_scale(driven: &Driven, steps: u32) -> f64 {
    step_length(driven, steps).powi(2) * driven.kept.mobility() / LENGTH
}

/// The instance as the kernel takes it.
pub(super) fn case<L: Lane, I: KernelLaw<L>, const M: usize>(
    plan: &CasePlan,
    driven: &Driven,
    start: Start,
) -> Case<L, I, M> {
    Case {
        flow: Flow::new(&driven.kept.flow(), step_length(driven, plan.steps)),
        free: start::free(driven, start, plan.steps),
        gap: L::splat(plan.gap / LENGTH),
        law: I::build(&plan.contact, force_scale(driven, plan.steps)),
    }
}

/// The deviation half a step into the run: nothing in steady free motion; from rest, the decaying
/// part of each kept mode.
pub(super) fn state<L: Lane, I: KernelLaw<L>, const M: usize>(
    case: &Case<L, I, M>,
    plan: &CasePlan,
    driven: &Driven,
    start: Start,
) -> State<L, M> {
    let zero = L::splat(0.0);
    let mut state = State { x: [zero; M], u: [zero; M], touching: zero };
    let (cosine, _) = start::amplitudes(driven, start);
    let mut travel = cosine;
    if start == Start::Rest {
        travel = 0.0;
        let half = 0.5 * step_length(driven, plan.steps);
        for (k, mode) in driven.kept.modes.iter().enumerate().take(M) {
            let Some(index) = mode.index else { continue };
            let [q, rate] = driven.free.transient[index];
            let tip = driven.instrument.modes[index].tip / LENGTH;
            let (x, u) = (tip * q, tip * rate / mode.omega);
            let [m00, m01, m10, m11] = increments(mode.omega * half, mode.damping);
            state.x[k] = L::splat(x + (m00 * x + m01 * u));
            state.u[k] = L::splat(u + (m10 * x + m11 * u));
        }
    }
    state.touching = case.law.touching_at(L::splat(-(plan.gap + travel) / LENGTH));
    state
}

impl<L: Scalar, I: KernelLaw<L>, const M: usize> Track<L, I, M> {
    pub fn new(plan: &CasePlan, driven: &Driven, start: Start) -> Self {
        let case = case(plan, driven, start);
        let state = state(&case, plan, driven, start);
        let (cosine, _) = start::amplitudes(driven, start);
        let first = if start == Start::Rest { 0.0 } else { cosine };
        let tally = Tally::start(L::splat(-(plan.gap + first) / LENGTH), state.touching);
        Self { case, state, tally, sums: Sums::new(), done: 0, finite: true }
    }

    /// Steps through `periods` more periods; `decay` holds their samples for a start from rest.
    pub fn advance(
        &mut self,
        run: &Run,
        periods: u32,
        waves: &[Vec<Wave<L>>],
        decay: Option<&[Decay<L>]>,
        wants: Wants,
    ) {
        let steps = waves[0].len();
        let warm = run.periods - run.measure;
        for index in 0..periods {
            if !self.finite {
                return;
            }
            let rows = decay.map(|rows| &rows[index as usize * steps..][..steps]);
            // Before the measured part only what judges steadiness is kept.
            let wants = if self.done < warm { Wants::FUNDAMENTAL } else { wants };
            period(&self.case, &mut self.state, waves, rows, wants, &mut self.tally);
            self.finite =
                self.state.x.iter().chain(&self.state.u).all(|value| Into::<f64>::into(*value).is_finite());
            self.sums.add(&self.tally, steps, self.done >= warm);
            self.tally.next_period();
            self.done += 1;
        }
    }

    /// What was measured.
    pub fn sums(&self) -> &Sums {
        &self.sums
    }
}
