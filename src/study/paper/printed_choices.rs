//! The choices that the printed text leaves, each with the size of its effect.

use super::super::{Numbers, StudyError};
use super::table1::{VOLTS, contact, lever, reduce, tip_mass, with};
use crate::contact::{Compact, Contact, Jkr, StaticLaw, combined_modulus};
use crate::instrument::InstrumentError;
use crate::scene::{ActuatorModel, InstrumentParams, LawChoice, Params};
use std::f64::consts::{PI, TAU};

/// One of Table 1's dimensionless ends: no larger than rounding, yet not zero.
const VANISHING: f64 = 1e-12;
/// Young's modulus of silicon, Pa, for the tip the paper calls silicon.
const SILICON: f64 = 130e9;
/// The deformation that the paper reads for Hertz and DMT, m.
pub(super) const DEEP: f64 = 150e-9;

/// The rod of a uniform electric field, Ha, Fung & Chen 2005, (11), in terms of the one computed here.
///
/// With `E = V/l_p` everywhere, `D = (E + h33 u_Z)/beta33` follows the strain: the bar has the modulus
/// `E_p - h33^2/beta33`, there is no spring on its top, and the force on the top stays `h33 A V/(beta33 l_p)`.
/// So the modulus is lessened, and h33 and beta33 shrink together until their spring is rounding.
fn uniform_field(instrument: &InstrumentParams) -> InstrumentParams {
    let mut other = instrument.clone();
    let rod = &mut other.actuator;
    rod.youngs_modulus -= rod.h33 * rod.h33 / rod.beta33;
    rod.h33 *= VANISHING;
    rod.beta33 *= VANISHING;
    other
}

/// DMT's force (N) at the indentation `delta` (m) with (17b) as printed: JKR's deformation for its radius.
fn dmt_as_printed(contact: &Contact, delta: f64) -> f64 {
    let jkr = Jkr::new(contact.modulus, contact.radius, contact.work);
    let a = jkr.contact_radius(delta, true);
    contact.modulus * a.powi(3) / contact.radius - 2.0 * PI * contact.radius * contact.work
}

/// JKR's deformation (m) and force (N) at the contact radius `a` (m), (16).
pub(super) fn jkr_at_radius(contact: &Contact, a: f64) -> (f64, f64) {
    let Compact { modulus, radius, work, .. } = **contact;
    let adhesion = 6.0 * PI * work * modulus * a.powi(3);
    let delta = a * a / radius - 2.0 / 3.0 * (6.0 * PI * work * a / modulus).sqrt();
    (delta, modulus * a.powi(3) / radius - adhesion.sqrt())
}

pub(super) fn find(numbers: &mut Numbers, params: &Params) -> Result<(), StudyError> {
    let instrument = &params.instrument;
    field(numbers, instrument)?;
    drive(numbers, instrument)?;
    tip(numbers, params)?;
    profile(numbers, params);
    Ok(())
}

fn field(numbers: &mut Numbers, instrument: &InstrumentParams) -> Result<(), InstrumentError> {
    let field = reduce(&uniform_field(instrument))?;
    let first = field.modes[0].omega / TAU;
    numbers.add("choice.field.frequency", "first frequency with a uniform electric field", first, "Hz");
    let tip = field.free_motion(VOLTS, 30e3)?.tip.norm();
    numbers.add("choice.field.tip", "free tip amplitude with a uniform electric field", tip, "m");
    Ok(())
}

fn drive(numbers: &mut Numbers, instrument: &InstrumentParams) -> Result<(), InstrumentError> {
    let printed = reduce(&with(instrument, ActuatorModel::AsPrinted))?.free_motion(VOLTS, 30e3)?;
    numbers.add("choice.printed.tip", "free tip amplitude, kinematics as printed", printed.tip.norm(), "m");
    let slow = reduce(instrument)?.free_motion(VOLTS, 30e3 / TAU)?;
    numbers.add("choice.radians.frequency", "30 krad/s as a frequency", 30e3 / TAU, "Hz");
    numbers.add("choice.radians.tip", "free tip amplitude at 30 krad/s", slow.tip.norm(), "m");
    Ok(())
}

fn tip(numbers: &mut Numbers, params: &Params) -> Result<(), InstrumentError> {
    let instrument = &params.instrument;
    let (mass, arm) = (tip_mass(instrument), instrument.tip.half_length);
    let meanings = ["no tip mass", "tip mass at the beam's end", "tip mass on its arm"];
    let cases = [("none", 0.0, 0.0), ("at_end", mass, 0.0), ("on_arm", mass, arm)];
    for ((key, mass, arm), meaning) in cases.into_iter().zip(meanings) {
        let first = lever(instrument, mass, arm)?.modes[0].omega / TAU;
        let meaning = format!("first frequency of the beam, {meaning}");
        numbers.add(format!("choice.tip.{key}"), meaning, first, "Hz");
    }
    let mut silicon = params.clone();
    silicon.instrument.tip.youngs_modulus = SILICON;
    numbers.add("choice.tip.modulus", "K with a tip of silicon", combined_modulus(&silicon), "Pa");
    Ok(())
}

fn profile(numbers: &mut Numbers, params: &Params) {
    let dmt = contact(params, LawChoice::Dmt);
    numbers.add("choice.profile.hertz", "DMT's force at 150 nm, Hertz profile", dmt.force(DEEP, true), "N");
    let printed = dmt_as_printed(&dmt, DEEP);
    numbers.add("choice.profile.printed", "DMT's force at 150 nm, (17b) as printed", printed, "N");
    let a = (dmt.radius * DEEP).sqrt();
    let meaning = "deformation at a²/R = 150 nm, (17b) as printed";
    numbers.add("choice.profile.depth", meaning, jkr_at_radius(&dmt, a).0, "m");
    let half = 0.5 * dmt.decay_length;
    let ours = dmt.force(-half, false);
    numbers.add("choice.attraction.ours", "DMT's force at D0/2 from the sample", ours, "N");
    let printed = -2.0 * PI * dmt.radius * dmt.work / 0.25;
    numbers.add("choice.attraction.printed", "the same, (18) as printed with D > 0", printed, "N");
}
