//! Axes that are no single quantity: contact laws, and quantities that vary together.

use super::axes;
use super::axes::AXIS_KEYS;
use super::draft::{Draft, Said};
use super::params::LawChoice;
use super::paths::LAW;
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use super::{Axis, Layout, SweptAxes};
use crate::observe::Observable;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// The path of the axis of samples.
pub(super) const SAMPLES: &str = "samples";
/// What the places along an axis of quantities that vary together are called.
pub(super) const LABEL: &str = "label";

const LAW_FORM: &str = "{ values = [\"hertz\", \"dmt\", \"jkr\"] }";
const FORM: &str =
    "a table such as { label = [\"PS\", \"PMMA\"], \"sample.youngs_modulus\" = [\"2.0 GPa\", \"2.7 GPa\"] }";

/// The law of that word.
pub(super) fn law_of(word: &str) -> Option<LawChoice> {
    LawChoice::WORDS.iter().find(|(known, _)| *known == word).map(|(_, law)| *law)
}

/// Reads an entry of `[sweep]` that is such an axis; none if it is not.
pub(super) fn read(key: &Key, value: &Value, layout: Layout, draft: &mut Draft) -> Option<Checked<Axis>> {
    if layout == Layout::List {
        return None;
    }
    if key.get_ref() == LAW {
        return Some(laws(key, value, draft));
    }
    let table = value.get_ref().as_table()?;
    let name = key.get_ref().as_ref();
    let own = |key: &Key| key.get_ref() == LABEL || key.get_ref().contains('.');
    (!name.contains('.') && table.keys().any(own)).then(|| together(key, value, table, draft))
}

/// An axis of contact laws.
fn laws(key: &Key, value: &Value, draft: &mut Draft) -> Checked<Axis> {
    let table = values::table(value, LAW, LAW_FORM)?;
    if let Some(other) = table.keys().find(|key| key.get_ref() != "values") {
        return Err(values::unknown_key(other, "sweep.contact.law", &["values"]));
    }
    let list = table.get("values").ok_or_else(|| {
        Fault::at(value.span(), "the axis `contact.law` lacks `values`")
            .label("found nothing")
            .expected(LAW_FORM)
            .help("add `values`")
    })?;
    let words = law_words(list)?;
    once(&words, list, LAW)?;
    draft.said.push(Said { path: LAW.into(), key: key.span(), swept: true });
    Ok(law_axis(words))
}

fn law_words(list: &Value) -> Checked<Vec<String>> {
    let entries = values::list(list, LAW, "a list such as [\"hertz\", \"dmt\", \"jkr\"]")?;
    for entry in entries {
        values::keyword(entry, LAW, LawChoice::WORDS)?;
    }
    entries.iter().map(|entry| values::text(entry, LAW).map(str::to_owned)).collect()
}

/// 0, 1 and so on.
fn places(count: usize) -> Arc<Vec<f64>> {
    Arc::new((0..count).map(|n| n as f64).collect())
}

fn law_axis(words: Vec<String>) -> Axis {
    Axis {
        path: LAW.into(),
        name: "law".into(),
        long_name: "contact law".into(),
        values: places(words.len()),
        words,
        ..Axis::default()
    }
}

/// Refuses words that are there twice.
fn once(words: &[String], list: &Value, path: &str) -> Checked<()> {
    let mut seen = HashSet::new();
    match words.iter().find(|word| !seen.insert(word.as_str())) {
        None => Ok(()),
        Some(word) => Err(Fault::at(list.span(), format!("the axis `{path}` repeats a value"))
            .label(format!("\"{word}\" is there twice"))
            .expected("values that differ")
            .help("remove one of the two")),
    }
}

/// Quantities that vary together, with a label for each place.
fn together(key: &Key, value: &Value, table: &DeTable, draft: &mut Draft) -> Checked<Axis> {
    let name = key.get_ref().as_ref();
    let path = format!("sweep.{name}");
    named(key)?;
    let mut columns: Vec<Axis> = Vec::new();
    let mut length = None;
    for (key, list) in table.iter().filter(|(key, _)| key.get_ref() != LABEL) {
        let column = column(key, list, name)?;
        agree(&mut length, column.values.len(), list, &path)?;
        draft.vary(&column.path, key.span())?;
        columns.push(column);
    }
    let Some(count) = length else {
        return Err(Fault::at(value.span(), format!("`{path}` has labels and no quantity"))
            .label("nothing varies")
            .expected(FORM)
            .help("add the quantities by their paths, each with its list"));
    };
    let words = match table.get(LABEL) {
        None => (1..=count).map(|n| n.to_string()).collect(),
        Some(list) => {
            let words = labels(list, &path)?;
            agree(&mut length, words.len(), list, &path)?;
            words
        }
    };
    Ok(Axis {
        name: name.into(),
        long_name: name.replace('_', " "),
        values: places(count),
        path,
        words,
        columns,
        ..Axis::default()
    })
}

