//! Periods with their slopes, behind functions that know neither lanes nor laws: each part is compiled for what it depends
//! on alone.

use super::contact::Interaction;
use super::dual::Dual;
use super::flow::{LANDS, MOTION, law_row};
use super::lanes::{Family, Rounding, WithLanes, with_double};
use super::sample::Wave;
use super::stepper::{Compiled, Seer};
use super::tangent::{Events, PARTIALS, PARTIALS_WITH_MEMORY, carry, partials, powers, stride};
use super::{Lane, Law, MODES_MAX, WithLaw};
use std::marker::PhantomData;

/// Steps [`Tangent::width`] instances of one law and number of modes through a period, and tells the slope of where it ends by
/// where it begins.
///
/// Derivatives go through every operation of the kicks, on the branches that the steps take. Where the motion would change
/// its kind at the least push, as where a contact would begin in another step, the slope is that of the side it is on.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<E> {
    /// Instances side by side.
    pub width: usize,
    /// Modes that each instance's lever must have, those filled up included.
    pub modes: usize,
    see: Seer<E>,
    kicks: Kicks<E>,
}

/// What counts as hardly any change of a kick over the way from step to step, where as many `steps` may change a slope by
/// `least`. `lands` are what a unit of impulse does to the state ([`LANDS`]).
pub fn little(lands: impl Iterator<Item = f64>, steps: usize, least: f64) -> f64 {
    least / (steps as f64 * lands.map(f64::abs).fold(f64::MIN_POSITIVE, f64::max))
}

/// What is compiled for lanes and for a law.
#[derive(Clone, Copy, Debug)]
struct Kicks<E> {
    partials: Partials<E>,
    carry: Carry<E>,
    stride: fn(usize) -> usize,
}

type Carry<E> = fn((&[E], &[[E; 3]]), usize, u32, Events<E>, &mut Vec<E>);
type Partials<E> = fn((&[E], &[E]), &[E], &mut Vec<u32>, &mut Vec<E>);

/// Room for the work of [`Tangent::period`], to be used again.
#[derive(Debug, Default)]
pub struct Room<E> {
    seen: Vec<E>,
    little: Vec<E>,
    /// Steps whose kicks have a slope, and these.
    steps: Vec<u32>,
    partials: Vec<E>,
    motion: Vec<E>,
    flows: Vec<[E; 3]>,
    /// Steps that these are of.
    period: u32,
    slope: Vec<E>,
}

/// A slope: rows of the travels, then of the rates, by column alike.
#[derive(Clone, Copy, Debug)]
pub struct SlopeRows<'a, E> {
    numbers: &'a [E],
    stride: usize,
}

impl<E: Copy> SlopeRows<'_, E> {
    /// How the number `row` of the end changes with the number `column` of the start.
    pub fn at(&self, row: usize, column: usize) -> E {
        self.numbers[row * self.stride + column]
    }
}

/// What tells slopes in f64 for a law and a number of modes; none for no mode, or for more than [`super::MODES_MAX`].
pub fn tangent(rounding: Rounding, law: Law, modes: usize) -> Option<Tangent<f64>> {
    if cfg!(test) {
        return None; // As in stepper.rs.
    }
    let see = with_double(rounding, Narrow(Compiled::<Seer<f64>> { law, modes, made: PhantomData }))?;
    Some(Tangent::new(see, with_double(rounding, NewKicks(law, see.modes))))
}

/// The same in f32, where every operation rounds.
pub fn strict_tangent(law: Law, modes: usize) -> Option<Tangent<f32>> {
    if cfg!(test) {
        return None; // As in stepper.rs.
    }
    let see = Compiled::<Seer<f32>> { law, modes, made: PhantomData }.with::<(f32, f32)>()?;
    Some(Tangent::new(see, NewKicks(law, see.modes).with::<(f32, f32)>()))
}

/// Done with single registers: all that is seen of a step goes on to the kicks side by side.
struct Narrow<W>(W);

impl<E: Copy, W: WithLanes<E>> WithLanes<E> for Narrow<W> {
    type Output = W::Output;

    fn with<F: Family<E>>(self) -> W::Output {
        self.0.with::<(F::Narrow, F::Narrow)>()
    }
}

struct NewKicks(Law, usize);

impl<E> WithLanes<E> for NewKicks {
    type Output = Kicks<E>;

    fn with<F: Family<E>>(self) -> Kicks<E> {
        self.0.with(KicksWith::<F::Narrow>(carry_of::<E, F>(self.1, self.0.has_memory())))
    }
}

struct KicksWith<L: Lane>(Carry<L::Element>);

/// Of as many modes as the stepper has.
fn carry_of<E, F: Family<E>>(modes: usize, memory: bool) -> Carry<E> {
    match modes {
        _ if memory => carry::<F::Narrow, MODES_MAX, PARTIALS_WITH_MEMORY>,
        _ if F::LOOPS => carry::<F::Narrow, MODES_MAX, PARTIALS>,
        1 => carry::<F::Narrow, 1, PARTIALS>,
        2 => carry::<F::Narrow, 2, PARTIALS>,
        3 => carry::<F::Narrow, 3, PARTIALS>,
        4 => carry::<F::Narrow, 4, PARTIALS>,
        6 => carry::<F::Narrow, 6, PARTIALS>,
        8 => carry::<F::Narrow, 8, PARTIALS>,
        _ => carry::<F::Narrow, MODES_MAX, PARTIALS>,
    }
}

