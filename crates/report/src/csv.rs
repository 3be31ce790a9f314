//! The numbers of a picture, in SI units, for spreadsheets and other plotters.

use super::frame::EXCLUDED;
use super::picture::places;
use crate::observe::Status;
use crate::store::{Coordinate, ForceCurve, NO_STATE, Results, Variable, Waveforms};

/// Rows at most: whoever wants more reads the results file.
const MOST_ROWS: usize = 100_000;

/// A name with its unit, as a column's head.
pub(super) fn head(name: &str, units: &str) -> String {
    defused(if matches!(units, "" | "1") { name.to_owned() } else { format!("{name} [{units}]") })
}

/// Rows of cells below each other, the head first.
pub(super) fn table(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = ::csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    // Writing to memory cannot fail.
    rows.into_iter().for_each(|row| drop(writer.write_record(row)));
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// A number that reads back as it is; nothing for one that is not there.
pub(super) fn number(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:e}") }
}

/// What stands at a place of an axis.
pub(super) fn place(axis: &Coordinate, at: usize) -> String {
    axis.words.get(at).map_or_else(|| number(axis.values[at]), |word| defused(word.clone()))
}

/// A text that no spreadsheet takes for a formula: what begins as one gets an apostrophe before it. Numbers stay numbers.
///
/// ```
/// use afmsweep_report::defused;
/// assert_eq!(defused("=1+1".into()), "'=1+1");
/// assert_eq!(defused("-2.5".into()), "-2.5");
/// assert_eq!(defused("PMMA".into()), "PMMA");
/// ```
pub fn defused(text: String) -> String {
    let runs = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.trim().parse::<f64>().is_err();
    if runs { format!("'{text}") } else { text }
}

/// What a status code means, in a word; nothing where there is no such state.
fn word(code: u8) -> String {
    match Status::from_code(code) {
        Some(status) => status.meaning().to_owned(),
        None if code == NO_STATE => String::new(),
        None if code == EXCLUDED => "outside_limits".to_owned(),
        None => code.to_string(),
    }
}

/// A row for each instance: its number, what varies, the variable, its status; then the second state's, if there are any.
pub(super) fn of_variable(results: &Results, variable: &Variable) -> Option<String> {
    let count = results.status.len();
    if count > MOST_ROWS {
        return None;
    }
    let second = results
        .other_branch
        .as_ref()
        .and_then(|branch| Some((branch, branch.variables.iter().find(|one| one.name == variable.name)?)));
    let width = variable.harmonics.unwrap_or(1);
    let names = |prefix: &str| -> Vec<String> {
        let name = format!("{prefix}{}", variable.name);
        match variable.harmonics {
            None => vec![head(&name, &variable.units)],
            Some(count) => (1..=count).map(|n| head(&format!("{name}_{n}"), &variable.units)).collect(),
        }
    };
    let mut heads = vec!["instance".to_owned()];
    heads.extend(results.axes.iter().map(|axis| head(&axis.name, &axis.units)));
    heads.extend(names(""));
    heads.push("status".to_owned());
    if second.is_some() {
        heads.extend(names("second_"));
        heads.push("second_status".to_owned());
    }
    let row = |i: usize| {
        let mut row = vec![i.to_string()];
        row.extend(places(results, i).into_iter().map(|(axis, at)| place(axis, at)));
        row.extend(variable.data[i * width..][..width].iter().map(|value| number(*value)));
        row.push(word(results.status[i]));
        if let Some((branch, second)) = second {
            row.extend(second.data[i * width..][..width].iter().map(|value| number(*value)));
            row.push(word(branch.status[i]));
        }
        row
    };
    Some(table(std::iter::once(heads).chain((0..count).map(row))))
}

/// One instance over time.
pub(super) fn of_waveform(waveforms: &Waveforms, row: usize) -> String {
    let nothing = Vec::new();
    let time = waveforms.time.get(row).or(waveforms.time.first()).unwrap_or(&nothing);
    let columns = [&waveforms.tip_travel, &waveforms.actuator_top, &waveforms.indentation, &waveforms.force];
    let heads = ["time [s]", "tip_travel [m]", "actuator_top [m]", "indentation [m]", "force [N]"];
    let rows = time.iter().enumerate().map(|(i, time)| {
        let value = |column: &&Vec<Vec<f64>>| column.get(row).and_then(|row| row.get(i)).copied();
        let values = columns.iter().map(|column| number(value(column).unwrap_or(f64::NAN)));
        std::iter::once(format!("{time:e}")).chain(values).collect()
    });
    table(std::iter::once(heads.map(str::to_owned).to_vec()).chain(rows))
}

/// All curves of one instance, below each other.
pub(super) fn of_force_curves(curves: &[&ForceCurve]) -> String {
    let heads = ["law", "branch", "indentation [m]", "force [N]", "contact_radius [m]"];
    let row = |curve: &ForceCurve, n: usize| {
        let names = [&curve.law, &curve.branch].map(|name| defused(name.clone()));
        let values = [curve.indentation[n], curve.force[n], curve.contact_radius[n]].map(number);
        names.into_iter().chain(values).collect()
    };
    let length =
        |curve: &ForceCurve| curve.indentation.len().min(curve.force.len()).min(curve.contact_radius.len());
    let rows = curves.iter().flat_map(|curve| (0..length(curve)).map(|n| row(curve, n)));
    table(std::iter::once(heads.map(str::to_owned).to_vec()).chain(rows))
}
