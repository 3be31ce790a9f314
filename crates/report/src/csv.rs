//! The numbers of a picture, in SI units, for spreadsheets and other plotters.

use super::frame::EXCLUDED;
use super::picture::places;
use crate::observe::Status;
use crate::store::{ForceCurve, NO_STATE, Results, Variable, Waveforms};
use std::fmt::Write;

/// Rows at most: whoever wants more reads the results file.
const MOST_ROWS: usize = 100_000;

/// A name with its unit, as a column's head.
pub(super) fn head(name: &str, units: &str) -> String {
    let text = defused(if matches!(units, "" | "1") { name.to_owned() } else { format!("{name} [{units}]") });
    // A comma or a quote would end the cell.
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
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
    let mut text = heads.join(",") + "\n";
    for i in 0..count {
        // Writing to a String cannot fail.
        let _ = write!(text, "{i}");
        for (axis, at) in places(results, i) {
            match axis.words.get(at) {
                Some(word) => text = text + "," + &head(word, ""),
                None => cell(&mut text, axis.values[at]),
            }
        }
        variable.data[i * width..][..width].iter().for_each(|value| cell(&mut text, *value));
        let _ = write!(text, ",{}", word(results.status[i]));
        if let Some((branch, second)) = second {
            second.data[i * width..][..width].iter().for_each(|value| cell(&mut text, *value));
            let _ = write!(text, ",{}", word(branch.status[i]));
        }
        text.push('\n');
    }
    Some(text)
}

/// A number that reads back as it is; nothing for one that is not there.
pub(super) fn cell(text: &mut String, value: f64) {
    text.push(',');
    if !value.is_nan() {
        let _ = write!(text, "{value:e}");
    }
}

/// One instance over time.
pub(super) fn of_waveform(waveforms: &Waveforms, row: usize) -> String {
    let nothing = Vec::new();
    let time = waveforms.time.get(row).or(waveforms.time.first()).unwrap_or(&nothing);
    let columns = [&waveforms.tip_travel, &waveforms.actuator_top, &waveforms.indentation, &waveforms.force];
    let mut text = "time [s],tip_travel [m],actuator_top [m],indentation [m],force [N]\n".to_owned();
    for (i, time) in time.iter().enumerate() {
        let _ = write!(text, "{time:e}");
        let value =
            |column: &[Vec<f64>]| column.get(row).and_then(|row| row.get(i)).copied().unwrap_or(f64::NAN);
        columns.iter().for_each(|column| cell(&mut text, value(column)));
        text.push('\n');
    }
    text
}

/// All curves of one instance, below each other.
pub(super) fn of_force_curves(curves: &[&ForceCurve]) -> String {
    let mut text = "law,branch,indentation [m],force [N],contact_radius [m]\n".to_owned();
    for curve in curves {
        for ((depth, force), radius) in curve.indentation.iter().zip(&curve.force).zip(&curve.contact_radius)
        {
            let _ = write!(text, "{},{}", head(&curve.law, ""), head(&curve.branch, ""));
            [depth, force, radius].into_iter().for_each(|value| cell(&mut text, *value));
            text.push('\n');
        }
    }
    text
}
