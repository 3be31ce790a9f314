//! Converts a chunk of a class to the shader's tables, and the shader's output to checkpoints.

use super::session::Job;
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::kernel_constants::{Member, begin, free, gap_and_law, lever, lever_key, member};
use crate::engine::period_jacobian::begun;
use crate::engine::start;
use crate::kernel::contact::force_table::ForceTable;
use crate::kernel::{Entry, LANDS, LENGTH, Lane, Lever, MODES_MAX, RunSums, ShaderSpec, little, powers};
use crate::plan::{Class, Plan, SectionState};
use crate::scene::Start;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Numbers of the shader's precision.
#[derive(Clone, Debug)]
pub(super) enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Numbers {
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Single(list) => bytemuck::cast_slice(list),
            Self::Double(list) => bytemuck::cast_slice(list),
        }
    }

    /// Rounds to the precision.
    pub fn new(double: bool, values: Vec<f64>) -> Self {
        match double {
            true => Self::Double(values),
            false => Self::Single(values.into_iter().map(|value| value as f32).collect()),
        }
    }

    /// Numbers as the device returned them.
    pub fn read(double: bool, bytes: &[u8]) -> Self {
        match double {
            true => Self::Double(bytemuck::pod_collect_to_vec(bytes)),
            false => Self::Single(bytemuck::pod_collect_to_vec(bytes)),
        }
    }

    pub(super) fn get(&self, index: usize) -> f64 {
        match self {
            Self::Single(list) => f64::from(list[index]),
            Self::Double(list) => list[index],
        }
    }
}

/// Input of a piece of a class on the device, whatever it is for.
pub(super) struct PieceTables {
    pub spec: ShaderSpec,
    pub steps: u32,
    /// The plan's drives of the instances, in order.
    pub drives: Vec<u32>,
    pub waves: Numbers,
    pub drive_table: Numbers,
    pub cases: Numbers,
    pub drive_of: Vec<u32>,
    pub states: Numbers,
    /// See [`going`]; a search has two alternating lists of indices.
    pub going: Vec<u32>,
}

impl PieceTables {
    pub fn count(&self) -> u32 {
        self.drive_of.len() as u32
    }

    /// The parameters of one dispatch in a round.
    pub fn job(&self, round: u32, first: u32, count: u32) -> Job {
        let (instances, drives, steps) = (self.count(), self.drives.len() as u32, self.steps);
        Job { instances, drives, steps, first, count, width: 0, round }
    }
}

/// Input of a chunk of instances on the device.
pub(super) struct Tables {
    pub piece: PieceTables,
    pub marks: Vec<u32>,
}

/// The number of instances in progress in each round of a search and after the last, then their indices. A run has one round
/// with all of them.
pub(super) fn going(entry: Entry, count: u32) -> impl Iterator<Item = u32> {
    let counts = std::iter::once(count).chain(std::iter::repeat_n(0, entry.rounds() as usize));
    counts.chain(0..count)
}

/// Instances, and their drives in order.
pub(super) struct Driven<'a> {
    pub members: Vec<Member<'a>>,
    pub drives: Vec<u32>,
    /// An instance of each drive.
    first_of: Vec<Member<'a>>,
    /// By instance: index among the drives.
    pub drive_of: Vec<u32>,
    /// Numbers of the force tables that the instances read, rising.
    force_tables: Vec<usize>,
}

impl<'a> Driven<'a> {
    pub fn new(plan: &'a Plan, instances: &[u32]) -> Self {
        let members: Vec<Member> = instances.iter().map(|instance| member(plan, *instance)).collect();
        let (mut drives, mut first_of): (Vec<u32>, Vec<Member>) = (Vec::new(), Vec::new());
        let drive_of = members
            .iter()
            .map(|one| {
                // A class's instances are ordered by drive. What a memory forgets is a part of its lever.
                let same = |last: &Member| last.0.drive == one.0.drive && lever_key(last) == lever_key(one);
                if !first_of.last().is_some_and(same) {
                    drives.push(one.0.drive);
                    first_of.push(*one);
                }
                drives.len() as u32 - 1
            })
            .collect();
        let terms = members.iter().flat_map(|one| one.0.contact.terms.into_iter().flatten());
        let force_tables: BTreeSet<usize> = terms.map(|term| term.table).collect();
        Self { members, drives, first_of, drive_of, force_tables: force_tables.into_iter().collect() }
    }

    /// The shader for these instances.
    pub fn shader(&self, spec: ShaderSpec) -> ShaderSpec {
        ShaderSpec { one_drive: self.drives.len() == 1, ..spec }
    }

    /// The table of the drives, and after it the force tables of the instances.
    pub fn table(&self, spec: &ShaderSpec, start: Start) -> Numbers {
        let rows: Vec<Vec<f64>> = self.first_of.iter().map(|one| drive_row(spec, one, start)).collect();
        let mut all = transposed(&rows, |row| row);
        for number in &self.force_tables {
            all.extend(ForceTable::numbered(*number).rows().iter().flatten());
        }
        Numbers::new(spec.double, all)
    }

