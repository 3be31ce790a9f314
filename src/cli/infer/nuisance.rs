//! What is not known of a measured curve, from the command line: an offset of its places, a factor of its values.

use super::sweep_point::{self, path};
use super::value::range;
use afmsweep::design::Distribution;
use afmsweep::report::shown;
use afmsweep::stats::{CurveMeasurement, Study};
use anyhow::{Context, bail};

/// What an instrument calls whatever it reads from the lever's bend.
pub(super) const DEFLECTION: &str = "deflection";
/// Standard deviation of the logarithm of a factor that nothing is said of.
const USUAL_SCALE: f64 = 0.1;

/// The prior of the offset, flat: as the option says, or as far as all rows of `file` stay within the curve.
pub(super) fn offset(
    option: &str,
    (study, axis): (&Study, usize),
    (file, measured): (&str, &CurveMeasurement),
) -> anyhow::Result<Distribution> {
    let coordinate = &study.beside[axis];
    let name = path(coordinate);
    let (asked, told) = option.split_once('=').map_or((option, None), |(a, b)| (a.trim(), Some(b.trim())));
    if sweep_point::axis(study, asked) != Some(axis) {
        bail!("--offset {asked}: expected {name}, which the curve runs along");
    }
    if let Some(told) = told {
        let form = || format!("--offset {option}: write it as {name}=\"-5 nm to 5 nm\"");
        let (from, to) = range(told, &coordinate.units).with_context(form)?;
        return Ok(Distribution::Uniform { from, to });
    }
    let (low, high) = sweep_point::ends(coordinate.values.iter());
    let (first, last) = sweep_point::ends(measured.places.iter());
    let (from, to) = (low - first, high - last);
    if from < to {
        return Ok(Distribution::Uniform { from, to });
    }
    bail!(
        "--offset {asked}: the rows of {file} span {}, and the curve, {}, leaves no room for an offset; make the curve \
         longer, or give a range, which leaves out the rows that do not fit: {name}=\"-5 nm to 5 nm\"",
        shown(last - first, &coordinate.units, 4),
        sweep_point::span(coordinate)
    )
}

/// The observables that share an unknown factor, and its prior.
pub(super) fn scale(
    option: &str,
    measured: &CurveMeasurement,
) -> anyhow::Result<(Vec<String>, Distribution)> {
    let (names, told) = option.split_once('=').map_or((option, None), |(a, b)| (a, Some(b.trim())));
    let lengths: Vec<&str> = measured.columns.iter().map(|one| one.name.as_str()).collect();
    let lengths: Vec<&str> = lengths.into_iter().filter(|name| !name.ends_with("phase")).collect();
    let mut scaled = Vec::new();
    for name in names.split(',').map(str::trim) {
        // What is read from the lever's deflection has its sensitivity in common.
        let is = |one: &&&str| **one == name || (name == DEFLECTION && one.starts_with(name));
        let found: Vec<String> = lengths.iter().filter(is).map(|one| (*one).to_owned()).collect();
        if found.is_empty() {
            bail!("--scale {name}: expected one of what was measured: {}", lengths.join(", "));
        }
        scaled.extend(found);
    }
    let form =
        || format!("--scale {option}: write it as {names}, {names}=\"10 %\" or {names}=\"0.8 to 1.25\"");
    let lognormal = |sigma| Distribution::LogNormal { median: 1.0, sigma, from: None, to: None };
    let prior = match told.map(|told| (told, told.strip_suffix('%'))) {
        None => lognormal(USUAL_SCALE),
        Some((_, Some(percent))) => {
            let percent =
                percent.trim().parse::<f64>().ok().filter(|percent| *percent > 0.0 && *percent <= 100.0);
            lognormal(percent.with_context(form)? / 100.0)
        }
        Some((told, None)) => {
            let (from, to) = range(told, "1").with_context(form)?;
            if from <= 0.0 {
                bail!("--scale {option}: a factor is above zero");
            }
            Distribution::Uniform { from, to }
        }
    };
    Ok((scaled, prior))
}
