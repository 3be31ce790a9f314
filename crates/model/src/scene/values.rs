//! Single values of a scene file: quantities, counts, keywords, and the keys around them.

use super::address::Address;
use super::plausibility;
use super::quantities::QUANTITIES;
use super::scene_error::{Checked, Fault};
use super::synonyms::{self, Meant};
use crate::suggestion::nearest;
use crate::units::{self, Dimension, UnitErrorKind, shortened};
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A key as it stands in the file.
pub(super) type Key<'a> = Spanned<std::borrow::Cow<'a, str>>;
/// A value as it stands in the file.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// The value of a quantity in SI units, its dimension and domain checked.
pub(super) fn quantity(value: &Value, address: Address, path: &str) -> Checked<f64> {
    let number = raw_quantity(value, address.quantity.dimension, path)?;
    in_domain(number, value.span(), || described(value), address, path)?;
    Ok(number)
}

/// Refuses a value outside the quantity's domain.
pub(super) fn in_domain(
    number: f64,
    place: Range<usize>,
    found: impl Fn() -> String,
    address: Address,
    path: &str,
) -> Checked<()> {
    let domain = address.quantity.domain;
    if domain.holds(number) {
        return plausibility::possible(number, place, found, address);
    }
    Err(Fault::at(place, format!("`{path}` has an impossible value"))
        .label(format!("found {}", found()))
        .expected(domain.described())
        .help(domain.advice(number)))
}

pub(super) fn raw_quantity(value: &Value, dimension: Dimension, path: &str) -> Checked<f64> {
    let fault = |found: String| {
        let expected = match dimension {
            Dimension::Dimensionless => "a number without unit and without quotes, such as 0.3".to_string(),
            other => format!("{} with its unit, such as {}", other.described(), other.example()),
        };
        let help = format!("write {path} = {}, for example", dimension.example());
        Fault::at(value.span(), format!("`{path}` is not {}", dimension.described()))
            .label(format!("found {found}"))
            .expected(expected)
            .help(help)
    };
    let text = match value.get_ref() {
        DeValue::String(text) => text.as_ref(),
        DeValue::Integer(integer) if integer.radix() != 10 => {
            return Err(fault(described(value)).help("write the number in decimal"));
        }
        DeValue::Integer(integer) => integer.as_str(),
        DeValue::Float(float) => float.as_str(),
        _ => return Err(fault(described(value))),
    };
    let quoted = value.get_ref().is_str();
    match units::parse(text, dimension) {
        // A number in quotes looks like a quantity that lost its unit; only `inf` is common in both forms.
        Ok(number) if quoted && dimension == Dimension::Dimensionless && number.is_finite() => {
            Err(fault(described(value)).help(format!("write {} without quotes", text.trim())))
        }
        Ok(number) => Ok(number),
        Err(error) => {
            let title = match error.kind {
                UnitErrorKind::MissingUnit => format!("`{path}` has no unit"),
                UnitErrorKind::UnknownUnit => format!("`{path}` has an unknown unit"),
                UnitErrorKind::OutOfRange => format!("`{path}` is beyond the range of numbers"),
                UnitErrorKind::NotANumber | UnitErrorKind::WrongDimension(_) => {
                    format!("`{path}` is not {}", dimension.described())
                }
            };
            Err(Fault::at(value.span(), title)
                .label(format!("found {}", error.found()))
                .expected(error.expected())
                .help(format!("write {}, for example", dimension.example()))
                .maybe_help(error.suggestion()))
        }
    }
}

/// A whole number within a range.
pub(super) fn count(value: &Value, path: &str, range: RangeInclusive<u64>) -> Checked<u64> {
    let (least, most) = (*range.start(), *range.end());
    let fault = |what: &str, nearest: u64| {
        let expected = match least == most {
            true => format!("{least}, the only possible value"),
            false => format!("a whole number from {least} to {most}"),
        };
        unfit(value, format!("`{path}` is {what}"))
            .expected(expected)
            .help(format!("the nearest allowed value is {nearest}"))
    };
    let DeValue::Integer(integer) = value.get_ref() else {
        let near = value.get_ref().as_float().and_then(|float| float.as_str().parse::<f64>().ok());
        // Casting saturates, and NaN becomes 0.
        let near = near.map_or(least, |near| near.round() as u64);
        return Err(fault("not a whole number", near.max(least).min(most)));
    };
    let negative = integer.as_str().starts_with('-');
    match u64::from_str_radix(integer.as_str().trim_start_matches('+'), integer.radix()) {
        Ok(number) if range.contains(&number) => Ok(number),
        Ok(number) if number < least => Err(fault("out of range", least)),
        _ if negative => Err(fault("out of range", least)),
        _ => Err(fault("out of range", most)),
    }
}

/// A plain number within a range.
pub(super) fn ratio(value: &Value, path: &str, range: RangeInclusive<f64>) -> Checked<f64> {
    let number = raw_quantity(value, Dimension::Dimensionless, path)?;
    if range.contains(&number) {
        return Ok(number);
    }
    Err(unfit(value, format!("`{path}` is out of range"))
        .expected(format!("a number from {:e} to {}", range.start(), range.end()))
        .help(format!("the nearest allowed value is {:?}", number.clamp(*range.start(), *range.end()))))
}

/// A text.
pub(super) fn text<'a>(value: &'a Value, path: &str) -> Checked<&'a str> {
    value.get_ref().as_str().ok_or_else(|| {
        unfit(value, format!("`{path}` is not a text"))
            .expected("a text in quotes")
            .help("put quotes around it")
    })
}

