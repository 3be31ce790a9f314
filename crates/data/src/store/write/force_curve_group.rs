//! Group `force_curves`.

use super::{Layout, dimension_scales};
use crate::kernel::Law;
use crate::store::ForceCurve;
use hdf5::File;

/// Writes the static curves.
pub(super) fn write(file: &File, curves: &[ForceCurve]) -> hdf5::Result<()> {
    let mut layout = Layout::group(file, "force_curves")?;
    let length = curves.iter().map(|curve| curve.force.len()).max().unwrap_or(0).max(1);
    let curve = layout.dimension("curve", curves.len())?;
    let point = layout.dimension("point", length)?;
    let numbers: Vec<i64> =
        curves.iter().map(|curve| i64::try_from(curve.instance).unwrap_or(i64::MAX)).collect();
    let dataset = layout.variable("instance", &[curve], &numbers)?;
    dimension_scales::text(&dataset, "long_name", "instance number, counted from 0")?;
    for (name, long_name, known, words) in [
        (
            "law",
            "contact law",
            Law::ALL.map(Law::name).as_slice(),
            curves.iter().map(|curve| curve.law.as_str()).collect::<Vec<_>>(),
        ),
        (
            "branch",
            "direction of travel",
            ["approach", "retract"].as_slice(),
            curves.iter().map(|curve| curve.branch.as_str()).collect(),
        ),
    ] {
        let (codes, meanings) = encode(known, &words)?;
        layout.flags(name, long_name, &[curve], &codes, &meanings)?;
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

/// A code for each word, and what each code means.
type CodedWords = (Vec<u8>, Vec<(u8, String)>);

/// Codes for words: known words keep their place whatever else occurs.
fn encode(known: &[&str], words: &[&str]) -> hdf5::Result<CodedWords> {
    let mut meanings: Vec<(u8, String)> = Vec::new();
    let mut codes = Vec::with_capacity(words.len());
    for (number, word) in known.iter().enumerate() {
        meanings.push((number as u8, (*word).to_owned()));
    }
    for word in words {
        let code = match meanings.iter().find(|(_, meaning)| meaning == word) {
            Some((code, _)) => *code,
            None => {
                let code = u8::try_from(meanings.len()).map_err(|_| "more than 256 different laws")?;
                meanings.push((code, (*word).to_owned()));
                code
            }
        };
        codes.push(code);
    }
    Ok((codes, meanings))
}
