//! What follows from Table 1 and the run of section 4: masses, stiffness, frequencies, contact.

use super::super::{Numbers, StudyError};
use crate::contact::{Contact, StaticLaw, combined_modulus};
use crate::instrument::{DEFAULT_TOLERANCE, Instrument, InstrumentError};
use crate::scene::{
    ActuatorModel, DriveLevel, DriveOn, InstrumentParams, LawChoice, LeverSpec, Params, TipMass,
};
use std::f64::consts::{PI, TAU};

/// The paper's drive.
pub(super) const VOLTS: DriveLevel = DriveLevel::Voltage(15.0);
/// Slow enough to be static, Hz: inertia is a part in 1e16.
const STATIC: f64 = 1e-3;

/// The instrument with another coupling of rod and lever.
pub(super) fn with(instrument: &InstrumentParams, model: ActuatorModel) -> InstrumentParams {
    let mut other = instrument.clone();
    other.actuator.model = model;
    other
}

/// Its modes, driven by the rod.
pub(super) fn reduce(instrument: &InstrumentParams) -> Result<Instrument, InstrumentError> {
    Instrument::reduce(instrument, DriveOn::Actuator, DEFAULT_TOLERANCE)
}

/// The lever alone with this tip mass (kg) at this distance beyond its end (m).
pub(super) fn lever(
    instrument: &InstrumentParams,
    mass: f64,
    arm: f64,
) -> Result<Instrument, InstrumentError> {
    let mut alone = with(instrument, ActuatorModel::Rigid);
    alone.tip.mass = TipMass::Given(mass);
    alone.tip.half_length = arm;
    Instrument::reduce(&alone, DriveOn::Tip, DEFAULT_TOLERANCE)
}

/// Mass of the tip, kg: given, or that of its pyramid.
pub(super) fn tip_mass(instrument: &InstrumentParams) -> f64 {
    match instrument.tip.mass {
        TipMass::Given(mass) => mass,
        TipMass::Pyramid { width, height, density } => {
            density * 2.0 * instrument.tip.half_length * width * height / 3.0
        }
    }
}

/// Mass of the rod, kg.
pub(super) fn rod_mass(instrument: &InstrumentParams) -> f64 {
    let rod = &instrument.actuator;
    rod.density * rod.width * rod.thickness * rod.length
}

/// Mass of the lever, kg; none of a lever that is not given by its dimensions.
pub(super) fn lever_mass(instrument: &InstrumentParams) -> f64 {
    match instrument.cantilever.lever {
        LeverSpec::Dimensions { density, length, width, thickness, .. } => {
            density * length * width * thickness
        }
        _ => f64::NAN,
    }
}

/// The paper's contact under another law.
pub(super) fn contact(params: &Params, law: LawChoice) -> Contact {
    let mut other = params.clone();
    other.contact.law = law;
    Contact::new(&other)
}

pub(super) fn find(numbers: &mut Numbers, params: &Params) -> Result<(), StudyError> {
    masses(numbers, &params.instrument);
    frequencies(numbers, &params.instrument)?;
    travel(numbers, &params.instrument)?;
    adhesion(numbers, params);
    Ok(())
}

fn masses(numbers: &mut Numbers, instrument: &InstrumentParams) {
    let (rod, lever) = (rod_mass(instrument), lever_mass(instrument));
    numbers.add("mass.rod", "mass of the rod", rod, "kg");
    numbers.add("mass.lever", "mass of the beam", lever, "kg");
    numbers.add("mass.tip", "mass of the tip, a pyramid", tip_mass(instrument), "kg");
    numbers.add("mass.lever_over_rod", "mass of the beam over that of the rod", lever / rod, "1");
    let p = &instrument.actuator;
    let share = p.h33 * p.h33 / (p.beta33 * p.youngs_modulus);
    numbers.add("rod.coupling_factor", "coupling factor k33 of the rod", share.sqrt(), "1");
}

fn frequencies(numbers: &mut Numbers, instrument: &InstrumentParams) -> Result<(), StudyError> {
    let bare = lever(instrument, 0.0, 0.0)?;
    numbers.add("lever.stiffness", "stiffness of the beam, 3EI/l³", 1.0 / bare.flexibility(), "N/m");
    for (k, mode) in bare.modes.iter().take(4).enumerate() {
        let meaning = format!("frequency {} of the beam alone", k + 1);
        numbers.add(format!("lever.frequency_{}", k + 1), meaning, mode.omega / TAU, "Hz");
    }
    for (k, mode) in reduce(instrument)?.modes.iter().take(5).enumerate() {
        let meaning = format!("frequency {} of rod, beam and tip", k + 1);
        numbers.add(format!("coupled.frequency_{}", k + 1), meaning, mode.omega / TAU, "Hz");
    }
    Ok(())
}

fn travel(numbers: &mut Numbers, instrument: &InstrumentParams) -> Result<(), StudyError> {
    let coupled = reduce(instrument)?;
    let still = coupled.free_motion(VOLTS, STATIC)?;
    numbers.add("rod.static_top", "static travel of the rod's top at 15 V", still.top.re, "m");
    let alone = reduce(&with(instrument, ActuatorModel::Prescribed))?.free_motion(VOLTS, 30e3)?;
    numbers.add("rod.top_alone", "amplitude of the rod's top, 30 kHz, without beam", alone.top.norm(), "m");
    let free = coupled.free_motion(VOLTS, 30e3)?;
    numbers.add("rod.top", "amplitude of the rod's top, 30 kHz, with beam", free.top.norm(), "m");
    numbers.add("tip.amplitude", "steady amplitude of the free tip, 30 kHz", free.tip.norm(), "m");
    Ok(())
}

fn adhesion(numbers: &mut Numbers, params: &Params) {
    let contact = contact(params, LawChoice::Jkr);
    let unit = PI * contact.work * contact.radius;
    numbers.add("contact.modulus", "reduced modulus K", combined_modulus(params), "Pa");
    numbers.add("contact.tabor", "Tabor's parameter, z0 = D0 = 0.3 nm", contact.tabor(), "1");
    numbers.add("dmt.pull_off", "pull-off force, DMT, 2πRw", 2.0 * unit, "N");
    let Some(jkr) = contact.jkr() else { return };
    numbers.add("jkr.pull_off", "largest pull, JKR, 3πRw/2", -jkr.pull_off(), "N");
    numbers.add("jkr.jump_force", "force after the jump into contact, JKR", jkr.force(0.0, true), "N");
    let touch = jkr.contact_radius(0.0, true);
    numbers.add("jkr.jump_radius", "contact radius after the jump into contact", touch, "m");
    numbers.add("jkr.rest_depth", "deformation without load, JKR", jkr.zero_force(), "m");
    let fold = jkr.release();
    numbers.add("jkr.fold_depth", "deformation at the fold, where JKR lets go", fold, "m");
    let reach = numbers.get("tip.amplitude") + params.approach.gap;
    let meaning = "height of the fold over that of the free tip above the sample";
    numbers.add("jkr.fold_over_reach", meaning, -fold / reach, "1");
    numbers.add("jkr.fold_force", "force at the fold", jkr.force(fold, true), "N");
    numbers.add("jkr.fold_radius", "contact radius at the fold", jkr.contact_radius(fold, true), "m");
    numbers.add("jkr.loss", "loss per tap, JKR", jkr.loss_per_cycle(), "J");
}
