//! A quantity of a scene by its path.

use super::params::Params;
use super::quantities::QUANTITIES;
use super::quantity::Quantity;
use crate::units::{self, Dimension};

/// A quantity and, where its path has an index, which one.
#[derive(Clone, Copy, Debug)]
pub struct Address {
    pub quantity: &'static Quantity,
    pub index: usize,
}

impl Address {
    /// The quantity at that path, `None` if there is none.
    pub fn find(path: &str) -> Option<Self> {
        if let Some(quantity) = QUANTITIES.iter().find(|quantity| quantity.path == path) {
            // The pattern itself, with its `#`, is no path.
            return (!path.contains('#')).then_some(Self { quantity, index: 0 });
        }
        QUANTITIES.iter().find_map(|quantity| {
            let (head, tail) = quantity.path.split_once('#')?;
            let digits = path.strip_prefix(head)?.strip_suffix(tail)?;
            let plain = digits == "0" || !digits.starts_with(['0', '+']);
            Some(Self { quantity, index: digits.parse().ok().filter(|_| plain)? })
        })
    }

    /// The path with its index.
    pub fn path(self) -> String {
        self.quantity.path.replacen('#', &self.index.to_string(), 1)
    }

    /// Label for people, as `sample Young's modulus`.
    pub fn long_name(self) -> String {
        if !self.quantity.path.contains('#') {
            return self.quantity.long_name.to_string();
        }
        self.quantity.long_name.replacen('#', &(self.index + 1).to_string(), 1)
    }

    /// The value in that case, SI; `None` where the case says the same thing another way.
    pub fn get(self, params: &Params) -> Option<f64> {
        (self.quantity.access.get)(params, self.index)
    }

    /// Puts an SI value in, and switches to this way of saying it where there are several.
    /// An index beyond the case's modes changes nothing; reading refuses it beforehand.
    pub fn set(self, params: &mut Params, value: f64) {
        (self.quantity.access.set)(params, self.index, value);
    }

    /// The value as the scene file writes it, quotes included where it has a unit.
    pub fn written(self, value: f64) -> String {
        self.quoted(units::format(value, self.quantity.dimension))
    }

    /// The same for people, with few digits.
    pub fn shown(self, value: f64) -> String {
        self.quoted(units::shown(value, self.quantity.dimension))
    }

    fn quoted(self, value: String) -> String {
        match self.quantity.dimension {
            Dimension::Dimensionless => value,
            _ => format!("\"{value}\""),
        }
    }
}
