//! A measured curve from its file, held against what the results file has.

use super::nuisance::{self, DEFLECTION};
use super::sheet::Sheet;
use super::sweep_point::{self, path};
use super::value::fits;
use afmsweep::stats::{CurveMeasurement, FreeParameter, Study};
use afmsweep::store::Coordinate;
use afmsweep_data::suggestion;
use anyhow::{anyhow, bail};
use std::path::Path;

/// Columns that are no observables.
pub(super) const DIRECTION: &str = "direction";
const TRAVEL: [&str; 2] = ["base_travel", "travel"];
pub(super) const GAP: &str = "approach.gap";
/// What `deflection` stands for.
const MEAN: &str = "deflection_mean";
/// End of a column of standard deviations.
pub(super) const SD: &str = "_sd";

/// What the command line says of a measured curve.
#[derive(clap::Args)]
pub(super) struct CurveArgs {
    /// The standard deviation of an observable in all rows of a measured curve: amplitude="0.1 nm"; or a column NAME_sd
    #[arg(long = "sd", value_name = "NAME=SD", value_parser = sweep_point::pair)]
    pub sds: Vec<(String, String)>,
    /// The way that rows without a column `direction` were taken: approach, retraction, forward or backward
    #[arg(long, value_name = "WAY")]
    pub direction: Option<String>,
    /// The place of a measured curve is known but for an offset: approach.gap, or approach.gap="-5 nm to 5 nm"
    #[arg(long, value_name = "PATH[=RANGE]", allow_hyphen_values = true)]
    offset: Option<String>,
    /// Observables that are known but for one factor: deflection, or amplitude,deflection="10 %" or ="0.8 to 1.25"
    #[arg(long, value_name = "NAMES[=PRIOR]")]
    scale: Option<String>,
}

impl CurveArgs {
    /// The first option that only goes with a measured curve.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            ("--sd", !self.sds.is_empty()),
            ("--direction", self.direction.is_some()),
            ("--offset", self.offset.is_some()),
            ("--scale", self.scale.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(name, _)| name)
    }
}

/// A measured curve as it is weighed.
pub(super) struct ObservedCurve {
    pub file: String,
    pub measured: CurveMeasurement,
    pub free: FreeParameter,
    /// The axis it runs along, among those beside the samples.
    pub axis: usize,
    /// Whether the places are those of the base, which has the gap shrink.
    pub travels: bool,
    /// Rows that are left out: beyond the curve, and of a way that the file does not have.
    pub outside: usize,
    pub other_way: usize,
}

/// What a column of the file is.
#[derive(PartialEq)]
pub(super) enum CurvePart {
    Place { travels: bool },
    Direction,
    Value(usize),
    Sd(usize),
}

/// A file of a measured curve, and what it is held against.
pub(super) struct Reading<'a> {
    pub sheet: Sheet,
    pub study: &'a Study,
    pub args: &'a CurveArgs,
    axis: usize,
    pub parts: Vec<CurvePart>,
    /// Unit of each column, as the file has it.
    pub units: Vec<String>,
}

/// Reads a measured curve.
pub(super) fn read(file: &Path, study: &Study, args: &CurveArgs) -> anyhow::Result<ObservedCurve> {
    let sheet = Sheet::read(file)?;
    let (names, units): (Vec<String>, Vec<String>) = sheet.head.iter().map(|cell| split(cell)).unzip();
    let along = names.iter().enumerate().find_map(|(n, name)| Some((n, place_of(study, name)?)));
    let Some((_, (axis, _))) = along else {
        return Err(without_place(&sheet, study, &names));
    };
    let mut reading = Reading { sheet, study, args, axis, parts: Vec::new(), units };
    reading.parts = reading.head(&names)?;
    let (measured, other_way) = reading.rows()?;
    let travels = reading.parts.contains(&CurvePart::Place { travels: true });
    let mut seen = ObservedCurve {
        file: reading.sheet.name.clone(),
        free: FreeParameter::default(),
        axis,
        travels,
        outside: 0,
        other_way,
        measured,
    };
    match &args.offset {
        Some(option) => {
            let prior = nuisance::offset(option, (study, axis), (&seen.file, &seen.measured))?;
            seen.free.offset = Some(prior);
        }
        None if travels => {
            bail!("{}: a travel of the base says nothing of the gap by itself; add --offset {GAP}", seen.file)
        }
        None => {}
    }
    if let Some(option) = &args.scale {
        let (scaled, prior) = nuisance::scale(option, &seen.measured)?;
        (seen.free.scaled, seen.free.scale) = (scaled, Some(prior));
    }
    seen.outside = inside(&mut seen.measured, &study.beside[axis], seen.free.offsets());
    if seen.measured.values() == 0 {
        bail!(
            "{}: none of its {} rows lies within the curve, {}{}{}",
            seen.file,
            reading.sheet.rows.len(),
            sweep_point::span(&study.beside[axis]),
            if travels { "; the offset is the gap where the travel of the base is zero" } else { "" },
            if other_way > 0 { format!("; {other_way} are of the other way") } else { String::new() }
        );
    }
    Ok(seen)
}