/// The fault of a quantity that an axis has before this place.
pub(super) fn varies_twice(path: &str, here: Range<usize>, draft: &Draft) -> Box<Fault> {
    let before = draft.said.iter().find(|said| said.swept && said.path == path);
    let fault = Fault::at(here, format!("`{path}` varies twice")).label("again here");
    let fault = match before {
        Some(said) => fault.related(said.key.clone(), "varies here"),
        None => fault,
    };
    fault.expected("each quantity once").help("remove one of the two")
}

/// `[samples]` beside a grid or a curve: one axis.
pub(super) fn samples(columns: Vec<Axis>, count: usize) -> Axis {
    Axis {
        path: SAMPLES.into(),
        name: "sample".into(),
        long_name: "sample".into(),
        units: "1".into(),
        values: places(count),
        columns,
        ..Axis::default()
    }
}

/// One of the quantities that vary together.
fn column(key: &Key, list: &Value, section: &str) -> Checked<Axis> {
    if key.get_ref() == LAW {
        return law_words(list).map(law_axis);
    }
    if let Some(word) = AXIS_KEYS.iter().find(|word| key.get_ref() == **word) {
        return Err(Fault::at(key.span(), format!("`{word}` is a key of a single quantity's axis"))
            .label("quantities that vary together are listed")
            .expected(FORM)
            .help("write the quantity's path in quotes, and its values as a list"));
    }
    let address = axes::swept_quantity(key, list, &format!("sweep.{section}"))?;
    Ok(axes::axis(address, axes::listed(list, address)?, false))
}

/// All lists of an axis have one length.
fn agree(length: &mut Option<usize>, here: usize, list: &Value, path: &str) -> Checked<()> {
    match *length.get_or_insert(here) {
        other if other == here => Ok(()),
        other => Err(Fault::at(list.span(), format!("the lists of [{path}] differ in length"))
            .label(axes::found_values(here))
            .expected(format!("{other} values, as in the list before"))
            .help("each place along the axis takes one entry of every list")),
    }
}

fn labels(list: &Value, path: &str) -> Checked<Vec<String>> {
    let at = format!("{path}.{LABEL}");
    let entries = values::list(list, &at, "a list of names such as [\"PS\", \"PMMA\"]")?;
    let text = |entry| values::text(entry, &at).map(|text| text.trim().to_owned());
    let words: Vec<String> = entries.iter().map(text).collect::<Checked<_>>()?;
    if let Some(entry) = entries.iter().zip(&words).find(|(_, word)| word.is_empty()).map(|(entry, _)| entry)
    {
        return Err(Fault::at(entry.span(), format!("a label of [{path}] is empty"))
            .label("no word")
            .expected("a name for each place along the axis")
            .help("give it one, or leave `label` out"));
    }
    once(&words, list, &at)?;
    Ok(words)
}

/// A name that a dimension of the results file can have.
fn named(key: &Key) -> Checked<()> {
    const TAKEN: [&str; 10] = [
        "instance",
        "direction",
        "harmonic",
        "status",
        "branch",
        "sample",
        "law",
        "waveform",
        "spectrum",
        "order",
    ];
    let name = key.get_ref().as_ref();
    let begins = name.starts_with(|c: char| c.is_ascii_lowercase());
    let plain = begins && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    let fault =
        |title: String| Fault::at(key.span(), title).expected("a name of small letters, digits and _");
    if !plain {
        return Err(fault(format!("`{name}` cannot be the name of an axis"))
            .label("a dimension of the results file has this name")
            .help("write [sweep.material], for example"));
    }
    if TAKEN.contains(&name) || Observable::from_name(name).is_some() {
        return Err(fault(format!("`{name}` is the name of something else in the results file"))
            .label("taken")
            .help("write [sweep.material], for example"));
    }
    Ok(())
}

/// Refuses axes of one name, in a section at this place.
pub(super) fn check(sweep: &SweptAxes, place: Range<usize>, draft: &Draft) -> Checked<()> {
    let mut seen = HashSet::new();
    match sweep.quantities().find(|axis| !seen.insert(axis.name.as_str())) {
        None => Ok(()),
        Some(axis) => {
            let said = draft.said.iter().rev().find(|said| said.swept && said.path == axis.path);
            Err(Fault::at(said.map_or(place, |said| said.key.clone()), "two axes have one name")
                .label(format!("`{}`", axis.name))
                .expected("axes whose names in the results file differ")
                .help("give the table another name"))
        }
    }
}
