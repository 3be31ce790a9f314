//! What must hold between a scene's quantities: one way to say each thing, nothing half said,
//! a rod that stands. The drive's own rules are `drive_rules.rs`'s.
//!
//! A swept quantity counts as if the file had written it in its section.

use super::address::Address;
use super::axis_zip::varies_twice;
use super::draft::{Draft, Said};
use super::drive_rules;
use super::outside_rules;
use super::outside_section::{self, OUTSIDE};
use super::params::*;
use super::paths::{CALIBRATION, LEVELS, MODES, RELAXATION, VISCOSITIES};
use super::sample_rules;
use super::scene_error::{Checked, Fault};
use super::tip_rules;
use super::{Layout, SweptAxes};
use crate::kernel::{Attraction, Law};
use std::ops::Range;

const LEVER: &str = "instrument.cantilever.";
const LEVER_SIZES: [&str; 5] = [
    "instrument.cantilever.youngs_modulus",
    "instrument.cantilever.density",
    "instrument.cantilever.length",
    "instrument.cantilever.width",
    "instrument.cantilever.thickness",
];
const LEVER_QUALITY: &str = "instrument.cantilever.quality_factor";
const PYRAMID: [&str; 3] = ["instrument.tip.width", "instrument.tip.height", "instrument.tip.density"];
const TIP_INERTIA: [&str; 4] =
    ["instrument.tip.half_length", "instrument.tip.width", "instrument.tip.height", "instrument.tip.density"];

/// Checks the draft with its sweep, and completes its base case with the first values of axes
/// that say something the file does not.
pub(super) fn check(draft: &mut Draft, sweep: &SweptAxes) -> Checked<()> {
    one_lever(draft)?;
    one_of_each(draft)?;
    indices_exist(draft)?;
    for axis in sweep.quantities() {
        let written = draft.said.iter().any(|said| !said.swept && said.path == axis.path);
        if let (false, Some(address), Some(first)) = (written, Address::find(&axis.path), axis.values.first())
            && address.get(&draft.params).is_none_or(f64::is_nan)
        {
            address.set(&mut draft.params, *first);
        }
    }
    lever_is_complete(draft)?;
    drive_rules::check(draft)?;
    adhesion_fits(draft, sweep)?;
    outside_rules::forces_fit(draft, sweep)?;
    sample_rules::viscosity_fits(draft, sweep)?;
    sample_rules::relaxation_fits(draft, sweep)?;
    tip_rules::shape_fits(draft, sweep)?;
    tip_rules::layer_fits(draft, sweep)?;
    axes_matter(draft)?;
    rod_is_stable(draft, sweep)
}

/// A lever given by its calibration or its modes stands on a rod only where the scene names one.
pub(super) fn base(draft: &mut Draft) {
    let named = draft.names_rod || draft.first_under("instrument.actuator").is_some();
    let own =
        draft.lever.is_some() || draft.first_of(&CALIBRATION).is_some() || draft.first_under(MODES).is_some();
    if own && !named {
        draft.params.instrument.actuator.model = ActuatorModel::Rigid;
    }
}

impl Draft {
    /// Notes that a quantity varies; once.
    pub(super) fn vary(&mut self, path: &str, key: Range<usize>) -> Checked<()> {
        if self.said.iter().any(|said| said.swept && said.path == path) {
            return Err(varies_twice(path, key, self));
        }
        self.said.push(Said { path: path.to_owned(), key, swept: true });
        Ok(())
    }

    pub(super) fn first_of(&self, paths: &[&str]) -> Option<&Said> {
        self.said.iter().find(|said| paths.contains(&said.path.as_str()))
    }

    pub(super) fn first_under(&self, prefix: &str) -> Option<&Said> {
        self.said.iter().find(|said| {
            said.path.strip_prefix(prefix).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })
    }

    /// Where the scene says it, or the fallback.
    pub(super) fn place_of(&self, path: &str) -> Range<usize> {
        self.first_of(&[path]).map_or(0..0, |said| said.key.clone())
    }
}

/// Two sayings that exclude each other; the one further down the file is pointed at.
fn clash(one: &Said, other: &Said, title: &str, expected: &str) -> Box<Fault> {
    let (earlier, later) = if one.key.start <= other.key.start { (one, other) } else { (other, one) };
    let verb = |said: &Said| if said.swept { "swept" } else { "given" };
    Fault::at(later.key.clone(), title)
        .label(format!("`{}` is {} here", later.path, verb(later)))
        .related(earlier.key.clone(), format!("`{}` is {} here", earlier.path, verb(earlier)))
        .expected(expected)
        .help(format!("remove `{}` or `{}`", earlier.path, later.path))
}

