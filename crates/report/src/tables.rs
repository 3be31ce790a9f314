//! The tables of a page.

use super::document::DocumentTable;
use super::frame::{NOTHING, State, status_word};
use super::labels::{ends, is_long, label, names, short};
use super::picture::{case, states};
use super::quantity_text::{DisplayUnit, number};
use crate::observe::Status;
use crate::store::{Attribute, NO_STATE, Results};

/// Instances that are told one by one at most.
const MOST_FAILED: usize = 20;

/// What came out, for a reader of the results.
pub(super) fn results(results: &Results) -> Vec<DocumentTable> {
    let all = [failed(results), harmonics(results), observables(results), axes(results), status(results)];
    some(all.into_iter().chain([flags(results)]))
}

/// How it was computed.
pub(super) fn computed(results: &Results) -> Vec<DocumentTable> {
    some([run(results), plan(results)].into_iter())
}

/// Those that have more than a head.
fn some(tables: impl Iterator<Item = DocumentTable>) -> Vec<DocumentTable> {
    tables.filter(|table| table.rows.len() > 1).collect()
}

/// Instances that are not ok, with what varies, and why.
fn failed(results: &Results) -> DocumentTable {
    let ok = Status::Ok as u8;
    let bad: Vec<usize> =
        (0..results.status.len()).filter(|i| ![ok, NO_STATE].contains(&results.status[*i])).collect();
    let names = results.axes.iter().map(short);
    let mut rows: Vec<Vec<String>> = vec![
        ["instance".to_owned()].into_iter().chain(names).chain(["status".into(), "why".into()]).collect(),
    ];
    for &i in bad.iter().take(MOST_FAILED) {
        let status = Status::from_code(results.status[i]);
        let word = status_word(results.status[i]);
        let why = status.map_or("", Status::reason);
        let mut row = vec![i.to_string()];
        row.extend(case(results, i));
        row.extend([word, why.to_owned()]);
        rows.push(row);
    }
    let caption = match bad.len() {
        count if count > MOST_FAILED => {
            format!("Instances that are not ok: the first {MOST_FAILED} of {count}")
        }
        _ => "Instances that are not ok".to_owned(),
    };
    DocumentTable { caption, rows }
}

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// Short root attributes: program, device, times.
fn run(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["run", ""])];
    rows.push(row(["instances", &results.status.len().to_string()]));
    let steps = results.steps_per_period.iter();
    if let (Some(least), Some(most)) = (steps.clone().min(), steps.max()) {
        let text = if least == most { least.to_string() } else { format!("{least} to {most}") };
        rows.push(row(["time steps per period", &text]));
    }
    for (name, value) in &results.attributes {
        let text = match value {
            Attribute::Text(text) if !is_long(text) => text.clone(),
            Attribute::Text(_) => continue,
            Attribute::Number(value) => number(*value, 6),
        };
        rows.push(vec![name.replace('_', " "), text]);
    }
    DocumentTable { caption: "Run".into(), rows }
}

fn axes(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["swept", "name", "values", "smallest or first", "largest or last"])];
    for axis in &results.axes {
        let (low, high) = ends(axis.values.iter().copied().filter(|value| value.is_finite()));
        let unit = DisplayUnit::fitting(&axis.units, low.abs().max(high.abs()));
        // What has words counts them from 0: the numbers tell nothing.
        let (from, to) = match (axis.words.first(), axis.words.last()) {
            (Some(first), Some(last)) => (first.clone(), last.clone()),
            _ => (unit.value(low), unit.value(high)),
        };
        rows.push(vec![label(axis).to_owned(), axis.name.clone(), axis.values.len().to_string(), from, to]);
    }
    let caption = if results.list { "Sweep (a list of samples)" } else { "Sweep (a grid)" };
    DocumentTable { caption: caption.into(), rows }
}

fn status(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["status", "instances", "share"])];
    let mut counts = [0usize; 256];
    for code in &results.status {
        counts[usize::from(*code)] += 1;
    }
    for (code, count) in (0u8..=u8::MAX).zip(counts).filter(|(_, count)| *count > 0) {
        let meaning = status_word(code);
        let share = 100.0 * count as f64 / results.status.len() as f64;
        rows.push(vec![meaning, count.to_string(), format!("{} %", number(share, 3))]);
    }
    DocumentTable { caption: "What became of the instances".into(), rows }
}

