//! Which sizes a quantity has in an instrument that can be built, and which no matter has at all.
//!
//! Beyond what is usual a scene runs with a warning: hard cases are made of such values. Beyond what is
//! possible it is refused: a slip of the unit or the exponent is likelier than a reason. So whatever is common in
//! a microscope, taken 1e9 times (`N/nm` for `N/m`, `m` for `nm`), is refused
//! (`cli_sense::a_slip_of_nine_powers_is_refused`).

use super::address::Address;
use super::params::{ActuatorModel, LawChoice};
use super::scene_error::{Checked, Fault, line_column};
use super::{Scene, Start};
use crate::units::{Dimension, format as written};
use std::ops::Range;

/// Sizes of one quantity, SI, signs apart; zero and `inf` are the domain's to judge.
struct Sizes {
    path: &'static str,
    usual: [f64; 2],
    possible: [f64; 2],
}

/// Lengths of solid parts, m.
const PARTS: [f64; 2] = [1e-11, 0.1];
/// Lengths of levers, m, and of rods.
const LEVERS: [f64; 2] = [1e-11, 1.0];
const RODS: [f64; 2] = [1e-9, 1e3];
/// How far a tip, its base and its gap go, m.
const PATHS: [f64; 2] = [1e-21, 0.1];
/// Moduli, Pa: a hundred times a diamond's, so that a part can be as good as rigid; and less than any gel has.
const MODULI: [f64; 2] = [1e-2, 1e14];
const DENSITIES: [f64; 2] = [1.0, 1e5];
const FREQUENCIES: [f64; 2] = [1e-4, 1e11];
const QUALITIES: [f64; 2] = [0.5, 1e12];
const ANY: [f64; 2] = [0.0, f64::INFINITY];

const fn sizes(path: &'static str, usual: [f64; 2], possible: [f64; 2]) -> Sizes {
    Sizes { path, usual, possible }
}

static SIZES: &[Sizes] = &[
    sizes("instrument.actuator.youngs_modulus", [1e8, 1e12], MODULI),
    sizes("instrument.actuator.density", [100.0, 3e4], DENSITIES),
    sizes("instrument.actuator.h33", [1e6, 1e11], [1e3, 1e14]),
    sizes("instrument.actuator.beta33", [1e5, 1e12], [1e2, 1e15]),
    sizes("instrument.actuator.length", [1e-6, 1.0], RODS),
    sizes("instrument.actuator.width", [1e-6, 1.0], RODS),
    sizes("instrument.actuator.thickness", [1e-6, 1.0], RODS),
    sizes("instrument.actuator.quality_factor", [0.5, 1e7], QUALITIES),
    sizes("instrument.cantilever.youngs_modulus", [1e6, 2e12], MODULI),
    sizes("instrument.cantilever.density", [100.0, 3e4], DENSITIES),
    sizes("instrument.cantilever.length", [1e-7, 1e-2], LEVERS),
    sizes("instrument.cantilever.width", [1e-8, 1e-2], LEVERS),
    sizes("instrument.cantilever.thickness", [1e-10, 1e-3], LEVERS),
    sizes("instrument.cantilever.stiffness", [1e-5, 1e5], [1e-7, 5e6]),
    sizes("instrument.cantilever.frequency", [10.0, 1e9], FREQUENCIES),
    sizes("instrument.cantilever.modes.#.stiffness", [1e-5, 1e7], [1e-7, 5e8]),
    sizes("instrument.cantilever.modes.#.frequency", [10.0, 1e10], FREQUENCIES),
    sizes("instrument.cantilever.modes.#.quality_factor", [0.5, 1e7], QUALITIES),
    sizes("instrument.cantilever.modes.#.drive", [1e-6, 1e6], ANY),
    sizes("instrument.cantilever.quality_factor", [0.5, 1e7], QUALITIES),
    sizes("instrument.cantilever.quality_factor.#", [0.5, 1e7], QUALITIES),
    sizes("instrument.tip.half_length", [1e-9, 1e-3], PARTS),
    sizes("instrument.tip.width", [1e-9, 1e-3], PARTS),
    sizes("instrument.tip.height", [1e-9, 1e-3], PARTS),
    sizes("instrument.tip.density", [100.0, 3e4], DENSITIES),
    sizes("instrument.tip.mass", [1e-21, 1e-7], [1e-24, 1e-6]),
    sizes("instrument.tip.radius", [1e-10, 1e-3], PARTS),
    sizes("instrument.tip.youngs_modulus", [1e3, 2e12], MODULI),
    sizes("instrument.tip.poisson_ratio", [0.0, 0.5], ANY),
    sizes("sample.youngs_modulus", [10.0, 2e12], MODULI),
    sizes("sample.poisson_ratio", [0.0, 0.5], ANY),
    sizes("sample.surface_energy", [1e-9, 10.0], [1e-15, 1e3]),
    sizes("sample.hamaker", [1e-24, 1e-17], [1e-27, 1e-14]),
    sizes("contact.decay_length", [1e-12, 1e-8], [1e-16, 1e-6]),
    sizes("drive.voltage", [1e-9, 1e4], [1e-12, 1e6]),
    sizes("drive.free_amplitude", [1e-15, 1e-3], PATHS),
    sizes("drive.base_amplitude", [1e-18, 1e-3], PATHS),
    sizes("approach.gap", [0.0, 1e-3], PATHS),
    sizes("approach.setpoint", [0.05, 360.0], ANY),
    sizes("approach.deepest", [1e-12, 1e-3], PATHS),
    sizes("approach.force_setpoint", [1e-14, 1e-3], [1e-17, 1e-2]),
];
/// Drives, of which the right size depends on the lever.
static DRIVES: &[Sizes] =
    &[sizes("drive.frequency", [0.1, 1e9], FREQUENCIES), sizes("drive.force", [1e-18, 1e-2], [1e-21, 0.1])];