/// A table, written as `[section]` or in braces.
pub(super) fn table<'a, 'i>(value: &'a Value<'i>, path: &str, expected: &str) -> Checked<&'a DeTable<'i>> {
    value.get_ref().as_table().ok_or_else(|| {
        unfit(value, format!("`{path}` is not a table"))
            .expected(expected)
            .help("its entries are written key = value, in that form")
    })
}

/// A list with at least one entry.
pub(super) fn list<'a, 'i>(value: &'a Value<'i>, path: &str, expected: &str) -> Checked<&'a DeArray<'i>> {
    let fault = |title: String| {
        let found = format!("found {}", described(value));
        Fault::at(value.span(), title)
            .label(found)
            .expected(expected)
            .help("write at least one entry in brackets")
    };
    match value.get_ref().as_array() {
        Some(array) if array.is_empty() => Err(fault(format!("`{path}` is an empty list"))),
        Some(array) => Ok(array),
        None => Err(fault(format!("`{path}` is not a list"))),
    }
}

/// One of a few words.
pub(super) fn keyword<T: Copy>(value: &Value, path: &str, words: &[(&str, T)]) -> Checked<T> {
    let quoted = || words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
    let Some(found) = value.get_ref().as_str() else {
        return Err(unfit(value, format!("`{path}` is not a word in quotes"))
            .expected(format!("one of {}", quoted()))
            .help("put one of these words, with its quotes"));
    };
    words.iter().find(|(word, _)| *word == found).map(|(_, meaning)| *meaning).ok_or_else(|| {
        let meant = nearest(found, words.iter().map(|(word, _)| *word));
        unfit(value, format!("`{path}` has an unknown value"))
            .expected(format!("one of {}", quoted()))
            .help("put one of these words")
            .maybe_help(meant.map(|word| format!("did you mean \"{word}\"?")))
    })
}

/// True or false.
pub(super) fn flag(value: &Value, path: &str) -> Checked<bool> {
    value.get_ref().as_bool().ok_or_else(|| {
        unfit(value, format!("`{path}` is not true or false"))
            .expected("true or false, without quotes")
            .help("write one of the two")
    })
}

/// Refuses keys that a section does not have.
pub(super) fn no_others(table: &DeTable, section: &str, known: &[&str]) -> Checked<()> {
    match table.keys().find(|key| !known.contains(&key.get_ref().as_ref())) {
        Some(key) => Err(unknown_key(key, section, known)),
        None => Ok(()),
    }
}

/// A key that its section does not have; `section` is empty for the file's top level.
pub(super) fn unknown_key(key: &Key, section: &str, known: &[&str]) -> Box<Fault> {
    let found = key.get_ref().as_ref();
    let place = if section.is_empty() { "the scene".to_string() } else { format!("[{section}]") };
    let help = synonyms::help(found, known.iter().copied())
        .or_else(|| nearest(found, known.iter().copied()).map(|meant| format!("did you mean `{meant}`?")))
        .or_else(|| home_of(found).map(|home| format!("`{found}` belongs in [{home}]")))
        .or_else(|| elsewhere(found));
    Fault::at(key.span(), format!("unknown key `{}` in {place}", shortened(found)))
        .label(format!("not a key of {place}"))
        .expected(format!("one of {}", known.join(", ")))
        .help("remove the line, or put one of these keys")
        .maybe_help(help)
}

/// Where what the word stands for has its place.
fn elsewhere(word: &str) -> Option<String> {
    let Some(Meant::Name(name)) = synonyms::meant(word) else { return None };
    Some(format!("here that is `{name}`, in [{}]", home_of(name)?))
}

/// The section that does have a key of that name.
fn home_of(key: &str) -> Option<&'static str> {
    const OTHERS: [(&str, &[&str]); 7] = [
        ("instrument", &["preset", "actuator", "tip"]),
        ("instrument.actuator", &["model"]),
        ("instrument.cantilever", &["modes"]),
        ("contact", &["law"]),
        ("drive", &["on"]),
        ("run", &["start", "periods", "measure", "accuracy", "steps_per_period"]),
        ("output", &["observables", "waveforms", "spectra"]),
    ];
    let quantity = QUANTITIES
        .iter()
        .filter(|quantity| !quantity.path.contains('#'))
        .filter_map(|quantity| quantity.path.rsplit_once('.'))
        .find(|(_, name)| *name == key);
    quantity
        .map(|(section, _)| section)
        .or_else(|| OTHERS.iter().find(|(_, keys)| keys.contains(&key)).map(|(section, _)| *section))
}

/// The fault of a value that is not what it should be.
pub(super) fn unfit(value: &Value, title: impl Into<String>) -> Box<Fault> {
    Fault::at(value.span(), title).label(format!("found {}", described(value)))
}

/// What a value is, as a phrase for "found ...".
pub(super) fn described(value: &Value) -> String {
    match value.get_ref() {
        DeValue::String(text) => format!("\"{}\"", shortened(text)),
        DeValue::Integer(integer) => format!("the number {}", shortened(&integer.to_string())),
        DeValue::Float(float) => format!("the number {}", shortened(float.as_str())),
        DeValue::Boolean(boolean) => format!("{boolean}"),
        DeValue::Datetime(_) => "a date or time".to_string(),
        DeValue::Array(array) if array.is_empty() => "an empty list".to_string(),
        DeValue::Array(_) => "a list".to_string(),
        DeValue::Table(table) if table.is_empty() => "an empty table".to_string(),
        DeValue::Table(_) => "a table".to_string(),
    }
}
