//! Cells of tables for other programs: heads with units, numbers with all their digits.

/// A name with its unit, as a column's head.
pub(super) fn head(name: &str, units: &str) -> String {
    if matches!(units, "" | "1") { name.to_owned() } else { format!("{name} [{units}]") }
}

/// A number that reads back as it is.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}
