//! The numbers a study finds: each has a key, so that page, table file and tests speak of the same one.

use crate::report::shown;
use std::fmt::Write;

/// One number of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Dotted words, as `rod.static_top`.
    pub key: String,
    /// What it is, for people.
    pub meaning: String,
    /// SI.
    pub value: f64,
    /// SI unit as results files write it; `1` without one.
    pub units: &'static str,
}

/// The numbers of a study, in the order they were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers(Vec<Number>);

impl Numbers {
    /// Adds a number.
    pub(super) fn add(
        &mut self,
        key: impl Into<String>,
        meaning: impl Into<String>,
        value: f64,
        units: &'static str,
    ) {
        self.0.push(Number { key: key.into(), meaning: meaning.into(), value, units });
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Number> {
        self.0.iter()
    }

    /// The number of that key.
    pub fn find(&self, key: &str) -> Option<&Number> {
        self.0.iter().find(|number| number.key == key)
    }

    /// The value of that key, SI; NaN where there is none, which a page shows as `no value`.
    pub fn get(&self, key: &str) -> f64 {
        self.find(key).map_or(f64::NAN, |number| number.value)
    }

    /// The number of that key with its unit, to so many significant digits.
    pub fn shown(&self, key: &str, digits: usize) -> String {
        self.find(key)
            .map_or_else(|| shown(f64::NAN, "1", digits), |number| shown(number.value, number.units, digits))
    }

    /// One line a number: key, value with 12 digits, unit, meaning.
    pub fn csv(&self) -> String {
        let mut text = String::from("key,value,unit,meaning\n");
        for number in &self.0 {
            // Writing to a String cannot fail.
            let meaning = number.meaning.replace('"', "\"\"");
            let _ = writeln!(text, "{},{:.11e},{},\"{meaning}\"", number.key, number.value, number.units);
        }
        text
    }
}