/// A sheet of which no column says where along the curve its rows are.
fn without_place(sheet: &Sheet, study: &Study, names: &[String]) -> anyhow::Error {
    let known: Vec<&str> = study.beside.iter().filter(|one| one.words.is_empty()).map(path).collect();
    match known.as_slice() {
        [] => anyhow!(
            "the results file has samples alone, no curve to hold {} against; give its scene a [curve] or a [sweep] of the gap",
            sheet.name
        ),
        _ => anyhow!(
            "{} has no column that the curve runs along: expected one of {}{}; its first line that is no comment has {}",
            sheet.name,
            known.join(", "),
            if known.contains(&GAP) {
                ", or base_travel (a z piezo's, with --offset approach.gap)"
            } else {
                ""
            },
            names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// `gap [nm]` or `Gap (nm)`: name and unit.
fn split(cell: &str) -> (String, String) {
    let parts = |open: char, close: char| cell.strip_suffix(close).and_then(|head| head.rsplit_once(open));
    let (name, unit) = parts('[', ']').or_else(|| parts('(', ')')).unwrap_or((cell, ""));
    (name.trim().to_lowercase().replace(' ', "_"), unit.trim().to_owned())
}

/// The axis that a column of places belongs to, and whether it is the travel of the base.
fn place_of(study: &Study, name: &str) -> Option<(usize, bool)> {
    match TRAVEL.contains(&name) {
        true => sweep_point::axis(study, GAP).map(|axis| (axis, true)),
        false => sweep_point::axis(study, name).filter(|_| name != DIRECTION).map(|axis| (axis, false)),
    }
}

/// Takes the rows out that leave the curve under some offset; gives how many they are.
fn inside(measured: &mut CurveMeasurement, axis: &Coordinate, (least, most): (f64, f64)) -> usize {
    let (low, high) = sweep_point::ends(axis.values.iter());
    // Rounding of a decimal place.
    let hair = 1e-9 * (high - low);
    let kept: Vec<usize> = (0..measured.places.len())
        .filter(|row| {
            measured.places[*row] + least >= low - hair && measured.places[*row] + most <= high + hair
        })
        .collect();
    let outside = measured.places.len() - kept.len();
    let pick = |values: &[f64]| kept.iter().map(|row| values[*row]).collect::<Vec<f64>>();
    measured.places = pick(&measured.places);
    measured.ways = kept.iter().map(|row| measured.ways[*row]).collect();
    for column in &mut measured.columns {
        (column.values, column.sds) = (pick(&column.values), pick(&column.sds));
    }
    outside
}

impl Reading<'_> {
    pub fn coordinate(&self) -> &Coordinate {
        &self.study.beside[self.axis]
    }

    /// The observable of a column, by its name or an instrument's.
    pub fn output(&self, name: &str) -> Option<usize> {
        let name = if name == DEFLECTION { MEAN } else { name };
        self.study.output_number(name).ok()
    }

    /// What the columns are.
    fn head(&self, names: &[String]) -> anyhow::Result<Vec<CurvePart>> {
        let mut parts = Vec::new();
        for (n, name) in names.iter().enumerate() {
            let (part, units) = self.part(name)?;
            if names[..n].contains(name) {
                bail!("{}: column `{name}` stands twice", self.sheet.name);
            }
            if let Err(expected) = fits(&self.units[n], units)
                && part != CurvePart::Direction
            {
                bail!(
                    "{}, column `{}`: found {}, expected {expected}",
                    self.sheet.name,
                    self.sheet.head[n],
                    if self.units[n].is_empty() {
                        "no unit".into()
                    } else {
                        format!("the unit {}", self.units[n])
                    }
                );
            }
            parts.push(part);
        }
        let places = parts.iter().filter(|part| matches!(part, CurvePart::Place { .. })).count();
        if places > 1 {
            bail!("{}: found {places} columns of places, expected one of them", self.sheet.name);
        }
        Ok(parts)
    }

    fn part(&self, name: &str) -> anyhow::Result<(CurvePart, &str)> {
        let study = self.study;
        if name == DIRECTION {
            return Ok((CurvePart::Direction, ""));
        }
        if let Some((axis, travels)) = place_of(study, name) {
            if axis != self.axis {
                bail!(
                    "{}: found places along {} and along {}, expected one of them; --at picks a value of the other",
                    self.sheet.name,
                    path(self.coordinate()),
                    path(&study.beside[axis])
                );
            }
            return Ok((CurvePart::Place { travels }, &self.coordinate().units));
        }
        if let Some(number) = self.output(name) {
            return Ok((CurvePart::Value(number), &study.outputs[number].units));
        }
        if let Some(number) = name.strip_suffix(SD).and_then(|name| self.output(name)) {
            return Ok((CurvePart::Sd(number), &study.outputs[number].units));
        }
        let outputs = study.outputs.iter().map(|one| one.name.clone());
        let mut known: Vec<String> =
            vec![path(self.coordinate()).rsplit('.').next().unwrap_or_default().into()];
        known.extend((self.coordinate().scene_path == GAP).then(|| TRAVEL[0].to_owned()));
        known.extend(outputs.clone());
        let mut all = known.clone();
        all.extend(outputs.map(|one| one + SD).chain([DIRECTION.to_owned()]));
        let near = suggestion::nearest(name, all.iter().map(String::as_str));
        let meant = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        bail!(
            "{}: column `{name}` is neither a place nor an observable of the results file; expected {}, NAME_sd or direction{meant}",
            self.sheet.name,
            known.join(", ")
        )
    }
}
