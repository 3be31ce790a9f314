//! `[sweep]` and `[samples]`: which quantities vary, and through which values.

use super::axes::{axis, axis_values, found_values, in_all, listed, swept_quantity};
use super::draft::{Draft, Said};
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use super::{Layout, SweptAxes, array_samples, axis_zip, table_file};
use std::ops::Range;
use toml::de::DeTable;

/// Reads whichever of the two sections there are, and notes their axes in the draft. Beside a grid or a curve a list is an
/// axis of it.
pub(super) fn read(document: &DeTable, draft: &mut Draft) -> SweptAxes {
    let (grid, list) = (document.get_key_value("sweep"), document.get_key_value("samples"));
    let alone = grid.is_none() && !document.contains_key("curve");
    let read = match (grid, list) {
        _ if draft.given.is_some() => arrays(document, alone, draft),
        (None, None) => Ok(SweptAxes::default()),
        (Some((key, value)), None) => section(key, value, Layout::Grid, draft),
        (None, Some((key, value))) if alone => section(key, value, Layout::List, draft),
        (grid, Some((key, value))) => {
            let read = |draft: &mut Draft| section(key, value, Layout::List, draft);
            crossed(grid, (key.span(), &read), draft)
        }
    };
    draft.faults.take(read).unwrap_or_default()
}

/// Samples of the caller, alone or beside a grid or a curve.
fn arrays(document: &DeTable, alone: bool, draft: &mut Draft) -> Checked<SweptAxes> {
    let Some(given) = draft.given.take() else { return Ok(SweptAxes::default()) };
    for section in ["samples", "uncertain", "design"] {
        if let Some((key, _)) = document.get_key_value(section) {
            return Err(array_samples::beside(&given, section, key.span()));
        }
    }
    let place = given.place.clone();
    if alone {
        return array_samples::read(given, draft);
    }
    let list = array_samples::read(given, draft)?;
    crossed(document.get_key_value("sweep"), (place, &|_| Ok(list.clone())), draft)
}

/// Reads the samples.
type ReadSamples<'a> = dyn Fn(&mut Draft) -> Checked<SweptAxes> + 'a;

/// A grid of which each point has every sample; `read` gives these, which the scene has at `place`.
fn crossed(
    grid: Option<(&Key, &Value)>,
    (place, read): (Range<usize>, &ReadSamples),
    draft: &mut Draft,
) -> Checked<SweptAxes> {
    let mut sweep = match grid {
        Some((key, value)) => section(key, value, Layout::Grid, draft)?,
        None => SweptAxes::default(),
    };
    let list = read(draft)?;
    let twice = list.axes.iter().find(|axis| sweep.quantities().any(|other| other.path == axis.path));
    if let Some(axis) = twice {
        let said = draft.said.iter().rev().find(|said| said.swept && said.path == axis.path);
        return Err(axis_zip::varies_twice(
            &axis.path,
            said.map_or(place.clone(), |said| said.key.clone()),
            draft,
        ));
    }
    let samples = list.len();
    sweep.axes.push(axis_zip::samples(list.axes, samples));
    in_all(sweep.len(), &place)?;
    axis_zip::check(&sweep, place, draft)?;
    Ok(sweep)
}

fn section(key: &Key, value: &Value, layout: Layout, draft: &mut Draft) -> Checked<SweptAxes> {
    let name = key.get_ref().as_ref();
    let table = values::table(value, name, &format!("a section [{name}]"))?;
    if table.is_empty() {
        return Err(Fault::at(key.span(), format!("[{name}] is empty"))
            .label("no quantity to vary")
            .expected(
                "at least one line, such as \"sample.youngs_modulus\" = { values = [\"1 GPa\", \"2 GPa\"] }",
            )
            .help("leave the section out to run the one case"));
    }
    if let (Layout::List, Some(file)) = (layout, table.get("file")) {
        return table_file::read(key, table, file, draft);
    }
    let mut sweep = SweptAxes { layout, ..SweptAxes::default() };
    let mut instances: usize = 1;
    for (key, value) in table {
        let read = axis_zip::read(key, value, layout, draft).unwrap_or_else(|| {
            let address = swept_quantity(key, value, name)?;
            let (values, log) = match layout {
                Layout::Grid => axis_values(value, address, &[])?,
                Layout::List => (listed(value, address)?, false),
            };
            draft.said.push(Said { path: address.path(), key: key.span(), swept: true });
            Ok(axis(address, values, log))
        });
        let Some(axis) = draft.faults.take(read) else { continue };
        let values = &axis.values;
        match layout {
            Layout::Grid => instances = instances.saturating_mul(values.len()),
            Layout::List if sweep.axes.is_empty() => instances = values.len(),
            Layout::List if values.len() != instances => {
                return Err(Fault::at(value.span(), "the lists of [samples] differ in length")
                    .label(found_values(values.len()))
                    .expected(format!("{instances} values, as for `{}`", sweep.axes[0].path))
                    .help("each instance takes one entry of every list"));
            }
            Layout::List => {}
        }
        in_all(instances, &key.span())?;
        sweep.axes.push(axis);
    }
    axis_zip::check(&sweep, key.span(), draft)?;
    Ok(sweep)
}
