//! As many instances as a lane holds, on their way through a run together.

use super::law::KernelLaw;
use super::measure::{Sums, first_seen};
use super::saved::Saved;
use super::start;
use crate::kernel::{
    Case, Decay, Flow, FlowMode, Free, LENGTH, Lane, Ledger, State, Tally, Wave, flown, period,
    unmeasured_period,
};
use crate::observe::Wants;
use crate::plan::{CasePlan, Driven, Plan, Station};
use crate::scene::{Run, Start};
use std::f64::consts::TAU;
use std::rc::Rc;

/// The least number that is infinite once it is rounded to f32: 2^128 - 2^103.
const BEYOND: f64 = 3.402_823_567_797_336_6e38;

/// Length of a step, s.
pub(super) fn step_length(driven: &Driven, steps: u32) -> f64 {
    TAU / (driven.free.omega * f64::from(steps))
}

/// Impulse per N: h^2 times the tip's mobility, in units of length.
pub(super) fn force_scale(driven: &Driven, steps: u32) -> f64 {
    step_length(driven, steps).powi(2) * driven.kept.mobility() / LENGTH
}

/// An instance and its driven instrument.
pub(super) type Member<'a> = (&'a CasePlan, &'a Driven);

/// Instance `instance` of the plan.
pub(super) fn member(plan: &Plan, instance: u32) -> Member<'_> {
    let case = &plan.cases[instance as usize];
    (case, &plan.drives[case.drive as usize])
}

/// The instances' constants as the kernel takes them; `members` has one for each lane.
pub(super) fn case<L: Lane, I: KernelLaw<L>, const M: usize>(
    members: &[Member],
    start: Start,
) -> Case<L, I, M> {
    let mut modes: Vec<Rc<Vec<FlowMode>>> = Vec::with_capacity(members.len());
    for (n, (_, driven)) in members.iter().enumerate() {
        let known = modes.last().filter(|_| std::ptr::eq(members[n - 1].1, *driven));
        modes.push(known.map_or_else(|| Rc::new(driven.kept.flow()), Rc::clone));
    }
    let flows: Vec<(&[FlowMode], f64)> = members
        .iter()
        .zip(&modes)
        .map(|((plan, driven), modes)| (modes.as_slice(), step_length(driven, plan.steps)))
        .collect();
    let contacts: Vec<_> =
        members.iter().map(|(plan, driven)| (plan.contact, force_scale(driven, plan.steps))).collect();
    let free: Vec<(f64, f64)> = members.iter().map(|(_, driven)| start::amplitudes(driven, start)).collect();
    Case {
        flow: Flow::new(&flows),
        free: Free {
            cosine: L::from_lanes(|i| free[i].0 / LENGTH),
            sine: L::from_lanes(|i| free[i].1 / LENGTH),
            rate: L::from_lanes(|i| TAU / f64::from(members[i].0.steps)),
        },
        gap: L::from_lanes(|i| members[i].0.gap / LENGTH),
        law: I::build(&contacts),
    }
}

/// Indentation at the run's first instant, kernel units.
pub(super) fn first_indentation((plan, driven): &Member, start: Start) -> f64 {
    let travel = match start {
        Start::Rest => 0.0,
        Start::Steady => start::amplitudes(driven, start).0,
    };
    -(plan.gap + travel) / LENGTH
}

/// The deviation half a step into the run: nothing in steady free motion; from rest, the decaying
/// part of each kept mode.
pub(super) fn state<L: Lane, I: KernelLaw<L>, const M: usize>(
    case: &Case<L, I, M>,
    members: &[Member],
    start: Start,
) -> State<L, M> {
    let half = |i: usize, k: usize| match start {
        Start::Steady => [0.0; 2],
        Start::Rest => decayed(members[i], k),
    };
    State {
        x: std::array::from_fn(|k| L::from_lanes(|i| half(i, k)[0])),
        u: std::array::from_fn(|k| L::from_lanes(|i| half(i, k)[1])),
        touching: case.law.touching_at(L::from_lanes(|i| first_indentation(&members[i], start))),
    }
}

/// Decaying part of a kept mode half a step after a start from rest: travel and rate over omega.
fn decayed((plan, driven): Member, k: usize) -> [f64; 2] {
    let Some(mode) = driven.kept.modes.get(k) else { return [0.0; 2] };
    let Some(index) = mode.index else { return [0.0; 2] };
    let [q, rate] = driven.free.transient[index];
    let tip = driven.instrument.modes[index].tip / LENGTH;
    let (x, u) = (tip * q, tip * rate / mode.omega);
    let half = 0.5 * step_length(driven, plan.steps);
    flown(mode.omega * half, mode.damping, [x, u])
}

