//! Samples that stand in a file beside the scene.

use super::address::Address;
use super::axes::{axis, in_all, swept_quantity};
use super::draft::Draft;
use super::sample_table::{self, SampleTable};
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use super::{Axis, Layout, SweptAxes, TableFile, axis_zip};
use std::ops::Range;
use std::path::Path;
use toml::de::DeTable;

/// `[samples]` from a file.
pub(super) fn read(key: &Key, table: &DeTable, file: &Value, draft: &mut Draft) -> Checked<SweptAxes> {
    if let Some(other) = table.keys().find(|key| !["file", "names"].contains(&key.get_ref().as_ref())) {
        return Err(Fault::at(other.span(), "[samples] has a file and lists of its own")
            .label("a list here")
            .related(file.span(), "a file here")
            .expected("the one or the other")
            .help("make it a column of the file"));
    }
    let (table, named) = file_of(file, table.get("names"), "samples", draft)?;
    if !table.ids.is_empty() {
        return Err(Fault::at(file.span(), "[samples] keeps no names of rows")
            .label("this file has a column `id`")
            .expected("columns of quantities")
            .help("write it as [design] with kind = \"table\", which keeps them"));
    }
    draft.drawn.file = Some(named);
    let axes = axes(table.columns, key.span(), draft)?;
    let sweep = SweptAxes { axes, layout: Layout::List, ..SweptAxes::default() };
    in_all(sweep.len(), &key.span())?;
    axis_zip::check(&sweep, key.span(), draft)?;
    Ok(sweep)
}

/// The table that `file = ...` and `names = ...` of a section name.
pub(super) fn file_of(
    value: &Value,
    names: Option<&Value>,
    section: &str,
    draft: &Draft,
) -> Checked<(SampleTable, TableFile)> {
    let name = values::text(value, &format!("{section}.file"))?;
    let addresses = match names {
        None => None,
        Some(list) => {
            let path = format!("{section}.names");
            let entries = values::list(list, &path, "a list of paths, such as [\"instrument.tip.radius\"]")?;
            let address = |entry: &Value| match Address::find(values::text(entry, &path)?) {
                Some(address) => Ok(address),
                None => {
                    let word = values::text(entry, &path)?.to_owned();
                    swept_quantity(&toml::Spanned::new(entry.span(), word.into()), entry, section)
                }
            };
            Some(entries.iter().map(address).collect::<Checked<Vec<Address>>>()?)
        }
    };
    // A results file may lie elsewhere than its scene did: whoever reads that again stands where it was run.
    let beside = draft.folder.join(name).exists() || !Path::new(name).exists();
    let folder = if beside { draft.folder.as_path() } else { Path::new("") };
    let table = sample_table::read(folder, name, addresses.as_deref(), value.span())?;
    let names = addresses.map(|all| all.iter().map(|address| address.path()).collect());
    Ok((table, TableFile { file: name.to_owned(), names }))
}

/// Columns of a table as axes that the scene says at `place`.
pub(super) fn axes(
    columns: Vec<(Address, Vec<f64>)>,
    place: Range<usize>,
    draft: &mut Draft,
) -> Checked<Vec<Axis>> {
    let mut axes = Vec::new();
    for (address, values) in columns {
        draft.vary(&address.path(), place.clone())?;
        axes.push(axis(address, values, false));
    }
    Ok(axes)
}
