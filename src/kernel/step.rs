//! One step, and one drive period of steps.

use super::constants::{HALF, TWENTY_FOURTH, ZERO};
use super::contact::{Approach, Interaction, Kick};
use super::{Flow, Lane, Tally};
use crate::observe::Wants;

/// Cosine and sine of the drive's phase at a sample.
#[derive(Clone, Copy, Debug)]
pub struct Wave<E> {
    pub cosine: E,
    pub sine: E,
}

/// The free tip's travel at the samples of a period, kernel units: `cosine`, `sine` its
/// amplitudes, `rate` the drive's phase per step.
#[derive(Clone, Copy, Debug)]
pub struct Free<L> {
    pub cosine: L,
    pub sine: L,
    pub rate: L,
}

/// Free travel beyond the steady one (a start from rest), its speed per step and acceleration.
#[derive(Clone, Copy, Debug)]
pub struct Decay<E> {
    pub travel: E,
    pub speed: E,
    pub acceleration: E,
}

/// What one instance is: lever, free motion, gap and law.
#[derive(Clone, Copy, Debug)]
pub struct Case<L, I, const M: usize> {
    pub flow: Flow<L, M>,
    pub free: Free<L>,
    pub gap: L,
    pub law: I,
}

/// Where one instance is: deviation of each mode at a sample before its kick, and the memory.
#[derive(Clone, Copy, Debug)]
pub struct State<L, const M: usize> {
    pub x: [L; M],
    pub u: [L; M],
    /// 1 in contact, else 0.
    pub touching: L,
}

/// What a step saw.
#[derive(Clone, Copy, Debug)]
pub struct Sample<L> {
    /// Steady free travel of the tip.
    pub steady: L,
    /// Travel beyond it, corrected to fourth order.
    pub beyond: L,
    /// Indentation, corrected likewise.
    pub indentation: L,
    /// Speed of the tip's travel that makes work of the impulse, to fourth order.
    pub speed: L,
    /// Travel that makes the virial of the impulse, likewise: the impulse is a mean over the step,
    /// so its factor is the travel less a 24th of its second difference.
    pub centred: L,
    pub kick: Kick<L>,
}

/// The body for each of M modes, written out: left as a loop of four or more, the compiler gives up
/// on vector registers and the step takes six times as long.
macro_rules! each_mode {
    ($count:ident, $k:ident => $body:block) => {
        each_mode!(@ $count, $k, $body, 0 1 2 3 4 5 6 7);
    };
    (@ $count:ident, $k:ident, $body:block, $($index:literal)*) => {
        $(if $count > $index {
            let $k = $index;
            $body
        })*
    };
}

impl<L: Lane, I: Interaction<L>, const M: usize> Case<L, I, M> {
    /// Kick at the sample, then exact flow to the next one.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut State<L, M>,
        wave: Wave<L::Element>,
        decay: Option<Decay<L::Element>>,
    ) -> Sample<L> {
        let flow = &self.flow;
        let free = &self.free;
        let (cosine, sine) = (L::broadcast(wave.cosine), L::broadcast(wave.sine));
        let steady = free.cosine.mul_add(cosine, free.sine * sine);
        let mut speed = free.rate * free.sine.mul_add(cosine, -(free.cosine * sine));
        let mut excess = -(free.rate * free.rate * speed * L::splat(TWENTY_FOURTH));
        let mut acceleration = -(free.rate * free.rate * steady);
        let mut beyond = L::splat(ZERO);
        if let Some(decay) = decay {
            beyond = L::broadcast(decay.travel);
            speed = speed + L::broadcast(decay.speed);
            acceleration = acceleration + L::broadcast(decay.acceleration);
        }
        each_mode!(M, k => {
            beyond = beyond + state.x[k];
            speed = flow.rate[k].mul_add(state.u[k], speed);
            acceleration = flow.pull[k].mul_add(state.x[k], acceleration);
            acceleration = flow.drag[k].mul_add(state.u[k], acceleration);
            excess = flow.work_x[k].mul_add(state.x[k], excess);
            excess = flow.work_u[k].mul_add(state.u[k], excess);
        });
        let indentation = -(self.gap + steady + beyond);
        let approach = Approach { indentation, speed: -speed, acceleration: -acceleration };
        let kick = self.law.kick(approach, state.touching);
        let impulse = kick.impulse;
        state.touching = kick.touching;
        each_mode!(M, k => {
            let u = flow.kick_u[k].mul_add(impulse, state.u[k]);
            let x = flow.kick_x[k].mul_add(impulse, state.x[k]);
            // A chain of sums: drivers take x + (a + b) apart into one.
            state.x[k] = flow.m01[k].mul_add(u, flow.m00[k].mul_add(x, x));
            state.u[k] = flow.m11[k].mul_add(u, flow.m10[k].mul_add(x, u));
        });
        // A kick's corner against the smooth path it stands for.
        let corner = impulse * L::splat(TWENTY_FOURTH);
        Sample {
            steady,
            beyond: beyond + corner,
            indentation: indentation - corner,
            speed: (L::splat(HALF) * flow.kick_speed - flow.kick_work).mul_add(impulse, speed) - excess,
            centred: steady + beyond - acceleration * L::splat(TWENTY_FOURTH),
            kick,
        }
    }
}

/// Steps through one drive period: `waves[n]` for the steps of harmonic n + 1, `decay` for the
/// same steps where the run started from rest.
///
/// Compiled once for each instruction set and chosen at run time; no operation is fused, so all of
/// them give the same bits.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn period<L: Lane, I: Interaction<L>, const M: usize>(
    case: &Case<L, I, M>,
    state: &mut State<L, M>,
    waves: &[Vec<Wave<L::Element>>],
    decay: Option<&[Decay<L::Element>]>,
    wants: Wants,
    tally: &mut Tally<L>,
) {
    for (index, wave) in waves[0].iter().enumerate() {
        let sample = case.step(state, *wave, decay.map(|rows| rows[index]));
        tally.add(&sample, waves, index, wants);
    }
}
