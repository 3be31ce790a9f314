//! Group `spectra`.

use super::Layout;
use crate::store::Spectra;
use hdf5::File;

/// Fills the group and closes it.
pub(super) fn write(file: &File, spectra: &Spectra) -> hdf5::Result<()> {
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
