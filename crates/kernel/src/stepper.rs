//! Steps for one law, number of modes and set of instructions, behind functions that know neither: the one place where
//! the kernel is compiled for all of them.
//!
//! Numbers come and go in rows, one number for each instance side by side; what is done once for an instance is done
//! outside, by code that is compiled once.

use super::constants::ZERO;
use super::contact::{self, Interaction};
use super::lanes::{Family, Rounding, WithLanes, with_double, with_single};
use super::period::{Span, each_step, period, unmeasured_period};
use super::run_sums::RunSums;
use super::sample::Wave;
use super::step::{Case, Decay, State};
use super::tally::Tally;
use super::tangent::{seen_period, seen_rows};

use super::{Lane, Law, MODES_MAX, WRITTEN_OUT, Wants, WithLaw};
use std::marker::PhantomData;

/// Steps [`Stepper::width`] instances of one law and number of modes side by side.
///
/// `constants` are the rows of [`super::Lever::motion`], of the free motion's cosine, sine and rate, of the gap, of the
/// law's constants in the order of [`super::contact::Interaction::FIELDS`], and last of [`super::Lever::energy`];
/// `state` those of x of each mode, of u of each, and of contact (1 or 0).
#[derive(Clone, Copy, Debug)]
pub struct Stepper<E> {
    /// Instances side by side.
    pub width: usize,
    /// Modes that each instance's lever must have, those filled up and the law's memory included.
    pub modes: usize,
    /// Whether measured periods take in [`Span::flights`].
    pub flies: bool,
    coast: Coast<E>,
    measure: Measure<E>,
}

/// Steps instances through a period of which all is seen; otherwise as [`Stepper::coast`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seer<E> {
    pub width: usize,
    pub modes: usize,
    /// Rows that a step leaves.
    pub rows: usize,
    pub period: See<E>,
}

pub(crate) type See<E> = fn(usize, &[E], &mut [E], &[Wave<E>], &mut [E]);
type Coast<E> = fn(usize, &[E], &mut [E], &[Wave<E>], u32) -> u32;
type Measure<E> = fn(usize, &[E], &mut [E], &mut [E], &Span<E>) -> u32;

impl<E> Stepper<E> {
    /// Steps through up to so many periods of which nothing is summed, from steady free motion. How many were done: it
    /// stops after one that leaves a state beyond f32's range.
    pub fn coast(&self, constants: &[E], state: &mut [E], waves: &[Wave<E>], periods: u32) -> u32 {
        (self.coast)(self.modes, constants, state, waves, periods)
    }

    /// The same with sums: `sums` are rows of the indentation at the last two samples, of contact at the last one, and of
    /// [`RunSums::numbers`].
    pub fn measure(&self, constants: &[E], state: &mut [E], sums: &mut [E], span: &Span<E>) -> u32 {
        (self.measure)(self.modes, constants, state, sums, span)
    }
}

/// Numbers that instances can be stepped in: f32 and f64.
pub trait Real: Lane<Element = Self> {
    /// The stepper for a law and a number of modes; none for no mode, or for more than [`MODES_MAX`].
    fn stepper(rounding: Rounding, law: Law, modes: usize) -> Option<Stepper<Self>>;
}

impl Real for f32 {
    fn stepper(rounding: Rounding, law: Law, modes: usize) -> Option<Stepper<Self>> {
        with_single(rounding, Compiled::<Stepper<f32>> { law, modes, made: PhantomData })
    }
}

impl Real for f64 {
    fn stepper(rounding: Rounding, law: Law, modes: usize) -> Option<Stepper<Self>> {
        with_double(rounding, Compiled::<Stepper<f64>> { law, modes, made: PhantomData })
    }
}

/// What is compiled for a law and a number of modes: a [`Stepper`], or a [`Seer`].
pub(crate) struct Compiled<T> {
    pub law: Law,
    pub modes: usize,
    pub made: PhantomData<T>,
}

/// Something that is compiled for lanes, a law and a number of modes.
pub(crate) trait Make<E> {
    /// `modes` are those of a loop; more than [`WRITTEN_OUT`] are.
    fn make<L: Lane<Element = E>, I: Interaction<L>, const M: usize>(modes: usize) -> Self;
}

impl<E: Copy, T: Make<E>> WithLanes<E> for Compiled<T> {
    type Output = Option<T>;