    /// The tables of a piece with these cases and states.
    pub fn piece(
        self,
        spec: ShaderSpec,
        steps: u32,
        (harmonics, start): (usize, Start),
        [cases, states]: [Numbers; 2],
    ) -> PieceTables {
        let count = self.drive_of.len() as u32;
        let listed = if spec.entry == Entry::Sweep { 0 } else { count };
        PieceTables {
            steps,
            waves: Numbers::new(spec.double, waves(harmonics, steps)),
            drive_table: self.table(&spec, start),
            cases,
            states,
            going: going(spec.entry, count).chain(0..listed).collect(),
            drives: self.drives,
            drive_of: self.drive_of,
            spec,
        }
    }

    /// Gap and constants of the law; force tables by their places behind the drives.
    pub fn gap_and_law(&self, one: &Member) -> Vec<f64> {
        let mut all: Vec<f64> = gap_and_law(one).collect();
        let law = one.0.contact.law;
        let fields = law.fields().iter().zip(&mut all[1..]);
        for (_, number) in fields.filter(|(name, _)| law.is_sum() && name.starts_with("table_")) {
            *number = self.force_tables.binary_search(&(*number as usize)).unwrap_or(0) as f64;
        }
        all
    }
}

/// The tables of `instances`, which belong to `class`, at the start of the run or at checkpoints.
pub(super) fn tables(
    plan: &Plan,
    class: &Class,
    instances: &[u32],
    saved: Option<&[InstanceCheckpoint]>,
) -> Tables {
    let driven = Driven::new(plan, instances);
    let spec = driven.shader(plan.shader(class, Entry::Sweep));
    let columns: Vec<[Vec<f64>; 2]> = (driven.members.par_iter().enumerate())
        .map(|(i, one)| {
            let place = saved.map_or_else(|| begin(one, plan.run.start), |saved| saved[i]);
            [driven.gap_and_law(one), write(&spec, &place)]
        })
        .collect();
    let count = instances.len();
    let mut marks = vec![0; 2 * count];
    for (mark, one) in marks[count..].iter_mut().zip(saved.unwrap_or_default()) {
        *mark = u32::from(!one.finite);
    }
    let table = |which: usize| Numbers::new(spec.double, transposed(&columns, |column| &column[which]));
    let rows = (plan.wants.harmonics, plan.run.start);
    Tables { piece: driven.piece(spec, class.steps, rows, [table(0), table(1)]), marks }
}

/// Input of a piece of a class on the device, for a period with its Jacobian.
pub(super) struct SlopeTables {
    pub piece: PieceTables,
    /// [`powers`] of each drive's lever.
    pub flows: Numbers,
}

impl SlopeTables {
    /// Bytes of the Jacobians.
    pub fn column_bytes(&self) -> u64 {
        let spec = &self.piece.spec;
        spec.bytes() * (2 * spec.modes as u64).pow(2) * u64::from(self.piece.count())
    }
}

/// The tables for a period with its Jacobian from the plan's starts; `least` is by instance of the plan. `told` gives further
/// constants of an instance.
pub(super) fn slope_tables(
    plan: &Plan,
    class: &Class,
    (least, told): (&[f64], impl Fn(u32) -> Vec<f64> + Sync),
) -> SlopeTables {
    let driven = Driven::new(plan, &class.instances);
    let spec = driven.shader(plan.shader(class, Entry::Kicks));
    let levers: Vec<Lever> = driven.first_of.iter().map(|one| lever(one, spec.modes)).collect();
    let rounded = |value: f64| if spec.double { value } else { f64::from(value as f32) };
    let of = |i: usize, instance: u32| {
        let lands =
            &levers[driven.drive_of[i] as usize].motion[LANDS.start * spec.modes..LANDS.end * spec.modes];
        let lands = lands.iter().map(|value| rounded(*value));
        let little = little(lands, class.steps as usize, least[instance as usize]);
        let own = driven.gap_and_law(&driven.members[i]).into_iter();
        let case = own.chain([little]).chain(told(instance)).collect();
        [case, slope_state(&spec, &begun(plan, instance))]
    };
    let columns: Vec<[Vec<f64>; 2]> =
        (class.instances.par_iter().enumerate()).map(|(i, instance)| of(i, *instance)).collect();
    let flows: Vec<Vec<f64>> = levers.iter().map(|lever| flows(&spec, lever, class.steps)).collect();
    let flows = Numbers::new(spec.double, transposed(&flows, |row| row));
    let table = |which: usize| Numbers::new(spec.double, transposed(&columns, |column| &column[which]));
    SlopeTables { piece: driven.piece(spec, class.steps, (1, Start::Steady), [table(0), table(1)]), flows }
}

