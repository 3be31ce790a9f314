//! Builds the plan of a scene.

use super::assignment::{self, INSTANCES_AT_ONCE};
use super::ensemble::Gaps;
use super::interning::{Codes, Interned};
use super::resolution::{Ids, InstanceResolutions};
use super::shared_contacts::SharedContacts;
use super::{
    CurveLayout, Drive, Driven, Ensemble, Grid, GridAxis, Plan, PlanError, Policy, Precision, ReducedBasis,
    SetPoint,
};
use crate::contact::Compact;
use crate::instrument::{FreeMotion, Instrument, InstrumentError, Pattern};
use crate::observe::{Scale, Wants, wants};
use crate::scene::{
    ApproachParams, Axis, Cases, DriveFrequency, Held, Layout, Params, Scene, Steady, SweptAxes,
};
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

impl Plan {
    /// Plans every instance. Each distinct instrument is reduced once.
    pub fn new(scene: &Scene, precision: Precision) -> Result<Self, PlanError> {
        let (mut drives, drive_of) = driven(scene)?;
        let ensemble = Arc::new(ensemble(scene, &drives, drive_of));
        let resolution = assignment::resolutions(&ensemble, &scene.run, &mut drives);
        let asked = wants(&scene.output.observables);
        let holds_force = matches!(scene.base.approach.held, Some(Held::Force(_)));
        let waiting = drives.iter().any(|driven| !driven.kept.waiting.is_empty());
        let of_force = scene.output.observables.iter().any(|one| one.scale() == Scale::Force);
        let extremes = asked.extremes || asked.energy || of_force || holds_force || waiting;
        let viscous = ensemble.has_viscous();
        Ok(Self {
            ids: Ids::All(ensemble.len() as u32),
            resolution: InstanceResolutions::coded(resolution),
            contacts: None,
            ensemble,
            drives,
            observables: scene.output.observables.clone(),
            wants: Wants {
                // The mean force tells the branch of a state.
                energy: asked.energy || scene.run.steady == Steady::Search,
                // Errors of forces, and of energies from rest, are relative to the largest force.
                extremes,
                // Contact time and largest force tell what faint modes lose.
                contact: asked.contact || waiting,
                // Where the tip went does not tell the force of a viscous sample.
                forces: extremes && viscous,
                ..asked
            },
            run: scene.run.clone(),
            precision,
            precision_open: false,
            policy: Policy::STANDARD,
            cold: false,
            waveforms: scene.output.waveforms.clone(),
            starts: None,
        })
    }
}

/// Whether the quantity changes the instrument or its drive, not only the contact.
fn moves_instrument(path: &str) -> bool {
    const APEX: [&str; 3] =
        ["instrument.tip.radius", "instrument.tip.youngs_modulus", "instrument.tip.poisson_ratio"];
    path.starts_with("drive.") || (path.starts_with("instrument.") && !APEX.contains(&path))
}

/// Whether the quantity changes the drive alone.
fn moves_drive(path: &str) -> bool {
    path.starts_with("drive.") && path != "drive.on"
}

/// Numbers things that several instances share, in order of appearance.
struct Distinct {
    /// By number: the first instance that has it.
    first: Vec<usize>,
    /// By instance: its number.
    of: Codes,
}

impl Distinct {
    /// Tells these instances apart by the values of the swept quantities for which `holds` is true.
    fn by(holds: impl Fn(&str) -> bool, scene: &Scene, instances: impl Iterator<Item = usize>) -> Self {
        let axes = scene.sweep.axes.iter().enumerate();
        // The quantities that matter, also among those that vary together: equal values mean one instrument.
        let axes: Vec<(usize, Vec<&Axis>)> = axes
            .map(|(n, axis)| {
                (n, std::iter::once(axis).chain(&axis.columns).filter(|a| holds(&a.path)).collect())
            })
            .filter(|(_, matter): &(usize, Vec<&Axis>)| !matter.is_empty())
            .collect();
        let mut numbers: HashMap<Vec<u64>, u32> = HashMap::new();
        let mut first = Vec::new();
        let number = |instance: usize| {
            let indices = scene.sweep.indices(instance);
            let values = axes.iter().flat_map(|(n, matter)| {
                let at = indices[*n];
                matter.iter().map(move |axis| axis.values[at].to_bits())
            });
            *numbers.entry(values.collect()).or_insert_with(|| {
                first.push(instance);
                first.len() as u32 - 1
            })
        };
        let of = match axes.is_empty() {
            // All instances are alike, as in the largest sweeps, so that none needs a look-up.
            true => Codes::zeros(instances.count()),
            false => instances.map(number).collect(),
        };
        if axes.is_empty() {
            first.push(0);
        }
        Self { first, of }
    }
}