    fn with<F: Family<E>>(self) -> Option<T> {
        if cfg!(test) {
            // This crate's unit tests step without it. Where nothing is compiled for it, their build takes half the time.
            return None;
        }
        let Self { law, modes, .. } = self;
        macro_rules! made {
            ($($(#[$doc:meta])* $law:ident = $code:literal, $word:literal $(in $scenes:ident)?, $kernel:ident
                { attraction: $attraction:ident, hysteresis: $hysteresis:literal, history: $history:literal,
                  kin: $kin:tt, reference: $reference:ident,
                  wide: [$($two:literal)*], narrow: [$($one:literal)*] };)*) => {
                match law {
                    $(Law::$law => match modes {
                        0 => None,
                        ..=MODES_MAX if F::LOOPS => Some(T::make::<F::Narrow, contact::$kernel<F::Narrow>, MODES_MAX>(modes)),
                        _ if F::LOOPS => None,
                        $(..=$two => Some(T::make::<F::Wide, contact::$kernel<F::Wide>, $two>(modes)),)*
                        $(..=$one => Some(T::make::<F::Narrow, contact::$kernel<F::Narrow>, $one>(modes)),)*
                        _ => None,
                    },)*
                }
            };
        }
        crate::laws!(made)
    }
}

impl<E: Copy> Make<E> for Stepper<E> {
    fn make<L: Lane<Element = E>, I: Interaction<L>, const M: usize>(modes: usize) -> Self {
        Self {
            width: L::WIDTH,
            modes: if M <= WRITTEN_OUT { M } else { modes },
            flies: I::ONLY_IN_CONTACT,
            coast: coast::<L, I, M>,
            measure: measure::<L, I, M>,
        }
    }
}

impl<E: Copy> Make<E> for Seer<E> {
    fn make<L: Lane<Element = E>, I: Interaction<L>, const M: usize>(modes: usize) -> Self {
        Self {
            width: L::WIDTH,
            modes: if M <= WRITTEN_OUT { M } else { modes },
            rows: seen_rows(I::MEMORY),
            period: see::<L, I, M>,
        }
    }
}

/// A call of its own, as [`store`] is: inlined into their three callers they make the crate's machine code a fifth larger.
#[inline(never)]
fn load<L: Lane, I: Interaction<L>, const M: usize>(
    modes: usize,
    constants: &[L::Element],
    rows: &[L::Element],
) -> (Case<L, I, M>, State<L, M>) {
    L::run(
        #[inline(always)]
        || (Case::load(modes, constants), State::load(modes, rows)),
    )
}

fn see<L: Lane, I: Interaction<L>, const M: usize>(
    modes: usize,
    constants: &[L::Element],
    rows: &mut [L::Element],
    waves: &[Wave<L::Element>],
    seen: &mut [L::Element],
) {
    let (case, mut state) = load::<L, I, M>(modes, constants, rows);
    seen_period(&case, &mut state, waves, seen);
    store(&state, modes, rows);
}

fn coast<L: Lane, I: Interaction<L>, const M: usize>(
    modes: usize,
    constants: &[L::Element],
    rows: &mut [L::Element],
    waves: &[Wave<L::Element>],
    periods: u32,
) -> u32 {
    let (case, mut state) = load::<L, I, M>(modes, constants, rows);
    let mut done = 0;
    while done < periods {
        unmeasured_period(&case, &mut state, waves);
        done += 1;
        if beyond(&state) {
            break;
        }
    }
    store(&state, modes, rows);
    done
}

fn measure<L: Lane, I: Interaction<L>, const M: usize>(
    modes: usize,
    constants: &[L::Element],
    rows: &mut [L::Element],
    sums: &mut [L::Element],
    span: &Span<L::Element>,
) -> u32 {
    let (case, mut state) = load::<L, I, M>(modes, constants, rows);
    let (mut tally, mut run_sums) = load_sums::<L>(sums);
    let steps = span.waves[0].len();
    let mut done = 0;
    while done < span.periods {
        let decay = span.decay.map(|rows| &rows[done as usize * steps..][..steps]);
        period(&case, &mut state, span, decay, &mut tally);
        close(&mut run_sums, &mut tally, steps, span.measured.then_some(span.wants));
        done += 1;
        if beyond(&state) {
            break;
        }
    }
    store(&state, modes, rows);
    store_sums(&tally, &run_sums, sums);
    done
}

fn beyond<L: Lane, const M: usize>(state: &State<L, M>) -> bool {
    L::run(
        #[inline(always)]
        || state.beyond(),
    )
}

#[inline(never)]
fn store<L: Lane, const M: usize>(state: &State<L, M>, modes: usize, rows: &mut [L::Element]) {
    L::run(
        #[inline(always)]
        || state.store(modes, rows),
    );
}

fn load_sums<L: Lane>(sums: &[L::Element]) -> (Tally<L>, RunSums<L>) {
    L::run(
        #[inline(always)]
        || {
            let (mut carried, mut run_sums) = ([L::splat(ZERO); 3], RunSums::new());
            let places = carried.iter_mut().chain(run_sums.places());
            for (place, row) in places.zip(sums.chunks_exact(L::WIDTH)) {
                *place = L::load(row);
            }
            let [first, middle, touched] = carried;
            (Tally::resume([first, middle], touched), run_sums)
        },
    )
}

fn store_sums<L: Lane>(tally: &Tally<L>, run_sums: &RunSums<L>, sums: &mut [L::Element]) {
    L::run(
        #[inline(always)]
        || {
            let carried = tally.carried();
            for (number, row) in carried.iter().chain(run_sums.numbers()).zip(sums.chunks_exact_mut(L::WIDTH))
            {
                number.store(row);
            }
        },
    );
}

/// Takes the period into the run's sums.
fn close<L: Lane>(run_sums: &mut RunSums<L>, tally: &mut Tally<L>, steps: usize, measured: Option<Wants>) {
    L::run(
        #[inline(always)]
        || {
            run_sums.close(tally, L::splat(steps as f64), measured);
            tally.next_period();
        },
    );
}

/// What a step of one instance saw, kernel units.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// The modes' parts of the travel before the kick.
    pub x: [f64; MODES_MAX],
    /// Steady free travel of the tip, and travel beyond it.
    pub steady: f64,
    pub beyond: f64,
    pub indentation: f64,
    pub impulse: f64,
    pub shift: f64,
    pub touching: bool,
}

