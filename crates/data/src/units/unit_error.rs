//! What can be wrong with a quantity's text.

use super::{Dimension, Number};
use crate::suggestion::nearest;
use std::fmt;

/// A text that is not the quantity asked for: what was found, what was expected, what to write instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitError {
    pub kind: UnitErrorKind,
    /// The text as found, shortened where it is long.
    pub text: String,
    pub expected: Dimension,
}

/// The ways a quantity's text can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitErrorKind {
    /// It does not start with a decimal number.
    NotANumber,
    /// A bare number where a unit is needed.
    MissingUnit,
    /// The unit is not in the table.
    UnknownUnit,
    /// A quantity, but of this dimension (`None`: of one that no quantity of a scene has).
    WrongDimension(Option<Dimension>),
    /// Too large or too small for a double.
    OutOfRange,
}

/// Units that are known under another name, or that need a word of explanation.
const ASIDES: [(&str, &[&str]); 18] = [
    ("write \"um\"", &["micron", "microns", "micrometer", "micrometers"]),
    ("write \"nm\"", &["nanometer", "nanometers"]),
    ("write \"nN\"", &["nanonewton"]),
    ("write \"GPa\"", &["gigapascal"]),
    ("write \"kHz\"", &["kilohertz"]),
    ("write \"V\"", &["volt", "volts"]),
    ("write \"Hz\"", &["hertz"]),
    ("write \"Pa\"", &["pascal"]),
    ("write \"N\"", &["newton"]),
    ("give cycles per second, in Hz: divide by 2 pi", &["rad/s"]),
    ("give cycles per second, in kHz: divide by 2 pi", &["krad/s"]),
    ("give joules: 1 eV is 1.602176634e-19 J", &["eV"]),
    ("give joules: 1 meV is 1.602176634e-22 J", &["meV"]),
    ("give joules: 1 kT at 300 K is 4.14e-21 J", &["kT"]),
    ("give pascals: 1 psi is 6894.76 Pa", &["psi"]),
    ("1 erg/cm^2 is 1 mJ/m^2", &["erg/cm^2"]),
    ("1 dyn/cm is 1 mN/m", &["dyn/cm"]),
    ("write the share as a number: 50% is 0.5", &["%"]),
];

impl UnitError {
    pub(super) fn new(kind: UnitErrorKind, text: &str, expected: Dimension) -> Self {
        Self { kind, text: shortened(text), expected }
    }

    /// What was found, as a phrase.
    pub fn found(&self) -> String {
        let text = &self.text;
        match self.kind {
            UnitErrorKind::NotANumber if text.is_empty() => "an empty text".to_string(),
            UnitErrorKind::NotANumber => format!("\"{text}\", which is not a number followed by a unit"),
            UnitErrorKind::MissingUnit => format!("the bare number {text}"),
            UnitErrorKind::UnknownUnit => format!("the unknown unit \"{}\"", self.unit_text()),
            UnitErrorKind::WrongDimension(Some(found)) => format!("\"{text}\", {}", found.described()),
            UnitErrorKind::WrongDimension(None) => format!("\"{text}\", a quantity of another kind"),
            UnitErrorKind::OutOfRange => format!("\"{text}\", beyond the range of numbers"),
        }
    }

    /// What was expected, as a phrase with an example.
    pub fn expected(&self) -> String {
        match self.expected {
            Dimension::Dimensionless => format!("{}, such as 0.3", self.expected.described()),
            other => format!("{} with its unit, such as {}", other.described(), other.example()),
        }
    }

    /// What to write instead, where that can be guessed.
    pub fn suggestion(&self) -> Option<String> {
        let expected = self.expected;
        let Some(number) = Number::scan(&self.text) else {
            return match self.kind {
                UnitErrorKind::NotANumber
                    if !self.text.is_empty() && super::Unit::read(&self.text).is_some() =>
                {
                    Some("put a number before the unit".to_string())
                }
                _ => None,
            };
        };
        let value = &self.text[..self.text.len() - number.rest.len()];
        let value = value.trim_end();
        match self.kind {
            UnitErrorKind::NotANumber if number.rest.trim_start().starts_with(',') => {
                Some(format!("write the decimal point as a point: \"{}\"", self.text.replacen(',', ".", 1)))
            }
            UnitErrorKind::NotANumber if self.text.contains('_') => {
                Some(format!("leave the underscores out: \"{}\"", self.text.replace('_', "")))
            }
            UnitErrorKind::MissingUnit => {
                // Zero is zero in any unit; any other number's unit is a guess, so offer the usual ones.
                let usual = expected.words().usual;
                let si = number.times_ten_to(0).unwrap_or(f64::NAN);
                let small = si.abs() > 0.0 && si.abs() < SMALL && usual.first() != Some(&expected.si_unit());
                let shown: Vec<String> = if si == 0.0 {
                    vec![format!("\"{value} {}\"", expected.si_unit())]
                } else if small {
                    // A program's number, in the unit without a prefix.
                    vec![format!("\"{}\", if it is in {}", super::format(si, expected), expected.si_unit())]
                } else {
                    usual.iter().take(2).map(|unit| format!("\"{value} {unit}\"")).collect()
                };
                Some(format!("give its unit: {}", shown.join(" or ")))
            }
            UnitErrorKind::UnknownUnit => {
                let unit = self.unit_text();
                if unit == "%" && expected != Dimension::Dimensionless {
                    return Some(format!("no share is meant: give {}", self.expected()));
                }
                if let Some((aside, _)) = ASIDES.iter().find(|(_, names)| names.contains(&unit)) {
                    return Some(aside.replacen("write \"", &format!("write \"{value} "), 1));
                }
                let usual = expected.words().usual;
                nearest(unit, usual.iter().copied())
                    .map(|meant| format!("did you mean \"{value} {meant}\"?"))
                    .or_else(|| (!usual.is_empty()).then(|| format!("known units are {}", usual.join(", "))))
            }
            UnitErrorKind::WrongDimension(_) if !expected.words().usual.is_empty() => {
                Some(format!("write \"{value} {}\" if that is its size", expected.words().usual[0]))
            }
            UnitErrorKind::WrongDimension(_) if expected == Dimension::Dimensionless => {
                Some("leave the unit out".to_string())
            }
            _ => None,
        }
    }

    fn unit_text(&self) -> &str {
        Number::scan(&self.text).map_or("", |number| number.rest.trim())
    }
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {}; expected {}", self.found(), self.expected())?;
        match self.suggestion() {
            Some(suggestion) => write!(f, "; {suggestion}"),
            None => Ok(()),
        }
    }
}

/// A number without its unit that is smaller than this is one in the unit without a prefix.
const SMALL: f64 = 1e-3;

impl std::error::Error for UnitError {}

/// Text for a message: without control characters, and cut where it is long.
pub fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let mut clean: String = text
        .chars()
        .take(MOST)
        .map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c })
        .collect();
    if text.chars().nth(MOST).is_some() {
        clean.push_str("...");
    }
    clean
}
