//! Quantities of observables as people write them: `14.2 nm`, `55 deg`.

use afmsweep::units::{self, Dimension};
use anyhow::{anyhow, bail};

/// The unit of phases in results files.
const DEGREE: &str = "degree";
/// How people write it.
const DEGREES: [&str; 4] = ["degrees", "degree", "deg", "°"];

/// A quantity in the unit of the results file.
pub(super) fn si(text: &str, units: &str) -> anyhow::Result<f64> {
    let text = text.trim();
    if units != DEGREE {
        return units::parse(text, dimension(units)).map_err(|error| anyhow!("{error}"));
    }
    let number = DEGREES.into_iter().find_map(|unit| text.strip_suffix(unit));
    let value = number.and_then(|number| number.trim().parse().ok());
    value.ok_or_else(|| anyhow!("\"{text}\" is no angle in degrees; write \"55 deg\""))
}

/// `-5 nm to 5 nm`, as a distribution has its ends.
pub(super) fn range(text: &str, units: &str) -> anyhow::Result<(f64, f64)> {
    let Some((from, to)) = text.split_once(" to ") else { bail!("no range; write it as \"FROM to TO\"") };
    let (from, to) = (si(from, units)?, si(to, units)?);
    if from >= to {
        bail!("the range ends where it begins, or before; write the smaller value first");
    }
    Ok((from, to))
}

fn dimension(units: &str) -> Dimension {
    Dimension::ALL.into_iter().find(|one| one.si_unit() == units).unwrap_or(Dimension::Dimensionless)
}

/// Whether a number may have this unit; otherwise what was expected.
pub(super) fn fits(unit: &str, units: &str) -> Result<(), String> {
    let example = match units {
        DEGREE => "an angle, such as [deg]".to_owned(),
        "1" | "" => "a number without unit".to_owned(),
        _ => {
            let example = dimension(units).example().trim_matches('"').split_once(' ');
            format!("{}, such as [{}]", dimension(units).described(), example.map_or(units, |(_, unit)| unit))
        }
    };
    si(&format!("1 {unit}"), units).map(|_| ()).map_err(|_| example)
}
