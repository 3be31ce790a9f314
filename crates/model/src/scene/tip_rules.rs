//! What a scene says of its tip's shape and of a layer under it, and what goes with them.

use super::SweptAxes;
use super::draft::Draft;
use super::params::*;
use super::paths::{BONDED, HALF_ANGLE, RELAXATION, THICKNESS, TIP_SHAPE, VISCOSITIES};
use super::sample_rules::{beside_law, laws_of};
use super::scene_error::{Checked, Fault};
use crate::kernel::Law;

const RADIUS: &str = "instrument.tip.radius";

/// A shape that is no paraboloid has what it needs, a law that knows it, and nothing that has no effect.
pub(super) fn shape_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let shape = draft.params.instrument.tip.shape;
    let angle = draft.first_of(&[HALF_ANGLE]);
    let told = draft.place_of(TIP_SHAPE);
    if shape.has_angle() && angle.is_none() {
        return Err(Fault::at(told, "the tip's shape lacks its half-angle")
            .label(format!("a {} has one", TipShape::listed(TipShape::has_angle)))
            .expected("half_angle in [instrument.tip]: from the axis to the side, or to the pyramid's face")
            .help("add a line such as half_angle = \"20 deg\""));
    }
    if let (Some(said), false) = (angle, shape.has_angle()) {
        return Err(Fault::at(said.key.clone(), "`instrument.tip.half_angle` has no effect here")
            .label("this tip has no half-angle")
            .expected(format!(
                "a shape that has one in [instrument.tip]: {}",
                TipShape::listed(TipShape::has_angle)
            ))
            .help("set one of them, or remove this line"));
    }
    let swept = draft.said.iter().find(|said| said.swept && said.path == RADIUS);
    if let Some(said) = swept.filter(|_| !shape.has_radius()) {
        return Err(Fault::at(said.key.clone(), "`instrument.tip.radius` has no effect here")
            .label(format!("a {} ends in a point", TipShape::listed(|shape| !shape.has_radius())))
            .related(told, "the shape is chosen here")
            .expected("an axis that changes the result")
            .help("take another shape, or remove this axis"));
    }
    match shape {
        TipShape::Paraboloid => Ok(()),
        _ => law_fits(draft, sweep, shape),
    }
}

/// A layer is pressed by a tip and under a law that know it.
pub(super) fn layer_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let Some(said) = draft.first_of(&[THICKNESS]) else {
        return match draft.first_of(&[BONDED]) {
            Some(bonded) => Err(Fault::at(bonded.key.clone(), "`sample.bonded` has no effect here")
                .label("the sample is thick: it has no ground")
                .expected("a layer on a rigid ground")
                .help("add its thickness to [sample], or remove this line")),
            None => Ok(()),
        };
    };
    let fault = |title: &str, why: &str| Fault::at(said.key.clone(), title).label(why);
    if let Some(loss) = draft.first_of(&VISCOSITIES).or(draft.first_of(&RELAXATION)) {
        return Err(fault("a layer cannot have losses", "its contact is known for an elastic sample alone")
            .related(loss.key.clone(), "the sample has losses here")
            .expected("an elastic layer, or a thick sample")
            .help("remove the thickness, or the sample's losses"));
    }
    let shape = draft.params.instrument.tip.shape;
    if !matches!(shape, TipShape::Paraboloid | TipShape::Cone) {
        return Err(fault("a layer is not known under this tip", "its force is known for two shapes")
            .related(draft.place_of(TIP_SHAPE), "the shape is chosen here")
            .expected("shape = \"paraboloid\", which is the default, or \"cone\" in [instrument.tip]")
            .help("take one of these shapes, or remove the thickness"));
    }
    let misfit = laws_of(draft, sweep)
        .into_iter()
        .find(|choice| !choice.law().is_some_and(|law| !law.acts() || law.shaped().is_some()));
    let Some(choice) = misfit else { return Ok(()) };
    let why = match choice.law() {
        None => "law = \"auto\" may choose JKR, which is known for a thick sample alone".into(),
        Some(Law::Sum) => "a table is the whole force, and knows no layer".into(),
        Some(Law::Jkr) => "JKR is known for a thick sample alone".into(),
        Some(law) => format!("law = \"{law}\" is known for a thick sample alone"),
    };
    Err(beside_law(fault("the law does not know a layer", &why), draft)
        .expected("law = \"hertz\" or law = \"dmt\" in [contact]")
        .help("set one of them, or remove the thickness"))
}

fn law_fits(draft: &Draft, sweep: &SweptAxes, shape: TipShape) -> Checked<()> {
    let told = draft.place_of(TIP_SHAPE);
    if let Some(loss) = draft.first_of(&VISCOSITIES).or(draft.first_of(&RELAXATION)) {
        return Err(Fault::at(loss.key.clone(), "a sample with losses needs a tip that is a paraboloid")
            .label("its contact is known for that shape alone")
            .related(told, "the shape is chosen here")
            .expected("shape = \"paraboloid\" in [instrument.tip], which is the default")
            .help("remove the shape, or the sample's losses"));
    }
    let known = |law: Law| match law.shaped() {
        Some(Law::ShapedDmt) => shape == TipShape::Sphere,
        Some(_) => true,
        None => !law.acts(),
    };
    let misfit = laws_of(draft, sweep).into_iter().find(|choice| !choice.law().is_some_and(known));
    let Some(choice) = misfit else { return Ok(()) };
    let (why, expected) = match choice.law() {
        None => {
            ("law = \"auto\" may choose JKR, which is known for a paraboloid alone".into(), "law = \"hertz\"")
        }
        Some(Law::Dmt) => {
            ("DMT's attraction is that of a round tip".into(), "law = \"hertz\", or a paraboloid or sphere")
        }
        Some(Law::Sum) => ("a table is the whole force, and knows no shape".into(), "law = \"hertz\""),
        Some(Law::Jkr) => {
            ("JKR is known for a paraboloid alone".into(), "law = \"hertz\", or \"dmt\" under a sphere")
        }
        Some(law) => (
            format!("law = \"{law}\" is known for a paraboloid alone"),
            "law = \"hertz\", or \"dmt\" under a sphere",
        ),
    };
    let fault = Fault::at(told, "the law does not know this shape of the tip").label(why);
    Err(beside_law(fault, draft)
        .expected(format!("{expected} in [contact]"))
        .help("set that law, or remove the shape"))
}
