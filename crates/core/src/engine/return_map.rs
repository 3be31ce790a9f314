//! Where instances are some periods later, on the CPU: their constants are made once, and periods stepped from any
//! place, again and again.

use super::compiled::{slopes, stepper};
use super::member::{Levers, Member, member, motion};
use super::{EngineError, Progress, start};
use crate::kernel::{LENGTH, Room, Rounding, SlopeRows, Stepper, Tangent, Wave};
use crate::plan::{Class, Plan, Station};
use crate::scene::Start;
use rayon::prelude::*;

/// The map that takes an instance's place at the start of a period of its drive to the one some periods later, with
/// the plan's steps and in f64.
pub trait ReturnMap: Send + Sync {
    /// Where each of `starts` (a number in the list of instances that the map was made for, and a place) is after
    /// `periods`; none where the run was stopped.
    ///
    /// This is done on the calling thread: callers have many lists.
    fn after(&self, starts: &[(u32, Station)], periods: u32, progress: &Progress) -> Vec<Option<Station>>;

    /// Where each of these is after one period, and how that changes with where it begins; none where the run was stopped.
    /// `room` is for the work, to be used again.
    fn sloped(&self, starts: &[SlopeStart], room: &mut Room<f64>, progress: &Progress)
    -> Vec<Option<Sloped>>;
}

/// Where the slope of a period is asked for.
#[derive(Clone, Copy, Debug)]
pub struct SlopeStart {
    /// A number in the list of instances that the map was made for.
    pub instance: u32,
    pub station: Station,
    /// What may be left out of the slope, about.
    pub least: f64,
}

/// Where a period ends, and its slope.
#[derive(Clone, Debug)]
pub struct Sloped {
    pub end: Station,
    /// Column by column: travels, then rates, of the kept modes; by each travel, then by each rate.
    pub slope: Box<[f64]>,
}

pub(super) struct Map {
    tables: Vec<Table>,
    /// By instance, its table and its row there.
    places: Vec<(u32, u32)>,
}

impl Map {
    pub fn new(plan: &Plan, instances: &[u32], rounding: Rounding) -> Result<Self, EngineError> {
        let part = plan.trial(instances, 1, 1);
        let mut places = vec![(0, 0); instances.len()];
        let classes = part.classes();
        let mut tables = Vec::with_capacity(classes.len());
        for (number, class) in classes.iter().enumerate() {
            for (row, instance) in class.instances.iter().enumerate() {
                places[*instance as usize] = (number as u32, row as u32);
            }
            tables.push(Table::new(&part, class, (stepper(rounding, class)?, slopes(rounding, class)?)));
        }
        Ok(Self { tables, places })
    }
}

impl Map {
    /// The starts of each table that has any: their places in the list, and their rows there.
    fn by_table<'a>(
        &'a self,
        instances: impl Iterator<Item = u32> + Clone + 'a,
    ) -> impl Iterator<Item = (&'a Table, Vec<(usize, u32)>)> + 'a {
        self.tables.iter().enumerate().filter_map(move |(number, table)| {
            let own: Vec<(usize, u32)> = (instances.clone().enumerate())
                .filter_map(|(n, instance)| {
                    let (table, row) = self.places[instance as usize];
                    (table as usize == number).then_some((n, row))
                })
                .collect();
            (!own.is_empty()).then_some((table, own))
        })
    }
}

impl ReturnMap for Map {
    fn after(&self, starts: &[(u32, Station)], periods: u32, progress: &Progress) -> Vec<Option<Station>> {
        let mut out = vec![None; starts.len()];
        for (table, own) in self.by_table(starts.iter().map(|start| start.0)) {
            let mut rows = table.buffers(table.stepper.width);
            for places in own.chunks(table.stepper.width) {
                if progress.stopped() {
                    return out;
                }
                table.gather(places, |n| &starts[n].1, &mut rows);
                table.after(periods, &mut rows);
                for (lane, (n, _)) in places.iter().enumerate() {
                    out[*n] = Some(table.end(lane, &starts[*n].1, &rows));
                }
                progress.add(places.len() as u64 * u64::from(periods) * table.waves.len() as u64);
            }
        }
        out
    }

    fn sloped(
        &self,
        starts: &[SlopeStart],
        room: &mut Room<f64>,
        progress: &Progress,
    ) -> Vec<Option<Sloped>> {
        let mut out = vec![None; starts.len()];
        for (table, own) in self.by_table(starts.iter().map(|start| start.instance)) {
            let mut rows = table.buffers(table.tangent.width);
            for places in own.chunks(table.tangent.width) {
                if progress.stopped() {
                    return out;
                }
                table.gather(places, |n| &starts[n].station, &mut rows);
                let least: Vec<f64> = places.iter().map(|(n, _)| starts[*n].least).collect();
                let mut slopes = Vec::with_capacity(places.len());
                let Buffers { constants, state, .. } = &mut rows;
                table.tangent.period(constants, state, &table.waves, &least, room, |lane, slope| {
                    slopes.push(table.slope(places[lane].1, slope));
                });
                for ((lane, (n, _)), slope) in places.iter().enumerate().zip(slopes) {
                    out[*n] = Some(Sloped { end: table.end(lane, &starts[*n].station, &rows), slope });
                }
                progress.add(places.len() as u64 * table.waves.len() as u64);
            }
        }
        out
    }
}

