//! A measured curve held against the samples' own, at each point of the sweep beside it.

use super::super::Verbosity;
use super::inference_messages::{InferenceAnswer, ObservedValues};
use super::{InferArgs, observed_curve, sweep_point};
use afmsweep::report::uncertainty::{Compared, Comparison, PredictionPath};
use afmsweep::stats::{
    CurveMeasurement, Fit, SampleCurve, Study, SummaryOptions, curve_posterior, quantity, stats_json,
};
use anyhow::Context;
use serde_json::{Map, Value};
use std::path::Path;

/// Places at which predictions are drawn along a measured curve.
const DRAWN: usize = 121;

/// What a measured curve tells, at each point of the axes beside it that is asked for.
pub(super) fn answers(
    study: &Study,
    file: &Path,
    args: &InferArgs,
    voice: Verbosity,
) -> anyhow::Result<Vec<InferenceAnswer>> {
    let seen = observed_curve::read(file, study, &args.curve)?;
    let all = seen.measured.places.len() + seen.outside + seen.other_way;
    let left_out = |count: usize, why: String| {
        let were = if count == 1 { "was" } else { "were" };
        if count > 0 {
            voice.say(format_args!("{count} of {all} rows of {} {were} left out: {why}", seen.file));
        }
    };
    let some = if seen.free.offset.is_some() {
        ", with some offset that is allowed; a smaller --offset or a longer [curve] keeps them"
    } else {
        ""
    };
    left_out(
        seen.outside,
        format!("beyond the curve, {}{some}", sweep_point::span(&study.beside[seen.axis])),
    );
    left_out(seen.other_way, "of a way that the results file does not have".to_owned());
    let mut fixed = sweep_point::fixed(study, &args.at)?;
    let beside = |axis: usize| axis != seen.axis && Some(axis) != study.ways();
    fixed.iter_mut().enumerate().filter(|(axis, _)| !beside(*axis)).for_each(|(_, at)| *at = Some(0));
    let one = |point: usize| {
        let mut at: Map<String, Value> = stats_json::place(study, point);
        let names = study.beside.iter().enumerate().filter(|(axis, _)| !beside(*axis));
        names.for_each(|(_, axis)| drop(at.remove(&axis.name)));
        let place = study.place(point);
        let curve = SampleCurve { study, axis: seen.axis, at: &place };
        let options = args.rows.options();
        let fit = curve_posterior(&curve, &seen.measured, &seen.free, &options)
            .with_context(|| sweep_point::named(&args.file, &at))?;
        if fit.bridged > 0 {
            voice.say(format_args!(
                "{} samples have points that are not ok, and are told by their neighbours there",
                fit.bridged
            ));
        }
        Ok(answer(&curve, (point, at), &seen, fit, &options))
    };
    sweep_point::points(study, &fixed).into_iter().map(one).collect()
}

fn answer(
    curve: &SampleCurve,
    (point, at): (usize, Map<String, Value>),
    seen: &observed_curve::ObservedCurve,
    fit: Fit,
    options: &SummaryOptions,
) -> InferenceAnswer {
    let panels = compared(curve, seen, &fit, options);
    let axis = curve.coordinate();
    let words = sweep_point::path(axis).rsplit('.').next().unwrap_or_default().replace('_', " ");
    let mut free = Vec::new();
    if let (Some(prior), Some(values)) = (seen.free.offset, &fit.offset) {
        let long = match seen.travels {
            true => format!("{words} without travel of the base"),
            false => format!("offset of the {words}"),
        };
        free.push((quantity(format!("{}_offset", axis.name), long, &axis.units, values), prior));
    }
    if let (Some(prior), Some(values), Some(first)) = (seen.free.scale, &fit.scale, seen.free.scaled.first())
    {
        let long = format!("factor of the measured {}", seen.free.scaled.join(", ").replace('_', " "));
        free.push((quantity(format!("{first}_scale"), long, "1", values), prior));
    }
    let along = match seen.travels {
        true => "travel of the base".to_owned(),
        false => words,
    };
    InferenceAnswer {
        at,
        point,
        found: fit.posterior,
        free,
        seen: ObservedValues::Curve(Comparison {
            file: seen.file.clone(),
            along,
            name: if seen.travels { "base_travel".to_owned() } else { axis.name.clone() },
            units: axis.units.clone(),
            rows: seen.measured.places.len(),
            values: seen.measured.values(),
            observables: seen.measured.columns.iter().map(|one| one.name.clone()).collect(),
            left_out: seen.outside + seen.other_way,
            panels,
        }),
    }
}

/// Every observable of the file along the measured curve, those that were measured first.
fn compared(
    curve: &SampleCurve,
    seen: &observed_curve::ObservedCurve,
    fit: &Fit,
    options: &SummaryOptions,
) -> Vec<Compared> {
    let study = curve.study;
    let measured = &seen.measured;
    let column = |output: usize| measured.columns.iter().find(|one| one.name == study.outputs[output].name);
    let mut outputs: Vec<usize> = (0..study.outputs.len()).collect();
    outputs.sort_by_key(|output| column(*output).is_none());
    let one = |output: usize| {
        let way = |way: usize| {
            let places = places(measured, way);
            let band = curve.predicted(fit, output, (way, &places), (&seen.free, options)).into_iter();
            let sign = if seen.travels { -1.0 } else { 1.0 };
            let points =
                measured.places.iter().zip(&measured.ways).enumerate().filter(|(_, (_, of))| **of == way);
            let point = |(row, (place, _)): (usize, (&f64, &usize))| {
                let column = column(output)?;
                Some((sign * place, column.values[row], column.sds[row]))
            };
            PredictionPath {
                name: study
                    .ways()
                    .and_then(|axis| study.beside[axis].words.get(way).cloned())
                    .unwrap_or_default(),
                points: points.filter_map(point).filter(|point| point.1.is_finite()).collect(),
                band: band.zip(&places).map(|(band, at)| (sign * at, band)).collect(),
            }
        };
        let ways = measured.ways.iter().max().map_or(0, |most| most + 1);
        let used = (0..ways).filter(|one| measured.ways.contains(one));
        Compared { output, ways: used.map(way).collect() }
    };
    outputs.into_iter().map(one).collect()
}

/// Places between the first and the last row of a way.
fn places(measured: &CurveMeasurement, way: usize) -> Vec<f64> {
    let of = measured.places.iter().zip(&measured.ways).filter(|(_, of)| **of == way);
    let (low, high) = sweep_point::ends(of.map(|(place, _)| place));
    (0..DRAWN).map(|n| low + (high - low) * n as f64 / (DRAWN - 1) as f64).collect()
}