impl<L: Lane> WithLaw<Dual<L>> for KicksWith<L> {
    type Output = Kicks<L::Element>;

    fn with<I: Interaction<Dual<L>>>(self) -> Self::Output {
        Kicks { partials: partials::<L, I>, carry: self.0, stride: stride::<L> }
    }
}

impl<E: Lane<Element = E>> Tangent<E> {
    fn new(see: Seer<E>, kicks: Kicks<E>) -> Self {
        Self { width: see.width, modes: see.modes, see, kicks }
    }

    /// One period from steady free motion: `constants` and `state` as [`super::Stepper`] has them, and the state ends where
    /// [`super::Stepper::coast`] ends it, to the bit. Shows the slopes of as many of the first instances as `least` has
    /// numbers.
    ///
    /// Steps out of contact whose kick hardly changes are left out: all of them together change the slope by about `least`, of
    /// each of these instances, at most. 0 leaves none out.
    pub fn period(
        &self,
        constants: &[E],
        state: &mut [E],
        waves: &[Wave<E>],
        least: &[f64],
        room: &mut Room<E>,
        mut show: impl FnMut(usize, SlopeRows<E>),
    ) {
        let zero = E::splat(0.0);
        room.seen.resize(waves.len() * self.see.rows * self.width, zero);
        (self.see.period)(self.modes, constants, state, waves, &mut room.seen);
        self.little(constants, waves.len(), least, room);
        // Whichever of the two, the same bits.
        let dense = 2 * least.len() > self.width;
        if dense {
            let laws = &constants[law_row(self.modes) * self.width..];
            let given = (laws, &room.little[..]);
            (self.kicks.partials)(given, &room.seen, &mut room.steps, &mut room.partials);
        }
        for lane in 0..least.len() {
            if !dense {
                self.alone(lane, constants, waves.len(), room);
            }
            self.lever(lane, constants, waves.len() as u32, room);
            let lever = (&room.motion[..], &room.flows[..]);
            let Room { steps, partials, slope, .. } = room;
            let lane_of = dense.then_some(lane);
            let events = Events { steps, partials, width: self.width, lane: lane_of };
            (self.kicks.carry)(lever, self.modes, waves.len() as u32, events, slope);
            show(lane, SlopeRows { numbers: &room.slope, stride: (self.kicks.stride)(self.modes) });
        }
    }

    /// The kicks of one of few instances, its steps side by side.
    fn alone(&self, lane: usize, constants: &[E], count: usize, room: &mut Room<E>) {
        let zero = E::splat(0.0);
        let seen = self.see.rows;
        let at = |step: usize, row: usize| room.seen[(step * seen + row) * self.width + lane];
        let little = room.little[lane];
        let flat =
            |a: usize, b: usize| (at(a, 4) - at(b, 4)).abs().less(little * (at(a, 0) - at(b, 0)).abs());
        let acts = |step: &usize| {
            let (last, next) = (step.max(&1) - 1, (step + 1).min(count - 1));
            let inside = zero.less(at(*step, 5));
            E::any(inside)
                || E::any(zero.less(at(*step, 4)))
                    && !(E::any(flat(*step, last)) && E::any(flat(*step, next)))
        };
        let own: Vec<u32> = (0..count).filter(acts).map(|step| step as u32).collect();
        let rows = seen * self.width;
        let mut packed = vec![zero; own.len().div_ceil(self.width) * rows];
        for (n, step) in own.iter().enumerate() {
            for row in 0..seen {
                packed[n / self.width * rows + row * self.width + n % self.width] = at(*step as usize, row);
            }
        }
        let laws = law_row(self.modes) * self.width;
        let laws = constants[laws..].iter().skip(lane).step_by(self.width);
        let spread: Vec<E> = laws.flat_map(|number| std::iter::repeat_n(*number, self.width)).collect();
        let none = vec![zero; self.width];
        (self.kicks.partials)((&spread, &none), &packed, &mut room.steps, &mut room.partials);
        room.steps = own;
    }

    /// [`little`] of each instance.
    fn little(&self, constants: &[E], steps: usize, least: &[f64], room: &mut Room<E>) {
        room.little.clear();
        room.little.extend((0..self.width).map(|lane| {
            let lands = LANDS.start * self.modes..LANDS.end * self.modes;
            let lands = lands.map(|row| constants[row * self.width + lane].lane(0));
            E::splat(little(lands, steps, least.get(lane).copied().unwrap_or(0.0)))
        }));
    }

    /// The constants of an instance's lever, where they are not those of the one before.
    fn lever(&self, lane: usize, constants: &[E], steps: u32, room: &mut Room<E>) {
        let count = MOTION * self.modes;
        let own = || (0..count).map(|row| constants[row * self.width + lane]);
        let bits = |number: E| number.lane(0).to_bits();
        let same = room.period == steps && room.motion.len() == count;
        if same && own().zip(&room.motion).all(|(own, last)| bits(own) == bits(*last)) {
            return;
        }
        room.period = steps;
        room.motion.clear();
        room.motion.extend(own());
        powers(&room.motion, self.modes, steps, &mut room.flows);
    }
}
