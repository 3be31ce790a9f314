//! The groups below the root: every file has all of them, and one that holds nothing says why.

use super::super::{GROUPS, HDF5_VERSION, PROVENANCE, Results};
use super::{Beside, Layout, branches, curves, labels, waveforms};
use crate::store::Listed;
use hdf5::File;

/// Writes them. `scene_text` is the scene where the results do not hold it.
pub(super) fn write(file: &File, results: &Results, scene_text: &str) -> hdf5::Result<()> {
    if let Some(one) = results.waveforms.as_ref().filter(|one| !one.instances.is_empty()) {
        waveforms::write(file, one)?;
    }
    if !results.force_curves.is_empty() {
        curves::write(file, &results.force_curves)?;
    }
    if let Some(listed) = results.audit.as_ref().filter(|one| !one.instances.is_empty()) {
        audit(file, listed)?;
    }
    if let Some(branch) = &results.other_branch {
        branches::write(Layout::group(file, "other_branch")?, results, branch)?;
    }
    for (name, why) in GROUPS.iter().filter(|(name, _)| !file.link_exists(name)) {
        labels::text(&Layout::group(file, name)?.group, "comment", why)?;
    }
    provenance(file, results, scene_text)
}

fn audit(file: &File, listed: &Listed) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "audit")?;
    let dims = vec![layout.some_of("audited", &listed.instances)?];
    let beside = Beside { coordinates: Some("instance"), ancillary: "reference_status reference_error" };
    layout.variables(&listed.variables, &dims, beside)?;
    for flags in &listed.flags {
        let dataset = layout.words(flags, &dims)?;
        beside.locate(&dataset)?;
    }
    layout.close()
}

/// Long texts, out of the way of those who list the root's attributes.
fn provenance(file: &File, results: &Results, scene_text: &str) -> hdf5::Result<()> {
    let group = Layout::group(file, PROVENANCE)?.group;
    if results.text("scene").is_none() {
        labels::text(&group, "scene", scene_text)?;
    }
    results.provenance.iter().try_for_each(|(name, text)| labels::text(&group, name, text))?;
    let (major, minor, micro) = hdf5::library_version();
    labels::text(&group, HDF5_VERSION, &format!("{major}.{minor}.{micro}"))
}
