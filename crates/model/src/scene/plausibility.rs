//! Which sizes a quantity has in an instrument that can be built, and which no matter has at all.
//!
//! Beyond what is usual a scene runs with a warning: hard cases are made of such values. Beyond what is
//! possible it is refused: a slip of the unit or the exponent is likelier than a reason. So whatever is common in
//! a microscope, taken 1e9 times (`N/nm` for `N/m`, `m` for `nm`), is refused
//! (`cli_sense::a_slip_of_nine_powers_is_refused`).

use super::address::Address;
use super::params::{ActuatorModel, LawChoice, LeverSpec};
use super::quantity::Quantity;
use super::scene_error::{Checked, Fault, line_column};
use super::{Scene, Start};
use crate::units::{Dimension, shown};
use std::f64::consts::TAU;
use std::ops::Range;

/// Effective masses of levers, kg: from the smallest ones to tuning forks.
const LEVER_MASS: [f64; 2] = [1e-17, 1e-6];

/// Whether zero, infinite, or within the bounds but for its sign.
fn within(value: f64, [least, most]: [f64; 2]) -> bool {
    value == 0.0 || value.is_infinite() || (least..=most).contains(&value.abs())
}

/// The bounds as a phrase.
fn described([least, most]: [f64; 2], dimension: Dimension) -> String {
    let end = |value: f64| shown(value, dimension);
    match least {
        0.0 => format!("at most {}", end(most)),
        _ => format!("from {} to {}", end(least), end(most)),
    }
}

/// Refuses a size that no matter has.
pub(super) fn possible(
    number: f64,
    place: Range<usize>,
    found: impl Fn() -> String,
    address: Address,
) -> Checked<()> {
    match sizes_missed(number, address) {
        None => Ok(()),
        Some(sizes) => Err(Fault::at(place, format!("`{}` has an impossible size", address.path()))
            .label(format!("found {}", found()))
            .expected(sizes)
            .help(CHECK_SIZE)),
    }
}

/// What to do about a size that no matter has.
pub(super) const CHECK_SIZE: &str = "check the exponent and the unit";

/// Which sizes are possible, where this one is not.
pub(super) fn sizes_missed(number: f64, address: Address) -> Option<String> {
    let &Quantity { usual, possible, dimension, domain, .. } = address.quantity;
    let or_inf = if domain.holds(f64::INFINITY) { ", or inf" } else { "" };
    let (most, common) = (described(possible, dimension), described(usual, dimension));
    (!within(number, possible)).then(|| format!("a size {most}{or_inf}; {common} is usual"))
}

impl Scene {
    /// What is odd about the scene though it can be run: sizes beyond what instruments and samples have, and a rod
    /// that rings for ever. One line each, with its place in the file.
    pub fn warnings(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.said.iter().filter_map(|said| self.odd(said)).collect();
        lines.extend(self.drawn.odd.iter().map(|(key, line)| format!("{}: {line}", self.place(key))));
        lines.extend(self.odd_lever());
        lines.extend(self.undamped_rod());
        lines
    }

    fn odd(&self, said: &super::draft::Said) -> Option<String> {
        let address = Address::find(&said.path)?;
        let &Quantity { usual, dimension, .. } = address.quantity;
        let odd = |value: &f64| !within(*value, usual);
        let value = match self.sweep.quantities().find(|axis| axis.path == said.path) {
            // The axis replaces what a section says.
            Some(_) if !said.swept => return None,
            Some(axis) => axis.values.iter().copied().find(odd)?,
            None => address.get(&self.base).filter(odd)?,
        };
        Some(format!(
            "{}: {} = {} is beyond what is usual ({}): check it{}",
            self.place(&said.key),
            said.path,
            shown(value, dimension),
            described(usual, dimension),
            if dimension == Dimension::Angle { "; angles are in degrees, not in radians" } else { "" }
        ))
    }

    /// A place as messages write it: `file:line:column`.
    fn place(&self, key: &Range<usize>) -> String {
        let text = self.source.strip_prefix('\u{FEFF}').unwrap_or(&self.source);
        let (line, column) = line_column(text, key.start);
        format!("{}:{line}:{column}", self.path.display())
    }

    /// Stiffness and frequency that are each usual, and together no lever's: a unit may lack its prefix.
    fn odd_lever(&self) -> Option<String> {
        const PATH: &str = "instrument.cantilever.frequency";
        let LeverSpec::Calibrated { stiffness, frequency } = self.base.instrument.cantilever.lever else {
            return None;
        };
        let mass = stiffness / (TAU * frequency).powi(2);
        let said = self.said.iter().find(|said| said.path == PATH && !said.swept)?;
        (!within(mass, LEVER_MASS)).then(|| {
            format!(
                "{}: a lever of {} at {} has an effective mass of {}, beyond what is usual ({}): check both and their units",
                self.place(&said.key),
                shown(stiffness, Dimension::Stiffness),
                shown(frequency, Dimension::Frequency),
                shown(mass, Dimension::Mass),
                described(LEVER_MASS, Dimension::Mass)
            )
        })
    }

    /// Where contact rings a rod that nothing calms.
    fn undamped_rod(&self) -> Option<String> {
        const PATH: &str = "instrument.actuator.quality_factor";
        let actuator = &self.base.instrument.actuator;
        let acted_upon = matches!(actuator.model, ActuatorModel::Coupled | ActuatorModel::AsPrinted);
        let undamped = match self.sweep.quantities().find(|axis| axis.path == PATH) {
            Some(axis) => axis.values.iter().any(|value| value.is_infinite()),
            None => actuator.quality_factor.is_infinite(),
        };
        let steady = self.run.start == Start::Steady && self.base.contact.law != LawChoice::None;
        (acted_upon && undamped && steady).then(|| {
            format!(
                "{}: an undamped rod never settles: every contact rings it, and nothing calms it; give \
                 [instrument.actuator] a quality_factor, or model = \"rigid\" where the rod does not matter",
                self.path.display()
            )
        })
    }
}
