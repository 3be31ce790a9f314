//! Group `waveforms`.

use super::{Layout, dimension_scales};
use crate::store::Waveforms;
use hdf5::File;

/// Fills the group and closes it.
pub(super) fn write(file: &File, waveforms: &Waveforms) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "waveforms")?;
    let instance = layout.some_of("waveform", &waveforms.instances)?;
    let long_name = "time from the drive's zero phase";
    let mut own_time = false;
    let dims = if let [time] = waveforms.time.as_slice() {
        vec![instance, layout.coordinate("time", "s", long_name, time)?]
    } else {
        let length = waveforms.time.first().map_or(0, Vec::len);
        let dims = vec![instance, layout.dimension("sample", length)?];
        layout.quantity("time", "s", long_name, &dims, &waveforms.time.concat())?;
        own_time = true;
        dims
    };
    for (name, units, long_name, rows) in [
        ("tip_travel", "m", "travel of the tip", &waveforms.tip_travel),
        ("actuator_top", "m", "travel of the actuator's top, or of a rigid base", &waveforms.actuator_top),
        ("indentation", "m", "indentation, negative for a gap", &waveforms.indentation),
        ("force", "N", "force on the tip, positive away from the sample", &waveforms.force),
    ] {
        let dataset = layout.quantity(name, units, long_name, &dims, &rows.concat())?;
        // Not `instance`: in a list's file xarray shows no group whose coordinate has the name of the file's own dimension.
        if own_time {
            dimension_scales::text(&dataset, "coordinates", "time")?;
        }
    }
    layout.close()
}