/// Instances of one class: the constants that all of them share, and a row of the others for each.
struct Table {
    stepper: Stepper<f64>,
    tangent: Tangent<f64>,
    /// Modes of each instance, those filled up not among them.
    modes: Vec<u8>,
    waves: Vec<Wave<f64>>,
    /// In their order; 0 where a number of a row stands.
    shared: Vec<f64>,
    /// Where the numbers of a row stand among them.
    own: Vec<usize>,
    rows: Vec<f64>,
}

/// Rows of a number for each instance side by side, as the kernel takes them.
struct Buffers {
    width: usize,
    /// Those that are shared are filled in.
    constants: Vec<f64>,
    state: Vec<f64>,
}

impl Table {
    fn new(plan: &Plan, class: &Class, (stepper, tangent): (Stepper<f64>, Tangent<f64>)) -> Self {
        let members: Vec<Member> = class.instances.iter().map(|instance| member(plan, *instance)).collect();
        let levers = Levers::of(&members, stepper.modes);
        let all = |one: Member| -> Vec<f64> { motion(one, levers.get(one), Start::Steady).collect() };
        let first = members.first().map_or_else(Vec::new, |one| all(*one));
        let differs = |mut differs: Vec<bool>, one: &Member| {
            let own = all(*one);
            let numbers = own.iter().zip(&first).map(|(own, first)| own.to_bits() != first.to_bits());
            differs.iter_mut().zip(numbers).for_each(|(place, differs)| *place |= differs);
            differs
        };
        let none = || vec![false; first.len()];
        let either = |a: Vec<bool>, b: Vec<bool>| a.iter().zip(&b).map(|(a, b)| a | b).collect();
        let differ = members.par_iter().fold(none, differs).reduce(none, either);
        let own: Vec<usize> = (0..differ.len()).filter(|place| differ[*place]).collect();
        let row = |one: &Member| {
            let all = all(*one);
            own.iter().map(move |place| all[*place]).collect::<Vec<f64>>()
        };
        Self {
            rows: members.par_iter().flat_map_iter(row).collect(),
            shared: first.iter().zip(&differ).map(|(number, own)| if *own { 0.0 } else { *number }).collect(),
            own,
            waves: start::waves(class.steps, 1).into_iter().flatten().collect(),
            modes: members.iter().map(|(_, driven)| driven.kept.modes.len() as u8).collect(),
            stepper,
            tangent,
        }
    }

    fn buffers(&self, width: usize) -> Buffers {
        Buffers {
            width,
            constants: self.shared.iter().flat_map(|number| std::iter::repeat_n(*number, width)).collect(),
            state: vec![0.0; (2 * self.stepper.modes + 1) * width],
        }
    }

    /// Puts up to as many starts as are stepped side by side into the rows: their places in a list, `places`, and their
    /// instances' rows here.
    fn gather<'a>(
        &self,
        places: &[(usize, u32)],
        station: impl Fn(usize) -> &'a Station,
        rows: &mut Buffers,
    ) {
        let (width, modes) = (rows.width, self.stepper.modes);
        for lane in 0..width {
            // The last one fills the places left over.
            let (start, row) = places[lane.min(places.len() - 1)];
            let station = station(start);
            let length = self.own.len();
            let own = &self.rows[row as usize * length..][..length];
            self.own
                .iter()
                .zip(own)
                .for_each(|(place, number)| rows.constants[place * width + lane] = *number);
            for k in 0..modes {
                rows.state[k * width + lane] = station.x[k] / LENGTH;
                rows.state[(modes + k) * width + lane] = station.u[k] / LENGTH;
            }
            rows.state[2 * modes * width + lane] = f64::from(u8::from(station.touching));
        }
    }

    /// Takes them on.
    fn after(&self, periods: u32, rows: &mut Buffers) {
        let mut done = 0;
        while done < periods {
            done += self.stepper.coast(&rows.constants, &mut rows.state, &self.waves, periods - done);
        }
    }

    /// Where one that began at `start` is.
    fn end(&self, lane: usize, start: &Station, rows: &Buffers) -> Station {
        let (width, modes) = (rows.width, self.stepper.modes);
        let mut end = *start;
        let number = |row: usize| rows.state[row * width + lane];
        for k in 0..modes {
            (end.x[k], end.u[k]) = (number(k) * LENGTH, number(modes + k) * LENGTH);
            // Beyond f32 counts as none, as in a run.
            end.finite &= (number(k) as f32).is_finite() && (number(modes + k) as f32).is_finite();
        }
        end.touching = number(2 * modes) > 0.0;
        end
    }

    /// The slope of the instance in this row.
    fn slope(&self, row: u32, slope: SlopeRows<f64>) -> Box<[f64]> {
        let (own, all) = (usize::from(self.modes[row as usize]), self.tangent.modes);
        let numbers = || (0..own).chain(all..all + own);
        numbers().flat_map(|column| numbers().map(move |row| slope.at(row, column))).collect()
    }
}
