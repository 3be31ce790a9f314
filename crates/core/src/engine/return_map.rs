//! The period map on the CPU: constants of instances are made once, and periods are stepped from any state, again and again.

use super::batch_map::{BatchMap, Buffers, MapStart};
use super::period_jacobian::PeriodJacobian;
use super::{EngineError, Finished, ProfileSection, Progress};
use crate::kernel::{LENGTH, Room, Rounding};
use crate::plan::{Plan, SectionState};
use std::collections::BTreeMap;

/// Maps an instance's state at the start of a drive period to the state some periods later, with the plan's steps and in f64.
pub trait ReturnMap: Send + Sync {
    /// The states `periods` later, for `starts` of (index in the list of the map's instances, state); `None` where the run was
    /// stopped.
    ///
    /// It runs on the calling thread: callers have many lists.
    fn after(
        &self,
        starts: &[(u32, SectionState)],
        periods: u32,
        progress: &Progress,
    ) -> Vec<Option<SectionState>>;

    /// The states one period later, with the Jacobian of the period; `None` where the run was stopped. `room` is memory for
    /// reuse.
    fn sloped(
        &self,
        starts: &[JacobianStart],
        room: &mut Room<f64>,
        progress: &Progress,
    ) -> Vec<Option<PeriodJacobian>>;
}

/// An instance during one period, measured or with its Jacobian.
#[derive(Debug)]
pub(super) struct MapPassage<'a> {
    /// Index in the list of the map's instances.
    pub instance: u32,
    /// Travels of the kept modes at the start, then at the end, and as many rates over the modes' angular frequencies, kernel
    /// units. Numbers beyond its modes do not change.
    pub state: &'a mut [f64],
    pub touching: bool,
    /// Whether the end is finite.
    pub finite: bool,
}

impl MapPassage<'_> {
    /// Its start.
    fn place(&self) -> MapStart<'_> {
        let (x, u) = self.state.split_at(self.state.len() / 2);
        MapStart { x, u, touching: self.touching, unit: 1.0 }
    }

    /// Reads its state from a lane of the rows.
    fn put(&mut self, table: &BatchMap, lane: usize, rows: &Buffers) {
        let (x, u) = self.state.split_at_mut(self.state.len() / 2);
        (self.touching, self.finite) = table.put(lane, (x, u), 1.0, rows);
    }
}

/// The start of a period whose Jacobian is needed.
#[derive(Clone, Copy, Debug)]
pub struct JacobianStart {
    /// Index in the list of the map's instances.
    pub instance: u32,
    pub station: SectionState,
    /// Approximate size of terms that the Jacobian may drop.
    pub least: f64,
}

pub(super) struct CpuReturnMap {
    tables: Vec<BatchMap>,
    /// By instance: its table and its row there.
    places: Vec<(u32, u32)>,
}

impl CpuReturnMap {
    /// Instances of one shape are stepped side by side, in order.
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
    /// Measures one period of each of these; `plan` is that of the map. Calls `ended` with each end and a function that
    /// returns the measurement if needed. It does not judge steadiness. A stopped run leaves the others unchanged.
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

    /// Steps each of these through one period in f64 with its Jacobian, which may drop terms of about the size in `least`.
    /// Calls `ended` with each end and its Jacobian, column by column. A stopped run leaves the others unchanged.
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

    /// The starts of each table that has any: their indices in the list, and their rows there.
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

/// The end state of the instance in a lane that started at `start`.
fn end(table: &BatchMap, lane: usize, start: &SectionState, rows: &Buffers) -> SectionState {
    let mut end = *start;
    let (touching, finite) = table.put(lane, (&mut end.x, &mut end.u), LENGTH, rows);
    (end.touching, end.finite) = (touching, start.finite && finite);
    end
}
