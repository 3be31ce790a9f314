//! The period map of instances of one law, number of modes and number of steps. Their constants are made once, and their
//! periods are stepped side by side, as many as a lane holds.

use super::kernel_constants::{flight, free, gap_and_law, lever, lever_key, member};
use super::kernel_dispatch::{TangentReal, stepper};
use super::measurement::{Sums, finish};
use super::period_jacobian::kept;
use super::section_state::indentation;
use super::{EngineError, Finished, section_state, start};
use crate::kernel::{
    Flight, Flights, LENGTH, Lever, Room, Rounding, RunSums, Span, Stepper, Tangent, Wave, flight_block,
};
use crate::plan::{Case, Class, Plan, SectionState, Shape};
use crate::scene::Start;
use std::collections::HashMap;

/// The start of an instance's period.
#[derive(Clone, Copy)]
pub(super) struct MapStart<'a> {
    /// Travels of the kept modes and rates over their angular frequencies, then the law's memory; missing modes are at rest.
    pub x: &'a [f64],
    pub u: &'a [f64],
    pub touching: bool,
    /// Divisor that converts these to kernel units.
    pub unit: f64,
}

impl<'a> MapStart<'a> {
    pub fn of(station: &'a SectionState) -> Self {
        Self { x: &station.x, u: &station.u, touching: station.touching, unit: LENGTH }
    }
}

/// Instances of one law, number of modes and number of steps.
pub(super) struct BatchMap {
    pub stepper: Stepper<f64>,
    pub tangent: Tangent<f64>,
    /// Modes of each instance, without padding; and of these, the ones that are the lever's and no memory.
    modes: usize,
    swinging: usize,
    /// By harmonic.
    waves: Vec<Vec<Wave<f64>>>,
    /// The distinct levers, and by row the index of its lever.
    levers: Vec<Lever>,
    lever_of: Vec<u32>,
    /// Steps in a block of free flight, where measured periods fly; and flight by lever.
    block: Option<usize>,
    flights: Vec<Flight>,
    /// By row: its number in the plan, and its case.
    cases: Vec<(u32, Case)>,
    /// By row: the free motion's numbers, the gap and the law's constants, `own` numbers in all.
    own: usize,
    rows: Vec<f64>,
    /// Cosine and sine of half a step.
    half: (f64, f64),
    /// Run sums before the first period.
    none_yet: Vec<f64>,
}

/// Rows of one number per instance side by side, in the kernel's layout.
pub(super) struct Buffers {
    width: usize,
    /// The lever's constants do not change if all instances share the lever.
    constants: Vec<f64>,
    /// Free flight of the same levers; empty where none flies.
    flights: Vec<f64>,
    state: Vec<f64>,
    sums: Vec<f64>,
    /// Travel beyond the free motion at each start, kernel units.
    travel: Vec<f64>,
}

impl BatchMap {
    /// The map of these instances of the plan, which all have this shape.
    pub fn new(
        plan: &Plan,
        (steps, law, modes): Shape,
        instances: impl ExactSizeIterator<Item = u32>,
        rounding: Rounding,
    ) -> Result<Self, EngineError> {
        let class = Class { law, modes, steps, instances: Vec::new() };
        let (stepper, tangent) = (stepper(rounding, &class)?, f64::tangent(rounding, &class)?);
        let count = instances.len();
        let (mut levers, mut known, mut lever_of) = (Vec::new(), HashMap::new(), Vec::with_capacity(count));
        let (mut cases, mut rows) = (Vec::with_capacity(count), Vec::new());
        // A shader steps through all blocks, and so does what must have its bits.
        let block = flight_block(steps).filter(|_| stepper.flies && rounding.fuses());
        let mut flights = Vec::new();
        // Most instances have the lever of the one before.
        let mut last = None;
        for i in instances {
            let one = member(plan, i);
            let key = lever_key(&one);
            let number = match last {
                Some((same, number)) if same == key => number,
                _ => *known.entry(key).or_insert_with(|| {
                    levers.push(lever(&one, stepper.modes));
                    flights.extend(
                        block.map(|block| flight(&one, (block, plan.wants.harmonics), stepper.modes)),
                    );
                    levers.len() as u32 - 1
                }),
            };
            last = Some((key, number));
            lever_of.push(number);
            rows.extend(free(&one, Start::Steady).into_iter().chain(gap_and_law(&one)));
            if cases.is_empty() {
                rows.reserve(rows.len() * (count - 1));
            }
            // No change counts against a state: one period alone cannot tell.
            cases.push((i, Case { least_change: Some(f64::INFINITY), ..one.0 }));
        }
        Ok(Self {
            stepper,
            tangent,
            modes,
            swinging: modes - usize::from(law.has_memory()),
            waves: start::waves(steps, plan.wants.harmonics),
            levers,
            lever_of,
            block,
            flights,
            own: rows.len() / cases.len().max(1),
            cases,
            rows,
            half: section_state::half_step(steps),
            none_yet: RunSums::new().numbers().copied().collect(),
        })
    }

    /// Steps in a period.
    pub fn steps(&self) -> u64 {
        self.waves[0].len() as u64
    }

