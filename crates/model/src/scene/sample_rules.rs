//! What a scene says of a sample's losses, and the laws that know them.

use super::axis_zip::law_of;
use super::draft::Draft;
use super::params::*;
use super::paths::{LAW, RELAXATION, VISCOSITIES, VISCOSITY_MODEL};
use super::scene_error::{Checked, Fault};
use super::{Axis, Layout, SweptAxes};
use crate::kernel::Law;

/// The laws of a scene's instances.
pub(super) fn laws_of(draft: &Draft, sweep: &SweptAxes) -> Vec<LawChoice> {
    let swept = sweep.quantities().find(|axis| axis.path == LAW).map(|axis| axis.words.iter());
    match swept {
        Some(words) => words.filter_map(|word| law_of(word)).collect(),
        None => vec![draft.params.contact.law],
    }
}

/// No theory of a viscous contact with adhesion within it is known that would serve here.
pub(super) fn viscosity_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let Some(said) = draft.first_of(&VISCOSITIES) else {
        return match draft.first_of(&[VISCOSITY_MODEL]) {
            Some(model) => Err(Fault::at(model.key.clone(), "`contact.viscosity_model` has no effect here")
                .label("the sample is elastic")
                .expected("a viscous sample")
                .help("add viscosity, retardation_time or loss_tangent to [sample], or remove this line")),
            None => Ok(()),
        };
    };
    let Some(choice) = misfit(draft, sweep, Law::viscous) else { return Ok(()) };
    let why = match choice.law() {
        None => "law = \"auto\" may choose JKR, and a viscous contact is not known for it".into(),
        Some(Law::Jkr) => {
            "a viscous contact is not known for JKR, whose adhesion acts within the contact".into()
        }
        Some(law) => format!("a viscous contact is not known for law = \"{law}\""),
    };
    let fault = Fault::at(said.key.clone(), "a viscous sample needs the Hertz or the DMT law").label(why);
    Err(beside_law(fault, draft)
        .expected("law = \"hertz\" or law = \"dmt\" in [contact]")
        .help("set one of them, or remove the sample's viscosity"))
}

/// A law of the scene that has no form for such a sample.
fn misfit(draft: &Draft, sweep: &SweptAxes, form: fn(Law) -> Option<Law>) -> Option<LawChoice> {
    laws_of(draft, sweep).into_iter().find(|choice| match choice.law() {
        Some(law) => law.acts() && form(law).is_none(),
        None => true,
    })
}

pub(super) fn beside_law(fault: Box<Fault>, draft: &Draft) -> Box<Fault> {
    match draft.first_of(&[LAW]) {
        Some(law) => fault.related(law.key.clone(), "the law is chosen here"),
        None => fault,
    }
}

/// A sample that relaxes has two moduli and a time, under Hertz's law or DMT's.
pub(super) fn relaxation_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let Some(said) = draft.first_of(&RELAXATION) else { return Ok(()) };
    if let Some(missing) = RELAXATION.iter().find(|path| draft.first_of(&[path]).is_none()) {
        let missing = missing.trim_start_matches("sample.");
        return Err(Fault::at(said.key.clone(), format!("a sample that relaxes lacks its {missing}"))
            .label("only this is given")
            .expected(
                "instantaneous_modulus and relaxation_time in [sample]; youngs_modulus is the relaxed one",
            )
            .help(format!("add {missing} to [sample], or remove this line")));
    }
    if let Some(choice) = misfit(draft, sweep, Law::relaxing) {
        let why = match choice.law() {
            None => "law = \"auto\" may choose JKR, and a sample that relaxes is not known for it".into(),
            Some(Law::Jkr) => {
                "a sample that relaxes is not known for JKR, whose adhesion acts within the contact".into()
            }
            Some(law) => format!("a sample that relaxes is not known for law = \"{law}\""),
        };
        let fault =
            Fault::at(said.key.clone(), "a sample that relaxes needs the Hertz or the DMT law").label(why);
        return Err(beside_law(fault, draft)
            .expected("law = \"hertz\" or law = \"dmt\" in [contact]")
            .help("set one of them, or remove instantaneous_modulus and relaxation_time"));
    }
    let Viscosity::Relaxing { modulus, .. } = draft.params.sample.viscosity else { return Ok(()) };
    let relaxed = ("sample.youngs_modulus", draft.params.sample.youngs_modulus);
    if let Some((most, least)) = exceeding(sweep, relaxed, (RELAXATION[0], modulus)) {
        return Err(Fault::at(said.key.clone(), "a sample cannot stiffen as it relaxes")
            .label(format!("found instantaneous_modulus {least:.4e} Pa below youngs_modulus {most:.4e} Pa"))
            .expected("instantaneous_modulus at least as large as youngs_modulus in every case of the scene")
            .help("youngs_modulus is the modulus after a while, instantaneous_modulus that at once"));
    }
    Ok(())
}

/// The values of two quantities in a case of the scene in which the first is larger than the second; each is given by its path
/// and by its value where it is not swept.
pub(super) fn exceeding(sweep: &SweptAxes, one: (&str, f64), other: (&str, f64)) -> Option<(f64, f64)> {
    let values = |(path, base): (&str, f64)| match sweep.quantities().find(|axis| axis.path == path) {
        Some(axis) => axis.values.to_vec(),
        None => vec![base],
    };
    let (all, others) = (values(one), values(other));
    if vary_together(sweep, one.0, other.0) {
        return all.into_iter().zip(others).find(|(one, other)| one > other);
    }
    let most = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let least = others.into_iter().fold(f64::INFINITY, f64::min);
    (most > least).then_some((most, least))
}

/// Whether each value of one quantity goes with one value of the other, as the columns of a list do.
fn vary_together(sweep: &SweptAxes, one: &str, other: &str) -> bool {
    let axis = |path: &str| {
        let has = |axis: &Axis| axis.path == path || axis.columns.iter().any(|column| column.path == path);
        sweep.axes.iter().position(has)
    };
    match (axis(one), axis(other)) {
        (Some(one), Some(other)) => one == other || sweep.layout == Layout::List,
        _ => false,
    }
}
