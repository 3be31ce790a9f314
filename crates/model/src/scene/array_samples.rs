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
                .label(format!("found {}", address.shown(values[row])))
                .expected(domain.described())
                .help(domain.advice(values[row])));
        }
        let of = |fold: fn(f64, f64) -> f64, start: f64| values.iter().copied().fold(start, fold);
        for value in [of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY)] {
            values::in_domain(value, place.clone(), || address.shown(value), address, &path)?;
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

#[cfg(test)]
mod tests {
    use crate::scene::{Layout, SampleArrays, Scene};
    use std::path::Path;

    const TEXT: &str = "\u{FEFF}[contact]\nlaw = \"hertz\"";

    fn radii(values: &[f64]) -> SampleArrays {
        vec![("instrument.tip.radius".into(), values.to_vec()), ("approach.gap".into(), vec![1e-8, 2e-8])]
    }

    fn read(text: &str, arrays: SampleArrays) -> Result<Scene, String> {
        let read = Scene::parse_with_samples(Path::new("arrays.toml"), text, arrays);
        read.map_err(|error| format!("{:?} {}", error.line_column(), error.title()))
    }

    /// Arrays are what the same numbers as text are, alone and beside a grid.
    #[test]
    fn arrays_are_lists_of_samples() {
        let list = "\n[samples]\n\"instrument.tip.radius\" = [\"8 nm\", \"9 nm\"]\n\"approach.gap\" = [\"10 nm\", \"20 nm\"]";
        for beside in ["", "\n[sweep]\n\"sample.youngs_modulus\" = { values = [\"1 GPa\", \"2 GPa\"] }"] {
            let text = format!("{TEXT}{beside}");
            let given = read(&text, radii(&[8e-9, 9e-9])).expect("it is a scene");
            let listed = Scene::parse(Path::new("list.toml"), &(text + list)).expect("it is a scene");
            assert_eq!(given.sweep, listed.sweep);
            assert_eq!(given.sweep.layout == Layout::List, beside.is_empty());
            let resolved = given.resolved_toml();
            assert!(resolved.contains("arrays of the caller") && !resolved.contains("9 nm"), "{resolved}");
        }
    }

    /// The place of a mistake is the line that tells of the arrays, also after a byte order mark.
    #[test]
    fn mistakes_are_told_at_the_line_of_the_arrays() {
        for (text, arrays, why) in [
            (TEXT, radii(&[8e-9, -1.0]), "row 1 of `instrument.tip.radius` has an impossible value"),
            (TEXT, radii(&[8e-9]), "the arrays of the samples differ in length"),
            (TEXT, vec![("tip.radius".into(), vec![1.0])], "`tip.radius` is not a quantity of a scene"),
            (TEXT, vec![], "samples have no or too many rows"),
        ] {
            assert_eq!(read(text, arrays).err(), Some(format!("Some((4, 1)) {why}")));
        }
        let both = format!("{TEXT}\n[samples]\n\"approach.gap\" = [\"1 nm\"]");
        let told = read(&both, radii(&[8e-9, 9e-9])).expect_err("two ways");
        assert_eq!(told, "Some((6, 1)) the samples are given in two ways");
    }
}
