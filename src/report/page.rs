//! The page around the pictures: HTML to look at, Markdown to paste.

use super::MARKER;
use super::document::{self, Table, code, escape, plain};
use super::frame::{NOTHING, State};
use super::pictures::{Drawn, capital, states};
use super::quantity::{Unit, number};
use crate::observe::Status;
use crate::store::{Attribute, Results};
use std::fmt::Write;
use std::path::Path;

/// Pictures larger than this stay outside the page, in bytes.
const MOST_INLINE: usize = 3_000_000;

/// The title of the page.
fn heading(results: &Results, file: &Path) -> String {
    match results.title.trim() {
        "" => file.file_name().map_or_else(|| "Results".into(), |name| name.to_string_lossy().into_owned()),
        title => title.to_owned(),
    }
}

fn tables(results: &Results) -> Vec<Table> {
    [run(results), axes(results), status(results), flags(results), observables(results)]
        .into_iter()
        .chain([plan(results), harmonics(results)])
        .filter(|table| table.rows.len() > 1)
        .collect()
}

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// Short root attributes: program, device, times.
fn run(results: &Results) -> Table {
    let mut rows = vec![row(["run", ""])];
    rows.push(row(["instances", &results.status.len().to_string()]));
    let steps = results.steps_per_period.iter();
    if let (Some(least), Some(most)) = (steps.clone().min(), steps.max()) {
        let text = if least == most { least.to_string() } else { format!("{least} to {most}") };
        rows.push(row(["time steps per period", &text]));
    }
    for (name, value) in &results.attributes {
        let text = match value {
            Attribute::Text(text) if !is_long(name, text) => text.clone(),
            Attribute::Text(_) => continue,
            Attribute::Number(value) => number(*value, 6),
        };
        rows.push(vec![name.replace('_', " "), text]);
    }
    Table { caption: "Run".into(), rows }
}

/// Texts shown in full below the tables.
fn is_long(name: &str, text: &str) -> bool {
    text.len() > 200 || text.trim().contains('\n') || ["scene", "scene_resolved", "plan"].contains(&name)
}

fn axes(results: &Results) -> Table {
    let mut rows = vec![row(["swept", "name", "values", "from", "to"])];
    for axis in &results.axes {
        let finite = axis.values.iter().copied().filter(|value| value.is_finite());
        let (low, high) =
            (finite.clone().fold(f64::INFINITY, f64::min), finite.fold(f64::NEG_INFINITY, f64::max));
        let unit = Unit::fitting(&axis.units, low.abs().max(high.abs()));
        let label = if axis.long_name.is_empty() { &axis.name } else { &axis.long_name };
        rows.push(vec![
            label.clone(),
            axis.name.clone(),
            axis.values.len().to_string(),
            unit.value(low),
            unit.value(high),
        ]);
    }
    let caption = if results.list { "Sweep (a list of samples)" } else { "Sweep (a grid)" };
    Table { caption: caption.into(), rows }
}

fn status(results: &Results) -> Table {
    let mut rows = vec![row(["status", "instances", "share"])];
    let mut counts = [0usize; 256];
    for code in &results.status {
        counts[usize::from(*code)] += 1;
    }
    for (code, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let known = u8::try_from(code).ok().and_then(Status::from_code);
        let meaning =
            known.map_or_else(|| format!("code {code}"), |status| status.meaning().replace('_', " "));
        let share = 100.0 * *count as f64 / results.status.len() as f64;
        rows.push(vec![meaning, count.to_string(), format!("{} %", number(share, 3))]);
    }
    Table { caption: "What became of the instances".into(), rows }
}

/// Contact laws used, warnings, and whatever else is told in words.
fn flags(results: &Results) -> Table {
    let mut rows = vec![row(["contact", "", "instances"])];
    for flags in &results.flags {
        for (number, word) in flags.meanings.iter().enumerate() {
            let is_set = |data: u8| match flags.bits {
                true => u32::from(data) >> number & 1 == 1,
                false => usize::from(data) == number,
            };
            let count = flags.data.iter().filter(|data| is_set(**data)).count();
            if count > 0 {
                rows.push(vec![flags.long_name.clone(), word.replace('_', " "), count.to_string()]);
            }
        }
    }
    Table { caption: "Contact laws and warnings".into(), rows }
}

fn observables(results: &Results) -> Table {
    let mut rows = vec![row(["observable", "name", "smallest", "median", "largest", "values", "without"])];
    for variable in &results.variables {
        let states = states(results, variable);
        // What is nothing within its error counts as that.
        let value = |&(value, state): &(f64, State)| match state {
            State::Zero => Some(0.0),
            state => state.has_value().then_some(value),
        };
        let mut values: Vec<f64> = states.iter().filter_map(value).collect();
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
            0.0 => Unit::fitting(&variable.units, largest).value(0.0),
            value => Unit::fitting(&variable.units, value.abs()).value(value),
        };
        let label = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
        rows.push(vec![
            label.clone(),
            variable.name.clone(),
            show(low),
            show(middle),
            show(high),
            values.len().to_string(),
            (variable.data.len() - values.len()).to_string(),
        ]);
    }
    Table { caption: "Observables, over the instances that have a value".into(), rows }
}

