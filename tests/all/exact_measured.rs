//! A measured curve held against the samples' own, where the answer is known: linear curves, Gaussian errors, flat or normal
//! priors, so that the posterior is that of linear regression.

use crate::study::*;
use afmsweep::design::{DesignKind, Distribution, Mix, Settings, normal_quantile};
use afmsweep::stats::{
    CurveColumn, CurveMeasurement, Fit, FreeParameter, SampleCurve, Study, SummaryOptions, curve_posterior,
};
use afmsweep::store::{Coordinate, Flags, Results, Variable};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Gaps of the model's curves, falling as on an approach, in steps that differ.
const GAPS: [f64; 9] = [24.0, 21.5, 20.0, 17.0, 16.0, 14.5, 12.0, 11.0, 8.0];
const SLOPES: [f64; 2] = [0.9, 3.0];
const SDS: [f64; 2] = [0.3, 0.8];

fn normal(place: u64, column: u64) -> f64 {
    normal_quantile(Mix::new(0xc0de).of(place).of(column).share())
}

fn prior() -> [Distribution; 2] {
    let one = |mean, sd| Distribution::Normal { mean, sd, from: None, to: None };
    [one(2.0, 0.4), one(-1.0, 0.9)]
}

/// A file whose observables over the gap are this function of a sample's two parameters and the gap.
fn curves(samples: usize, model: impl Fn([f64; 2], f64) -> [f64; 2]) -> Results {
    let settings = Settings { seed: 3, ..settings(DesignKind::Sobol, samples, 2) };
    let mut results = results(settings, &prior(), |_| 0.0);
    let columns = &results.axes[0].columns;
    let rows: Vec<[f64; 2]> = (0..samples).map(|n| [columns[0].values[n], columns[1].values[n]]).collect();
    let variable = |name: &str, units: &str, which: usize| Variable {
        name: name.into(),
        units: units.into(),
        long_name: name.into(),
        data: rows.iter().flat_map(|row| GAPS.map(|gap| model(*row, gap)[which])).collect(),
        ..Variable::default()
    };
    results.variables = vec![variable("amplitude", "m", 0), variable("phase", "degree", 1)];
    results.axes.push(Coordinate {
        name: "approach_gap".into(),
        units: "m".into(),
        long_name: "gap".into(),
        scene_path: "approach.gap".into(),
        values: Arc::new(GAPS.to_vec()),
        ..Coordinate::default()
    });
    let count = samples * GAPS.len();
    (results.status, results.steps_per_period) = (vec![0; count], vec![1; count]);
    let meanings = ["continuous", "jump"].map(str::to_owned).to_vec();
    results.flags = vec![Flags { name: "jump".into(), meanings, data: vec![0; count], ..Flags::default() }];
    results
}

fn linear([a, b]: [f64; 2], gap: f64) -> [f64; 2] {
    [a + SLOPES[0] * gap, b + SLOPES[1] * gap]
}

/// What is measured of a truth at 30 places, before an offset and with a factor of the amplitude.
fn measured(model: impl Fn(f64) -> [f64; 2], offset: f64, factor: f64) -> CurveMeasurement {
    let places: Vec<f64> = (0..30).map(|n| 21.0 - 0.34 * n as f64).collect();
    let column = |which: usize, name: &str, factor: f64| CurveColumn {
        name: name.into(),
        values: (0..30)
            .map(|n| factor * model(places[n] + offset)[which] + SDS[which] * normal(n as u64, which as u64))
            .collect(),
        sds: vec![SDS[which]; 30],
    };
    let columns = vec![column(0, "amplitude", factor), column(1, "phase", 1.0)];
    CurveMeasurement { ways: vec![0; 30], places, columns }
}

fn fit(results: &Results, measured: &CurveMeasurement, free: &FreeParameter) -> (Study, Fit) {
    let study = Study::of(results).unwrap();
    let curve = SampleCurve { study: &study, axis: 0, at: &[0] };
    let fit = curve_posterior(&curve, measured, free, &SummaryOptions::default()).unwrap();
    (study, fit)
}

/// Mean and standard deviations of a linear model's unknowns: `rows` of coefficients, each with what it gave and its
/// standard deviation. Priors are rows as well.
fn regression(unknowns: usize, rows: &[(Vec<f64>, f64, f64)]) -> Vec<(f64, f64)> {
    let (mut precision, mut pull) = (DMatrix::zeros(unknowns, unknowns), DVector::zeros(unknowns));
    for (coefficients, value, sd) in rows {
        let row = DVector::from_row_slice(coefficients) / *sd;
        precision += &row * row.transpose();
        pull += row * (*value / sd);
    }
    let covariance = precision.try_inverse().unwrap();
    let mean = &covariance * pull;
    (0..unknowns).map(|n| (mean[n], covariance[(n, n)].sqrt())).collect()
}

