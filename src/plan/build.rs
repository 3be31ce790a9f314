//! From a scene to its plan.

use super::{CasePlan, Class, Driven, KeptModes, Plan, Precision, steps};
use crate::contact::{Contact, Law};
use crate::instrument::{Instrument, InstrumentError};
use crate::observe::Wants;
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
        let (drives, drive_of) = reduce(scene)?;
        let cases: Vec<CasePlan> = (0..scene.len())
            .into_par_iter()
            .map(|index| {
                let drive = drive_of[index];
                plan_case(scene, &scene.instance(index), drive, &drives[drive as usize])
            })
            .collect();
        let classes = classify(&cases, &drives, 0..cases.len() as u32);
        Ok(Self {
            drives,
            cases,
            classes,
            observables: scene.output.observables.clone(),
            // The branch of a state is told by its mean force.
            wants: Wants {
                energy: Wants::of(&scene.output.observables).energy || scene.run.steady == Steady::Search,
                ..Wants::of(&scene.output.observables)
            },
            run: scene.run.clone(),
            precision,
            precision_open: false,
            waveforms: scene.output.waveforms.clone(),
            stations: None,
        })
    }
}

/// Other ways to run the same scene, to learn what a choice of the plan costs in accuracy.
impl Plan {
    /// The same plan for these instances alone; the others are not run.
    pub fn only(&self, instances: &[u32]) -> Self {
        self.stepped(instances, |case| case.steps)
    }

    /// Likewise, with another number of steps per period for each. Instances that are free of the sample
    /// stay so.
    pub fn stepped(&self, instances: &[u32], steps: impl Fn(&CasePlan) -> u32) -> Self {
        let mut plan = self.clone();
        for &index in instances {
            let case = &mut plan.cases[index as usize];
            if case.steps > 0 {
                case.steps = steps(case);
            }
        }
        plan.classes = classify(&plan.cases, &plan.drives, instances.iter().copied());
        plan
    }

    /// A plan of some of this one's instances alone, numbered in their order here, each as often as it is named.
    pub fn part(&self, instances: &[u32]) -> Self {
        let mut place = HashMap::new();
        let mut drives = Vec::new();
        let mut cases = Vec::with_capacity(instances.len());
        for &index in instances {
            let mut case = self.cases[index as usize];
            case.drive = *place.entry(case.drive).or_insert_with(|| {
                drives.push(self.drives[case.drive as usize].clone());
                drives.len() as u32 - 1
            });
            cases.push(case);
        }
        let classes = classify(&cases, &drives, 0..cases.len() as u32);
        Self {
            drives,
            cases,
            classes,
            observables: self.observables.clone(),
            wants: self.wants,
            run: self.run.clone(),
            precision: self.precision,
            precision_open: self.precision_open,
            waveforms: None,
            stations: None,
        }
    }

    /// Likewise, over `periods` of which the last `measure` are measured: the same stepping, nothing but the
    /// fundamental summed.
    pub fn trial(&self, instances: &[u32], periods: u32, measure: u32) -> Self {
        let observables = Vec::new();
        Self {
            wants: Wants::of(&observables),
            observables,
            run: Run { periods, measure, ..self.run.clone() },
            precision_open: false,
            ..self.part(instances)
        }
    }

    /// The same plan for these instances alone, with the modes that `accuracy` would ask for, and as many more
    /// steps as they need.
    pub fn richer(&self, instances: &[u32], accuracy: f64) -> Self {
        let mut plan = self.clone();
        let run = &self.run;
        for driven in &mut plan.drives {
            driven.kept = lever(driven, accuracy, run);
        }
        let fewest = |case: &CasePlan| steps::fewest(&plan.drives[case.drive as usize]);
        plan.stepped(instances, |case| match run.steps_per_period {
            Some(_) => case.steps,
            None => case.steps.max(fewest(case)),
        })
    }

