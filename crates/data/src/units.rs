//! Text to SI and back: the only place that knows units.
//!
//! Reading is exact: every unit here is a power of ten of SI, so the unit's
//! exponent is added to that of the decimal text and the sum is read once.
//! `"30 nm"` is therefore the f64 nearest to 3e-8, as the literal `3e-8` is.
//!
//! ```
//! use afmsweep_data::units::{Dimension, format, parse};
//! assert_eq!(parse("30 nm", Dimension::Length), Ok(3e-8));
//! assert_eq!(parse("20 mJ/m^2", Dimension::SurfaceEnergy), Ok(0.02));
//! assert_eq!(format(3e-8, Dimension::Length), "30 nm");
//! ```

mod symbols;
#[cfg(test)]
mod tests;
mod unit_error;

use symbols::Unit;
pub use unit_error::shortened;
pub use unit_error::{UnitError, UnitErrorKind};

macro_rules! dimensions {
    ($($name:ident, $si_unit:literal, $powers:expr, $described:literal, $example:literal, $usual:expr;)*) => {
        /// What kind of quantity a text must hold.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Dimension {
            $(#[doc = $si_unit] $name,)*
        }

        impl Dimension {
            /// Every dimension.
            pub const ALL: [Dimension; DIMENSIONS.len()] = [$(Self::$name),*];
        }

        const DIMENSIONS: &[Words] = &[$(Words {
            si_unit: $si_unit,
            powers: $powers,
            described: $described,
            example: $example,
            usual: &$usual,
        }),*];
    };
}

/// What is said of a dimension.
struct Words {
    si_unit: &'static str,
    /// Exponents of m, kg, s, A and degree.
    powers: [i32; 5],
    described: &'static str,
    example: &'static str,
    /// Units people write for it, the first being what a bare number most likely meant.
    usual: &'static [&'static str],
}

dimensions! {
    Dimensionless, "1", [0, 0, 0, 0, 0], "a number without unit", "0.3", [];
    Length, "m", [1, 0, 0, 0, 0], "a length", "\"30 nm\"", ["nm", "um", "µm", "mm", "pm", "m"];
    Angle, "degree", [0, 0, 0, 0, 1], "an angle", "\"20 deg\"", ["deg", "degree", "°"];
    Time, "s", [0, 0, 1, 0, 0], "a time", "\"5 us\"", ["us", "ms", "ns", "s"];
    Mass, "kg", [0, 1, 0, 0, 0], "a mass", "\"0.8 ng\"", ["ng", "pg", "kg", "ug", "mg", "g"];
    Density, "kg/m^3", [-3, 1, 0, 0, 0], "a density", "\"2500 kg/m^3\"", ["kg/m^3", "g/cm^3"];
    Frequency, "Hz", [0, 0, -1, 0, 0], "a frequency", "\"30 kHz\"", ["kHz", "Hz", "MHz"];
    Force, "N", [1, 1, -2, 0, 0], "a force", "\"2 nN\"", ["nN", "pN", "uN", "mN", "N"];
    Stiffness, "N/m", [0, 1, -2, 0, 0], "a stiffness", "\"42 N/m\"", ["N/m", "mN/m", "nN/nm", "pN/nm", "kN/m"];
    Pressure, "Pa", [-1, 1, -2, 0, 0], "a pressure or modulus", "\"1 GPa\"",
        ["GPa", "MPa", "kPa", "Pa", "N/m^2"];
    Viscosity, "Pa s", [-1, 1, -1, 0, 0], "a viscosity", "\"1 mPa s\"", ["mPa s", "Pa s", "uPa s"];
    Energy, "J", [2, 1, -2, 0, 0], "an energy", "\"6.4e-20 J\"", ["aJ", "zJ", "fJ", "J"];
    // The same as N/m.
    SurfaceEnergy, "J/m^2", [0, 1, -2, 0, 0], "a surface energy", "\"50 mJ/m^2\"",
        ["mJ/m^2", "J/m^2", "uJ/m^2", "mN/m", "N/m"];
    SurfaceCharge, "C/m^2", [-2, 0, 1, 1, 0], "a charge per area", "\"20 mC/m^2\"", ["mC/m^2", "C/m^2"];
    Voltage, "V", [2, 1, -3, -1, 0], "a voltage", "\"15 V\"", ["V", "mV", "kV"];
    // The same as N/C: the rod's h33.
    ElectricField, "V/m", [1, 1, -3, -1, 0], "an electric field (h33)", "\"545.136 MV/m\"",
        ["V/m", "MV/m", "N/C"];
    // The rod's beta33.
    InversePermittivity, "V m/C", [3, 1, -4, -2, 0], "an inverse permittivity (beta33)", "\"7.81e7 V m/C\"",
        ["V m/C", "m/F"];
}