/// Holds quantiles and standard deviation against a normal posterior, as well as so many effective samples can know them.
fn is_normal(fit: &Fit, values: &[f64], (mean, sd): (f64, f64), what: &str) {
    let found = &fit.posterior;
    let known = 4.0 * sd / found.effective.sqrt();
    assert!((found.mean(values) - mean).abs() < known, "{what}: {} not {mean}", found.mean(values));
    assert!((found.sd(values) - sd).abs() < known, "{what}: {} not {sd}", found.sd(values));
    for share in [0.025, 0.5, 0.975] {
        let truth = mean + sd * normal_quantile(share);
        let off = (found.quantile(values, share) - truth).abs();
        assert!(off < 2.5 * known, "{what} {share}: off by {off}, {known}");
    }
}

/// The rows of the regression: the priors, then the measured values less what is known of them.
fn rows(measured: &CurveMeasurement, with_offset: bool) -> Vec<(Vec<f64>, f64, f64)> {
    let unit = |n: usize, of: f64| (0..3).map(|k| if k == n { of } else { 0.0 }).collect::<Vec<f64>>();
    let mut rows = vec![(unit(0, 1.0), 2.0, 0.4), (unit(1, 1.0), -1.0, 0.9)];
    for (which, column) in measured.columns.iter().enumerate() {
        for (place, value) in measured.places.iter().zip(&column.values) {
            let mut coefficients = unit(which, 1.0);
            coefficients[2] = if with_offset { SLOPES[which] } else { 0.0 };
            rows.push((coefficients, value - SLOPES[which] * place, SDS[which]));
        }
    }
    if !with_offset {
        // Known to be none.
        rows.push((unit(2, 1.0), 0.0, 1e-3));
    }
    rows
}

#[test]
fn a_known_gap_gives_the_posterior_of_linear_regression() {
    let results = curves(1 << 13, linear);
    let measured = measured(|gap| linear([2.3, -1.4], gap), 0.0, 1.0);
    let (study, fit) = fit(&results, &measured, &FreeParameter::default());
    let truth = regression(3, &rows(&measured, false));
    for (n, (parameter, truth)) in study.parameters.iter().zip(&truth).enumerate() {
        is_normal(&fit, &parameter.values, *truth, &format!("parameter {n}"));
    }
    assert!(fit.offset.is_none() && fit.scale.is_none() && fit.bridged == 0);
    // Of 60 values with two unknowns.
    assert!((30.0..95.0).contains(&fit.posterior.best_chi_squared), "{}", fit.posterior.best_chi_squared);
}

#[test]
fn an_unknown_offset_is_one_more_unknown_of_the_regression() {
    let results = curves(1 << 12, linear);
    let measured = measured(|gap| linear([2.3, -1.4], gap), 0.7, 1.0);
    let offset = Some(Distribution::Uniform { from: -2.0, to: 2.0 });
    let (study, fit) = fit(&results, &measured, &FreeParameter { offset, ..FreeParameter::default() });
    let truth = regression(3, &rows(&measured, true));
    for (n, (parameter, truth)) in study.parameters.iter().zip(&truth).enumerate() {
        is_normal(&fit, &parameter.values, *truth, &format!("parameter {n}"));
    }
    is_normal(&fit, fit.offset.as_ref().unwrap(), truth[2], "offset");
    let (parameter, offset) = (&study.parameters[1].values, fit.offset.as_ref().unwrap());
    assert!(fit.posterior.correlation(parameter, offset) < -0.5, "they make up for each other");
}

