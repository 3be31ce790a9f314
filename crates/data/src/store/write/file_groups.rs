//! The groups below the root: every file has all of them, so that readers need not ask which there are.

use super::super::{ERROR, GROUPS, HDF5_VERSION, OBSERVABLE, PROVENANCE, Results};
use super::{
    Beside, FileContents, Layout, branch_group, dimension_scales, force_curve_group, spectrum_group,
    waveform_group,
};
use crate::store::AuditTable;
use hdf5::File;

/// Writes them. `scene_text` is the scene where the results do not hold it.
pub(super) fn write(file: &File, filled: &FileContents, scene_text: &str) -> hdf5::Result<()> {
    let results = filled.frame;
    if let Some(one) = results.waveforms.as_ref().filter(|one| !one.instances.is_empty()) {
        waveform_group::write(file, one)?;
    }
    if let Some(one) = results.spectra.as_ref().filter(|one| !one.instances.is_empty()) {
        spectrum_group::write(file, one)?;
    }
    if !results.force_curves.is_empty() {
        force_curve_group::write(file, &results.force_curves)?;
    }
    if let Some(table) = results.audit.as_ref().filter(|one| !one.instances.is_empty()) {
        audit(file, table)?;
    }
    if let Some(branch) = filled.second() {
        branch_group::write(Layout::group(file, "other_branch")?, filled, branch)?;
    }
    for name in GROUPS.iter().filter(|name| !file.link_exists(name)) {
        Layout::group(file, name)?;
    }
    provenance(file, results, scene_text)
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
