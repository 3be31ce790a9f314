//! The plan's own steps per period against eight times as many with the same oscillators, over random cases: the
//! error stays below the accuracy asked for.

use crate::checks;
use crate::checks::{Errors, calibrated, one_mode, sample, show, worst};
use afmsweep::observe::Status;
use afmsweep::plan::{BasisRule, ReducedBasis};
use afmsweep::scene::{DriveFrequency, LawChoice, Scene};
use rayon::prelude::*;
use std::path::Path;

/// Knuth's linear congruence: the same cases everywhere.
struct Random(u64);

impl Random {
    /// 0 to 1
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread in the logarithm.
    fn log(&mut self, from: f64, to: f64) -> f64 {
        from * (to / from).powf(self.even())
    }
}

/// A soft to stiff lever, one mode or calibrated, on a soft to stiff sample, at resonance or near it.
fn case(seed: u64, accuracy: f64) -> (String, Scene) {
    let mut random = Random(seed.wrapping_mul(7919).wrapping_add(17));
    // Neighbouring seeds begin alike.
    for _ in 0..5 {
        random.even();
    }
    let law = [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr][(random.even() * 3.0) as usize];
    let many = random.even() < 0.4;
    let (k, frequency, q) = (random.log(0.5, 100.0), random.log(20e3, 500e3), random.log(5.0, 200.0));
    let a0 = random.log(3e-9, 100e-9);
    let gap = a0 * (0.3 + 0.8 * random.even());
    let (modulus, w, radius) = (random.log(3e6, 100e9), random.log(1e-3, 0.1), random.log(3e-9, 50e-9));
    let decay = random.log(0.15e-9, 0.5e-9);
    let detuned = if random.even() < 0.3 { 0.97 + 0.06 * random.even() } else { 1.0 };
    let change = |scene: &mut Scene| {
        sample(scene, law, modulus, w, radius);
        scene.base.contact.decay_length = decay;
        scene.run.accuracy = accuracy;
        scene.run.periods = (5.0 * q).max(30.0) as u32;
        scene.run.measure = 4;
        if detuned != 1.0 {
            scene.base.drive.frequency = DriveFrequency::Hertz(frequency * detuned);
        }
    };
    let make = if many { calibrated } else { one_mode };
    let name = format!(
        "{law:?}, {}, k {k:.2}, f {frequency:.0}, Q {q:.1}, A0 {a0:.2e}, gap/A0 {:.3}, E {modulus:.1e}, \
         w {w:.1e}, R {radius:.1e}, D0 {decay:.1e}, drive {detuned:.3}",
        if many { "calibrated" } else { "one mode" },
        gap / a0
    );
    (name, make(k, frequency, q, a0, gap, change))
}

struct Row {
    name: String,
    steps: u32,
    errors: Errors,
}

/// Cases that touch the sample and are ok with both counts of steps.
fn survey(accuracy: f64, count: u64) -> Vec<Row> {
    let rows: Vec<Row> = (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let (name, scene) = case(seed, accuracy);
            let plan = checks::plan(&scene, None);
            let steps = plan.steps(0);
            if steps == 0 {
                return None;
            }
            // The same lever: prescribed steps would bring the one that they can step.
            let fine = plan.clone().with_steps(|steps| 8 * steps);
            let [own, best] = [checks::run(&plan)[0], checks::run(&fine)[0]];
            if own.status != Status::Ok || best.status != Status::Ok {
                return None;
            }
            let truth = checks::outcome(&best.measured);
            let scales = checks::scales(&fine, 0, &truth);
            Some(Row { name, steps, errors: checks::errors(&own.measured, &truth, &scales) })
        })
        .collect();
    let mut errors: Vec<f64> = rows.iter().map(|row| worst(&row.errors).1 / accuracy).collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
    let over = errors.iter().filter(|error| **error > 1.0).count();
    let mean = rows.iter().map(|row| f64::from(row.steps)).sum::<f64>() / rows.len() as f64;
    println!(
        "accuracy {accuracy:e}: {} of {count} cases, {mean:.0} steps on average; error over ask: median {:.1e}, \
         90 % {:.1e}, 99 % {:.1e}, largest {:.1e}; {over} above 1",
        rows.len(),
        quantile(0.5),
        quantile(0.9),
        quantile(0.99),
        quantile(1.0)
    );
    for row in rows.iter().filter(|row| worst(&row.errors).1 > accuracy) {
        println!("  {} steps, {}: {}", row.steps, row.name, show(&row.errors));
    }
    rows
}

#[test]
fn the_plans_steps_give_the_accuracy_asked_for() {
    let rows = survey(1e-3, 120);
    assert!(rows.len() >= 100, "only {} cases are ok", rows.len());
    for row in rows {
        let (which, error) = worst(&row.errors);
        assert!(error <= 1e-3, "{}, {} steps: {which} off by {error:e}", row.name, row.steps);
    }
}

/// Truth: audits of the whole sweep, which modes by share have always met (`afmsweep run scenes/quickstart.toml --audit 64`).
/// Levers made for fast contacts would cost it ten times the steps.
#[test]
fn contacts_that_are_not_fast_pay_nothing_for_those_that_are() {
    let text = include_str!("../../scenes/quickstart.toml");
    let scene = Scene::parse(Path::new("quickstart.toml"), text).expect("the scene is whole");
    let plan = checks::plan(&scene, None);
    assert_eq!(plan.drives.len(), 1, "every contact has the lever of the instrument");
    let most = plan.cases().map(|case| case.steps).max();
    assert!(most <= Some(256), "{most:?} steps");
    // Of a lever made for a contact the modes kept as they are move the tip as the lever's do: the rod's would fill
    // their places.
    let driven = &plan.drives[0];
    let rate = 8.0 * driven.free.omega;
    let rule = BasisRule::Contact { rate, count: 8, elastic: true, resonant: false };
    let kept = ReducedBasis::for_contact(&driven.instrument, driven.free.omega, rule, scene.run.accuracy)
        .expect("it can be made");
    let exact = || kept.modes.iter().filter(|mode| mode.index.is_some());
    let first = exact().map(|mode| mode.inverse_mass).fold(f64::NAN, f64::max);
    assert!(exact().count() > 2 && exact().all(|mode| mode.inverse_mass > 0.03 * first), "{:?}", kept.modes);
}

/// What the rule's constants in `plan/steps.rs` were set by.
#[test]
#[ignore = "a study of some minutes"]
fn survey_of_the_rule() {
    for accuracy in [1e-2, 1e-3, 1e-4] {
        survey(accuracy, 700);
    }
}
