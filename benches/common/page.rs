//! A bench's tables as a page that is kept.

use afmsweep::engine::processor;
use afmsweep::report::Document;
use serde_json::{Value, json};
use std::path::Path;

/// One table: heading, what it says, and its rows with the columns that the page shows, by key and title.
pub struct Part<'a> {
    pub heading: &'a str,
    pub text: &'a str,
    pub columns: &'a [(&'a str, &'a str)],
    pub rows: Vec<Value>,
}

/// Writes README.md and numbers.json into `folder`.
pub fn write(folder: &str, title: &str, command: &str, parts: &[Part]) {
    let date = afmsweep::store::now();
    let mut page = Document { title: title.to_owned(), ..Document::default() };
    page.paragraph("", format!("Made by the command \"{command}\" on {}, {date}.", processor()));
    let mut numbers = json!({ "command": command, "processor": processor(), "date": date });
    for part in parts.iter().filter(|part| !part.rows.is_empty()) {
        page.heading(part.heading);
        page.paragraph("", part.text);
        let head = part.columns.iter().map(|(_, title)| (*title).to_owned()).collect();
        let row = |row: &Value| part.columns.iter().map(|(key, _)| written(&row[*key])).collect();
        let rows = std::iter::once(head).chain(part.rows.iter().map(row)).collect();
        page.table("", rows);
        numbers[part.heading] = json!(part.rows);
    }
    let folder = Path::new(folder);
    let text = serde_json::to_string_pretty(&numbers).expect("plain data") + "\n";
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(folder.join("README.md"), page.markdown()))
        .and_then(|()| std::fs::write(folder.join("numbers.json"), text))
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
}

/// A number as a reader wants it: whole ones whole, others with two or three digits.
fn written(value: &Value) -> String {
    match value {
        Value::Null => "-".into(),
        Value::String(text) => text.clone(),
        Value::Number(number) => match number.as_f64() {
            Some(0.0) => "0".into(),
            Some(number) if number.fract() == 0.0 && number.abs() < 1e7 => format!("{number:.0}"),
            Some(number) if (10.0..100.0).contains(&number.abs()) => format!("{number:.1}"),
            Some(number) if (100.0..1e7).contains(&number.abs()) => format!("{number:.0}"),
            Some(number) if (0.1..10.0).contains(&number.abs()) => format!("{number:.2}"),
            Some(number) => format!("{number:.1e}"),
            None => number.to_string(),
        },
        other => other.to_string(),
    }
}
