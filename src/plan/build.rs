//! From a scene to its plan.

use super::{CasePlan, Class, Driven, Plan, Policy, Precision, ReducedBasis, steps};
use crate::contact::{Contact, Law};
use crate::instrument::{Instrument, InstrumentError};
use crate::observe::{Wants, wants};
use crate::scene::{DriveFrequency, Params, Run, Scene, Start, Steady};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use thiserror::Error;

/// Why a scene cannot be planned.
#[derive(Debug, Error)]
pub enum PlanError {
    /// `values` names the swept values of the instance, empty without a sweep.
    #[error("instance {instance}{values}: {source}")]
    Instrument { instance: usize, values: String, source: InstrumentError },
}

/// Most steps that keeping a fast oscillator may cost, per period of the lever's first mode or of the
/// drive, whichever is shorter.
const STEPS_FOR_MODES: f64 = 2048.0;

impl Plan {
    /// Plans every instance. Each distinct instrument is reduced once.
    pub fn new(scene: &Scene, precision: Precision) -> Result<Self, PlanError> {
        let (mut drives, mut drive_of) = reduce(scene)?;
        // Prescribed steps are for the modes that they can step.
        if scene.run.modes.is_none() && scene.run.steps_per_period.is_none() {
            fast_contacts(scene, &mut drives, &mut drive_of);
        }
        let cases: Vec<CasePlan> = (0..scene.len())
            .into_par_iter()
            .map(|index| {
                let drive = drive_of[index];
                plan_case(scene, &scene.instance(index), drive, &drives[drive as usize])
            })
            .collect();
        let classes = classify(&cases, &drives, 0..cases.len() as u32);
        let asked = wants(&scene.output.observables);
        Ok(Self {
            drives,
            cases,
            classes,
            observables: scene.output.observables.clone(),
            wants: Wants {
                // The branch of a state is told by its mean force.
                energy: asked.energy || scene.run.steady == Steady::Search,
                // Errors of the mean force, and from rest of energies, count on the largest force.
                extremes: asked.extremes || asked.energy,
                ..asked
            },
            run: scene.run.clone(),
            precision,
            precision_open: false,
            policy: Policy::STANDARD,
            waveforms: scene.output.waveforms.clone(),
            stations: None,
        })
    }
}

/// Gives instances whose contacts are too fast for the modes with the largest shares a basis that is made for them.
fn fast_contacts(scene: &Scene, drives: &mut Vec<Driven>, drive_of: &mut [u32]) {
    let rungs: Vec<(u32, u32)> = drive_of
        .par_iter()
        .enumerate()
        .map(|(index, drive)| {
            let params = scene.instance(index);
            (*drive, drives[*drive as usize].rung(&Contact::new(&params), params.approach.gap))
        })
        .collect();
    let mut distinct = rungs.clone();
    distinct.par_sort_unstable();
    distinct.dedup();
    let run = &scene.run;
    let bases: Vec<Option<Arc<ReducedBasis>>> = distinct
        .par_iter()
        .map(|(drive, rung)| {
            let driven = &drives[*drive as usize];
            driven.for_rung(*rung, run.accuracy, |accuracy| shares(driven, accuracy, run))
        })
        .collect();
    let mut made: HashMap<(u32, u32), u32> = HashMap::new();
    for (key, kept) in distinct.into_iter().zip(bases) {
        if let Some(kept) = kept {
            made.insert(key, drives.len() as u32);
            drives.push(Driven { kept, ..drives[key.0 as usize].clone() });
        }
    }
    if !made.is_empty() {
        let own = |(drive, key): (&mut u32, &(u32, u32))| *drive = made.get(key).copied().unwrap_or(*drive);
        drive_of.iter_mut().zip(&rungs).for_each(own);
    }
}

/// The modes with the largest shares that `accuracy` asks for.
pub(super) fn shares(driven: &Driven, accuracy: f64, run: &Run) -> ReducedBasis {
    let most = steps_for_modes(&driven.instrument, driven.frequency(), run.steps_per_period);
    ReducedBasis::choose(&driven.instrument, driven.free.omega, accuracy, run.modes, most)
}

/// Most steps per period that a mode kept may need.
pub(super) fn steps_for_modes(instrument: &Instrument, frequency: f64, asked: Option<u32>) -> f64 {
    match asked {
        Some(steps) => f64::from(steps),
        None => STEPS_FOR_MODES * (instrument.lever_frequency / frequency).max(1.0),
    }
}

/// Whether that quantity changes the instrument or its drive, not only the contact.
fn moves_instrument(path: &str) -> bool {
    const APEX: [&str; 3] =
        ["instrument.tip.radius", "instrument.tip.youngs_modulus", "instrument.tip.poisson_ratio"];
    path.starts_with("drive.") || (path.starts_with("instrument.") && !APEX.contains(&path))
}

/// Whether that quantity changes the drive alone.
fn moves_drive(path: &str) -> bool {
    path.starts_with("drive.") && path != "drive.on"
}