impl Dimension {
    const fn words(self) -> &'static Words {
        &DIMENSIONS[self as usize]
    }

    /// SI unit as the results file writes it; `1` for a plain number.
    pub fn si_unit(self) -> &'static str {
        self.words().si_unit
    }

    /// With its article, for a sentence: `a length`.
    pub fn described(self) -> &'static str {
        self.words().described
    }

    /// A value as a scene file writes it, quotes included.
    pub fn example(self) -> &'static str {
        self.words().example
    }

    /// The unit that [`format`] puts a prefix on, its power of ten against SI, and whether it takes prefixes.
    fn written_unit(self) -> (&'static str, i32, bool) {
        match self {
            Self::Mass => ("g", -3, true),
            Self::Density | Self::InversePermittivity | Self::Angle => (self.si_unit(), 0, false),
            other => (other.si_unit(), 0, true),
        }
    }
}

/// Reads a quantity and returns it in SI units: exactly the f64 nearest to the decimal value written.
///
/// `"inf"`, with or without a unit, is infinity; whether that is allowed is the caller's business.
///
/// # Errors
/// No number at the start, no unit or one of another dimension or unknown, or a number beyond f64.
pub fn parse(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let trimmed = text.trim();
    let fail = |kind| UnitError::new(kind, trimmed, expected);
    let Some(number) = Number::scan(trimmed) else {
        return Err(fail(UnitErrorKind::NotANumber));
    };
    let unit_text = number.rest.trim();
    if unit_text.is_empty() {
        if expected == Dimension::Dimensionless || number.infinite {
            return number.times_ten_to(0).ok_or_else(|| fail(UnitErrorKind::OutOfRange));
        }
        return Err(fail(UnitErrorKind::MissingUnit));
    }
    let Some(unit) = Unit::read(unit_text) else {
        // "0,3 nm" and "1.2.3 nm" are slips in the number, not odd units.
        let in_number = unit_text.starts_with([',', '.', '_', '\''])
            || unit_text.starts_with(|c: char| c.is_ascii_digit());
        return Err(fail(if in_number { UnitErrorKind::NotANumber } else { UnitErrorKind::UnknownUnit }));
    };
    if unit.powers != expected.words().powers {
        return Err(fail(UnitErrorKind::WrongDimension(unit.dimension())));
    }
    number.times_ten_to(unit.exponent).ok_or_else(|| fail(UnitErrorKind::OutOfRange))
}

/// Writes an SI value with a prefix that suits it; [`parse`] reads the text back to the identical f64.
///
/// Plain numbers are written as TOML floats (`200.0`, `inf`).
pub fn format(value: f64, dimension: Dimension) -> String {
    if dimension == Dimension::Dimensionless {
        return format!("{value:?}");
    }
    let (unit, unit_exponent, takes_prefix) = dimension.written_unit();
    if !value.is_finite() {
        return format!("{value} {unit}");
    }
    let sign = if value.is_sign_negative() { "-" } else { "" };
    // The shortest digits that identify the number; moving the point keeps the decimal value as it is.
    let scientific = format!("{:e}", value.abs());
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent = exponent.parse::<i32>().unwrap_or(0) - unit_exponent;
    let digits: String = mantissa.chars().filter(|c| *c != '.').collect();
    if value == 0.0 {
        return format!("{sign}0 {unit}");
    }
    let step = if takes_prefix { 3 * exponent.div_euclid(3) } else { 0 };
    match symbols::prefix_of(step) {
        Some(prefix) if (0..6).contains(&(exponent - step)) => {
            let whole = (exponent - step) as usize + 1;
            if digits.len() <= whole {
                format!("{sign}{digits:0<whole$} {prefix}{unit}")
            } else {
                format!("{sign}{}.{} {prefix}{unit}", &digits[..whole], &digits[whole..])
            }
        }
        _ => format!("{sign}{mantissa}e{exponent} {unit}"),
    }
}

