//! Inference from weighted samples, where the answer is known: a linear model with Gaussian errors.

use crate::study::*;
use afmsweep::design::{DesignKind, Distribution, Mix, Settings, normal_quantile};
use afmsweep::stats::{Observed, Study, SummaryOptions, posterior};

/// A normal number of a place in a stream of its own.
fn normal(seed: u64, place: u64) -> f64 {
    normal_quantile(Mix::new(0xfeed).of(seed).of(place).share())
}

fn prior() -> [Distribution; 2] {
    let one = |mean, sd| Distribution::Normal { mean, sd, from: None, to: None };
    [one(2.0, 1.0), one(0.0, 0.5)]
}

fn model(x: &[f64]) -> f64 {
    x[0] + x[1]
}

fn of_kind(kind: DesignKind, seed: u64) -> Study {
    of_samples(kind, seed, 1 << 13)
}

fn of_samples(kind: DesignKind, seed: u64, samples: usize) -> Study {
    study(Settings { seed, ..settings(kind, samples, 2) }, &prior(), model)
}

fn seen(value: f64) -> [Observed; 1] {
    [Observed { name: "amplitude".into(), value, sd: 0.2 }]
}

/// The conjugate posterior: precision 1/s1^2 of the prior, and one observation of the sum.
#[test]
fn a_gaussian_posterior_is_found() {
    for kind in [DesignKind::MonteCarlo, DesignKind::LatinHypercube, DesignKind::Sobol] {
        let study = of_kind(kind, 1);
        let found = posterior(&study, 0, &seen(3.0), &SummaryOptions::default()).unwrap();
        let (spread, gain) = (1.0 + 0.25 + 0.04, [1.0, 0.25]);
        let columns: Vec<&[f64]> = study.parameters.iter().map(|one| &one.values[..]).collect();
        for (n, (mean, variance)) in [(2.0, 1.0), (0.0, 0.25)].into_iter().enumerate() {
            let gain: f64 = gain[n];
            let (mean, sd) = (mean + gain / spread, (variance - gain * gain / spread).sqrt());
            // So many effective samples know a mean to one part in the root of their number.
            let known = 4.0 * sd / found.effective.sqrt();
            assert!((found.mean(columns[n]) - mean).abs() < known, "{kind:?} {n}");
            assert!((found.sd(columns[n]) - sd).abs() < known, "{kind:?} {n}");
            for share in [0.025, 0.5, 0.975] {
                let truth = mean + sd * normal_quantile(share);
                let off = (found.quantile(columns[n], share) - truth).abs();
                assert!(off < 2.5 * known, "{kind:?} {n} {share}: off by {off}");
            }
        }
        let truth = -(1.0 * 0.25 / spread) / ((1.0 - 1.0 / spread) * (0.25 - 0.25 * 0.25 / spread)).sqrt();
        let together = found.correlation(columns[0], columns[1]);
        assert!((together - truth).abs() < 0.05, "{kind:?}: {together}, not {truth}");
        assert!(found.effective > 500.0 && found.effective < 8192.0, "{}", found.effective);
    }
}

/// The truth is drawn from the prior, what is observed of it with its error: an interval of 95 % holds it in 95 % of all
/// cases, 90 to 99 of 100 but for one case in a hundred.
#[test]
fn intervals_hold_the_truth_in_a_hundred_studies() {
    let (mut held, mut told) = ([0; 2], 0);
    for seed in 1..=100 {
        let truth = [prior()[0].value(share(seed, 0)), prior()[1].value(share(seed, 1))];
        let value = model(&truth) + 0.2 * normal(seed, 2);
        // Enough for truths far out: the farthest has 70 effective samples.
        let study = of_samples(DesignKind::Sobol, seed, 1 << 15);
        let found = posterior(&study, 0, &seen(value), &SummaryOptions::default()).unwrap();
        told += 1;
        for n in 0..2 {
            let column = &study.parameters[n].values;
            let inside = found.quantile(column, 0.025)..=found.quantile(column, 0.975);
            held[n] += u32::from(inside.contains(&truth[n]));
        }
    }
    assert_eq!(told, 100);
    assert!(held.iter().all(|count| (90..=99).contains(count)), "{held:?}");
}

fn share(seed: u64, place: u64) -> f64 {
    Mix::new(0xbead).of(seed).of(place).share()
}

/// What no row agrees with is refused with its numbers; so are rows that are no sample.
#[test]
fn too_few_effective_samples_are_refused() {
    let study = of_kind(DesignKind::Sobol, 1);
    let far = posterior(&study, 0, &seen(30.0), &SummaryOptions::default()).unwrap_err().to_string();
    for words in ["effective samples of 8192", "fewer than 50", "Take more samples", "standard deviations"] {
        assert!(far.contains(words), "{far}");
    }
    let saltelli = of_kind(DesignKind::Saltelli, 1);
    let refused = posterior(&saltelli, 0, &seen(3.0), &SummaryOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("no sample of the parameters") && refused.contains("\"sobol\""), "{refused}");
}
