//! One drive period of steps.

use super::constants::ZERO;
use super::contact::Interaction;
use super::flight::Flights;
use super::sample::{Sample, Wave};
use super::step::{Case, Decay, State};
use super::tally::Tally;
use super::{Lane, Wants};

/// Periods that are measured.
#[derive(Clone, Copy, Debug)]
pub struct Span<'a, E> {
    /// Cosines and sines at the steps of a period, by harmonic.
    pub waves: &'a [Vec<Wave<E>>],
    /// What decays of the free motion at the steps of these periods, after a start from rest.
    pub decay: Option<&'a [Decay<E>]>,
    /// Sums that are kept.
    pub wants: Wants,
    /// Where instances may fly through blocks of steps, from steady free motion.
    pub flights: Option<Flights<'a, E>>,
    /// Whether the run's sums takes them in; else it only sees how the fundamental changes.
    pub measured: bool,
    pub periods: u32,
}

/// Steps a lane through one drive period and hands each sample to `see`, with the state before its kick:
/// `waves` for the steps, `decay` for the same steps where the run started from rest.
///
/// The steps are compiled for the lane's instructions; `see` ought to be inlined into them.
pub(crate) fn each_step<L: Lane, I: Interaction<L>, const M: usize>(
    case: &Case<L, I, M>,
    state: &mut State<L, M>,
    waves: &[Wave<L::Element>],
    decay: Option<&[Decay<L::Element>]>,
    wants: Wants,
    mut see: impl FnMut(usize, &State<L, M>, &Sample<L>),
) {
    L::run(
        #[inline(always)]
        || {
            // Something aligned that must be in memory: the compiler then aligns the whole stack, and what
            // it keeps there of registers does not straddle lines of the cache.
            std::hint::black_box(&L::splat(ZERO));
            // A copy, which the compiler can keep in registers.
            let mut here = *state;
            for (index, wave) in waves.iter().enumerate() {
                let before = here;
                let sample = case.step(&mut here, *wave, decay.map(|rows| rows[index]), wants);
                see(index, &before, &sample);
            }
            *state = here;
        },
    );
}

/// One drive period from steady free motion of which nothing is summed; `waves` of the fundamental.
///
/// A loop of its own: without the sums, more of the step stays in registers.
pub(crate) fn unmeasured_period<L: Lane, I: Interaction<L>, const M: usize>(
    case: &Case<L, I, M>,
    state: &mut State<L, M>,
    waves: &[Wave<L::Element>],
) {
    L::run(
        #[inline(always)]
        || {
            // As in `each_step`.
            std::hint::black_box(&L::splat(ZERO));
            let mut here = *state;
            for wave in waves {
                case.step(&mut here, *wave, None, Wants::FUNDAMENTAL);
            }
            *state = here;
        },
    );
}

/// One drive period into `tally`, which holds the sums; `decay` is of its steps. Where the span has flights, instances that are free
/// for a block of steps fly through it.
pub(crate) fn period<L: Lane, I: Interaction<L>, const M: usize>(
    case: &Case<L, I, M>,
    state: &mut State<L, M>,
    span: &Span<L::Element>,
    decay: Option<&[Decay<L::Element>]>,
    tally: &mut Tally<L>,
) {
    let (waves, wants) = (span.waves, span.wants);
    let (steps, flights) = (waves[0].len(), span.flights.filter(|_| I::ONLY_IN_CONTACT));
    L::run(
        #[inline(always)]
        || {
            // As in `each_step`.
            std::hint::black_box(&L::splat(ZERO));
            let (mut here, mut sums) = (*state, *tally);
            let mut begin = 0;
            while begin < steps {
                let mut end = steps;
                let mut flown = None;
                if let Some(flights) = flights.filter(|flights| begin + flights.block <= steps) {
                    end = begin + flights.block;
                    // In memory: what steps stays in registers.
                    let mut there = here;
                    let free = flights.free(case, &there, waves[0][begin]);
                    if L::any(free) {
                        let mut summed = sums;
                        flights.fly(case, &mut there, (waves, begin), wants.harmonics, &mut summed);
                        if !L::any(L::not(free)) {
                            (here, sums, begin) = (there, summed, end);
                            continue;
                        }
                        flown = Some((free, there, summed));
                    }
                }
                for index in begin..end {
                    let decay = decay.map(|rows| rows[index]);
                    let sample = case.step(&mut here, waves[0][index], decay, wants);
                    sums.add(&sample, waves, index, wants);
                }
                if let Some((free, there, summed)) = &flown {
                    here.choose(*free, there);
                    sums.choose(*free, summed, wants.harmonics);
                }
                begin = end;
            }
            (*state, *tally) = (here, sums);
        },
    );
}
