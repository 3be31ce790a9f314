//! The root group: what the file says of itself, and the variables over all instances.

use super::super::history::history;
use super::super::{Attribute, OWN_ATTRIBUTES, StateSet};
use super::{Beside, FileContents, Layout, dimension_scales, quality};
use crate::observe::Status;
use hdf5::File;

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
    let beside = Beside { coordinates: coordinates.as_deref(), ancillary: quality(&results.variables) };
    layout.variables(&results.variables, &dims, beside, Some((filled, StateSet::First)))?;
    for (name, comment) in results.comments.iter().filter(|(name, _)| file.link_exists(name)) {
        let dataset = file.dataset(name)?;
        dimension_scales::text(&dataset, "comment", comment)?;
    }
    let meanings: Vec<(u8, String)> =
        Status::ALL.iter().map(|status| (*status as u8, status.meaning().to_owned())).collect();
    let codes = filled.status(StateSet::First)?;
    let status = layout.flags("status", "what became of the instance", &dims, &codes, &meanings)?;
    let steps = layout.variable("steps_per_period", &dims, &filled.steps(StateSet::First)?)?;
    dimension_scales::text(&steps, "long_name", "time steps per period of the drive")?;
    let mut described = vec![status, steps];
    for (n, flags) in results.flags.iter().enumerate() {
        described.push(layout.words(flags, &dims, &filled.flags(StateSet::First, n, flags)?)?);
    }
    described.iter().try_for_each(|dataset| beside.locate(dataset))?;
    layout.close()
}
