//! Cells of tables for other programs: heads with units, numbers with all their digits, labels that no spreadsheet runs.

use std::borrow::Cow;

/// A name with its unit, as a column's head.
pub(super) fn head(name: &str, units: &str) -> String {
    if matches!(units, "" | "1") { name.to_owned() } else { format!("{name} [{units}]") }
}

/// A number that reads back as it is.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A label. Where a spreadsheet would take it for a formula it gets an apostrophe, which makes it a text; numbers stay
/// numbers.
pub(super) fn label(text: &str) -> Cow<'_, str> {
    let formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    if formula { format!("'{text}").into() } else { text.into() }
}
