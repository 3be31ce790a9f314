//! Indices, means and quantiles of functions whose answers are known in closed form, through the same path as observables.

use crate::study::*;
use afmsweep::design::{DesignKind, Distribution, Settings, normal_quantile};
use afmsweep::stats::{Estimate, SHARES, SensitivityIndices, Study, Summary, SummaryOptions, summary};
use std::f64::consts::PI;

fn told(study: &Study) -> Summary {
    summary(study, &study.outputs[0], 0, &SummaryOptions::default()).unwrap()
}

fn covers(one: &Estimate, truth: f64) -> bool {
    (one.value - truth).abs() <= one.half_width
}

/// All first and total indices.
fn sobol_indices(summary: &Summary) -> Vec<Estimate> {
    match &summary.indices {
        SensitivityIndices::Saltelli(all) => all.first.iter().chain(&all.total).copied().collect(),
        other => panic!("{other:?}"),
    }
}

/// 16,384 base samples: every index within 1 % of the variance and within twice its interval (of 18 intervals of 95 % one
/// fails by chance, none by twice its width: beyond 4 standard errors).
#[test]
fn indices_of_ishigami_and_g() {
    let (first, total) = ishigami_indices();
    let truth: Vec<f64> = first.into_iter().chain(total).collect();
    let told_of = told(&study(settings(DesignKind::Saltelli, 1 << 14, 3), &uniform(3, -PI, PI), ishigami));
    inside(&sobol_indices(&told_of), &truth);
    let (first, total) = g_indices();
    let truth: Vec<f64> = first.into_iter().chain(total).collect();
    let told_of = told(&study(settings(DesignKind::Saltelli, 1 << 14, 6), &uniform(6, 0.0, 1.0), g_function));
    inside(&sobol_indices(&told_of), &truth);
}

fn inside(found: &[Estimate], truth: &[f64]) {
    for (one, truth) in found.iter().zip(truth) {
        assert!((one.value - truth).abs() < 0.01 && one.half_width < 0.01, "{one:?}, not {truth}");
        assert!((one.value - truth).abs() < 2.0 * one.half_width + 1e-12, "{one:?}, not {truth}");
    }
    let hit = found.iter().zip(truth).filter(|(one, truth)| covers(one, **truth)).count();
    assert!(hit + 1 >= truth.len(), "{hit} of {} intervals cover", truth.len());
}

/// Shares of 1,000 repeats in which the interval covers the truth, by index.
fn coverage(
    distributions: &[Distribution],
    function: impl Fn(&[f64]) -> f64 + Sync,
    truth: &[f64],
) -> Vec<f64> {
    use rayon::prelude::*;
    const REPEATS: u64 = 1000;
    let one = |seed: u64| -> Vec<f64> {
        let settings = Settings { seed, ..settings(DesignKind::Saltelli, 1 << 10, distributions.len()) };
        let found = sobol_indices(&told(&study(settings, distributions, &function)));
        found.iter().zip(truth).map(|(one, truth)| f64::from(u8::from(covers(one, *truth)))).collect()
    };
    let sums = (0..REPEATS)
        .into_par_iter()
        .map(one)
        .reduce(|| vec![0.0; truth.len()], |a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect());
    sums.into_iter().map(|sum| sum / REPEATS as f64).collect()
}

/// 1,000 repeats tell a coverage of 95 % to 0.7 %.
#[test]
fn intervals_of_1024_samples_cover_the_truth_as_often_as_they_say() {
    let (first, total) = ishigami_indices();
    let truth: Vec<f64> = first.into_iter().chain(total).collect();
    let ishigami = coverage(&uniform(3, -PI, PI), ishigami, &truth);
    let (first, total) = g_indices();
    let truth: Vec<f64> = first.into_iter().chain(total).collect();
    let g = coverage(&uniform(6, 0.0, 1.0), g_function, &truth);
    let all: Vec<f64> = ishigami.iter().chain(&g).copied().collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!(all.iter().all(|share| (0.93..=0.97).contains(share)), "mean {mean}: {ishigami:?} {g:?}");
}

/// First-order indices by bins, from every kind of sample: within 0.02 of the truth, and of their intervals.
#[test]
fn bins_tell_first_order_of_any_sample() {
    let (truth, _) = ishigami_indices();
    for kind in [DesignKind::MonteCarlo, DesignKind::LatinHypercube, DesignKind::Sobol] {
        let found = told(&study(settings(kind, 1 << 14, 3), &uniform(3, -PI, PI), ishigami));
        let SensitivityIndices::Bins(first) = found.indices else { panic!("{kind:?}") };
        for (one, truth) in first.iter().zip(truth) {
            let miss = (one.value - truth).abs();
            assert!(miss < 0.02 && miss < 2.0 * one.half_width + 0.003, "{kind:?}: {one:?}, not {truth}");
        }
    }
}