/// Steps one instance of so many modes through a period in f64 and shows each step; rows as [`Stepper`] has them, one
/// number wide.
pub type Tracer = fn(usize, &[f64], &mut [f64], &[Wave<f64>], Option<&[Decay<f64>]>, &mut dyn FnMut(&Traced));

/// The tracer of a law.
pub fn tracer(rounding: Rounding, law: Law) -> Tracer {
    with_double(rounding.least(), NewTracer(law))
}

struct NewTracer(Law);

impl WithLanes<f64> for NewTracer {
    type Output = Tracer;

    fn with<F: Family<f64>>(self) -> Tracer {
        self.0.with(TraceWith::<F::Narrow>(PhantomData))
    }
}

struct TraceWith<L>(PhantomData<L>);

impl<L: Lane<Element = f64>> WithLaw<L> for TraceWith<L> {
    type Output = Tracer;

    fn with<I: Interaction<L>>(self) -> Tracer {
        if cfg!(test) {
            return |_, _, _, _, _, _| {}; // As above.
        }
        trace::<L, I>
    }
}

/// Every lane holds the same instance.
fn trace<L: Lane<Element = f64>, I: Interaction<L>>(
    modes: usize,
    constants: &[f64],
    rows: &mut [f64],
    waves: &[Wave<f64>],
    decay: Option<&[Decay<f64>]>,
    see: &mut dyn FnMut(&Traced),
) {
    let spread = |row: &[f64]| -> Vec<f64> {
        row.iter().flat_map(|number| std::iter::repeat_n(*number, L::WIDTH)).collect()
    };
    let (case, mut state) = L::run(
        #[inline(always)]
        || {
            let case = Case::<L, I, MODES_MAX>::load(modes, &spread(constants));
            (case, State::load(modes, &spread(rows)))
        },
    );
    each_step(
        &case,
        &mut state,
        waves,
        decay,
        Wants::FUNDAMENTAL,
        #[inline(always)]
        |_, before, sample| {
            let mut x = [0.0; MODES_MAX];
            for (place, number) in x.iter_mut().zip(&before.x[..modes]) {
                *place = number.lane(0);
            }
            see(&Traced {
                x,
                steady: sample.steady.lane(0),
                beyond: sample.beyond.lane(0),
                indentation: sample.indentation.lane(0),
                impulse: sample.kick.impulse.lane(0),
                shift: sample.kick.shift.lane(0),
                touching: sample.kick.touching.lane(0) > 0.0,
            });
        },
    );
    let numbers = state.x[..modes].iter().chain(&state.u[..modes]).chain([&state.touching]);
    numbers.zip(rows).for_each(|(number, place)| *place = number.lane(0));
}