/// Writes an SI value for people: as [`format()`] does, with six significant digits at most, and a number without prefix
/// plainly from 1e-3 to 1e6.
///
/// ```
/// use afmsweep_data::units::{Dimension, shown};
/// assert_eq!(shown(20f64.to_radians(), Dimension::Angle), "0.349066 degree");
/// assert_eq!(shown(2.5e9, Dimension::Pressure), "2.5 GPa");
/// ```
pub fn shown(value: f64, dimension: Dimension) -> String {
    let rounded = format!("{value:.5e}").parse::<f64>().unwrap_or(value);
    let unit = match (dimension, dimension.written_unit()) {
        (Dimension::Dimensionless, _) => String::new(),
        (_, (_, _, true)) => return format(rounded, dimension),
        (_, (unit, ..)) => format!(" {unit}"),
    };
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) || !size.is_finite() => format!("{rounded}{unit}"),
        _ => format!("{rounded:e}{unit}"),
    }
}

/// A decimal number at the start of a text, and what follows it.
struct Number<'a> {
    /// Sign and digits, at most one point, no exponent.
    mantissa: String,
    exponent: i64,
    infinite: bool,
    rest: &'a str,
}

impl<'a> Number<'a> {
    fn scan(text: &'a str) -> Option<Self> {
        // Text copied from documents often carries the typographic minus.
        let (sign, body) = match text.strip_prefix(['-', '\u{2212}']) {
            Some(body) => ("-", body),
            None => ("", text.strip_prefix('+').unwrap_or(text)),
        };
        if let Some(rest) = body.strip_prefix("inf")
            && !rest.starts_with(char::is_alphanumeric)
        {
            return Some(Self { mantissa: sign.to_string(), exponent: 0, infinite: true, rest });
        }
        let mut point = false;
        let end = body
            .find(|c: char| !(c.is_ascii_digit() || (c == '.' && !std::mem::replace(&mut point, true))))
            .unwrap_or(body.len());
        let digits = &body[..end];
        if !digits.contains(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let (exponent, rest) = scan_exponent(&body[end..]);
        Some(Self { mantissa: format!("{sign}{digits}"), exponent, infinite: false, rest })
    }

    /// The number times a power of ten; `None` where f64 cannot hold it (too large, or lost in zero).
    fn times_ten_to(&self, exponent: i32) -> Option<f64> {
        if self.infinite {
            return Some(if self.mantissa.is_empty() { f64::INFINITY } else { f64::NEG_INFINITY });
        }
        let exponent = self.exponent.saturating_add(i64::from(exponent));
        let value: f64 = format!("{}e{exponent}", self.mantissa).parse().ok()?;
        let is_zero = !self.mantissa.contains(|c: char| ('1'..='9').contains(&c));
        (value.is_finite() && (value != 0.0 || is_zero)).then_some(value)
    }
}

/// The exponent at the start of `text`, and the rest; `e` without digits after it belongs to the rest.
fn scan_exponent(text: &str) -> (i64, &str) {
    let Some(body) = text.strip_prefix(['e', 'E']) else {
        return (0, text);
    };
    let unsigned = body.strip_prefix(['-', '+', '\u{2212}']).unwrap_or(body);
    let end = unsigned.find(|c: char| !c.is_ascii_digit()).unwrap_or(unsigned.len());
    if end == 0 {
        return (0, text);
    }
    // Beyond i64 the number is 0 or infinite whatever its digits, so a capped exponent tells the same.
    let size = unsigned[..end].parse::<i64>().unwrap_or(i64::MAX / 2).min(i64::MAX / 2);
    let negative = body.starts_with(['-', '\u{2212}']);
    (if negative { -size } else { size }, &unsigned[end..])
}