/// The distinct drives, with the modes of the largest shares, and the drive of each instance.
fn driven(scene: &Scene) -> Result<(Vec<Driven>, Codes), PlanError> {
    let drives = Distinct::by(moves_instrument, scene, 0..scene.len());
    // Levers and rods without the drive: fewer still.
    let body = |path: &str| moves_instrument(path) && !moves_drive(path);
    let bodies = Distinct::by(body, scene, drives.first.iter().copied());
    let cases = Cases::of(scene);
    let fail = |instance: usize| {
        move |source| PlanError::Instrument { instance, values: scene.described(instance), source }
    };
    let tolerance = (1e-3 * scene.run.accuracy).clamp(1e-11, 1e-7);
    // Levers that differ only in scale are reduced once.
    let served = bodies.first.first().filter(|&&one| Pattern::serves(&cases.instance(one).instrument));
    let pattern = served.map(|&one| Pattern::new(scene.base.drive.on, tolerance).map_err(fail(one)));
    let pattern = pattern.transpose()?;
    let instrument = |&instance: &usize| {
        let params = cases.instance(instance);
        let scaled = pattern.as_ref().and_then(|pattern| pattern.instrument(&params.instrument));
        let own =
            scaled.unwrap_or_else(|| Instrument::reduce(&params.instrument, params.drive.on, tolerance));
        own.map(Arc::new).map_err(fail(instance))
    };
    let instruments: Vec<Arc<Instrument>> =
        bodies.first.par_iter().map(instrument).collect::<Result<_, _>>()?;
    let frequency =
        |(n, &instance): (usize, &usize)| (bodies.of.get(n), cases.instance(instance).drive.frequency);
    let asked: Vec<(u32, DriveFrequency)> = drives.first.par_iter().enumerate().map(frequency).collect();
    // Drives that differ only in level share one swing.
    let mut numbers: HashMap<(u32, Option<u64>), u32> = HashMap::new();
    let mut distinct: Vec<usize> = Vec::new();
    let swing = |(n, (body, frequency)): (usize, &(u32, DriveFrequency))| {
        let given = match frequency {
            DriveFrequency::Hertz(frequency) => Some(frequency.to_bits()),
            DriveFrequency::Resonance => None,
        };
        *numbers.entry((*body, given)).or_insert_with(|| {
            distinct.push(n);
            distinct.len() as u32 - 1
        })
    };
    let swing_of: Vec<u32> = asked.iter().enumerate().map(swing).collect();
    let swing = |&n: &usize| {
        let (body, frequency) = asked[n];
        Swing::new(scene, frequency, &instruments[body as usize]).map_err(fail(drives.first[n]))
    };
    let swings: Vec<Swing> = distinct.par_iter().map(swing).collect::<Result<_, _>>()?;
    let one = |(&instance, &swing): (&usize, &u32)| {
        swings[swing as usize].driven(&cases.instance(instance)).map_err(fail(instance))
    };
    let all = drives.first.par_iter().zip(&swing_of).map(one).collect::<Result<_, _>>()?;
    Ok((all, drives.of))
}

