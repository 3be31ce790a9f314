//! Samples that a caller hands over as arrays, in place of `[samples]`.

use super::address::Address;
use super::axes::MOST_INSTANCES;
use super::draft::{Draft, GivenSamples, SampleArrays};
use super::quantities::QUANTITIES;
use super::scene_error::{Checked, Fault};
use super::{Layout, SweptAxes, axis_zip, table_file, values};
use crate::suggestion::nearest;
use crate::units::shortened;
use std::ops::Range;

/// The scene's text with a line that tells of the arrays, which messages point at.
pub(super) fn told(text: &str, arrays: SampleArrays) -> (String, GivenSamples) {
    let paths: Vec<String> = arrays.iter().map(|(path, _)| shortened(path)).collect();
    let rows = arrays.first().map_or(0, |(_, values)| values.len());
    let line = format!("# samples, {rows} rows of arrays: {}", paths.join(", "));
    let text = format!("{}\n\n{line}\n", text.trim_end());
    let end = text.len() - 1;
    // Places are counted after a byte order mark.
    let mark = text.len() - text.strip_prefix('\u{FEFF}').map_or(text.len(), str::len);
    (text, GivenSamples { arrays, place: end - line.len() - mark..end - mark })
}

/// The arrays as a list of samples.
pub(super) fn read(given: GivenSamples, draft: &mut Draft) -> Checked<SweptAxes> {
    let GivenSamples { arrays, place } = given;
    let rows = arrays.first().map_or(0, |(_, values)| values.len());
    let fault = |title: String| Fault::at(place.clone(), title);
    if rows == 0 || rows > MOST_INSTANCES {
        return Err(fault("samples have no or too many rows".into())
            .label(format!("{rows} rows"))
            .expected(format!("arrays of 1 to {MOST_INSTANCES} values, by the paths of their quantities"))
            .help("leave the samples out to run the one case, or split them into several runs"));
    }
    let mut columns = Vec::new();
    for (path, values) in arrays {
        let Some(address) = Address::find(&path) else {
            let meant = nearest(&path, QUANTITIES.iter().map(|quantity| quantity.path));
            return Err(fault(format!("`{}` is not a quantity of a scene", shortened(&path)))
                .label("unknown path")
                .expected("the path of a quantity, such as `instrument.tip.radius`")
                .maybe_help(meant.map(|meant| format!("did you mean `{}`?", meant.replace('#', "0")))));
        };
        if values.len() != rows {
            return Err(fault("the arrays of the samples differ in length".into())
                .label(format!("{} values of `{path}`", values.len()))
                .expected(format!("{rows} values, as in the first array"))
                .help("each instance takes one value of every array"));
        }
        let domain = address.quantity.domain;
        if let Some(row) = values.iter().position(|value| !domain.holds(*value)) {
            return Err(fault(format!("row {row} of `{path}` has an impossible value"))
                .label(format!("found {} in SI units", values[row]))
                .expected(domain.described())
                .help(domain.advice(values[row])));
        }
        let of = |fold: fn(f64, f64) -> f64, start: f64| values.iter().copied().fold(start, fold);
        for value in [of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY)] {
            values::in_domain(value, place.clone(), || address.written(value), address, &path)?;
        }
        columns.push((address, values));
    }
    let axes = table_file::axes(columns, place.clone(), draft)?;
    draft.drawn.arrays = true;
    let sweep = SweptAxes { axes, layout: Layout::List, ..SweptAxes::default() };
    axis_zip::check(&sweep, place, draft)?;
    Ok(sweep)
}

/// Refuses samples of two kinds.
pub(super) fn beside(given: &GivenSamples, section: &str, other: Range<usize>) -> Box<Fault> {
    Fault::at(given.place.clone(), "the samples are given in two ways")
        .label("arrays here")
        .related(other, format!("[{section}] here"))
        .expected("arrays, or a section of the scene")
        .help("remove one of the two")
}
