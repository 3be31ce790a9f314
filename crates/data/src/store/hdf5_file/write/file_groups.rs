//! The groups below the root: every file has all of them, so that readers need not ask which there are.

use super::super::{ERROR, GROUPS, HDF5_VERSION, OBSERVABLE, PROVENANCE, Results};
use super::{Beside, FileContents, Layout, dimension_scales, force_curve_group, root_group};
use crate::store::{AuditTable, Spectra, Waveforms};
use hdf5::File;

/// Writes them. `scene_text` is the scene where the results do not hold it.
pub(super) fn write(file: &File, filled: &FileContents, scene_text: &str) -> hdf5::Result<()> {
    let results = filled.frame;
    if let Some(one) = results.waveforms.as_ref().filter(|one| !one.instances.is_empty()) {
        waveforms(file, one)?;
    }
    if let Some(one) = results.spectra.as_ref().filter(|one| !one.instances.is_empty()) {
        spectra(file, one)?;
    }
    if !results.force_curves.is_empty() {
        force_curve_group::write(file, &results.force_curves)?;
    }
    if let Some(table) = results.audit.as_ref().filter(|one| !one.instances.is_empty()) {
        audit(file, table)?;
    }
    if let Some(branch) = filled.second() {
        root_group::second_states(Layout::group(file, "other_branch")?, filled, branch)?;
    }
    for name in GROUPS.iter().filter(|name| !file.link_exists(name)) {
        Layout::group(file, name)?;
    }
    provenance(file, results, scene_text)
}

fn waveforms(file: &File, waveforms: &Waveforms) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "waveforms")?;
    let instance = layout.some_of("waveform", &waveforms.instances)?;
    let long_name = "time from the drive's zero phase";
    let own_time = waveforms.time.len() != 1;
    let dims = if let [time] = waveforms.time.as_slice() {
        vec![instance, layout.coordinate("time", "s", long_name, time)?]
    } else {
        let length = waveforms.time.first().map_or(0, Vec::len);
        let dims = vec![instance, layout.dimension("sample", length)?];
        layout.quantity("time", "s", long_name, &dims, &waveforms.time.concat())?;
        dims
    };
    for column in Waveforms::COLUMNS {
        let rows = (column.of)(waveforms).concat();
        let dataset = layout.quantity(column.name, column.units, column.long_name, &dims, &rows)?;
        // Not `instance`: in a list's file xarray shows no group whose coordinate has the name of the file's own dimension.
        if own_time {
            dimension_scales::text(&dataset, "coordinates", "time")?;
        }
    }
    layout.close()
}

fn spectra(file: &File, spectra: &Spectra) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "spectra")?;
    let spectrum = layout.some_of("spectrum", &spectra.instances)?;
    // Not `harmonic`: a group's dimension must not have the name of a longer or shorter one of the root's.
    let orders: Vec<i32> = (1..=spectra.harmonics() as i32).collect();
    let order = layout.coordinate("order", "1", "harmonic of the drive frequency", &orders)?;
    for column in Spectra::COLUMNS {
        let rows = (column.of)(spectra).concat();
        layout.quantity(column.name, column.units, column.long_name, &[spectrum, order], &rows)?;
    }
    layout.close()
}

fn audit(file: &File, table: &AuditTable) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "audit")?;
    let dims = vec![layout.some_of("audited", &table.instances)?];
    let beside = Beside { coordinates: None, ancillary: "reference_status reference_error" };
    layout.variables(&table.variables, &dims, beside, None)?;
    let observables = layout.labels(OBSERVABLE, "observable", &table.observables)?;
    let long_name = "error of the run, on the scale of accuracy";
    layout.quantity(ERROR, "1", long_name, &[dims[0], observables], &table.errors)?;
    for flags in &table.flags {
        layout.words(flags, &dims, &flags.data)?;
    }
    layout.close()
}

/// Long texts, out of the way of those who list the root's attributes.
fn provenance(file: &File, results: &Results, scene_text: &str) -> hdf5::Result<()> {
    let group = Layout::group(file, PROVENANCE)?.group;
    if results.text("scene").is_none() {
        dimension_scales::text(&group, "scene", scene_text)?;
    }
    results.provenance.iter().try_for_each(|(name, text)| dimension_scales::text(&group, name, text))?;
    let (major, minor, micro) = hdf5::library_version();
    dimension_scales::text(&group, HDF5_VERSION, &format!("{major}.{minor}.{micro}"))
}
