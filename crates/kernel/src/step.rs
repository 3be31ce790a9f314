//! One step.

use super::constants::{HALF, TWENTY_FOURTH, ZERO};
use super::contact::{Approach, Interaction, Kick};
use super::flow::Flow;
use super::sample::{Sample, Wave};

use super::{Lane, WRITTEN_OUT, Wants};

/// The least number that is infinite once it is rounded to f32: 2^128 - 2^103. Beyond f32 counts as no number, so that
/// both precisions and a shader agree on it.
const BEYOND: f64 = 3.402_823_567_797_336_6e38;

/// The free tip's travel at the samples of a period, kernel units: `cosine`, `sine` its
/// amplitudes, `rate` the drive's phase per step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Free<L> {
    pub cosine: L,
    pub sine: L,
    pub rate: L,
}

impl<L: Lane> Free<L> {
    /// The travel at a sample, and its change by a radian of the drive's phase.
    #[inline(always)]
    pub fn at(&self, wave: Wave<L::Element>) -> [L; 2] {
        let (cosine, sine) = (L::broadcast(wave.cosine), L::broadcast(wave.sine));
        [self.cosine.mul_add(cosine, self.sine * sine), self.sine.mul_add(cosine, -(self.cosine * sine))]
    }
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
pub(crate) struct Case<L, I, const M: usize> {
    pub flow: Flow<L, M>,
    pub free: Free<L>,
    pub gap: L,
    pub law: I,
}

/// The tip at a sample before its kick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met<L> {
    /// Steady free travel of the tip, and travel beyond it.
    pub steady: L,
    pub beyond: L,
    /// What the speed is too large by when the kick counts as work.
    pub excess: L,
    pub approach: Approach<L>,
}

/// Where one instance is: deviation of each mode at a sample before its kick, and contact. The last mode may be the law's
/// memory ([`Interaction::MEMORY`]).
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<L, const M: usize> {
    pub x: [L; M],
    pub u: [L; M],
    /// 1 in contact, else 0.
    pub touching: L,
}

/// The body for each of M modes, written out where there are few: left as a loop of four or more, the compiler gives
/// up on vector registers and the step takes six times as long. More than [`WRITTEN_OUT`] are in memory anyway: a loop
/// over as many as there are, compiled once.
macro_rules! each_mode {
    ($count:ident of $case:ident, $k:ident => $body:block) => {
        if $count <= WRITTEN_OUT {
            each_mode!(@ $k, $body, 0 1 2 3 4 5 6 7);
        } else {
            for $k in 0..$case.flow.count.min($count) {
                $body
            }
        }
    };
    (@ $k:ident, $body:block, $($index:literal)*) => {
        $(if Self::SWINGING > $index {
            let $k = $index;
            $body
        })*
    };
}

impl<L: Lane, const M: usize> State<L, M> {
    /// From rows of a number for each lane: x of each of `modes` modes, u of each, contact.
    #[inline(always)]
    pub fn load(modes: usize, rows: &[L::Element]) -> Self {
        let zero = L::splat(ZERO);
        let mut rows = rows.chunks_exact(L::WIDTH);
        let mut next = || rows.next().map_or(zero, L::load);
        let count = if M <= WRITTEN_OUT { M } else { modes.min(M) };
        let mut state = Self { x: [zero; M], u: [zero; M], touching: zero };
        state.x[..count].iter_mut().for_each(|value| *value = next());
        state.u[..count].iter_mut().for_each(|value| *value = next());
        state.touching = next();
        state
    }

    /// The other way.
    #[inline(always)]
    pub fn store(&self, modes: usize, rows: &mut [L::Element]) {
        let count = if M <= WRITTEN_OUT { M } else { modes.min(M) };
        let numbers = self.x[..count].iter().chain(&self.u[..count]).chain([&self.touching]);
        numbers.zip(rows.chunks_exact_mut(L::WIDTH)).for_each(|(number, row)| number.store(row));
    }

    /// Takes the other one's numbers where the mask says so.
    #[inline(always)]
    pub fn choose(&mut self, mask: L::Mask, other: &Self) {
        for k in 0..M {
            self.x[k] = L::select(mask, other.x[k], self.x[k]);
            self.u[k] = L::select(mask, other.u[k], self.u[k]);
        }
        self.touching = L::select(mask, other.touching, self.touching);
    }

