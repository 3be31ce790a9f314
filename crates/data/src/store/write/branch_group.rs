//! Group `other_branch`, with dimensions and coordinates of its own that are the root's.

use super::super::{BranchTable, NO_STATE, StateSet};
use super::{Beside, FileContents, Layout, dimension_scales, quality};
use crate::observe::Status;

/// The word for [`NO_STATE`] in the group's `status`.
const NO_STATE_MEANING: &str = "no_second_state";

/// Fills the group and closes it.
pub(super) fn write(mut layout: Layout, filled: &FileContents, branch: &BranchTable) -> hdf5::Result<()> {
    let (dims, coordinates) = layout.axes(filled)?;
    let beside = Beside { coordinates: coordinates.as_deref(), ancillary: quality(&branch.variables) };
    layout.variables(&branch.variables, &dims, beside, Some((filled, StateSet::Second)))?;
    let mut meanings: Vec<(u8, String)> =
        Status::ALL.iter().map(|status| (*status as u8, status.meaning().to_owned())).collect();
    meanings.push((NO_STATE, NO_STATE_MEANING.to_owned()));
    let long_name = "what became of the second state";
    let codes = filled.status(StateSet::Second)?;
    let status = layout.flags("status", long_name, &dims, &codes, &meanings)?;
    let steps = layout.variable("steps_per_period", &dims, &filled.steps(StateSet::Second)?)?;
    dimension_scales::text(
        &steps,
        "long_name",
        "time steps per period of the drive, 0 without a second state",
    )?;
    let mut described = vec![status, steps];
    for (n, flags) in branch.flags.iter().enumerate() {
        described.push(layout.words(flags, &dims, &filled.flags(StateSet::Second, n, flags)?)?);
    }
    described.iter().try_for_each(|dataset| beside.locate(dataset))?;
    layout.close()
}
