//! Where instances are some periods later, on the CPU: their constants are made once, and periods stepped from any
//! place, again and again.

use super::batch_map::{BatchMap, Buffers, MapStart};
use super::period_jacobian::PeriodJacobian;
use super::{EngineError, Finished, ProfileSection, Progress};
use crate::kernel::{LENGTH, Room, Rounding};
use crate::plan::{Plan, SectionState};
use std::collections::BTreeMap;

/// The map that takes an instance's place at the start of a period of its drive to the one some periods later, with
/// the plan's steps and in f64.
pub trait ReturnMap: Send + Sync {
    /// Where each of `starts` (a number in the list of instances that the map was made for, and a place) is after
    /// `periods`; none where the run was stopped.
    ///
    /// This is done on the calling thread: callers have many lists.
    fn after(
        &self,
        starts: &[(u32, SectionState)],
        periods: u32,
        progress: &Progress,
    ) -> Vec<Option<SectionState>>;

    /// Where each of these is after one period, and how that changes with where it begins; none where the run was stopped.
    /// `room` is for the work, to be used again.
    fn sloped(
        &self,
        starts: &[JacobianStart],
        room: &mut Room<f64>,
        progress: &Progress,
    ) -> Vec<Option<PeriodJacobian>>;
}

/// An instance on its way through one period, measured or with its Jacobian.
#[derive(Debug)]
pub(super) struct MapPassage<'a> {
    /// A number in the list of instances that the map was made for.
    pub instance: u32,
    /// Travels of the kept modes where it begins, then where it ends, and as many rates over the modes' angular frequencies,
    /// kernel units; what lies beyond its modes stays.
    pub state: &'a mut [f64],
    pub touching: bool,
    /// Whether all numbers of the end are numbers.
    pub finite: bool,
}

impl MapPassage<'_> {
    /// Where it begins.
    fn place(&self) -> MapStart<'_> {
        let (x, u) = self.state.split_at(self.state.len() / 2);
        MapStart { x, u, touching: self.touching, unit: 1.0 }
    }

    /// Takes in where it is, in a lane of the rows.
    fn put(&mut self, table: &BatchMap, lane: usize, rows: &Buffers) {
        let (x, u) = self.state.split_at_mut(self.state.len() / 2);
        (self.touching, self.finite) = table.put(lane, (x, u), 1.0, rows);
    }
}

/// Where the Jacobian of a period is asked for.
#[derive(Clone, Copy, Debug)]
pub struct JacobianStart {
    /// A number in the list of instances that the map was made for.
    pub instance: u32,
    pub station: SectionState,
    /// What may be left out of the Jacobian, about.
    pub least: f64,
}

pub(super) struct CpuReturnMap {
    tables: Vec<BatchMap>,
    /// By instance, its table and its row there.
    places: Vec<(u32, u32)>,
}

impl CpuReturnMap {
    /// Instances that are alike are stepped side by side in the order in which they come.
    pub fn new(plan: &Plan, instances: &[u32], rounding: Rounding) -> Result<Self, EngineError> {
        let mut places = vec![(0, 0); instances.len()];
        let mut alike = BTreeMap::<_, Vec<(usize, u32)>>::new();
        for (n, i) in instances.iter().enumerate() {
            alike.entry(plan.shape(*i)).or_default().push((n, *i));
        }
        let mut tables = Vec::with_capacity(alike.len());
        for (number, (shape, members)) in alike.into_iter().enumerate() {
            members.iter().enumerate().for_each(|(row, (n, _))| places[*n] = (number as u32, row as u32));
            tables.push(BatchMap::new(plan, shape, members.iter().map(|(_, i)| *i), rounding)?);
        }
        Ok(Self { tables, places })
    }
}

impl CpuReturnMap {
    /// Takes each of these through one period and measures it; `plan` is the one that the map was made for. `ended` is told where
    /// each one ends, and asks of those that it wants what was measured. Whether they are steady is not judged. A run that was
    /// stopped leaves the others where they are.
    pub fn measured(
        &self,
        plan: &Plan,
        passing: &mut [MapPassage],
        mut ended: impl FnMut(&MapPassage, &dyn Fn() -> Finished),
        progress: &Progress,
    ) {
        let instances: Vec<u32> = passing.iter().map(|one| one.instance).collect();
        for (table, own) in self.by_table(instances.iter().copied()) {
            let mut rows = table.buffers(table.stepper.width);
            for places in own.chunks(table.stepper.width) {
                if progress.stopped() {
                    return;
                }
                table.gather(places, |n| passing[n].place(), &mut rows);
                progress.timed(ProfileSection::Steps, || table.measure(places, plan, &mut rows));
                progress.timed(ProfileSection::Algebra, || {
                    for (lane, (n, row)) in places.iter().enumerate() {
                        passing[*n].put(table, lane, &rows);
                        let one = &passing[*n];
                        ended(one, &|| table.finished((lane, *row), one.finite, plan, &rows));
                    }
                });
                progress.add(places.len() as u64 * table.steps());
            }
        }
    }

