//! Instances that are stepped side by side through a run.

use super::checkpoint::InstanceCheckpoint;
use super::kernel_constants::{LeverTable, Member, constants};
use super::measurement::{Sums, first_seen};
use crate::kernel::{Decay, LENGTH, Real, RunSums, Span, Stepper, Wants, Wave};
use crate::plan::SectionState;
use crate::scene::{Run, Start};

/// Constants, state and sums so far, in rows of one number per instance.
pub(super) struct Batch<E> {
    stepper: Stepper<E>,
    constants: Vec<E>,
    state: Vec<E>,
    sums: Vec<E>,
    /// By member: whether its state is still finite.
    finite: Vec<bool>,
    /// Drive periods done.
    done: u32,
}

impl<E: Real> Batch<E> {
    /// Up to [`Stepper::width`] members, each from its checkpoint after `done` periods. The last one also fills the lanes left
    /// over.
    pub fn new(
        stepper: &Stepper<E>,
        members: &[Member],
        levers: &LeverTable,
        start: Start,
        saved: impl Fn(usize) -> InstanceCheckpoint,
        done: u32,
    ) -> Self {
        let (width, modes) = (stepper.width, stepper.modes);
        let fields = constants(&members[0], levers.get(&members[0]), start).count();
        let zeros = |fields: usize| vec![E::element(0.0); fields * width];
        let sums = 3 + RunSums::<f64>::new().numbers().count();
        let mut batch = Self {
            stepper: *stepper,
            constants: zeros(fields),
            state: zeros(2 * modes + 1),
            sums: zeros(sums),
            finite: Vec::with_capacity(members.len()),
            done,
        };
        for lane in 0..width {
            let place = lane.min(members.len() - 1);
            let (member, saved) = (&members[place], saved(place));
            batch.put(lane, member, levers, start, &saved);
            if lane == place {
                batch.finite.push(saved.finite);
            }
        }
        batch
    }

    fn put(
        &mut self,
        lane: usize,
        member: &Member,
        levers: &LeverTable,
        start: Start,
        saved: &InstanceCheckpoint,
    ) {
        let (width, modes) = (self.stepper.width, self.stepper.modes);
        put(&mut self.constants, width, lane, constants(member, levers.get(member), start));
        let state = saved.x[..modes].iter().chain(&saved.u[..modes]).chain([&saved.touching]);
        put(&mut self.state, width, lane, state.copied());
        let sums = saved.last.iter().chain([&saved.touched]).chain(saved.run_sums.numbers());
        put(&mut self.sums, width, lane, sums.copied());
    }

    /// Steps through `periods` more periods; `decay` holds their samples for a start from rest.
    pub fn advance(
        &mut self,
        run: &Run,
        periods: u32,
        waves: &[Vec<Wave<E>>],
        decay: Option<&[Decay<E>]>,
        wants: Wants,
    ) {
        let (begin, end) = (self.done, self.done + periods);
        let (warm, seen) = (run.periods - run.measure, first_seen(run));
        while self.done < end && self.finite.contains(&true) {
            let (constants, state) = (&self.constants, &mut self.state);
            self.done += if decay.is_none() && self.done < seen {
                self.stepper.coast(constants, state, &waves[0], seen.min(end) - self.done)
            } else {
                // Before the measured part only the sums that judge steadiness are kept.
                let measured = self.done >= warm;
                let until = if measured { end } else { warm.min(end) };
                let span = Span {
                    waves,
                    decay: decay.map(|rows| &rows[(self.done - begin) as usize * waves[0].len()..]),
                    wants: if measured { wants } else { Wants::FUNDAMENTAL },
                    flights: None,
                    measured,
                    periods: until - self.done,
                };
                self.stepper.measure(constants, state, &mut self.sums, &span)
            };
            // A number beyond f32 counts as not finite, so that both precisions and a shader agree on it.
            for row in self.state.chunks_exact(self.stepper.width) {
                for (finite, value) in self.finite.iter_mut().zip(row) {
                    *finite &= (value.lane(0) as f32).is_finite();
                }
            }
        }
    }

    /// The section state of member `lane`.
    pub fn station(&self, lane: usize) -> SectionState {
        let modes = self.stepper.modes;
        let mut state = lane_of(&self.state, self.stepper.width, lane);
        let mut station = SectionState { finite: self.finite[lane], ..SectionState::FREE };
        let places = station.x[..modes].iter_mut().chain(&mut station.u[..modes]);
        places.zip(&mut state).for_each(|(place, value)| *place = value * LENGTH);
        station.touching = state.next().is_some_and(|touching| touching > 0.0);
        station
    }

    /// The sums of each member, with `steps` steps a period.
    pub fn sums(&self, run: &Run, steps: u32) -> Vec<Sums> {
        let sums = |(lane, finite): (usize, &bool)| {
            let mut run_sums = RunSums::new();
            let numbers = lane_of(&self.sums, self.stepper.width, lane).skip(3);
            run_sums.fill(numbers);
            Sums::new(run_sums, *finite, run.measure, steps)
        };
        self.finite.iter().enumerate().map(sums).collect()
    }

    /// Number of members.
    pub fn members(&self) -> usize {
        self.finite.len()
    }
}

/// Writes an instance's numbers to its lane of the rows.
fn put<E: Real>(rows: &mut [E], width: usize, lane: usize, numbers: impl Iterator<Item = f64>) {
    rows.chunks_exact_mut(width).zip(numbers).for_each(|(row, number)| row[lane] = E::element(number));
}

/// Reads an instance's numbers from its lane of the rows.
fn lane_of<E: Real>(rows: &[E], width: usize, lane: usize) -> impl Iterator<Item = f64> {
    rows.chunks_exact(width).map(move |row| row[lane].lane(0))
}