/// Travel and rate of each mode, contact, and no steps done.
fn slope_state(spec: &ShaderSpec, station: &SectionState) -> Vec<f64> {
    let modes = (0..spec.modes).flat_map(|k| [station.x[k] / LENGTH, station.u[k] / LENGTH]);
    let mut state: Vec<f64> = modes.chain([f64::from(u8::from(station.touching))]).collect();
    state.resize(spec.state_fields().len(), 0.0);
    state
}

/// `[power][m00, m01, m11][mode]`, in the precision of the shader.
fn flows(spec: &ShaderSpec, lever: &Lever, steps: u32) -> Vec<f64> {
    fn of<E: Lane<Element = E>>(motion: &[f64], modes: usize, steps: u32) -> Vec<f64> {
        let motion: Vec<E> = motion.iter().map(|value| E::element(*value)).collect();
        let mut all = Vec::new();
        powers(&motion, modes, steps, &mut all);
        let field =
            |power: &[[E; 3]], field: usize| power.iter().map(|one| one[field].lane(0)).collect::<Vec<_>>();
        all.chunks(modes).flat_map(|power| (0..3).flat_map(|n| field(power, n)).collect::<Vec<_>>()).collect()
    }
    match spec.double {
        true => of::<f64>(&lever.motion, spec.modes, steps),
        false => of::<f32>(&lever.motion, spec.modes, steps),
    }
}

/// `[field][row]` from rows of fields.
pub(super) fn transposed<T>(rows: &[T], values: impl Fn(&T) -> &Vec<f64>) -> Vec<f64> {
    let fields = rows.first().map_or(0, |row| values(row).len());
    let mut out = Vec::with_capacity(fields * rows.len());
    for field in 0..fields {
        out.extend(rows.iter().map(|row| values(row)[field]));
    }
    out
}

pub(super) fn waves(harmonics: usize, steps: u32) -> Vec<f64> {
    let waves = start::waves::<f64>(steps, harmonics);
    waves.iter().flatten().flat_map(|wave| [wave.cosine, wave.sine]).collect()
}

/// In the order of [`ShaderSpec::drive_fields`].
fn drive_row(spec: &ShaderSpec, member: &Member, start: Start) -> Vec<f64> {
    let lever = lever(member, spec.modes);
    let mut row = lever.motion;
    row.extend(lever.energy);
    row.extend(free(member, start));
    row
}

/// Number of sums in the state that the tally of an unfinished period leaves.
fn tally_sums(spec: &ShaderSpec) -> usize {
    2 * spec.wants.harmonics + spec.wants.kept().count()
}

/// In the order of [`ShaderSpec::state_fields`]; the tally's own sums start anew with a period.
pub(super) fn write(spec: &ShaderSpec, place: &InstanceCheckpoint) -> Vec<f64> {
    let run_sums = &place.run_sums;
    let wants = spec.wants;
    let mut out = Vec::new();
    for k in 0..spec.modes {
        out.extend([place.x[k], place.u[k]]);
    }
    out.push(place.touching);
    out.extend(std::iter::repeat_n(0.0, tally_sums(spec)));
    if wants.looks_back() {
        out.extend([place.last[0], place.last[1], place.touched]);
    }
    out.extend([run_sums.last_cosine, run_sums.last_sine]);
    out.extend(run_sums.changes);
    out.push(run_sums.largest);
    for n in 0..wants.harmonics {
        out.extend([run_sums.cosine[n], run_sums.sine[n]]);
    }
    out.extend(run_sums.sums.kept(wants));
    out
}

/// The checkpoints of a chunk's instances as the device left them between two periods.
pub(super) fn saved(spec: &ShaderSpec, states: &Numbers, marks: &[u32]) -> Vec<InstanceCheckpoint> {
    let count = marks.len() / 2;
    (0..count)
        .map(|i| {
            let mut field = 0;
            let mut next = || {
                field += 1;
                states.get((field - 1) * count + i)
            };
            read(spec, &mut next, marks[count + i] == 0)
        })
        .collect()
}

fn read(spec: &ShaderSpec, next: &mut impl FnMut() -> f64, finite: bool) -> InstanceCheckpoint {
    let wants = spec.wants;
    let (mut x, mut u) = ([0.0; MODES_MAX], [0.0; MODES_MAX]);
    for k in 0..spec.modes {
        (x[k], u[k]) = (next(), next());
    }
    let touching = next();
    (0..tally_sums(spec)).for_each(|_| {
        next();
    });
    let mut run_sums = RunSums::new();
    let (mut last, mut touched) = ([0.0; 2], touching);
    if wants.looks_back() {
        last = [next(), next()];
        touched = next();
    }
    (run_sums.last_cosine, run_sums.last_sine) = (next(), next());
    run_sums.changes = [next(), next(), next(), next()];
    run_sums.largest = next();
    for n in 0..wants.harmonics {
        (run_sums.cosine[n], run_sums.sine[n]) = (next(), next());
    }
    run_sums.sums.kept_places(wants).for_each(|place| *place = next());
    InstanceCheckpoint { x, u, touching, last, touched, run_sums, finite }
}