/// What helps where a contact law is used outside its assumptions; nothing for other words.
fn cure(word: &str) -> &'static str {
    match word {
        "law_does_not_fit" => "set contact.law to the law that fits Tabor's parameter, or to \"auto\"",
        "between_laws" => {
            "adhesion off by up to a third: run the other law as well to see what depends on it"
        }
        "adhesion_left_out" => {
            "set contact.law to \"dmt\" if the sample is viscous or a layer, else to \"auto\", or sample.surface_energy to zero"
        }
        "large_strain" => "beyond small strain: expect an error in the force of 1 % or more",
        "beyond_series" => {
            "deeper than the force on the layer, or of the tip's shape, is known: do not trust it"
        }
        "adhesive_layer" => "the attraction is that of a thick sample",
        "beyond_table" => "the tip is deeper than its table of forces",
        "rigid_tip" => "give the tip its youngs_modulus and poisson_ratio",
        _ => "",
    }
}

/// Contact laws used, warnings with what helps, and whatever else is told in words.
fn flags(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["contact", "", "instances", "what helps"])];
    for flags in &results.flags {
        for (number, word) in flags.meanings.iter().enumerate() {
            let is_set = |data: u8| match flags.bits {
                true => u32::from(data) >> number & 1 == 1,
                false => usize::from(data) == number,
            };
            let count = flags.data.iter().filter(|data| is_set(**data)).count();
            if count > 0 {
                let said = word.replace('_', " ");
                rows.push(vec![flags.long_name.clone(), said, count.to_string(), cure(word).to_owned()]);
            }
        }
    }
    DocumentTable { caption: "Contact laws and warnings".into(), rows }
}

/// The values of a single case.
fn single(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["observable", "name", "value"])];
    for variable in results.variables.iter().filter(|one| one.harmonics.is_none()) {
        let value = match states(results, variable).first() {
            Some((_, State::Zero)) => NOTHING.to_owned(),
            Some((value, state)) if state.has_value() => {
                DisplayUnit::fitting(&variable.units, value.abs()).value(*value)
            }
            _ => "–".to_owned(),
        };
        rows.push(vec![names(variable).0.to_owned(), variable.name.clone(), value]);
    }
    DocumentTable { caption: "Observables".into(), rows }
}

fn observables(results: &Results) -> DocumentTable {
    if results.status.len() == 1 {
        return single(results);
    }
    let mut rows = vec![row(["observable", "name", "smallest", "median", "largest", "values", "without"])];
    for variable in &results.variables {
        let states = states(results, variable);
        // What is nothing within its error counts as that.
        let mut values: Vec<f64> = states.iter().filter_map(|(value, state)| state.counted(*value)).collect();
        let nothing = states.iter().any(|(_, state)| *state == State::Zero);
        values.sort_by(f64::total_cmp);
        let middle = match values.as_slice() {
            [] => f64::NAN,
            values if values.len() % 2 == 1 => values[values.len() / 2],
            values => (values[values.len() / 2 - 1] + values[values.len() / 2]) / 2.0,
        };
        let (low, high) =
            (values.first().copied().unwrap_or(f64::NAN), values.last().copied().unwrap_or(f64::NAN));
        // Each in the unit that fits it; zero, which none fits, in that of the largest.
        let largest = low.abs().max(high.abs());
        let show = |value: f64| match value {
            value if value.is_nan() => "–".to_owned(),
            0.0 if nothing => NOTHING.to_owned(),
            0.0 => DisplayUnit::fitting(&variable.units, largest).value(0.0),
            value => DisplayUnit::fitting(&variable.units, value.abs()).value(value),
        };
        rows.push(vec![
            names(variable).0.to_owned(),
            variable.name.clone(),
            show(low),
            show(middle),
            show(high),
            values.len().to_string(),
            (variable.data.len() - values.len()).to_string(),
        ]);
    }
    DocumentTable { caption: "Observables, over the instances that have a value".into(), rows }
}

/// Each harmonic of a single case.
fn harmonics(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["harmonic", "value"])];
    let variables = results.variables.iter().filter(|_| results.status.len() == 1);
    for variable in variables.filter(|variable| variable.harmonics.is_some()) {
        let largest = variable.data.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let unit = DisplayUnit::fitting(&variable.units, largest);
        for (order, value) in variable.data.iter().enumerate() {
            rows.push(vec![(order + 1).to_string(), unit.value(*value)]);
        }
    }
    DocumentTable { caption: "Harmonics".into(), rows }
}

/// The plan's own entries, one level deep.
fn plan(results: &Results) -> DocumentTable {
    let mut rows = vec![row(["plan", ""])];
    let json = results.text("plan").and_then(|text| serde_json::from_str::<serde_json::Value>(text).ok());
    if let Some(serde_json::Value::Object(entries)) = json {
        for (name, value) in entries {
            let text = match value {
                serde_json::Value::Null => continue,
                serde_json::Value::String(text) => text,
                serde_json::Value::Number(value) => {
                    value.as_f64().map_or(value.to_string(), |v| number(v, 6))
                }
                other => other.to_string(),
            };
            if text.len() <= 200 {
                rows.push(vec![name.replace('_', " "), text]);
            }
        }
    }
    DocumentTable { caption: "Plan".into(), rows }
}
