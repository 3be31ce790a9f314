//! The closed table of unit symbols and prefixes, and unit expressions made of them.

use super::Dimension;

/// Symbol, powers of m, kg, s, A and degree, power of ten against SI, takes prefixes.
const SYMBOLS: [(&str, [i32; 5], i32, bool); 18] = [
    ("m", [1, 0, 0, 0, 0], 0, true),
    ("g", [0, 1, 0, 0, 0], -3, true),
    ("s", [0, 0, 1, 0, 0], 0, true),
    ("A", [0, 0, 0, 1, 0], 0, true),
    ("Hz", [0, 0, -1, 0, 0], 0, true),
    ("N", [1, 1, -2, 0, 0], 0, true),
    ("Pa", [-1, 1, -2, 0, 0], 0, true),
    ("bar", [-1, 1, -2, 0, 0], 5, true),
    ("J", [2, 1, -2, 0, 0], 0, true),
    ("V", [2, 1, -3, -1, 0], 0, true),
    ("C", [0, 0, 1, 1, 0], 0, true),
    ("F", [-2, -1, 4, 2, 0], 0, true),
    ("degree", [0, 0, 0, 0, 1], 0, false),
    ("deg", [0, 0, 0, 0, 1], 0, false),
    ("°", [0, 0, 0, 0, 1], 0, false),
    // The ångström, as its own sign, as a letter, and spelled.
    ("\u{212B}", [1, 0, 0, 0, 0], -10, false),
    ("\u{C5}", [1, 0, 0, 0, 0], -10, false),
    ("angstrom", [1, 0, 0, 0, 0], -10, false),
];

/// Prefixes, with both micro signs (U+00B5 and U+03BC) and the ASCII one first.
const PREFIXES: [(&str, i32); 18] = [
    ("y", -24),
    ("z", -21),
    ("a", -18),
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("\u{B5}", -6),
    ("\u{3BC}", -6),
    ("m", -3),
    ("c", -2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("P", 15),
    ("E", 18),
    ("", 0),
];

/// Longest unit text worth reading.
const LONGEST: usize = 48;

/// The prefix for that power of ten, in ASCII.
pub(super) fn prefix_of(exponent: i32) -> Option<&'static str> {
    PREFIXES.iter().find(|(_, power)| *power == exponent).map(|(prefix, _)| *prefix)
}

/// A unit expression: what it measures and its power of ten against SI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unit {
    pub powers: [i32; 5],
    pub exponent: i32,
}

impl Unit {
    /// Reads symbols joined by `/` (which divides by the next one only), `*`, `·` or a space,
    /// each with an optional power: `kg/m^3`, `J/m²`, `V m/C`.
    pub fn read(text: &str) -> Option<Self> {
        if text.len() > LONGEST {
            return None;
        }
        let mut unit = Self { powers: [0; 5], exponent: 0 };
        let mut rest = text;
        let mut sign = 1;
        loop {
            rest = rest.trim_start();
            let end = rest.find(|c: char| "/*·".contains(c) || c.is_whitespace()).unwrap_or(rest.len());
            let factor = Self::read_factor(&rest[..end])?;
            for (sum, power) in unit.powers.iter_mut().zip(factor.powers) {
                *sum += sign * power;
            }
            unit.exponent += sign * factor.exponent;
            rest = rest[end..].trim_start();
            if rest.is_empty() {
                return Some(unit);
            }
            sign = if rest.starts_with('/') { -1 } else { 1 };
            rest = rest.strip_prefix(['/', '*', '·']).unwrap_or(rest);
        }
    }

    fn read_factor(text: &str) -> Option<Self> {
        let (symbol, power) = if let Some(symbol) = text.strip_suffix('²') {
            (symbol, 2)
        } else if let Some(symbol) = text.strip_suffix('³') {
            (symbol, 3)
        } else if let Some((symbol, power)) = text.split_once('^') {
            (symbol, power.parse().ok().filter(|power| (-9..=9).contains(power) && *power != 0)?)
        } else {
            (text, 1)
        };
        let (powers, exponent) = lookup(symbol)?;
        Some(Self { powers: powers.map(|p| p * power), exponent: exponent * power })
    }

    /// The first dimension it could stand for, or `None` where the program knows no such quantity.
    pub fn dimension(self) -> Option<Dimension> {
        Dimension::ALL.into_iter().find(|dimension| dimension.words().powers == self.powers)
    }
}

/// A symbol with or without a prefix; the whole word counts first, so `Pa` is not peta-anything.
fn lookup(symbol: &str) -> Option<([i32; 5], i32)> {
    if let Some((_, powers, exponent, _)) = SYMBOLS.iter().find(|entry| entry.0 == symbol) {
        return Some((*powers, *exponent));
    }
    PREFIXES.iter().find_map(|(prefix, prefix_exponent)| {
        let bare = symbol.strip_prefix(prefix)?;
        let (_, powers, exponent, _) = SYMBOLS.iter().find(|entry| entry.3 && entry.0 == bare)?;
        Some((*powers, exponent + prefix_exponent))
    })
}
