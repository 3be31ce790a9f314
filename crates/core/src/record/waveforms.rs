//! Waveforms of chosen instances, sampled evenly in the drive's phase.

use crate::control::{ChunkJournal, FollowupKey, FollowupKind, JournaledRun, MemoryJournal, RunResult};
use crate::engine::{EngineError, trace};
use crate::instrument::MotionPlace;
use crate::orbit::OrbitTable;
use crate::plan::{Plan, SectionState};
use crate::scene::{Start, WaveformRequest};
use crate::store::Waveforms;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Computes the waveforms that a scene requests: the last periods of the run, from a zero of the drive's phase on. Time
/// counts from the start of the run or, for a start in steady motion, from the first sample. `found` has the periodic states
/// by instance; it may be empty.
///
/// # Errors
/// Those of the engine.
pub fn waveforms(
    plan: &Plan,
    found: &OrbitTable,
    request: &WaveformRequest,
) -> Result<Waveforms, EngineError> {
    let places: Vec<u32> = request.instances.iter().map(|&instance| instance as u32).collect();
    waveforms_of((plan, found), &places, request, &MemoryJournal::default())
}

/// Computes the [`waveforms`] of a run. `keep` provides known ones and receives each new one.
///
/// # Errors
/// Those of the engine.
pub fn waveforms_kept(
    run: &JournaledRun,
    request: &WaveformRequest,
    keep: &dyn ChunkJournal,
) -> Result<Waveforms, EngineError> {
    let (some, places) = gathered(run, &request.instances)?;
    waveforms_of((&some.plan, &some.found), &places, request, keep)
}

/// Loads these instances of a run. Returns the place of each among the loaded ones.
pub(super) fn gathered(run: &JournaledRun, wanted: &[usize]) -> Result<(RunResult, Vec<u32>), EngineError> {
    let all: Vec<u32> = wanted.iter().map(|&instance| instance as u32).collect();
    let mut instances = all.clone();
    instances.sort_unstable();
    instances.dedup();
    let place = |i: &u32| instances.partition_point(|other| other < i) as u32;
    let places = all.iter().map(place).collect();
    Ok((run.some(&instances)?, places))
}

/// The waveforms of the requested instances, which are at these places of the plan.
fn waveforms_of(
    (plan, found): (&Plan, &OrbitTable),
    places: &[u32],
    request: &WaveformRequest,
    keep: &dyn ChunkJournal,
) -> Result<Waveforms, EngineError> {
    let mut all = Waveforms::default();
    let mut times: Vec<Vec<f64>> = Vec::new();
    let rows: Vec<WaveformRows> = places
        .par_iter()
        .map(|&i| {
            let place = found.get(i as usize);
            let from = place.as_ref().map(|place| &place.section);
            let question = FollowupKey::new(FollowupKind::Waveforms, plan, i, from);
            if let Some(known) =
                keep.numbers(&question).and_then(|numbers| WaveformRows::of(&numbers, request))
            {
                return Ok(known);
            }
            let rows = instance_rows(plan, i as usize, from, request)?;
            // The journal keeps its own error, and there is nothing more to do here.
            let _ = keep.numbered(&question, &rows.numbers());
            Ok(rows)
        })
        .collect::<Result<_, EngineError>>()?;
    all.instances = request.instances.iter().map(|&instance| instance as u64).collect();
    for rows in rows {
        times.push(rows.time);
        all.tip_travel.push(rows.tip_travel);
        all.actuator_top.push(rows.actuator_top);
        all.indentation.push(rows.indentation);
        all.force.push(rows.force);
    }
    // One shared time axis if the drive is the same for all.
    let shared = times.windows(2).all(|pair| pair[0] == pair[1]);
    if shared {
        times.truncate(1);
    }
    all.time = times;
    Ok(all)
}

struct WaveformRows {
    time: Vec<f64>,
    tip_travel: Vec<f64>,
    actuator_top: Vec<f64>,
    indentation: Vec<f64>,
    force: Vec<f64>,
}

/// Number of samples of a waveform.
fn samples(request: &WaveformRequest) -> usize {
    request.samples_per_period as usize * request.periods as usize
}

impl WaveformRows {
    /// All rows, one after the other.
    fn numbers(&self) -> Vec<f64> {
        [&self.time, &self.tip_travel, &self.actuator_top, &self.indentation, &self.force]
            .map(|row| &row[..])
            .concat()
    }

    /// Reads [`WaveformRows::numbers`] back. None if the count is wrong.
    fn of(numbers: &[f64], request: &WaveformRequest) -> Option<Self> {
        let count = samples(request);
        if numbers.len() != 5 * count {
            return None;
        }
        let row = |n: usize| numbers[n * count..][..count].to_vec();
        Some(Self {
            time: row(0),
            tip_travel: row(1),
            actuator_top: row(2),
            indentation: row(3),
            force: row(4),
        })
    }
}

fn instance_rows(
    plan: &Plan,
    instance: usize,
    from: Option<&SectionState>,
    request: &WaveformRequest,
) -> Result<WaveformRows, EngineError> {
    let case = plan.case(instance as u32);
    let driven = plan.driven(instance as u32);
    let free = &driven.free;
    let rest = plan.run.start == Start::Rest;
    // One period beyond the run, because the drive's zero lies between two of its periods.
    let trace = trace(plan, instance, from, plan.run.periods + 1, request.periods + 2)?;
    let length = TAU / free.omega;
    let run_start = f64::from(plan.run.periods - request.periods);
    let zero = (-trace.phase / TAU).rem_euclid(1.0);
    let count = samples(request);
    let mut rows = WaveformRows {
        time: Vec::with_capacity(count),
        tip_travel: Vec::with_capacity(count),
        actuator_top: Vec::with_capacity(count),
        indentation: Vec::with_capacity(count),
        force: Vec::with_capacity(count),
    };
    let none: Vec<bool> = Vec::new();
    let kept: Vec<usize> = driven.kept.modes.iter().filter_map(|mode| mode.index).collect();
    let skip: Vec<bool> = (0..driven.instrument.modes.len()).map(|k| kept.contains(&k)).collect();
    for sample in 0..count {
        let cycles = sample as f64 / f64::from(request.samples_per_period);
        let time = (run_start + zero + cycles) * length;
        let between = trace.at(time);
        // Steady free motion at the drive's own phase.
        let angle = free.omega * time + trace.phase;
        let steady = |phasor: nalgebra::Complex<f64>| phasor.re * angle.sin() + phasor.im * angle.cos();
        let steady_rate = (free.tip.re * angle.cos() - free.tip.im * angle.sin()) * free.omega;
        let (mut travel, mut rate) = (steady(free.tip) + between.beyond, steady_rate + between.rate);
        let mut top = steady(free.top) + between.top;
        if rest {
            // A run from rest has a first half step before the first sample.
            if time < trace.begin() {
                (travel, rate) = free.tip_from_rest(&driven.instrument, time, &none);
            }
            top += free.transient_at(&driven.instrument, MotionPlace::Top, time, &skip).0;
        }
        let indentation = -(case.gap + travel);
        let contact = &case.contact;
        let touching = contact.in_contact_within(indentation, between.was_touching, between.touching);
        rows.time.push(if rest { time } else { cycles * length });
        rows.tip_travel.push(travel);
        rows.actuator_top.push(top);
        rows.indentation.push(indentation);
        rows.force.push(contact.force_moving(indentation, -rate, touching));
    }
    Ok(rows)
}
