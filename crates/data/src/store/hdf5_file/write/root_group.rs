//! The root group: what the file says of itself, and the variables over all instances; the group of second states likewise.

use super::super::history::history;
use super::super::{Attribute, BranchTable, Flags, NO_STATE, OWN_ATTRIBUTES, StateSet, Variable};
use super::{Beside, FileContents, Layout, dimension_scales, quality};
use crate::observe::Status;
use hdf5::File;

/// The word for [`NO_STATE`] in a group's `status`.
const NO_STATE_MEANING: &str = "no_second_state";

/// Writes it, but for the checksums.
pub(super) fn write(file: &File, filled: &FileContents) -> hdf5::Result<()> {
    let results = filled.frame;
    let history =
        results.text("history").map_or_else(|| history(results.text("command_line")), str::to_owned);
    dimension_scales::text(file, "title", &results.title)?;
    dimension_scales::text(file, "Conventions", "CF-1.10")?;
    dimension_scales::text(file, "history", &history)?;
    for (name, value) in &results.attributes {
        match value {
            _ if OWN_ATTRIBUTES.contains(&name.as_str()) => {}
            Attribute::Text(value) => dimension_scales::text(file, name, value)?,
            Attribute::Number(value) => dimension_scales::number(file, name, *value)?,
        }
    }
    let group = file.group("/")?;
    let mut layout = Layout { file: file.clone(), group, scales: Vec::new() };
    let (dims, coordinates) = layout.axes(filled)?;
    if !results.list {
        layout.numbered(&dims, &(0..filled.count() as i64).collect::<Vec<_>>())?;
    }
    let described = ["what became of the instance", "time steps per period of the drive"];
    let all = (&results.variables[..], &results.flags[..], coordinates.as_deref());
    states(&mut layout, filled, StateSet::First, &dims, all, described)?;
    layout.close()
}

/// Fills group `other_branch`, with dimensions and coordinates of its own that are the root's.
pub(super) fn second_states(
    mut layout: Layout,
    filled: &FileContents,
    branch: &BranchTable,
) -> hdf5::Result<()> {
    let (dims, coordinates) = layout.axes(filled)?;
    let described =
        ["what became of the second state", "time steps per period of the drive, 0 without a second state"];
    let all = (&branch.variables[..], &branch.flags[..], coordinates.as_deref());
    states(&mut layout, filled, StateSet::Second, &dims, all, described)?;
    layout.close()
}

/// Variables and flags over all instances, and the names of those that say where they lie in a list.
type OverInstances<'a> = (&'a [Variable], &'a [Flags], Option<&'a str>);

/// Writes these, status and steps, the last two described like that.
fn states(
    layout: &mut Layout,
    filled: &FileContents,
    of: StateSet,
    dims: &[usize],
    all: OverInstances,
    [of_status, of_steps]: [&str; 2],
) -> hdf5::Result<()> {
    let (variables, flags, coordinates) = all;
    let beside = Beside { coordinates, ancillary: quality(variables) };
    layout.variables(variables, dims, beside, Some((filled, of)))?;
    let comments = filled.frame.comments.iter().filter(|_| of == StateSet::First);
    for (name, comment) in comments.filter(|(name, _)| layout.file.link_exists(name)) {
        dimension_scales::text(&*layout.file.dataset(name)?, "comment", comment)?;
    }
    let known = Status::ALL.map(|status| (status as u8, status.meaning()));
    let none = (of == StateSet::Second).then_some((NO_STATE, NO_STATE_MEANING));
    let (values, words): (Vec<u8>, Vec<&str>) = known.into_iter().chain(none).unzip();
    let meanings = words.into_iter().map(str::to_owned).collect();
    let status = Flags { name: "status".into(), long_name: of_status.into(), meanings, ..Flags::default() };
    let status = layout.flags(&status, dims, &filled.status(of)?, &values)?;
    let steps = layout.variable("steps_per_period", dims, &filled.steps(of)?)?;
    dimension_scales::text(&steps, "long_name", of_steps)?;
    let mut described = vec![status, steps];
    for (n, flags) in flags.iter().enumerate() {
        described.push(layout.words(flags, dims, &filled.flags(of, n, flags)?)?);
    }
    described.iter().try_for_each(|dataset| beside.locate(dataset))
}
