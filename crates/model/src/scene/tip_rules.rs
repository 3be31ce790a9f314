//! What a scene says of its tip's shape, and what goes with it.

use super::SweptAxes;
use super::draft::Draft;
use super::params::*;
use super::paths::{HALF_ANGLE, RELAXATION, TIP_SHAPE, VISCOSITIES};
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
            .label("a cone and a pyramid have one")
            .expected("half_angle in [instrument.tip]: from the axis to the cone, or to the pyramid's face")
            .help("add a line such as half_angle = \"20 deg\""));
    }
    if let (Some(said), false) = (angle, shape.has_angle()) {
        return Err(Fault::at(said.key.clone(), "`instrument.tip.half_angle` has no effect here")
            .label("this tip has no half-angle")
            .expected("shape = \"cone\" or shape = \"pyramid\" in [instrument.tip]")
            .help("set one of them, or remove this line"));
    }
    if let Some(said) = draft.said.iter().find(|said| said.swept && said.path == RADIUS && shape.has_angle())
    {
        return Err(Fault::at(said.key.clone(), "`instrument.tip.radius` has no effect here")
            .label("a cone and a pyramid end in a point")
            .related(told, "the shape is chosen here")
            .expected("an axis that changes the result")
            .help("take another shape, or remove this axis"));
    }
    match shape {
        TipShape::Paraboloid => Ok(()),
        _ => law_fits(draft, sweep, shape),
    }
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
        None => ("law = \"auto\" may choose JKR, which is known for a paraboloid alone", "law = \"hertz\""),
        Some(Law::Dmt) => {
            ("DMT's attraction is that of a round tip", "law = \"hertz\", or a paraboloid or sphere")
        }
        Some(_) => ("JKR is known for a paraboloid alone", "law = \"hertz\", or \"dmt\" under a sphere"),
    };
    let fault = Fault::at(told, "the law does not know this shape of the tip").label(why);
    Err(beside_law(fault, draft)
        .expected(format!("{expected} in [contact]"))
        .help("set that law, or remove the shape"))
}
