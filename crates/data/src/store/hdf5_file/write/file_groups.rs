//! All groups of a file: every file has all of them, so that readers need not ask which there are.

use super::super::{ERROR, GROUPS, HDF5_VERSION, OBSERVABLE, PROVENANCE, Results, StoreError};
use super::group_layout::{ArrayValues, Beside, GroupLayout};
use super::{FileContents, force_curve_group, root_group};
use crate::store::{AuditTable, Spectra, Waveforms};

/// The groups, the root first. `scene_text` is the scene where the results do not hold it.
pub(super) fn all<'a>(
    filled: &FileContents<'a>,
    scene_text: &'a str,
) -> Result<Vec<GroupLayout<'a>>, StoreError> {
    let results = filled.frame;
    let mut groups = vec![root_group::root(filled)];
    groups.extend(results.waveforms.as_ref().filter(|one| !one.instances.is_empty()).map(waveforms));
    groups.extend(results.spectra.as_ref().filter(|one| !one.instances.is_empty()).map(spectra));
    if !results.force_curves.is_empty() {
        groups.push(force_curve_group::of_curves(&results.force_curves)?);
    }
    groups.extend(results.audit.as_ref().filter(|one| !one.instances.is_empty()).map(audit));
    groups.extend(filled.second().map(|branch| root_group::second_states(filled, branch)));
    for name in GROUPS {
        if groups.iter().all(|group| group.name != name) {
            groups.push(GroupLayout::new(name));
        }
    }
    groups.push(provenance(results, scene_text));
    Ok(groups)
}

fn rows(rows: &[Vec<f64>]) -> ArrayValues<'static> {
    ArrayValues::F64(rows.concat().into())
}

fn waveforms(waveforms: &Waveforms) -> GroupLayout<'_> {
    let mut layout = GroupLayout::new("waveforms");
    let instance = layout.some_of("waveform", &waveforms.instances);
    let long_name = "time from the drive's zero phase";
    let own_time = waveforms.time.len() != 1;
    let dims = if let [time] = waveforms.time.as_slice() {
        let time = ArrayValues::F64(time.as_slice().into());
        vec![instance, layout.coordinate("time", "s", long_name, time)]
    } else {
        let length = waveforms.time.first().map_or(0, Vec::len);
        let dims = vec![instance, layout.dimension("sample", length)];
        layout.quantity("time", ("s", long_name), &dims, rows(&waveforms.time));
        dims
    };
    for column in Waveforms::COLUMNS {
        let values = rows((column.of)(waveforms));
        let place = layout.quantity(column.name, (column.units, column.long_name), &dims, values);
        // Not `instance`: in a list's file xarray shows no group whose coordinate has the name of the file's own dimension.
        if own_time {
            layout.label(place, "coordinates", "time");
        }
    }
    layout
}

fn spectra(spectra: &Spectra) -> GroupLayout<'_> {
    let mut layout = GroupLayout::new("spectra");
    let spectrum = layout.some_of("spectrum", &spectra.instances);
    // Not `harmonic`: a group's dimension must not have the name of a longer or shorter one of the root's.
    let orders = ArrayValues::I32((1..=spectra.harmonics() as i32).collect());
    let order = layout.coordinate("order", "1", "harmonic of the drive frequency", orders);
    for column in Spectra::COLUMNS {
        let (of, values) = ((column.units, column.long_name), rows((column.of)(spectra)));
        layout.quantity(column.name, of, &[spectrum, order], values);
    }
    layout
}

fn audit(table: &AuditTable) -> GroupLayout<'_> {
    let mut layout = GroupLayout::new("audit");
    let dims = vec![layout.some_of("audited", &table.instances)];
    let beside = Beside { coordinates: None, ancillary: "reference_status reference_error" };
    layout.variables(&table.variables, &dims, beside, None);
    let words = ArrayValues::Words(&table.observables);
    let observables = layout.coordinate(OBSERVABLE, "", "observable", words);
    let of = ("1", "error of the run, on the scale of accuracy");
    let errors = ArrayValues::F64(table.errors.as_slice().into());
    layout.quantity(ERROR, of, &[dims[0], observables], errors);
    for flags in &table.flags {
        layout.words(flags, &dims, ArrayValues::U8(flags.data.as_slice().into()));
    }
    layout
}

/// Long texts, out of the way of those who list the root's attributes.
fn provenance<'a>(results: &'a Results, scene_text: &'a str) -> GroupLayout<'a> {
    let mut layout = GroupLayout::new(PROVENANCE);
    if results.text("scene").is_none() {
        layout.text("scene", scene_text);
    }
    results.provenance.iter().for_each(|(name, text)| layout.text(name, text.as_str()));
    let (major, minor, micro) = hdf5::library_version();
    layout.text(HDF5_VERSION, format!("{major}.{minor}.{micro}"));
    layout
}