/// The scene's instances.
fn ensemble(scene: &Scene, drives: &[Driven], drive_of: Codes) -> Ensemble {
    let cases = Cases::of(scene);
    let instance = |params: &mut Params, index: usize| {
        cases.put(params, index);
        let driven = &drives[drive_of.get(index) as usize];
        let ApproachParams { gap, branch, deepest, .. } = params.approach;
        let (held, free) = (params.approach.target(), driven.free_amplitude());
        let gap = match held {
            None => gap,
            Some(Held::Amplitude(share) | Held::Deflection(share)) => share * free,
            // The share of the amplitude that remains at this phase if no energy is lost.
            Some(Held::Phase(degrees)) => degrees.to_radians().sin().abs() * free,
            // A light tap, apart from the lever's bending.
            Some(Held::Force(force)) => free - force * driven.kept.flexibility,
        };
        (
            Compact::at_frequency(params, driven.frequency()),
            gap,
            held.map(|held| SetPoint { held, branch, deepest }),
        )
    };
    let (mut contacts, mut gaps, mut setpoints) =
        (SharedContacts::new(drive_of.len(), scene.sweep.layout), Met::new(), Vec::new());
    for from in (0..drive_of.len()).step_by(INSTANCES_AT_ONCE) {
        let some = from..drive_of.len().min(from + INSTANCES_AT_ONCE);
        let some: Vec<_> =
            some.into_par_iter().map_init(|| cases.base(), |params, index| instance(params, index)).collect();
        for (contact, gap, setpoint) in some {
            contacts.push(contact);
            gaps.push(gap);
            setpoints.extend(setpoint);
        }
    }
    Ensemble {
        drives: drives.iter().map(|driven| Arc::clone(&driven.drive)).collect(),
        gaps: gaps.end(cases.column(GAP).filter(|_| setpoints.is_empty())),
        columns: cases.columns(),
        contacts: contacts.end(cases),
        drive_of,
        setpoints,
        curves: scene.sweep.curve.and_then(|curve| {
            let points = scene.sweep.axes.last()?.values.len() as u32;
            Some(CurveLayout { points, ways: 1 + u32::from(curve.both) })
        }),
        grid: grid(&scene.sweep),
    }
}

/// Path of the gap among the scene's quantities.
const GAP: &str = "approach.gap";

/// The gaps of instances while they are collected.
enum Met {
    Few(Interned<u64>),
    Many(Vec<f64>),
}

impl Met {
    fn new() -> Self {
        Self::Few(Interned::new())
    }

    fn push(&mut self, gap: f64) {
        match self {
            Self::Few(all) => {
                all.push(gap.to_bits());
                if all.values() > INSTANCES_AT_ONCE {
                    *self = Self::Many((0..all.len()).map(|at| f64::from_bits(all.get(at))).collect());
                }
            }
            Self::Many(all) => all.push(gap),
        }
    }

    /// The gaps of all instances; a column of the scene is shared, not copied.
    fn end(self, given: Option<&Arc<Vec<f64>>>) -> Gaps {
        match (self, given) {
            (Self::Few(all), _) => Gaps::Coded(all),
            (Self::Many(all), Some(given)) if all.len() == given.len() => Gaps::Given(Arc::clone(given)),
            (Self::Many(all), _) => Gaps::Each(all),
        }
    }
}

/// The arrangement of a grid's axes in the order of its instances; `None` for a list or without a sweep.
fn grid(sweep: &SweptAxes) -> Option<Grid> {
    if sweep.layout == Layout::List || sweep.axes.is_empty() {
        return None;
    }
    let mut stride = 1;
    let of = |axis: &Axis| {
        let length = axis.values.len() as u32;
        // Words and numbered samples have no neighbours.
        let ordered = axis.words.is_empty() && axis.columns.is_empty();
        let mut order: Vec<u32> = if ordered { (0..length).collect() } else { Vec::new() };
        order.sort_by(|a, b| axis.values[*a as usize].total_cmp(&axis.values[*b as usize]));
        stride *= length;
        GridAxis { stride: stride / length, length, order }
    };
    let mut axes: Vec<GridAxis> = sweep.axes.iter().rev().map(of).collect();
    axes.reverse();
    Some(Grid { axes })
}

/// An instrument at one frequency, and the modes with the largest shares.
struct Swing {
    instrument: Arc<Instrument>,
    /// Motion without a sample at level 1.
    unit: FreeMotion,
    kept: Arc<ReducedBasis>,
}

impl Swing {
    fn new(
        scene: &Scene,
        asked: DriveFrequency,
        instrument: &Arc<Instrument>,
    ) -> Result<Self, InstrumentError> {
        let frequency = match asked {
            DriveFrequency::Hertz(frequency) => frequency,
            DriveFrequency::Resonance => instrument.resonance()?,
        };
        let (omega, accuracy) = (TAU * frequency, scene.run.accuracy);
        let kept = assignment::by_shares(instrument, omega, (accuracy, false), &scene.run);
        let unit = instrument.unit_motion(frequency)?;
        Ok(Self { instrument: Arc::clone(instrument), unit, kept: Arc::new(kept) })
    }

    /// The drive at a case's level.
    fn driven(&self, params: &Params) -> Result<Driven, InstrumentError> {
        let free = self.instrument.at_level(&self.unit, params.drive.level)?;
        let drive = Arc::new(Drive { instrument: Arc::clone(&self.instrument), free });
        Ok(Driven { drive, kept: Arc::clone(&self.kept) })
    }
}