fn one_lever(draft: &Draft) -> Checked<()> {
    const TITLE: &str = "the cantilever is described in two ways";
    const EXPECTED: &str =
        "its dimensions and material, or its calibrated stiffness and frequency, or its modes";
    let preset = draft.lever.as_ref().map(|(_, key)| Said {
        path: "instrument.preset".to_owned(),
        key: key.clone(),
        swept: false,
    });
    // A maker's lever is one by its calibration.
    let calibration = draft.first_of(&CALIBRATION).or(preset.as_ref());
    let (sizes, modes) = (draft.first_of(&LEVER_SIZES), draft.first_under(MODES));
    for (one, other) in [(sizes, calibration), (sizes, modes), (calibration, modes)] {
        if let (Some(one), Some(other)) = (one, other) {
            return Err(clash(one, other, TITLE, EXPECTED));
        }
    }
    if let (Some(modes), Some(quality)) = (modes, draft.first_under(LEVER_QUALITY)) {
        return Err(clash(
            modes,
            quality,
            "the quality factor is given in two places",
            "with listed modes, each mode's own quality_factor",
        ));
    }
    let shape = draft.first_of(&TIP_INERTIA);
    let told = match (calibration, modes) {
        (Some(lever), _) => shape.map(|tip| (lever, tip)),
        (None, Some(lever)) => shape.or(draft.first_of(&["instrument.tip.mass"])).map(|tip| (lever, tip)),
        (None, None) => None,
    };
    if let Some((lever, tip)) = told {
        return Err(clash(
            lever,
            tip,
            "the tip's inertia is given twice",
            "a calibrated lever's values hold for the lever as it is, tip included; with stiffness and frequency, instrument.tip.mass says how much of it is the tip's",
        ));
    }
    Ok(())
}

/// What a scene says in one way: of the paths of each, only one.
const ONE_OF: [(&[&str], &str, &str); 6] = [
    (
        &["sample.surface_energy", "sample.hamaker"],
        "the adhesion is given in two ways",
        "surface_energy (the work of adhesion), or hamaker with law = \"dmt\"",
    ),
    (
        &VISCOSITIES,
        "the viscosity is given in two ways",
        "one of viscosity (shear), retardation_time, loss_tangent",
    ),
    (
        &[VISCOSITIES[0], VISCOSITIES[1], VISCOSITIES[2], RELAXATION[0]],
        "the sample's loss is given in two ways",
        "a viscosity, or a modulus that relaxes",
    ),
    (
        &[VISCOSITIES[0], VISCOSITIES[1], VISCOSITIES[2], RELAXATION[1]],
        "the sample's loss is given in two ways",
        "a viscosity, or a modulus that relaxes",
    ),
    (
        &LEVELS,
        "the drive's strength is given in two ways",
        "one of voltage, free_amplitude, force, base_amplitude",
    ),
    (
        &["approach.gap", "approach.setpoint", "approach.force_setpoint"],
        "the place of the sample is given in two ways",
        "one of gap, setpoint, force_setpoint; a set-point is held by moving the sample, and the gap is a result",
    ),
];

fn one_of_each(draft: &Draft) -> Checked<()> {
    if let (Some(mass), Some(shape)) = (draft.first_of(&["instrument.tip.mass"]), draft.first_of(&PYRAMID)) {
        return Err(clash(
            mass,
            shape,
            "the tip's mass is given in two ways",
            "mass, or the width, height and density of a pyramid",
        ));
    }
    for (paths, title, expected) in ONE_OF {
        let mut said = draft.said.iter().filter(|said| paths.contains(&said.path.as_str()));
        if let Some(first) = said.next()
            && let Some(second) = said.find(|said| said.path != first.path)
        {
            return Err(clash(first, second, title, expected));
        }
    }
    let swept = |fits: &dyn Fn(&str) -> bool| draft.said.iter().find(|said| said.swept && fits(&said.path));
    let all = swept(&|path| path == LEVER_QUALITY);
    let single = swept(&|path| path.starts_with("instrument.cantilever.quality_factor."));
    if let (Some(all), Some(single)) = (all, single) {
        return Err(clash(
            all,
            single,
            "the quality factor is swept in two ways",
            "one axis for all modes, or axes for single modes",
        ));
    }
    Ok(())
}