    pub fn buffers(&self, width: usize) -> Buffers {
        let lever = &self.levers[0];
        let constants = lever.motion.len() + self.own + lever.energy.len();
        let mut rows = Buffers {
            width,
            constants: vec![0.0; constants * width],
            flights: vec![0.0; self.flights.first().map_or(0, |flight| flight.fields.len()) * width],
            state: vec![0.0; (2 * self.stepper.modes + 1) * width],
            sums: vec![0.0; (3 + self.none_yet.len()) * width],
            travel: vec![0.0; width],
        };
        (0..width).for_each(|lane| self.put_lever(lane, 0, &mut rows));
        rows
    }

    fn put_lever(&self, lane: usize, number: usize, rows: &mut Buffers) {
        let lever = &self.levers[number];
        if let Some(flight) = self.flights.get(number) {
            let places = rows.flights.chunks_exact_mut(rows.width).map(|row| &mut row[lane]);
            places.zip(&flight.fields).for_each(|(place, field)| *place = *field);
        }
        let places = rows.constants.chunks_exact_mut(rows.width).map(|row| &mut row[lane]);
        let (motion, last) = (lever.motion.len(), lever.motion.len() + self.own);
        for (n, start) in places.enumerate() {
            match n {
                n if n < motion => *start = lever.motion[n],
                n if n >= last => *start = lever.energy[n - last],
                _ => {}
            }
        }
    }

    /// Writes up to a batch of starts to the rows; `places` gives their indices in a list, and their instances' rows here.
    pub fn gather<'a>(
        &self,
        places: &[(usize, u32)],
        place: impl Fn(usize) -> MapStart<'a>,
        rows: &mut Buffers,
    ) {
        let (width, modes, motion) = (rows.width, self.stepper.modes, self.levers[0].motion.len());
        for lane in 0..width {
            // The last one fills the lanes left over.
            let (start, row) = places[lane.min(places.len() - 1)];
            if self.levers.len() > 1 {
                self.put_lever(lane, self.lever_of[row as usize] as usize, rows);
            }
            let own = &self.rows[row as usize * self.own..][..self.own];
            for (n, number) in own.iter().enumerate() {
                rows.constants[(motion + n) * width + lane] = *number;
            }
            let MapStart { x, u, touching, unit } = place(start);
            for k in 0..self.modes {
                rows.state[k * width + lane] = x[k] / unit;
                rows.state[(modes + k) * width + lane] = u[k] / unit;
            }
            rows.travel[lane] = x[..self.swinging].iter().map(|x| x / unit).sum();
            rows.state[2 * modes * width + lane] = f64::from(u8::from(touching));
        }
    }

    /// Steps the rows through these periods.
    pub fn after(&self, periods: u32, rows: &mut Buffers) {
        let mut done = 0;
        while done < periods {
            done += self.stepper.coast(&rows.constants, &mut rows.state, &self.waves[0], periods - done);
        }
    }

    /// Steps the rows through a period and returns the Jacobian of each.
    pub fn slopes(&self, least: &[f64], (rows, room): (&mut Buffers, &mut Room<f64>)) -> Vec<Box<[f64]>> {
        let mut slopes = Vec::with_capacity(least.len());
        let Buffers { constants, state, .. } = rows;
        self.tangent.period(constants, state, &self.waves[0], least, room, |_, slope| {
            slopes.push(kept((self.modes, self.tangent.modes), |row, column| slope.at(row, column)));
        });
        slopes
    }

    /// Steps the gathered rows through one measured period.
    pub fn measure(&self, places: &[(usize, u32)], plan: &Plan, rows: &mut Buffers) {
        let (width, modes) = (rows.width, self.stepper.modes);
        for lane in 0..width {
            let (_, row) = places[lane.min(places.len() - 1)];
            let (i, case) = &self.cases[row as usize];
            let last = indentation(case, (plan.driven(*i), Start::Steady), self.half, rows.travel[lane]);
            let touched = rows.state[2 * modes * width + lane];
            let first = rows.sums.chunks_exact_mut(width).zip([last, last, touched]);
            first.for_each(|(row, number)| row[lane] = number);
        }
        let sums = rows.sums.chunks_exact_mut(width).skip(3);
        sums.zip(&self.none_yet).for_each(|(row, number)| row.fill(*number));
        let flights = self.block.map(|block| Flights { fields: &rows.flights, block });
        let span =
            Span { waves: &self.waves, decay: None, wants: plan.wants, flights, measured: true, periods: 1 };
        self.stepper.measure(&rows.constants, &mut rows.state, &mut rows.sums, &span);
    }

    /// Reads the state of the instance in a lane; see [`section_state::put`].
    pub fn put(
        &self,
        lane: usize,
        place: (&mut [f64], &mut [f64]),
        unit: f64,
        rows: &Buffers,
    ) -> (bool, bool) {
        let number = |row: usize| rows.state[row * rows.width + lane];
        section_state::put((self.modes, self.stepper.modes), number, place, unit)
    }

    /// The measurement of the instance in a lane, whose row here is `row`.
    pub fn finished(&self, (lane, row): (usize, u32), finite: bool, plan: &Plan, rows: &Buffers) -> Finished {
        let mut run_sums = RunSums::new();
        let numbers = rows.sums.chunks_exact(rows.width).skip(3).map(|row| row[lane]);
        run_sums.fill(numbers);
        let (i, case) = &self.cases[row as usize];
        let sums = Sums::new(run_sums, finite, 1, case.steps);
        finish(&sums, case, plan.driven(*i), &plan.run, plan.wants)
    }
}
