//! Which pictures a results file gets.

use super::ReportError;
use super::band::{self, Band};
use super::error_floor::SCALES;
use super::force_curve;
use super::frame::{Legend, State, Tally};
use super::hover::Hover;
use super::labels::{capital, caption};
use super::picture::{Picture, PictureKind, places, states};
use super::quantity_text::DisplayUnit;
use super::view_request::{View, ViewRequest};
use super::{csv, curve_forces, harmonics, variable, waveform};
use crate::store::{Coordinate, ForceCurve, Results, Variable};

/// Pictures of single instances at most, of each kind.
const MOST_INSTANCES: usize = 24;

/// What a page shows, and what it does not: a line for each.
pub(super) struct DrawnPicture {
    pub pictures: Vec<Picture>,
    pub left_out: Vec<String>,
}

/// All pictures: one for each variable that varies by more than its error, then waveforms, then force curves.
pub(super) fn all(results: &Results, wish: &ViewRequest) -> Result<DrawnPicture, ReportError> {
    if !results.list {
        // A wish that cannot be met is told whatever there is to draw.
        View::of(results, wish)?;
    }
    let (mut pictures, mut undrawn) = (Vec::new(), Vec::new());
    for one in results.variables.iter().filter(|one| !SCALES.contains(&one.name.as_str())) {
        match says_nothing(results, one) {
            Some(line) => undrawn.push(line),
            None => {
                pictures.extend(variable::draw(results, one, wish)?);
                pictures.extend(band_of(results, one)?);
            }
        }
    }
    if let Some(waveforms) = &results.waveforms {
        for (row, instance) in waveforms.instances.iter().enumerate().take(MOST_INSTANCES) {
            let title = with_case(results, &format!("Waveform of instance {instance}"), *instance);
            let svg = waveform::draw(waveforms, row, &title, curve_forces::sticks(results, *instance))?;
            let note = left_out(row, waveforms.instances.len(), "waveforms");
            let name = format!("waveform_{instance}");
            let csv = Some(csv::of_waveform(waveforms, row));
            let hover = Hover::default();
            pictures.push(Picture { kind: PictureKind::Asked, name, title, note, svg, hover, csv });
        }
    }
    if let Some(spectra) = &results.spectra {
        for (row, instance) in spectra.instances.iter().enumerate().take(MOST_INSTANCES) {
            let title = with_case(results, &format!("Spectrum of instance {instance}"), *instance);
            let (svg, hover) = harmonics::draw(spectra, row, &title)?;
            let note = format!(
                "{} {}",
                harmonics::told(spectra, row),
                left_out(row, spectra.instances.len(), "spectra")
            );
            let (kind, name) = (PictureKind::Spectrum, format!("spectrum_{instance}"));
            let csv = Some(harmonics::csv(spectra, row));
            pictures.push(Picture { kind, name, title, note: note.trim_end().to_owned(), svg, hover, csv });
        }
    }
    let mut instances: Vec<u64> = results.force_curves.iter().map(|curve| curve.instance).collect();
    instances.dedup();
    instances.sort_unstable();
    instances.dedup();
    for (row, instance) in instances.iter().enumerate().take(MOST_INSTANCES) {
        let told = curve_forces::forces(results, *instance);
        let laws = results.force_curves.iter().filter(|curve| curve.instance == *instance);
        let curves: Vec<&ForceCurve> = laws.chain(&told).collect();
        let title = with_case(results, &format!("Force curve of instance {instance}"), *instance);
        let svg = force_curve::draw(&curves, &title, curve_forces::decay_length(results, *instance))?;
        let note = left_out(row, instances.len(), "force curves");
        let name = format!("force_curve_{instance}");
        let csv = Some(csv::of_force_curves(&curves));
        let (kind, hover) = (PictureKind::Asked, Hover::default());
        pictures.push(Picture { kind, name, title, note, svg, hover, csv });
    }
    Ok(DrawnPicture { pictures, left_out: undrawn })
}

/// What an observable is over many curves.
fn band_of(results: &Results, variable: &Variable) -> Result<Option<Picture>, ReportError> {
    let kind = PictureKind::of(variable);
    if kind == PictureKind::Computed {
        return Ok(None);
    }
    let name = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    let title = format!("{}, median and bands", capital(name));
    Ok(band::draw(results, variable, &title)?.map(|Band { svg, note, csv }| Picture {
        kind,
        name: format!("{}_band", variable.name),
        title,
        note,
        svg,
        hover: Hover::default(),
        csv: Some(csv),
    }))
}

/// Why a variable of several instances needs no picture: it is nothing within its error everywhere, or the same.
fn says_nothing(results: &Results, variable: &Variable) -> Option<String> {
    if results.status.len() < 2 {
        return None;
    }
    let name = capital(if variable.long_name.is_empty() { &variable.name } else { &variable.long_name });
    let states = states(results, variable);
    let zeros = states.iter().filter(|(_, state)| *state == State::Zero).count();
    let values: Vec<f64> = states.iter().filter(|one| one.1.has_value()).map(|one| one.0).collect();
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    match (zeros, values.len()) {
        (0, 0) => Some(without(&name, &states)),
        (0, 1) => None,
        (zeros, 0) => Some(format!("{name}: 0 within its error in all {zeros} instances that have a value.")),
        (0, count) if high - low <= SAME * low.abs().max(high.abs()) => {
            let value = DisplayUnit::fitting(&variable.units, high.abs()).value(high);
            Some(format!("{name}: the same in all {count} instances that have a value, {value}."))
        }
        _ => None,
    }
}

/// That no instance has a value, and why.
fn without(name: &str, states: &[(f64, State)]) -> String {
    let tally = Tally::of(states.iter().map(|one| one.1));
    let words = tally.entries([Legend::Hatched; 5]).into_iter().map(|one| one.1).collect::<Vec<_>>();
    format!("{name}: no instance has a value: {}.", words.join(", "))
}

/// Values that differ by less than this share of themselves are the same.
const SAME: f64 = 1e-9;

fn left_out(row: usize, count: usize, what: &str) -> String {
    if row + 1 == MOST_INSTANCES && count > MOST_INSTANCES {
        format!("The other {} {what} are in the results file.", count - MOST_INSTANCES)
    } else {
        String::new()
    }
}

/// A title with the swept values of that instance.
fn with_case(results: &Results, title: &str, instance: u64) -> String {
    let Ok(instance) = usize::try_from(instance) else { return title.to_owned() };
    let one = |(axis, at): (&Coordinate, usize)| caption(axis, axis.values[at]);
    let parts: Vec<String> = places(results, instance).into_iter().map(one).collect();
    if parts.is_empty() { title.to_owned() } else { format!("{title}: {}", parts.join(", ")) }
}
