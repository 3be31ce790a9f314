//! Group `force_curves`.

use super::super::StoreError;
use super::group_layout::{ArrayValues, GroupLayout};
use crate::kernel::Law;
use crate::store::ForceCurve;

/// The static curves.
pub(super) fn of_curves(curves: &[ForceCurve]) -> Result<GroupLayout<'_>, StoreError> {
    let mut layout = GroupLayout::new("force_curves");
    let length = curves.iter().map(|curve| curve.force.len()).max().unwrap_or(0).max(1);
    let curve = layout.dimension("curve", curves.len());
    let point = layout.dimension("point", length);
    layout.instances(&[curve], &curves.iter().map(|curve| curve.instance).collect::<Vec<_>>());
    let (laws, ways) = (Law::ALL.map(Law::name), ["approach", "retract"]);
    type Word = fn(&ForceCurve) -> &str;
    let words: [(&str, &str, &[&str], Word); 2] =
        [("law", "contact law", &laws, |c| &c.law), ("branch", "direction of travel", &ways, |c| &c.branch)];
    for (name, long_name, known, word) in words {
        let (meanings, codes) = encode(known, curves.iter().map(word))?;
        let values = (0..meanings.len() as u8).collect();
        let told = (name, long_name, meanings.join(" "));
        layout.codes(told, &[curve], ("flag_values", values), ArrayValues::U8(codes.into()));
    }
    let counts: Vec<u32> = curves.iter().map(|curve| curve.force.len() as u32).collect();
    let place = layout.variable("points", &[curve], ArrayValues::U32(counts.into()));
    layout.label(place, "long_name", "points of the curve; NaN beyond");
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
        layout.quantity(name, (units, long_name), &[curve, point], ArrayValues::F64(data.into()));
    }
    Ok(layout)
}

/// Codes for words, and what they mean: known words keep their place whatever else occurs.
fn encode<'a>(
    known: &[&'a str],
    words: impl Iterator<Item = &'a str>,
) -> Result<(Vec<&'a str>, Vec<u8>), StoreError> {
    let (mut meanings, mut codes) = (known.to_vec(), Vec::new());
    for word in words {
        let place = meanings.iter().position(|meaning| *meaning == word);
        let code = u8::try_from(place.unwrap_or(meanings.len()));
        codes.push(code.map_err(|_| StoreError::inconsistent("more than 256 different laws"))?);
        if place.is_none() {
            meanings.push(word);
        }
    }
    Ok((meanings, codes))
}