    /// Takes each of these through one period in f64 and tells its Jacobian, of which about as much may be left out as the number
    /// beside it says. `ended` is told where each one ends, and its Jacobian, column by column. A run that was stopped leaves the
    /// others where they are.
    pub fn sloping(
        &self,
        (passing, least): (&mut [MapPassage], &[f64]),
        room: &mut Room<f64>,
        mut ended: impl FnMut(&MapPassage, Box<[f64]>),
        progress: &Progress,
    ) {
        let instances: Vec<u32> = passing.iter().map(|one| one.instance).collect();
        for (table, own) in self.by_table(instances.iter().copied()) {
            let mut rows = table.buffers(table.tangent.width);
            for places in own.chunks(table.tangent.width) {
                if progress.stopped() {
                    return;
                }
                table.gather(places, |n| passing[n].place(), &mut rows);
                let least: Vec<f64> = places.iter().map(|(n, _)| least[*n]).collect();
                let slopes =
                    progress.timed(ProfileSection::Steps, || table.slopes(&least, (&mut rows, room)));
                progress.timed(ProfileSection::Algebra, || {
                    for ((lane, (n, _)), slope) in places.iter().enumerate().zip(slopes) {
                        passing[*n].put(table, lane, &rows);
                        ended(&passing[*n], slope);
                    }
                });
                progress.add(places.len() as u64 * table.steps());
            }
        }
    }

    /// The starts of each table that has any: their places in the list, and their rows there.
    fn by_table<'a>(
        &'a self,
        instances: impl Iterator<Item = u32> + Clone + 'a,
    ) -> impl Iterator<Item = (&'a BatchMap, Vec<(usize, u32)>)> + 'a {
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

impl ReturnMap for CpuReturnMap {
    fn after(
        &self,
        starts: &[(u32, SectionState)],
        periods: u32,
        progress: &Progress,
    ) -> Vec<Option<SectionState>> {
        let mut out = vec![None; starts.len()];
        for (table, own) in self.by_table(starts.iter().map(|start| start.0)) {
            let mut rows = table.buffers(table.stepper.width);
            for places in own.chunks(table.stepper.width) {
                if progress.stopped() {
                    return out;
                }
                table.gather(places, |n| MapStart::of(&starts[n].1), &mut rows);
                progress.timed(ProfileSection::Steps, || table.after(periods, &mut rows));
                for (lane, (n, _)) in places.iter().enumerate() {
                    out[*n] = Some(end(table, lane, &starts[*n].1, &rows));
                }
                progress.add(places.len() as u64 * u64::from(periods) * table.steps());
            }
        }
        out
    }

    fn sloped(
        &self,
        starts: &[JacobianStart],
        room: &mut Room<f64>,
        progress: &Progress,
    ) -> Vec<Option<PeriodJacobian>> {
        let mut out = vec![None; starts.len()];
        for (table, own) in self.by_table(starts.iter().map(|start| start.instance)) {
            let mut rows = table.buffers(table.tangent.width);
            for places in own.chunks(table.tangent.width) {
                if progress.stopped() {
                    return out;
                }
                table.gather(places, |n| MapStart::of(&starts[n].station), &mut rows);
                let least: Vec<f64> = places.iter().map(|(n, _)| starts[*n].least).collect();
                let slopes =
                    progress.timed(ProfileSection::Steps, || table.slopes(&least, (&mut rows, room)));
                for ((lane, (n, _)), slope) in places.iter().enumerate().zip(slopes) {
                    out[*n] =
                        Some(PeriodJacobian { end: end(table, lane, &starts[*n].station, &rows), slope });
                }
                progress.add(places.len() as u64 * table.steps());
            }
        }
        out
    }
}

/// Where the instance in a lane is, that began at `start`.
fn end(table: &BatchMap, lane: usize, start: &SectionState, rows: &Buffers) -> SectionState {
    let mut end = *start;
    let (touching, finite) = table.put(lane, (&mut end.x, &mut end.u), LENGTH, rows);
    (end.touching, end.finite) = (touching, start.finite && finite);
    end
}