/// An axis over a listed mode, or over one of listed quality factors, needs that entry in the file.
fn indices_exist(draft: &Draft) -> Checked<()> {
    let listed_quality = match &draft.params.instrument.cantilever.quality_factor {
        QualityFactor::PerMode(values) => values.len(),
        QualityFactor::All(_) => 0,
    };
    outside_exist(draft)?;
    for said in draft.said.iter().filter(|said| said.swept && said.path.starts_with(LEVER)) {
        let Some(address) = Address::find(&said.path) else { continue };
        let (list, length) = match said.path.strip_prefix(LEVER) {
            Some(rest) if rest.starts_with("modes.") => (MODES, draft.modes.len()),
            Some(rest) if rest.starts_with("quality_factor.") => (LEVER_QUALITY, listed_quality),
            _ => continue,
        };
        if address.index >= length {
            let found = match length {
                0 => format!("the scene gives no list `{list}`"),
                length => format!("the last entry of `{list}` is number {}, counted from 0", length - 1),
            };
            return Err(Fault::at(said.key.clone(), format!("`{}` does not exist", said.path))
                .label(found)
                .expected("the index of an entry that the file lists")
                .help(format!(
                    "list the entry in [instrument.cantilever], then sweep it by `{}`",
                    said.path
                )));
        }
    }
    Ok(())
}

/// An axis over a force outside contact needs that force, which has this key.
fn outside_exist(draft: &Draft) -> Checked<()> {
    for said in draft.said.iter().filter(|said| said.swept && said.path.starts_with(OUTSIDE)) {
        let key = said.path.rsplit('.').next().unwrap_or_default();
        let exists = |address: Address| {
            let force = draft.params.contact.outside.get(address.index);
            force.is_some_and(|force| outside_section::keys(force).0.contains(&key))
        };
        if Address::find(&said.path).is_some_and(|address| !exists(address)) {
            return Err(Fault::at(said.key.clone(), format!("`{}` does not exist", said.path))
                .label(format!(
                    "the scene lists {} such forces, counted from 0",
                    draft.params.contact.outside.len()
                ))
                .expected("a quantity that a [[contact.outside]] of the scene gives")
                .help("give it there, then sweep it by this path"));
        }
    }
    Ok(())
}

fn adhesion_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let Some(said) = draft.first_of(&["sample.hamaker"]) else {
        return Ok(());
    };
    let laws = sample_rules::laws_of(draft, sweep);
    let attraction = |law: &LawChoice| law.law().map(Law::attraction);
    let fails = laws.into_iter().find(|law| attraction(law) != Some(Attraction::Distant));
    let Some(law) = fails.map(LawChoice::law) else { return Ok(()) };
    let why = match law.map(Law::attraction) {
        None => "law = \"auto\" chooses by the work of adhesion".to_owned(),
        Some(Attraction::None) => "this law has no adhesion".to_owned(),
        Some(_) => format!(
            "{} has no attraction outside contact that a Hamaker constant could describe",
            law.map_or_else(String::new, |law| law.name().to_uppercase())
        ),
    };
    let fault = Fault::at(said.key.clone(), "a Hamaker constant needs the DMT law").label(why);
    let fault = match draft.first_of(&["contact.law"]) {
        Some(law) => fault.related(law.key.clone(), "the law is chosen here"),
        None => fault,
    };
    Err(fault
        .expected("law = \"dmt\" in [contact], where w = H/(12 pi D0^2)")
        .help("set law = \"dmt\", or give surface_energy"))
}

/// Axes that cannot change anything would fill the results with copies.
fn axes_matter(draft: &Draft) -> Checked<()> {
    let rigid = draft.params.instrument.actuator.model == ActuatorModel::Rigid;
    let idle = draft.said.iter().find(|said| said.swept && said.path.starts_with("instrument.actuator."));
    match idle {
        Some(said) if rigid => {
            Err(Fault::at(said.key.clone(), format!("`{}` has no effect here", said.path))
                .label("with a rigid base there is no rod")
                .related(draft.place_of("instrument.actuator.model"), "the model is chosen here")
                .expected("an axis that changes the result")
                .help("take another actuator model, or remove this axis"))
        }
        _ => Ok(()),
    }
}