    /// Whether some number is beyond what f32 holds, or none.
    #[inline(always)]
    pub fn beyond(&self) -> bool {
        let beyond = L::splat(BEYOND);
        self.x.iter().zip(&self.u).fold(false, |some, (x, u)| {
            some | L::any(L::not(L::both(x.abs().less(beyond), u.abs().less(beyond))))
        })
    }
}

impl<L: Lane, I: Interaction<L>, const M: usize> Case<L, I, M> {
    /// Modes of the lever, where all M are gone through.
    const SWINGING: usize = M - I::MEMORY as usize;

    /// From rows of a number for each lane: what the motion depends on of the lever's `modes` and its corner, the free motion's
    /// cosine, sine and rate, the gap, the law's constants, and last what makes work of it, without which there is none.
    #[inline(always)]
    pub fn load(modes: usize, constants: &[L::Element]) -> Self {
        let zero = L::splat(ZERO);
        let mut rows = constants.chunks_exact(L::WIDTH);
        let mut next = || rows.next().map_or(zero, L::load);
        // All of few: the loops are then written out.
        let count = if M <= WRITTEN_OUT { M } else { modes.min(M) };
        let mut each = || {
            let mut values = [zero; M];
            values[..count].iter_mut().for_each(|value| *value = next());
            values
        };
        let [m00, m01, m11, rate] = [each(), each(), each(), each()];
        let [pull, drag, land_x, land_u] = [each(), each(), each(), each()];
        let [shift_x, shift_u] = [each(), each()];
        let corner = next();
        let free = Free { cosine: next(), sine: next(), rate: next() };
        let (gap, law) = (next(), I::from_numbers(&mut next));
        let mut each = || {
            let mut values = [zero; M];
            values[..count].iter_mut().for_each(|value| *value = next());
            values
        };
        let (work_x, work_u) = (each(), each());
        let (kick_paid, mean_corner) = (next(), next());
        let flow = Flow {
            count: count - usize::from(I::MEMORY),
            m00,
            m01,
            m11,
            rate,
            pull,
            drag,
            work_x,
            work_u,
            land_x,
            land_u,
            shift_x,
            shift_u,
            corner,
            kick_paid,
            mean_corner,
        };
        Self { flow, free, gap, law }
    }