/// Mean, standard deviation and quantiles of a sum of two normal numbers, by every kind.
#[test]
fn a_normal_output_has_its_mean_spread_and_quantiles() {
    let normal = |mean: f64, sd: f64| Distribution::Normal { mean, sd, from: None, to: None };
    for kind in [DesignKind::MonteCarlo, DesignKind::LatinHypercube, DesignKind::Sobol, DesignKind::Saltelli]
    {
        let sum = |x: &[f64]| x[0] + x[1];
        let found = told(&study(settings(kind, 1 << 12, 2), &[normal(3.0, 0.3), normal(1.0, 0.4)], sum));
        let spread = found.spread.unwrap();
        let near = |one: &Estimate, truth: f64| {
            assert!((one.value - truth).abs() < 1.6 * one.half_width, "{kind:?}: {one:?}, not {truth}");
            assert!(one.half_width < 0.1, "{kind:?}: {one:?}");
        };
        near(&spread.mean, 4.0);
        near(&spread.sd, 0.5);
        for (share, one) in SHARES.iter().zip(&spread.quantiles) {
            near(one, 4.0 + 0.5 * normal_quantile(*share));
        }
        // Balanced points know the mean far better than random ones, and their intervals say so.
        let half_width = spread.mean.half_width;
        assert!(
            (kind == DesignKind::MonteCarlo || kind == DesignKind::LatinHypercube) == (half_width > 2e-3),
            "{kind:?}"
        );
    }
}

/// Effects of a linear function are its coefficients times the ranges, without spread.
#[test]
fn effects_of_a_linear_function_are_its_slopes() {
    let linear = |x: &[f64]| 2.0 * x[0] - 3.0 * x[1] + x[2] * 0.0;
    let found = told(&study(settings(DesignKind::Morris, 40, 3), &uniform(3, -1.0, 1.0), linear));
    let SensitivityIndices::Morris(effects) = found.indices else { panic!() };
    for (n, slope) in [4.0, -6.0, 0.0].into_iter().enumerate() {
        assert!((effects.mu[n] - slope).abs() < 1e-12 && effects.sigma[n] < 1e-12, "{effects:?}");
        assert!((effects.mu_star[n].value - slope.abs()).abs() < 1e-12, "{effects:?}");
    }
    assert!(found.spread.is_none());
}

/// Failed rows take their base samples with them, are told by status, and are refused where there are many.
#[test]
fn failed_rows_are_counted_and_never_averaged_in() {
    let (first, total) = ishigami_indices();
    let truth: Vec<f64> = first.into_iter().chain(total).collect();
    let mut results = results(settings(DesignKind::Saltelli, 1 << 12, 3), &uniform(3, -PI, PI), ishigami);
    for (n, row) in (0..results.status.len()).step_by(397).enumerate() {
        results.status[row] = if n % 2 == 0 { 1 } else { 4 };
        results.variables[0].data[row] = if n % 3 == 0 { f64::NAN } else { 1.0 };
    }
    let failed = results.status.iter().filter(|code| **code != 0).count();
    let study = Study::of(&results).unwrap();
    let found = told(&study);
    let by_status: usize = ["not_steady", "out_of_range"].iter().map(|word| found.left_out[word]).sum();
    assert_eq!(by_status, failed);
    assert_eq!(found.left_out["beside_a_failed_row"], 4 * failed);
    assert_eq!(found.count, results.status.len() - 5 * failed);
    for (one, truth) in sobol_indices(&found).iter().zip(&truth) {
        // The points that are left are no longer balanced, and the interval says so.
        assert!((one.value - truth).abs() < 1.5 * one.half_width, "{one:?}, not {truth}");
        assert!(one.half_width < 0.06, "{one:?}");
    }
    results.status.iter_mut().take(1500).for_each(|code| *code = 3);
    let study = Study::of(&results).unwrap();
    let refused = summary(&study, &study.outputs[0], 0, &SummaryOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("1500 non_finite") && refused.contains("--left-out 100"), "{refused}");
    let allowed = SummaryOptions { most_left_out: 1.0, ..SummaryOptions::default() };
    assert!(summary(&study, &study.outputs[0], 0, &allowed).is_ok());
}