/// The distinct driven instruments, and which one each instance has.
fn reduce(scene: &Scene) -> Result<(Vec<Driven>, Vec<u32>), PlanError> {
    let axes = &scene.sweep.axes;
    let relevant: Vec<usize> = (0..axes.len()).filter(|&a| moves_instrument(&axes[a].path)).collect();
    let mut numbers: HashMap<Vec<u64>, u32> = HashMap::new();
    let mut first = Vec::new();
    if relevant.is_empty() {
        // One instrument for all, as in the largest sweeps: nothing to look up for each instance.
        first.push(0);
    }
    let looked_up = if relevant.is_empty() { 0 } else { scene.len() };
    let mut drive_of: Vec<u32> = (0..looked_up)
        .map(|instance| {
            let indices = scene.sweep.indices(instance);
            let key = relevant.iter().map(|&a| axes[a].values[indices[a]].to_bits()).collect();
            *numbers.entry(key).or_insert_with(|| {
                first.push(instance);
                first.len() as u32 - 1
            })
        })
        .collect();
    drive_of.resize(scene.len(), 0);

    // Levers and rods without the drive: fewer still.
    let bodies: Vec<usize> = relevant.into_iter().filter(|&a| !moves_drive(&axes[a].path)).collect();
    let mut body_numbers: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut body_first = Vec::new();
    let body_of: Vec<usize> = first
        .iter()
        .map(|&instance| {
            let indices = scene.sweep.indices(instance);
            let key = bodies.iter().map(|&a| axes[a].values[indices[a]].to_bits()).collect();
            *body_numbers.entry(key).or_insert_with(|| {
                body_first.push(instance);
                body_first.len() - 1
            })
        })
        .collect();

    let fail = |instance: usize| {
        let values = scene.described(instance);
        move |source| PlanError::Instrument { instance, values, source }
    };
    let instruments: Vec<Arc<Instrument>> = body_first
        .par_iter()
        .map(|&instance| {
            let params = scene.instance(instance);
            let tolerance = (1e-3 * scene.run.accuracy).clamp(1e-11, 1e-7);
            Instrument::reduce(&params.instrument, params.drive.on, tolerance)
                .map(Arc::new)
                .map_err(fail(instance))
        })
        .collect::<Result<_, _>>()?;
    let drives = first
        .par_iter()
        .zip(&body_of)
        .map(|(&instance, &body)| {
            let params = scene.instance(instance);
            drive(scene, &params, &instruments[body]).map_err(fail(instance))
        })
        .collect::<Result<_, _>>()?;
    Ok((drives, drive_of))
}

fn drive(scene: &Scene, params: &Params, instrument: &Arc<Instrument>) -> Result<Driven, InstrumentError> {
    let frequency = match params.drive.frequency {
        DriveFrequency::Hertz(frequency) => frequency,
        DriveFrequency::Resonance => instrument.resonance()?,
    };
    let free = instrument.free_motion(params.drive.level, frequency)?;
    let steps_max = steps_for_modes(instrument, frequency, scene.run.steps_per_period);
    let kept = ReducedBasis::choose(instrument, free.omega, scene.run.accuracy, scene.run.modes, steps_max);
    Ok(Driven { instrument: Arc::clone(instrument), free, kept: Arc::new(kept) })
}

fn plan_case(scene: &Scene, params: &Params, drive: u32, driven: &Driven) -> CasePlan {
    let contact = Contact::new(params);
    let gap = params.approach.gap;
    let amplitude = driven.free.tip.norm();
    let settled = scene.run.start == Start::Steady;
    let free = settled && contact.is_out_of_reach(amplitude, gap);
    let steps = if free {
        0
    } else {
        scene.run.steps_per_period.unwrap_or_else(|| {
            steps::steps(&contact, &driven.kept, driven.free.omega, amplitude, gap, scene.run.accuracy)
        })
    };
    CasePlan { drive, contact, gap, steps, least_change: None }
}

/// Groups these instances by shape; within a class by drive, then gap, then stiffness.
pub(super) fn classify(
    cases: &[CasePlan],
    drives: &[Driven],
    instances: impl Iterator<Item = u32>,
) -> Vec<Class> {
    let mut all: Vec<Placed> = instances.map(|index| Placed::new(index, cases, drives)).collect();
    // In place: a stable sort would hold them twice.
    all.par_sort_unstable_by(|a, b| {
        let order = a.shape().cmp(&b.shape()).then(a.drive.cmp(&b.drive));
        let order = order.then(a.gap.total_cmp(&b.gap)).then(a.stiffness.total_cmp(&b.stiffness));
        order.then(a.index.cmp(&b.index))
    });
    all.chunk_by(|a, b| a.shape() == b.shape())
        .map(|class| {
            let (steps, law, modes) = class[0].shape();
            Class { law, modes, steps, instances: class.iter().map(|one| one.index).collect() }
        })
        .collect()
}

/// What decides an instance's place in the classes.
struct Placed {
    index: u32,
    steps: u32,
    law: Law,
    modes: usize,
    drive: u32,
    gap: f64,
    stiffness: f64,
}

impl Placed {
    fn new(index: u32, cases: &[CasePlan], drives: &[Driven]) -> Self {
        let CasePlan { drive, steps, gap, contact, .. } = &cases[index as usize];
        Self {
            index,
            steps: *steps,
            law: contact.law,
            modes: drives[*drive as usize].kept.modes.len(),
            drive: *drive,
            gap: *gap,
            stiffness: contact.modulus * contact.radius.sqrt(),
        }
    }

    fn shape(&self) -> (u32, Law, usize) {
        (self.steps, self.law, self.modes)
    }
}