fn lever_is_complete(draft: &Draft) -> Checked<()> {
    if let Some((lever, key)) = &draft.lever
        && draft.first_under(LEVER_QUALITY).is_none()
    {
        return Err(Fault::at(key.clone(), format!("the preset {} has no quality factor", lever.preset))
            .label("a data sheet has none: it is the surroundings' as much as the lever's")
            .expected("quality_factor in [instrument.cantilever], as measured beside the stiffness")
            .help("add a line such as quality_factor = 400; in air stiff levers have some 300 to 600, soft ones 30 to 200"));
    }
    let missing = |stiffness: f64, frequency: f64| match (stiffness.is_nan(), frequency.is_nan()) {
        (true, _) => Some(("stiffness", "stiffness = \"42 N/m\"")),
        (_, true) => Some(("frequency", "frequency = \"300 kHz\"")),
        _ => None,
    };
    match &draft.params.instrument.cantilever.lever {
        LeverSpec::Dimensions { .. } => {}
        LeverSpec::Calibrated { stiffness, frequency } => {
            if let Some((missing, example)) = missing(*stiffness, *frequency) {
                let place = draft.first_of(&CALIBRATION).map_or(0..0, |said| said.key.clone());
                return Err(Fault::at(place, format!("the calibrated cantilever lacks its {missing}"))
                    .label("only this is given")
                    .expected("both stiffness and frequency of the first mode")
                    .help(format!("add a line such as {example}")));
            }
        }
        LeverSpec::Modes(modes) => {
            for (mode, place) in modes.iter().zip(&draft.modes) {
                let Some((missing, _)) = missing(mode.stiffness, mode.frequency) else { continue };
                return Err(Fault::at(place.clone(), format!("a listed mode lacks its {missing}"))
                    .label("in this mode")
                    .expected("stiffness and frequency of each mode, such as { stiffness = \"2 N/m\", frequency = \"70 kHz\" }")
                    .help(format!("add {missing} to this mode")));
            }
        }
    }
    Ok(())
}

/// Without charge flowing, the rod's field softens it; beyond this bound it would collapse.
fn rod_is_stable(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    const PATHS: [&str; 3] =
        ["instrument.actuator.youngs_modulus", "instrument.actuator.h33", "instrument.actuator.beta33"];
    let actuator = &draft.params.instrument.actuator;
    // A swept value is pointed at rather than the written one, which it replaces.
    let said = draft.said.iter().rev().find(|said| PATHS.contains(&said.path.as_str()));
    let Some(said) = said.filter(|_| actuator.model != ActuatorModel::Rigid) else {
        return Ok(());
    };
    let [modulus, h33, beta33] = PATHS.map(|path| sweep.quantities().find(|axis| axis.path == path));
    let case = |index: usize| {
        let value = |axis: Option<&super::Axis>, base: f64| {
            axis.and_then(|axis| axis.values.get(index)).copied().unwrap_or(base)
        };
        (value(modulus, actuator.youngs_modulus), value(h33, actuator.h33), value(beta33, actuator.beta33))
    };
    let softest = |(modulus, h33, beta33): (f64, f64, f64)| (modulus, h33 * h33 / beta33);
    let unstable = |&(modulus, softening): &(f64, f64)| modulus <= softening || softening.is_nan();
    let found = match sweep.layout {
        Layout::List => (0..sweep.len()).map(|index| softest(case(index))).find(unstable),
        Layout::Grid => {
            // Every combination occurs, so the worst value of each decides.
            let least = |axis: Option<&super::Axis>, base: f64| {
                axis.map_or(base, |axis| axis.values.iter().copied().fold(f64::INFINITY, f64::min))
            };
            let most = |axis: Option<&super::Axis>, base: f64| {
                axis.map_or(base, |axis| axis.values.iter().copied().fold(0.0, f64::max))
            };
            let worst = (
                least(modulus, actuator.youngs_modulus),
                most(h33, actuator.h33),
                least(beta33, actuator.beta33),
            );
            Some(softest(worst)).filter(unstable)
        }
    };
    match found {
        None => Ok(()),
        Some((modulus, softening)) => Err(Fault::at(said.key.clone(), "the rod would be unstable")
            .label(format!("found youngs_modulus {modulus:.4e} Pa against h33^2/beta33 {softening:.4e} Pa"))
            .expected("youngs_modulus above h33^2/beta33")
            .help("check h33 and beta33 (the preset has 5.45136e8 V/m and 7.81e7 V m/C)")),
    }
}