    /// The same plan for these instances alone, each with the modes that its own accuracy would ask for: as many
    /// more steps as richer modes need, as many fewer as the rule gives for poorer ones.
    pub fn levers(&self, wanted: &[(u32, f64)]) -> Self {
        let run = &self.run;
        let mut made: HashMap<(u32, u64), u32> = HashMap::new();
        // By drive of this plan, those of the new one.
        let mut variants: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut plan = Self { drives: Vec::new(), ..self.clone() };
        let mut drive_of = |drive: u32, accuracy: Option<f64>, drives: &mut Vec<Driven>| {
            *made.entry((drive, accuracy.map_or(u64::MAX, f64::to_bits))).or_insert_with(|| {
                let mut driven = self.drives[drive as usize].clone();
                if let Some(accuracy) = accuracy {
                    driven.kept = lever(&driven, accuracy, run);
                }
                // The same lever by another accuracy.
                let known = variants.entry(drive).or_default();
                let same = |n: &&u32| drives[**n as usize].kept.modes == driven.kept.modes;
                if let Some(found) = known.iter().find(same) {
                    return *found;
                }
                drives.push(driven);
                known.push(drives.len() as u32 - 1);
                drives.len() as u32 - 1
            })
        };
        for &(i, accuracy) in wanted {
            let case = &mut plan.cases[i as usize];
            case.drive = drive_of(case.drive, Some(accuracy), &mut plan.drives);
            let driven = &plan.drives[case.drive as usize];
            if run.steps_per_period.is_none() && case.steps > 0 {
                case.steps = match accuracy > run.accuracy {
                    true => case.steps.min(steps_of(case, driven, run)),
                    false => case.steps.max(steps::fewest(driven)),
                };
            }
        }
        let chosen: std::collections::HashSet<u32> = wanted.iter().map(|(i, _)| *i).collect();
        for i in 0..plan.cases.len() as u32 {
            if !chosen.contains(&i) {
                let case = &mut plan.cases[i as usize];
                case.drive = drive_of(case.drive, None, &mut plan.drives);
            }
        }
        plan.classes = classify(&plan.cases, &plan.drives, wanted.iter().map(|(i, _)| *i));
        plan
    }
}

/// The modes that `accuracy` asks for.
fn lever(driven: &Driven, accuracy: f64, run: &Run) -> Arc<KeptModes> {
    let most = steps_for_modes(&driven.instrument, driven.frequency(), run.steps_per_period);
    Arc::new(KeptModes::choose(&driven.instrument, driven.free.omega, accuracy, run.modes, most))
}

/// The rule's steps for a case and its lever.
fn steps_of(case: &CasePlan, driven: &Driven, run: &Run) -> u32 {
    let (omega, amplitude) = (driven.free.omega, driven.free.tip.norm());
    steps::steps(&case.contact, &driven.kept, omega, amplitude, case.gap, run.accuracy)
}

/// Most steps per period that a mode kept may need.
fn steps_for_modes(instrument: &Instrument, frequency: f64, asked: Option<u32>) -> f64 {
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
    let drive_of: Vec<u32> = (0..scene.len())
        .map(|instance| {
            let indices = scene.sweep.indices(instance);
            let key = relevant.iter().map(|&a| axes[a].values[indices[a]].to_bits()).collect();
            *numbers.entry(key).or_insert_with(|| {
                first.push(instance);
                first.len() as u32 - 1
            })
        })
        .collect();

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
        let values = describe(scene, instance);
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

/// ` (sample.youngs_modulus = 1e9 Pa, ...)`, or nothing without a sweep.
fn describe(scene: &Scene, instance: usize) -> String {
    if scene.sweep.axes.is_empty() {
        return String::new();
    }
    let indices = scene.sweep.indices(instance);
    let values: Vec<String> = scene
        .sweep
        .axes
        .iter()
        .zip(indices)
        .map(|(axis, index)| format!("{} = {:e} {}", axis.path, axis.values[index], axis.units))
        .collect();
    format!(" ({})", values.join(", "))
}

fn drive(scene: &Scene, params: &Params, instrument: &Arc<Instrument>) -> Result<Driven, InstrumentError> {
    let frequency = match params.drive.frequency {
        DriveFrequency::Hertz(frequency) => frequency,
        DriveFrequency::Resonance => instrument.resonance()?,
    };
    let free = instrument.free_motion(params.drive.level, frequency)?;
    let steps_max = steps_for_modes(instrument, frequency, scene.run.steps_per_period);
    let kept = KeptModes::choose(instrument, free.omega, scene.run.accuracy, scene.run.modes, steps_max);
    Ok(Driven { instrument: Arc::clone(instrument), free, kept: Arc::new(kept) })
}

fn plan_case(scene: &Scene, params: &Params, drive: u32, driven: &Driven) -> CasePlan {
    let contact = Contact::new(params);
    let gap = params.approach.gap;
    let amplitude = driven.free.tip.norm();
    let settled = scene.run.start == Start::Steady;
    let free = settled
        && match contact.law {
            Law::None => true,
            // No force at a distance: a swing that ends above the surface stays free.
            Law::Hertz | Law::Jkr => amplitude * (1.0 + 1e-9) < gap,
            Law::Dmt => false,
        };
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
fn classify(cases: &[CasePlan], drives: &[Driven], instances: impl Iterator<Item = u32>) -> Vec<Class> {
    let mut all: Vec<Placed> = instances.map(|index| Placed::new(index, cases, drives)).collect();
    all.par_sort_by(|a, b| {
        let order = a.shape().cmp(&b.shape()).then(a.drive.cmp(&b.drive));
        order.then(a.gap.total_cmp(&b.gap)).then(a.stiffness.total_cmp(&b.stiffness))
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
