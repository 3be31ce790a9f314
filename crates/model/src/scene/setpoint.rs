//! What goes with a set-point, and what does not.

use super::draft::Draft;
use super::error::{Checked, Fault};
use super::values::Value;
use super::{Run, Start, Steady, SweptAxes};

/// The quantities that are held in place of the gap.
pub(super) const PATHS: [&str; 2] = ["approach.setpoint", "approach.force_setpoint"];
/// Which of two states holds it.
const BRANCH: &str = "approach.setpoint_branch";

/// Refuses what a scene with a set-point cannot have beside it.
pub(super) fn check(run_section: Option<&Value>, run: &Run, sweep: &SweptAxes, draft: &Draft) -> Checked<()> {
    let Some(held) = draft.first_of(&PATHS) else {
        return match draft.first_of(&[BRANCH]) {
            Some(branch) => Err(Fault::at(branch.key.clone(), "a branch is chosen for a set-point")
                .label("this scene gives the gap")
                .expected("setpoint or force_setpoint beside it")
                .help("give setpoint = 0.8 in place of the gap, or remove this line")),
            None => Ok(()),
        };
    };
    let table = run_section.and_then(|section| section.get_ref().as_table());
    let span = |key: &str| table.and_then(|table| table.get(key)).map_or(0..0, |value| value.span());
    if sweep.curve.is_some() {
        return Err(Fault::at(held.key.clone(), "a curve has no set-point")
            .label("along a curve the gap is given, or stays")
            .expected("a gap, or a scene without [curve]")
            .help("make the quantity of the curve an axis of [sweep]: the set-point is held at each of its values"));
    }
    if run.start == Start::Rest {
        return Err(Fault::at(span("start"), "a set-point is not held from rest")
            .label("the sample moves until a periodic state holds it")
            .expected("start = \"steady\"")
            .help("remove the line"));
    }
    if run.steady == Steady::Wait {
        return Err(Fault::at(span("steady"), "a set-point is held in a periodic state")
            .label("waiting does not move the sample")
            .expected("steady = \"search\", which a scene with a set-point has by itself")
            .help("remove the line"));
    }
    if run.both_branches {
        return Err(Fault::at(span("branches"), "a set-point is held in one state")
            .label("second states belong to a gap that is given")
            .expected("setpoint_branch in [approach]")
            .help("run the scene twice, with setpoint_branch = \"attractive\" and \"repulsive\""));
    }
    Ok(())
}