/// Constants, state, and what has been measured so far.
pub(super) struct Track<L, I, const M: usize> {
    case: Case<L, I, M>,
    state: State<L, M>,
    tally: Tally<L>,
    ledger: Ledger<L>,
    /// Of each member, whether its state is still a number.
    finite: Vec<bool>,
    /// Drive periods done.
    pub done: u32,
}

impl<L: Lane, I: KernelLaw<L>, const M: usize> Track<L, I, M> {
    /// Up to [`Lane::WIDTH`] members; the last one also fills the lanes left over.
    pub fn new(members: &[Member], start: Start) -> Self {
        let mut filled = members.to_vec();
        filled.resize(L::WIDTH, members[members.len() - 1]);
        let case = case(&filled, start);
        let state = state(&case, &filled, start);
        let first = L::from_lanes(|i| first_indentation(&filled[i], start));
        let tally = Tally::start(first, state.touching);
        Self { case, state, tally, ledger: Ledger::new(), finite: vec![true; members.len()], done: 0 }
    }

    /// Members that were saved after `done` periods.
    pub fn resumed(members: &[Member], start: Start, saved: &[Saved], done: u32) -> Self {
        let mut track = Self::new(members, start);
        let at = |i: usize| &saved[i.min(saved.len() - 1)];
        track.state = State {
            x: std::array::from_fn(|k| L::from_lanes(|i| at(i).x.get(k).copied().unwrap_or(0.0))),
            u: std::array::from_fn(|k| L::from_lanes(|i| at(i).u.get(k).copied().unwrap_or(0.0))),
            touching: L::from_lanes(|i| at(i).touching),
        };
        let last = [0, 1].map(|n| L::from_lanes(|i| at(i).last[n]));
        track.tally = Tally::resume(last, L::from_lanes(|i| at(i).touched));
        track.ledger = Ledger::from_lanes(|i| &at(i).ledger);
        track.finite = saved.iter().map(|one| one.finite).collect();
        track.done = done;
        track
    }

    /// Where member `lane` stands.
    pub fn station(&self, lane: usize) -> Station {
        let mut station = Station { finite: self.finite[lane], ..Station::FREE };
        for (k, (x, u)) in self.state.x.iter().zip(&self.state.u).enumerate() {
            (station.x[k], station.u[k]) = (x.lane(lane) * LENGTH, u.lane(lane) * LENGTH);
        }
        station.touching = self.state.touching.lane(lane) > 0.0;
        station
    }

    /// Steps through `periods` more periods; `decay` holds their samples for a start from rest.
    pub fn advance(
        &mut self,
        run: &Run,
        periods: u32,
        waves: &[Vec<Wave<L::Element>>],
        decay: Option<&[Decay<L::Element>]>,
        wants: Wants,
    ) {
        let steps = waves[0].len();
        let (warm, seen) = (run.periods - run.measure, first_seen(run));
        for index in 0..periods {
            if self.finite.iter().all(|finite| !finite) {
                return;
            }
            match decay {
                None if self.done < seen => unmeasured_period(&self.case, &mut self.state, &waves[0]),
                _ => {
                    let rows = decay.map(|rows| &rows[index as usize * steps..][..steps]);
                    // Before the measured part only what judges steadiness is kept.
                    let measured = (self.done >= warm).then_some(wants);
                    let sums = measured.unwrap_or(Wants::FUNDAMENTAL);
                    period(&self.case, &mut self.state, waves, rows, sums, &mut self.tally);
                    self.close_period(steps, measured);
                }
            }
            if self.beyond() {
                for (lane, finite) in self.finite.iter_mut().enumerate() {
                    let state = self.state.x.iter().chain(&self.state.u);
                    *finite &= state.fold(true, |all, value| all & (value.lane(lane) as f32).is_finite());
                }
            }
            self.done += 1;
        }
    }

    /// Takes the period into the ledger.
    fn close_period(&mut self, steps: usize, measured: Option<Wants>) {
        L::run(
            #[inline(always)]
            || {
                self.ledger.close(&self.tally, steps, measured);
                self.tally.next_period();
            },
        );
    }

    /// Whether some state is no number. Beyond f32 counts as none, so that both precisions and a shader agree on it.
    fn beyond(&self) -> bool {
        L::run(
            #[inline(always)]
            || {
                let beyond = L::splat(BEYOND);
                let state = self.state.x.iter().zip(&self.state.u);
                state.fold(false, |some, (x, u)| {
                    some | L::any(L::not(L::both(x.abs().less(beyond), u.abs().less(beyond))))
                })
            },
        )
    }

    /// What has been measured of each member, with `steps` steps a period.
    pub fn sums(&self, run: &Run, steps: u32) -> Vec<Sums> {
        let sum = |(finite, ledger): (&bool, _)| Sums::new(ledger, *finite, run.measure, steps);
        self.finite.iter().zip(self.ledger.lanes()).map(sum).collect()
    }

    /// Members.
    pub fn members(&self) -> usize {
        self.finite.len()
    }
}