    /// Kick at the sample, then exact flow to the next one. What makes work and virial is zero in the
    /// sample unless they are asked for, and so are extreme forces.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut State<L, M>,
        wave: Wave<L::Element>,
        decay: Option<Decay<L::Element>>,
        wants: Wants,
    ) -> Sample<L> {
        let met = self.meet(state, wave, decay, wants.energy);
        let kick = self.law.kick(met.approach, state.touching);
        self.fly(state, &kick);
        let mut sample = self.sampled(&met, kick, wants.energy);
        if wants.forces {
            [sample.least, sample.most] = self.law.extremes(met.approach, &kick);
        }
        sample
    }

    /// What the step saw, corrected to fourth order.
    #[inline(always)]
    pub fn sampled(&self, met: &Met<L>, kick: Kick<L>, energy: bool) -> Sample<L> {
        let Met { steady, beyond, excess, approach } = *met;
        let (speed, acceleration, indentation) =
            (-approach.speed, -approach.acceleration, approach.indentation);
        let impulse = kick.impulse;
        // A kick's corner against the smooth path it stands for.
        let corner = self.flow.corner;
        let (mut work, mut virial) = (L::splat(ZERO), L::splat(ZERO));
        if energy {
            work = impulse * (self.flow.kick_paid.mul_add(impulse, speed) - excess);
            // The impulse is a mean over the step: its factor is the travel less a 24th of its second
            // difference, and the mean travel of fast modes.
            let mean = self.flow.mean_corner.mul_add(impulse, steady + beyond);
            virial = impulse * (-acceleration).mul_add(L::splat(TWENTY_FOURTH), mean);
            if I::SHIFTS {
                // Impulse that falls early or late falls at another speed and travel.
                work = (-acceleration).mul_add(kick.shift, work);
                virial = (-kick.shift).mul_add(L::splat(HALF).mul_add(impulse, speed), virial);
            }
        }
        Sample {
            steady,
            beyond: corner.mul_add(impulse, beyond),
            indentation: (-corner).mul_add(impulse, indentation),
            work,
            virial,
            least: L::splat(ZERO),
            most: L::splat(ZERO),
            kick,
        }
    }

    /// A step from steady free motion: what its kick was given, and the kick.
    #[inline(always)]
    pub fn kicked(&self, state: &mut State<L, M>, wave: Wave<L::Element>) -> (Approach<L>, Kick<L>) {
        let approach = self.meet(state, wave, None, false).approach;
        let kick = self.law.kick(approach, state.touching);
        self.fly(state, &kick);
        (approach, kick)
    }

    /// Where the tip meets the kick. What the speed is too large by when the kick counts as work is zero unless `energy` is
    /// asked for.
    #[inline(always)]
    pub fn meet(
        &self,
        state: &State<L, M>,
        wave: Wave<L::Element>,
        decay: Option<Decay<L::Element>>,
        energy: bool,
    ) -> Met<L> {
        let (flow, free) = (&self.flow, &self.free);
        let [steady, turned] = free.at(wave);
        let mut speed = free.rate * turned;
        let excess = if energy { self.excess(state, speed) } else { L::splat(ZERO) };
        let mut acceleration = -(free.rate * free.rate * steady);
        let mut beyond = L::splat(ZERO);
        if let Some(decay) = decay {
            beyond = L::broadcast(decay.travel);
            speed = speed + L::broadcast(decay.speed);
            acceleration = acceleration + L::broadcast(decay.acceleration);
        }
        each_mode!(M of self, k => {
            beyond = beyond + state.x[k];
            speed = flow.rate[k].mul_add(state.u[k], speed);
            acceleration = flow.pull[k].mul_add(state.x[k], acceleration);
            acceleration = flow.drag[k].mul_add(state.u[k], acceleration);
        });
        let indentation = -(self.gap + steady + beyond);
        let (speed, acceleration, memory) = (-speed, -acceleration, self.memory(state));
        Met { steady, beyond, excess, approach: Approach { indentation, speed, acceleration, memory } }
    }

    /// What the speed is too large by when the kick counts as work, at the steady free `speed`.
    #[inline(always)]
    fn excess(&self, state: &State<L, M>, speed: L) -> L {
        let (flow, free) = (&self.flow, &self.free);
        let mut excess = -(free.rate * free.rate * speed * L::splat(TWENTY_FOURTH));
        each_mode!(M of self, k => {
            excess = flow.work_x[k].mul_add(state.x[k], excess);
            excess = flow.work_u[k].mul_add(state.u[k], excess);
        });
        excess
    }

    /// The place of the law's memory, which has one.
    #[inline(always)]
    fn last(&self) -> usize {
        if M <= WRITTEN_OUT { M - 1 } else { self.flow.count }
    }

    /// What the law remembers.
    #[inline(always)]
    fn memory(&self, state: &State<L, M>) -> [L; 2] {
        match I::MEMORY {
            true => [state.x[self.last()], state.u[self.last()]],
            false => [L::splat(ZERO); 2],
        }
    }

    /// The exact flow to the next sample, and what the kick has done by then.
    #[inline(always)]
    pub fn fly(&self, state: &mut State<L, M>, kick: &Kick<L>) {
        let flow = &self.flow;
        state.touching = kick.touching;
        each_mode!(M of self, k => {
            let (x, u) = (state.x[k], state.u[k]);
            // Chains of sums: drivers take x + (a + b) apart into one. The kick comes last: nothing before
            // it waits for it.
            let flown_x = flow.m01[k].mul_add(u, flow.m00[k].mul_add(x, x));
            let flown_u = flow.m11[k].mul_add(u, (-flow.m01[k]).mul_add(x, u));
            state.x[k] = flow.land_x[k].mul_add(kick.impulse, flown_x);
            state.u[k] = flow.land_u[k].mul_add(kick.impulse, flown_u);
        });
        // A shift of zero changes nothing.
        if I::SHIFTS && L::any(L::splat(ZERO).less(kick.shift.abs())) {
            each_mode!(M of self, k => {
                state.x[k] = flow.shift_x[k].mul_add(kick.shift, state.x[k]);
                state.u[k] = flow.shift_u[k].mul_add(kick.shift, state.u[k]);
            });
        }
        if I::MEMORY {
            let (k, [x, u]) = (self.last(), self.memory(state));
            state.x[k] = flow.m01[k].mul_add(u, flow.m00[k].mul_add(x, x)) + kick.memory[0];
            state.u[k] = flow.m11[k].mul_add(u, (-flow.m01[k]).mul_add(x, u)) + kick.memory[1];
        }
    }
}
