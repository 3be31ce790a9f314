//! What goes with a set-point, and what does not.

use super::draft::{Draft, Said};
use super::quantity::SETPOINT;
use super::scene_error::{Checked, Fault};
use super::values::Value;
use super::{Axis, Held, Run, SetPointOf, Start, Steady, SweptAxes};

/// The quantities that are held in place of the gap.
pub(super) const PATHS: [&str; 2] = ["approach.setpoint", "approach.force_setpoint"];
/// What goes with them: which of two states holds it, what it is of, how deep it is looked for.
const BESIDE: [(&str, &str); 3] = [
    ("approach.setpoint_branch", "a branch is chosen for a set-point"),
    ("approach.setpoint_of", "it says what a set-point is of"),
    ("approach.deepest", "it says how deep a set-point is looked for"),
];

/// Names the axes of set-points by what they are of.
pub(super) fn name(sweep: &mut SweptAxes, of: SetPointOf) {
    let (long_name, units) = match of {
        SetPointOf::Tip => return,
        SetPointOf::Deflection => ("deflection set-point", "1"),
        SetPointOf::Phase => ("phase set-point", "degree"),
    };
    let columns = sweep.axes.iter_mut().flat_map(|axis| {
        let Axis { path, long_name, units, columns, .. } = axis;
        let own = std::iter::once((&*path, long_name, units));
        own.chain(columns.iter_mut().map(|one| (&one.path, &mut one.long_name, &mut one.units)))
    });
    for (_, name, unit) in columns.filter(|(path, ..)| *path == PATHS[0]) {
        (*name, *unit) = (long_name.into(), units.into());
    }
}

/// Refuses shares that are none.
fn shares(held: &Said, sweep: &SweptAxes, draft: &Draft) -> Checked<()> {
    if held.path != PATHS[0] || draft.params.approach.of == SetPointOf::Phase {
        return Ok(());
    }
    let base = match draft.params.approach.held {
        Some(Held::Amplitude(share)) => Some(share),
        _ => None,
    };
    let axes = sweep.axes.iter().flat_map(|axis| std::iter::once(axis).chain(&axis.columns));
    let swept = axes.filter(|axis| axis.path == PATHS[0]).flat_map(|axis| axis.values.iter().copied());
    match swept.chain(base).find(|share| *share >= 1.0) {
        None => Ok(()),
        Some(share) => Err(Fault::at(held.key.clone(), format!("`{}` has an impossible value", held.path))
            .label(format!("found {share}"))
            .expected(SETPOINT.0)
            .help(SETPOINT.1)),
    }
}

/// Refuses what a scene with a set-point cannot have beside it.
pub(super) fn check(run_section: Option<&Value>, run: &Run, sweep: &SweptAxes, draft: &Draft) -> Checked<()> {
    let Some(held) = draft.first_of(&PATHS) else {
        let beside = |(path, why): &(&'static str, &'static str)| Some((draft.first_of(&[*path])?, *why));
        return match BESIDE.iter().find_map(beside) {
            Some((said, why)) => Err(Fault::at(said.key.clone(), why)
                .label("this scene gives the gap")
                .expected("setpoint or force_setpoint beside it")
                .help("give setpoint = 0.8 in place of the gap, or remove this line")),
            None => Ok(()),
        };
    };
    shares(held, sweep, draft)?;
    if let Some(of) = draft.first_of(&[BESIDE[1].0]).filter(|_| held.path == PATHS[1]) {
        return Err(Fault::at(of.key.clone(), "a force set-point is of the largest force")
            .label("it says what `setpoint` is of")
            .expected("no such line beside force_setpoint")
            .help("remove the line, or give setpoint in place of force_setpoint"));
    }
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
