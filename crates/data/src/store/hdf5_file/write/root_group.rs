//! The root group: what the file says of itself, and the variables over all instances; the group of second states likewise.

use super::super::history::history;
use super::super::{BranchTable, Flags, NO_STATE, OWN_ATTRIBUTES, StateSet, Variable};
use super::FileContents;
use super::group_layout::{ArrayRole, ArrayValues, Beside, GroupLayout, InstanceColumn};
use crate::observe::Status;

/// The word for [`NO_STATE`] in a group's `status`.
const NO_STATE_MEANING: &str = "no_second_state";

/// The root, but for the checksums.
pub(super) fn root<'a>(filled: &FileContents<'a>) -> GroupLayout<'a> {
    let results = filled.frame;
    let history =
        results.text("history").map_or_else(|| history(results.text("command_line")), str::to_owned);
    let mut layout = GroupLayout::new("");
    layout.text("title", results.title.as_str());
    layout.text("Conventions", "CF-1.10");
    layout.text("history", history);
    let told = results.attributes.iter().filter(|(name, _)| !OWN_ATTRIBUTES.contains(&name.as_str()));
    told.for_each(|(name, value)| layout.attribute(name, value));
    let (dims, coordinates) = layout.axes(filled);
    if !results.list {
        layout.numbered(&dims, ArrayValues::Count(filled.count()));
    }
    let all = (&results.variables[..], &results.flags[..], coordinates.as_deref());
    states(&mut layout, StateSet::First, &dims, all);
    for (name, comment) in &results.comments {
        let is_it = |array: &super::ArrayLayout| array.name == name && array.role == ArrayRole::Variable;
        if let Some(place) = layout.arrays.iter().position(is_it) {
            layout.label(place, "comment", comment.as_str());
        }
    }
    layout
}

/// Group `other_branch`, with dimensions and coordinates of its own that are the root's.
pub(super) fn second_states<'a>(filled: &FileContents<'a>, branch: &'a BranchTable) -> GroupLayout<'a> {
    let mut layout = GroupLayout::new("other_branch");
    let (dims, coordinates) = layout.axes(filled);
    let all = (&branch.variables[..], &branch.flags[..], coordinates.as_deref());
    states(&mut layout, StateSet::Second, &dims, all);
    layout
}

/// Variables and flags over all instances, and the names of those that say where they lie in a list.
type OverInstances<'a, 'n> = (&'a [Variable], &'a [Flags], Option<&'n str>);

/// These, status and steps.
fn states<'a>(
    layout: &mut GroupLayout<'a>,
    of: StateSet,
    dims: &[usize],
    (variables, flags, coordinates): OverInstances<'a, '_>,
) {
    let (of_status, of_steps) = match of {
        StateSet::First => ("what became of the instance", "time steps per period of the drive"),
        StateSet::Second => (
            "what became of the second state",
            "time steps per period of the drive, 0 without a second state",
        ),
    };
    let beside = Beside { coordinates, ancillary: quality(variables) };
    layout.variables(variables, dims, beside, Some(of));
    let known = Status::ALL.map(|status| (status as u8, status.meaning()));
    let none = (of == StateSet::Second).then_some((NO_STATE, NO_STATE_MEANING));
    let (values, words): (Vec<u8>, Vec<&str>) = known.into_iter().chain(none).unzip();
    let told = ("status", of_status, words.join(" "));
    let column = |column| ArrayValues::Instances(of, column);
    let first = layout.codes(told, dims, ("flag_values", values), column(InstanceColumn::Status));
    let steps = layout.variable("steps_per_period", dims, column(InstanceColumn::Steps));
    layout.label(steps, "long_name", of_steps);
    for (n, flags) in flags.iter().enumerate() {
        layout.words(flags, dims, column(InstanceColumn::Flags(n)));
    }
    (first..layout.arrays.len()).for_each(|place| layout.locate(place, beside));
}

/// What tells how good the instances of these variables are.
fn quality(variables: &[Variable]) -> &'static str {
    match variables.iter().any(|one| one.name == "error_estimate") {
        true => "status error_estimate",
        false => "status",
    }
}