/// Each harmonic of a single case.
fn harmonics(results: &Results) -> Table {
    let mut rows = vec![row(["harmonic", "value"])];
    let variables = results.variables.iter().filter(|_| results.status.len() == 1);
    for variable in variables.filter(|variable| variable.harmonics.is_some()) {
        let largest = variable.data.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let unit = Unit::fitting(&variable.units, largest);
        for (order, value) in variable.data.iter().enumerate() {
            rows.push(vec![(order + 1).to_string(), unit.value(*value)]);
        }
    }
    Table { caption: "Harmonics".into(), rows }
}

/// The plan's own entries, one level deep.
fn plan(results: &Results) -> Table {
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
    Table { caption: "Plan".into(), rows }
}

/// Long texts: name and content.
fn texts(results: &Results) -> Vec<(String, &str)> {
    let mut texts = Vec::new();
    for (name, value) in &results.attributes {
        if let Attribute::Text(text) = value
            && is_long(name, text)
        {
            let label = match name.as_str() {
                "scene" => "The scene as written".to_owned(),
                "scene_resolved" => "The scene with every value used".to_owned(),
                "plan" => "The plan in full (JSON)".to_owned(),
                other => capital(&other.replace('_', " ")),
            };
            texts.push((label, text.as_str()));
        }
    }
    texts
}

/// How many instances the pictures say less about.
fn remark(results: &Results) -> String {
    let bad = results.status.iter().filter(|code| **code != Status::Ok as u8).count();
    let ended = match (bad, results.status.len()) {
        (0, count) => format!("All {count} instances ended well."),
        (bad, count) => format!(
            "{bad} of {count} instances did not end well; pictures mark them, tables leave out those without a value."
        ),
    };
    // Words by bits are warnings.
    let warned = |i: &usize| results.flags.iter().any(|flags| flags.bits && flags.data.get(*i) != Some(&0));
    match (0..results.status.len()).filter(warned).count() {
        0 => ended,
        warned => format!(
            "{ended} {warned} of {} carry a warning: see the table of contact laws and warnings.",
            results.status.len()
        ),
    }
}

/// `index.html`.
pub(super) fn html(results: &Results, file: &Path, Drawn { pictures, left_out }: &Drawn) -> String {
    let mut page = document::open(&heading(results, file), MARKER);
    // Writing to a String cannot fail.
    let _ = writeln!(
        page,
        "<p>From <code>{}</code>. {}</p>",
        escape(&file.display().to_string()),
        escape(&remark(results)),
    );
    for table in tables(results) {
        let _ = writeln!(page, "<h2>{}</h2>", escape(&table.caption));
        page.push_str(&table.html());
    }
    for (name, text) in texts(results) {
        let (name, text) = (escape(&name), escape(text));
        let _ = writeln!(page, "<details><summary>{name}</summary><pre>{text}</pre></details>");
    }
    page.push_str("<h2>Pictures</h2>\n");
    if pictures.is_empty() {
        page.push_str(
            "<p>A single case has no pictures of its observables; the table above holds them.</p>\n",
        );
    }
    for line in left_out {
        let _ = writeln!(page, "<p class=\"caption\">Not drawn: {}</p>", escape(line));
    }
    for picture in pictures {
        let name = escape(&picture.title);
        page.push_str("<figure>\n");
        if picture.svg.len() <= MOST_INLINE {
            page.push_str(&picture.svg);
        } else {
            let _ = write!(page, "<img src=\"{}\" alt=\"{name}\"/>", escape(&picture.file));
        }
        let (note, file) = (escape(&picture.note), escape(&picture.file));
        let _ = writeln!(
            page,
            "<figcaption>{name}. {note} <a href=\"{file}\">{file}</a></figcaption>\n</figure>"
        );
    }
    page.push_str(document::CLOSE);
    page
}

/// `report.md`.
pub(super) fn markdown(results: &Results, file: &Path, Drawn { pictures, left_out }: &Drawn) -> String {
    let mut page = String::new();
    let _ = write!(page, "# {}\n\n", plain(&heading(results, file)));
    let _ = write!(page, "From {}. {}\n\n", code(&file.display().to_string()), remark(results));
    for table in tables(results) {
        let _ = write!(page, "## {}\n\n{}\n", table.caption, table.markdown());
    }
    for line in left_out {
        let _ = write!(page, "Not drawn: {}\n\n", plain(line));
    }
    for picture in pictures {
        let title = plain(&picture.title);
        let _ = write!(page, "## {title}\n\n![{title}]({})\n\n", picture.file);
        if !picture.note.is_empty() {
            let _ = write!(page, "{}\n\n", plain(&picture.note));
        }
    }
    for (name, text) in texts(results) {
        // Indented text needs no fence that the text itself might hold.
        let _ = write!(page, "## {}\n\n", plain(&name));
        for line in text.lines() {
            let _ = writeln!(page, "    {line}");
        }
        page.push('\n');
    }
    page
}
