//! A chunk of a class as the shader's tables, and what comes back as saved instances.

use crate::engine::member::{Member, begin, free, gap_and_law, lever, member};
use crate::engine::saved::Saved;
use crate::engine::start;
use crate::kernel::{HARMONICS, MODES_MAX, RunSums, ShaderSpec};
use crate::plan::{Class, Plan, Precision};
use rayon::prelude::*;

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

    /// Rounded to the precision.
    pub fn new(double: bool, values: Vec<f64>) -> Self {
        match double {
            true => Self::Double(values),
            false => Self::Single(values.into_iter().map(|value| value as f32).collect()),
        }
    }

    /// As they came back.
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

/// What a chunk of instances needs on the device.
pub(super) struct Tables {
    /// Instance numbers of the plan, in the class' order.
    pub instances: Vec<u32>,
    /// The plan's drives that they have, in order.
    pub drives: Vec<u32>,
    pub waves: Numbers,
    pub drive_table: Numbers,
    pub cases: Numbers,
    pub drive_of: Vec<u32>,
    pub states: Numbers,
    pub marks: Vec<u32>,
}

/// What the shader of a class is made for; the measured part's.
pub(super) fn spec(plan: &Plan, class: &Class) -> ShaderSpec {
    ShaderSpec {
        law: class.law.shader(),
        modes: class.modes,
        wants: plan.wants,
        measured: true,
        decay: plan.run.start == crate::scene::Start::Rest,
        double: plan.precision == Precision::F64,
    }
}

/// The tables of `instances`, which belong to `class`, at the start of the run or where they were saved.
pub(super) fn tables(plan: &Plan, class: &Class, instances: &[u32], saved: Option<&[Saved]>) -> Tables {
    let spec = spec(plan, class);
    let members: Vec<Member> = instances.iter().map(|instance| member(plan, *instance)).collect();
    let mut drives: Vec<u32> = Vec::new();
    let mut first_of: Vec<Member> = Vec::new();
    let drive_of: Vec<u32> = members
        .iter()
        .map(|one| {
            // Instances of a class are ordered by their drive.
            if drives.last() != Some(&one.0.drive) {
                drives.push(one.0.drive);
                first_of.push(*one);
            }
            drives.len() as u32 - 1
        })
        .collect();
    let rows: Vec<Vec<f64>> = first_of.iter().map(|one| drive_row(plan, &spec, *one)).collect();
    let columns: Vec<(Vec<f64>, Vec<f64>)> = members
        .par_iter()
        .enumerate()
        .map(|(i, one)| {
            let place = saved.map_or_else(|| begin(*one, plan.run.start), |saved| saved[i]);
            (gap_and_law(*one).collect(), write(&spec, &place))
        })
        .collect();
    let count = instances.len();
    let mut marks = vec![0; 2 * count];
    for (mark, one) in marks[count..].iter_mut().zip(saved.unwrap_or_default()) {
        *mark = u32::from(!one.finite);
    }
    Tables {
        instances: instances.to_vec(),
        waves: Numbers::new(spec.double, waves(plan, class.steps)),
        drive_table: Numbers::new(spec.double, transposed(&rows, |row| row)),
        cases: Numbers::new(spec.double, transposed(&columns, |column| &column.0)),
        states: Numbers::new(spec.double, transposed(&columns, |column| &column.1)),
        drives,
        drive_of,
        marks,
    }
}

/// `[field][row]` from rows of fields.
fn transposed<T>(rows: &[T], values: impl Fn(&T) -> &Vec<f64>) -> Vec<f64> {
    let fields = rows.first().map_or(0, |row| values(row).len());
    let mut out = Vec::with_capacity(fields * rows.len());
    for field in 0..fields {
        out.extend(rows.iter().map(|row| values(row)[field]));
    }
    out
}

fn waves(plan: &Plan, steps: u32) -> Vec<f64> {
    let waves = start::waves::<f64>(steps, plan.wants.harmonics);
    waves.iter().flatten().flat_map(|wave| [wave.cosine, wave.sine]).collect()
}

/// In the order of [`ShaderSpec::drive_fields`].
fn drive_row(plan: &Plan, spec: &ShaderSpec, member: Member) -> Vec<f64> {
    let lever = lever(member, spec.modes);
    let mut row = lever.motion;
    row.extend(lever.energy);
    row.extend(free(member, plan.run.start));
    row
}

/// Sums that the tally of a part of a period leaves in the state.
fn tally_sums(spec: &ShaderSpec) -> usize {
    2 * spec.wants.harmonics + spec.wants.kept().count()
}

/// In the order of [`ShaderSpec::state_fields`]; the tally's own sums begin anew with a period.
fn write(spec: &ShaderSpec, place: &Saved) -> Vec<f64> {
    let run_sums = &place.run_sums;
    let wants = spec.wants;
    let mut out = Vec::new();
    for k in 0..spec.modes {
        out.extend([place.x[k], place.u[k]]);
    }
    out.push(place.touching);
    out.extend(std::iter::repeat_n(0.0, tally_sums(spec)));
    for n in 0..wants.harmonics {
        out.extend([run_sums.cosine[n], run_sums.sine[n]]);
    }
    out.extend(run_sums.sums.kept(wants));
    if wants.looks_back() {
        out.extend([place.last[0], place.last[1], place.touched]);
    }
    out.extend([run_sums.last_cosine, run_sums.last_sine]);
    out.extend(run_sums.changes);
    out.push(run_sums.largest);
    out
}

/// The instances of a chunk as the device left them between two periods.
pub(super) fn saved(spec: &ShaderSpec, states: &Numbers, marks: &[u32]) -> Vec<Saved> {
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

fn read(spec: &ShaderSpec, next: &mut impl FnMut() -> f64, finite: bool) -> Saved {
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
    let (mut cosine, mut sine) = ([0.0; HARMONICS], [0.0; HARMONICS]);
    for n in 0..wants.harmonics {
        (cosine[n], sine[n]) = (next(), next());
    }
    (run_sums.cosine, run_sums.sine) = (cosine, sine);
    run_sums.sums.kept_places(wants).for_each(|place| *place = next());
    let (mut last, mut touched) = ([0.0; 2], touching);
    if wants.looks_back() {
        last = [next(), next()];
        touched = next();
    }
    (run_sums.last_cosine, run_sums.last_sine) = (next(), next());
    run_sums.changes = [next(), next(), next(), next()];
    run_sums.largest = next();
    Saved { x, u, touching, last, touched, run_sums, finite }
}
