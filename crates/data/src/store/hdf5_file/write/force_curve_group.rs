//! Group `force_curves`.

use super::{Layout, dimension_scales};
use crate::kernel::Law;
use crate::store::{Flags, ForceCurve};
use hdf5::File;

/// Writes the static curves.
pub(super) fn write(file: &File, curves: &[ForceCurve]) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "force_curves")?;
    let length = curves.iter().map(|curve| curve.force.len()).max().unwrap_or(0).max(1);
    let curve = layout.dimension("curve", curves.len())?;
    let point = layout.dimension("point", length)?;
    layout.instances(&[curve], &curves.iter().map(|curve| curve.instance).collect::<Vec<_>>())?;
    let laws = encode(&Law::ALL.map(Law::name), curves.iter().map(|curve| &curve.law))?;
    let branches = encode(&["approach", "retract"], curves.iter().map(|curve| &curve.branch))?;
    for (name, long_name, flags) in
        [("law", "contact law", laws), ("branch", "direction of travel", branches)]
    {
        let flags = Flags { name: name.into(), long_name: long_name.into(), ..flags };
        layout.words(&flags, &[curve], &flags.data)?;
    }
    let counts: Vec<u32> = curves.iter().map(|curve| curve.force.len() as u32).collect();
    let dataset = layout.variable("points", &[curve], &counts)?;
    dimension_scales::text(&dataset, "long_name", "points of the curve; NaN beyond")?;
    type Column = fn(&ForceCurve) -> &[f64];
    let columns: [(&str, &str, &str, Column); 3] = [
        ("indentation", "m", "indentation, negative for a gap", |c| &c.indentation),
        ("force", "N", "force on the tip, positive away from the sample", |c| &c.force),
        ("contact_radius", "m", "radius of the contact", |c| &c.contact_radius),
    ];
    for (name, units, long_name, column) in columns {
        let mut data = vec![f64::NAN; curves.len() * length];
        for (row, curve) in data.chunks_mut(length).zip(curves) {
            for (slot, value) in row.iter_mut().zip(column(curve)) {
                *slot = *value;
            }
        }
        layout.quantity(name, units, long_name, &[curve, point], &data)?;
    }
    layout.close()
}

/// Codes for words, and what they mean: known words keep their place whatever else occurs.
fn encode<'a>(known: &[&str], words: impl Iterator<Item = &'a String>) -> hdf5::Result<Flags> {
    let mut flags =
        Flags { meanings: known.iter().map(|word| (*word).to_owned()).collect(), ..Flags::default() };
    for word in words {
        let place = flags.meanings.iter().position(|meaning| meaning == word);
        let code = place.unwrap_or(flags.meanings.len());
        flags.data.push(u8::try_from(code).map_err(|_| "more than 256 different laws")?);
        if place.is_none() {
            flags.meanings.push(word.clone());
        }
    }
    Ok(flags)
}
