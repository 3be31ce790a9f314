//! Numbers and units as people read them: `1.5 nN`, not `1.5e-9 N`.

/// SI prefixes from 1e-18 to 1e12, a thousand apart.
const PREFIXES: [&str; 11] = ["a", "f", "p", "n", "µ", "m", "", "k", "M", "G", "T"];

/// How values of one quantity are shown: `shown = SI value / size`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DisplayUnit {
    size: f64,
    /// With its prefix; empty for a dimensionless quantity.
    pub text: String,
}

impl DisplayUnit {
    /// The unit in which `largest` has one to three digits before the point, if prefixes go with it.
    pub fn fitting(units: &str, largest: f64) -> Self {
        let pretty = match units {
            "1" | "" => String::new(),
            "degree" => "°".to_owned(),
            other => other.replace("^2", "²").replace("^3", "³").replace('*', "·"),
        };
        let plain = Self { size: 1.0, text: pretty.clone() };
        let first = units.split(['/', '*', ' ']).next().unwrap_or_default();
        let most = match first {
            "s" => 0,
            "m" | "N" | "Pa" | "J" | "Hz" | "V" | "W" | "A" | "C" => 12,
            _ => return plain,
        };
        if !(largest.is_finite() && largest > 0.0) {
            return plain;
        }
        // 999.9996 would be shown as 1000; take the next prefix there.
        let power = ((largest * 1.000_001).log10() / 3.0).floor() as i32 * 3;
        let power = power.clamp(-18, most);
        let prefix = PREFIXES[((power + 18) / 3) as usize];
        Self { size: 10f64.powi(power), text: format!("{prefix}{pretty}") }
    }

    /// An SI value in this unit.
    pub fn show(&self, value: f64) -> f64 {
        value / self.size
    }

    /// `label (nm)`, or the label alone.
    pub fn label(&self, label: &str) -> String {
        if self.text.is_empty() { label.to_owned() } else { format!("{label} ({})", self.text) }
    }

    /// A value with its unit: `12.5 nm`.
    pub fn value(&self, value: f64) -> String {
        self.digits(value, 4)
    }

    /// A value with its unit, as a sentence has it: `12.5 nm`.
    pub fn short(&self, value: f64) -> String {
        self.digits(value, 3)
    }

    /// As [`DisplayUnit::value`], with so many significant digits.
    pub fn digits(&self, value: f64, digits: usize) -> String {
        if value.is_nan() {
            return number(value, digits);
        }
        self.of(&number(self.show(value), digits))
    }

    /// A number that is written in this unit, with it.
    pub fn of(&self, number: &str) -> String {
        match self.text.as_str() {
            "" => number.to_owned(),
            "°" => format!("{number}°"),
            unit => format!("{number} {unit}"),
        }
    }
}

/// A value in SI `units` as people read it, with at most so many significant digits: `5.70416 nm`.
///
/// ```
/// use afmsweep_report::shown;
/// assert_eq!(shown(5.70415785e-9, "m", 6), "5.70416 nm");
/// assert_eq!(shown(f64::NAN, "m", 4), "no value");
/// assert_eq!(shown(0.0123, "1", 2), "0.012");
/// ```
pub fn shown(value: f64, units: &str, digits: usize) -> String {
    DisplayUnit::fitting(units, value.abs()).digits(value, digits)
}

/// At most so many significant digits, no trailing zeros, powers of ten written out where they are needed.
pub(super) fn number(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "no value".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞".to_owned() } else { "−∞".to_owned() };
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    let text = if (-3..6).contains(&power) {
        let places = (digits as i32 - 1 - power).max(0) as usize;
        trim(&format!("{value:.places$}"))
    } else {
        format!("{}×10{}", trim(mantissa), superscript(power))
    };
    text.replace('-', "−")
}

fn trim(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

/// `10⁻³` needs these.
pub(super) fn superscript(power: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    };
    power.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn single(value: f64, units: &str) -> String {
        DisplayUnit::fitting(units, value.abs()).value(value)
    }

    #[test]
    fn prefixes_fit_the_largest_value() {
        for (value, units, expected) in [
            (2.5e-9, "m", "2.5 nm"),
            (1e11, "Pa", "100 GPa"),
            (0.05, "J/m^2", "50 mJ/m²"),
            (3e-18, "J", "3 aJ"),
            (3e-22, "J", "3×10⁻⁴ aJ"),
            (-1.5e-9, "N", "−1.5 nN"),
            (90.0, "degree", "90°"),
            (0.25, "1", "0.25"),
            (2.5e3, "kg/m^3", "2500 kg/m³"),
            (4e-12, "m^2", "4×10⁻¹² m²"),
            (3600.0, "s", "3600 s"),
            (0.0, "m", "0 m"),
            (999.9999e-9, "m", "1 µm"),
        ] {
            assert_eq!(single(value, units), expected);
        }
    }
}