/// A flat prior of the factor over a constant amplitude: normal around the mean over that amplitude. A lognormal one: an
/// integral over the factor, here as a sum over a fine grid.
#[test]
fn an_unknown_factor_is_told_beside_an_offset() {
    let model = |[_, b]: [f64; 2], gap: f64| [10.0, b + SLOPES[1] * gap];
    let results = curves(1 << 12, model);
    let measured = measured(|gap| model([2.3, -1.4], gap), 0.7, 1.08);
    let mean = measured.columns[0].values.iter().sum::<f64>() / 30.0 / 10.0;
    let sd = SDS[0] / 10.0 / 30f64.sqrt();
    let offset = Some(Distribution::Uniform { from: -2.0, to: 2.0 });
    let scaled = vec!["amplitude".to_owned()];
    for sigma in [None, Some(0.02), Some(0.002)] {
        let prior = sigma.map_or(Distribution::Uniform { from: 0.5, to: 2.0 }, |sigma| {
            Distribution::LogNormal { median: 1.0, sigma, from: None, to: None }
        });
        let free = FreeParameter { offset, scale: Some(prior), scaled: scaled.clone() };
        let (_, fit) = fit(&results, &measured, &free);
        let density = |f: f64| {
            let prior = sigma.map_or(0.0, |sigma: f64| -0.5 * (f.ln() / sigma).powi(2) - f.ln());
            (prior - 0.5 * ((f - mean) / sd).powi(2)).exp()
        };
        let grid: Vec<f64> = (0..100_000).map(|n| 0.9 + 0.3 * n as f64 / 1e5).collect();
        let moment = |power: i32| grid.iter().map(|f| f.powi(power) * density(*f)).sum::<f64>();
        let (first, second) = (moment(1) / moment(0), moment(2) / moment(0));
        let truth = (first, (second - first * first).sqrt());
        is_normal(&fit, fit.scale.as_ref().unwrap(), truth, &format!("factor {sigma:?}"));
        let rows: Vec<_> = rows(&measured, true).into_iter().filter(|(row, ..)| row[0] == 0.0).collect();
        let rows: Vec<_> = rows.into_iter().map(|(row, value, sd)| (row[1..].to_vec(), value, sd)).collect();
        is_normal(&fit, fit.offset.as_ref().unwrap(), regression(2, &rows)[1], "offset");
    }
}

/// Between 16 and 14.5 the model jumps by 40 times the error: a value on either side agrees, one halfway does not, and no
/// sample is pulled by where it stands.
#[test]
fn nothing_is_interpolated_across_a_jump() {
    let model = |[a, b]: [f64; 2], gap: f64| [a + if gap > 15.0 { 12.0 } else { 0.0 }, b];
    let mut results = curves(1 << 10, model);
    for sample in results.flags[0].data.chunks_mut(GAPS.len()) {
        sample[5] = 1;
    }
    let at = |value: f64| CurveMeasurement {
        places: vec![18.0, 15.25],
        ways: vec![0, 0],
        columns: vec![CurveColumn { name: "amplitude".into(), values: vec![14.1, value], sds: vec![0.3; 2] }],
    };
    for value in [14.1, 2.1] {
        let (study, fit) = fit(&results, &at(value), &FreeParameter::default());
        let truth = regression(1, &[(vec![1.0], 2.0, 0.4), (vec![1.0], 2.1, 0.3), (vec![1.0], 2.1, 0.3)]);
        is_normal(&fit, &study.parameters[0].values, truth[0], "parameter");
        assert!(fit.posterior.best_chi_squared < 3.0);
    }
    let study = Study::of(&results).unwrap();
    let curve = SampleCurve { study: &study, axis: 0, at: &[0] };
    let halfway = curve_posterior(&curve, &at(8.1), &FreeParameter::default(), &SummaryOptions::default());
    assert!(halfway.unwrap_err().to_string().contains("standard deviations in all"));
    // Without the mark it is a slope like any other.
    results.flags[0].data.fill(0);
    let (_, fit) = fit(&results, &at(8.1), &FreeParameter::default());
    assert!(fit.posterior.best_chi_squared < 3.0);
}

/// One point that failed is told by its neighbours; a hole where something was measured leaves the sample out, one beyond it
/// does not.
#[test]
fn failed_points_are_told() {
    let mut results = curves(1 << 11, linear);
    let measured = measured(|gap| linear([2.3, -1.4], gap), 0.0, 1.0);
    let fail = |results: &mut Results, sample: usize, points: std::ops::Range<usize>| {
        results.status[sample * GAPS.len()..][points.clone()].fill(1);
        for variable in &mut results.variables {
            variable.data[sample * GAPS.len()..][points.clone()].fill(f64::NAN);
        }
    };
    fail(&mut results, 7, 4..5);
    fail(&mut results, 8, 3..6);
    // The measured rows begin at 21, below 21.5.
    fail(&mut results, 9, 0..1);
    let (_, found) = fit(&results, &measured, &FreeParameter::default());
    assert_eq!((found.bridged, found.posterior.left_out), (1, 1));
    assert!(!found.posterior.rows.contains(&8) && found.posterior.rows.contains(&9));
    for sample in 100..210 {
        fail(&mut results, sample, 3..6);
    }
    let study = Study::of(&results).unwrap();
    let curve = SampleCurve { study: &study, axis: 0, at: &[0] };
    let refused = curve_posterior(&curve, &measured, &FreeParameter::default(), &SummaryOptions::default());
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("111 of 2048 rows cannot count") && refused.contains("not_steady"), "{refused}");
}