fn sizes_of(address: Address) -> Option<&'static Sizes> {
    SIZES.iter().chain(DRIVES).find(|sizes| sizes.path == address.quantity.path)
}

/// Whether zero, infinite, or within the bounds but for its sign.
fn within(value: f64, [least, most]: [f64; 2]) -> bool {
    value == 0.0 || value.is_infinite() || (least..=most).contains(&value.abs())
}

/// The bounds as a phrase.
fn described([least, most]: [f64; 2], dimension: Dimension) -> String {
    let end = |value: f64| match dimension {
        Dimension::Dimensionless if !(1e-3..1e5).contains(&value) => format!("{value:e}"),
        _ => written(value, dimension),
    };
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
    let Some(sizes) = sizes_of(address).filter(|sizes| !within(number, sizes.possible)) else {
        return Ok(());
    };
    let dimension = address.quantity.dimension;
    let infinite = address.quantity.domain.holds(f64::INFINITY);
    Err(Fault::at(place, format!("`{}` has an impossible size", address.path()))
        .label(format!("found {}", found()))
        .expected(format!(
            "a size {}{}; {} is usual",
            described(sizes.possible, dimension),
            if infinite { ", or inf" } else { "" },
            described(sizes.usual, dimension)
        ))
        .help("check the exponent and the unit"))
}

impl Scene {
    /// What is odd about the scene though it can be run: sizes beyond what instruments and samples have, and a rod
    /// that rings for ever. One line each, with its place in the file.
    pub fn warnings(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.said.iter().filter_map(|said| self.odd(said)).collect();
        lines.extend(self.drawn.odd.iter().map(|(key, line)| format!("{}: {line}", self.place(key))));
        lines.extend(self.undamped_rod());
        lines
    }

    fn odd(&self, said: &super::draft::Said) -> Option<String> {
        let address = Address::find(&said.path)?;
        let sizes = sizes_of(address)?;
        let odd = |value: &f64| !within(*value, sizes.usual);
        let value = match self.sweep.quantities().find(|axis| axis.path == said.path) {
            // The axis replaces what a section says.
            Some(_) if !said.swept => return None,
            Some(axis) => axis.values.iter().copied().find(odd)?,
            None => address.get(&self.base).filter(odd)?,
        };
        let dimension = address.quantity.dimension;
        Some(format!(
            "{}: {} = {} is beyond what is usual ({}): check it",
            self.place(&said.key),
            said.path,
            written(value, dimension),
            described(sizes.usual, dimension)
        ))
    }

    /// A place as messages write it: `file:line:column`.
    fn place(&self, key: &Range<usize>) -> String {
        let text = self.source.strip_prefix('\u{FEFF}').unwrap_or(&self.source);
        let (line, column) = line_column(text, key.start);
        format!("{}:{line}:{column}", self.path.display())
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
