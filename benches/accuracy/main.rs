//! Whether the accuracy asked for is met: random instances from wide ranges, run to several accuracies, held
//! against the reference engine one by one.
//!
//! `cargo bench --bench accuracy -- [--instances N] [--seed S] [-o FILE]`; the answer is a table, and JSON in FILE.

use afmsweep::compare::{Scales, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Engine, Progress, Reference, processor};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Numbers between 0 and 1 (SplitMix64; Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// A calibrated lever, and `count` samples, tips, quality factors, amplitudes and gaps under one law.
fn scene(law: &str, count: usize, seed: u64, accuracy: f64) -> Scene {
    let mut random = Random(seed);
    let mut lists: [(&str, &str, Vec<f64>); 6] = [
        ("sample.youngs_modulus", "Pa", vec![]),
        ("sample.surface_energy", "J/m^2", vec![]),
        ("instrument.tip.radius", "m", vec![]),
        ("instrument.cantilever.quality_factor", "", vec![]),
        ("drive.free_amplitude", "m", vec![]),
        ("approach.gap", "m", vec![]),
    ];
    for _ in 0..count {
        let amplitude = random.log(5e-9, 100e-9);
        let values = [
            random.log(10e6, 100e9),
            random.log(1e-3, 0.2),
            random.log(5e-9, 100e-9),
            random.log(10.0, 60.0),
            amplitude,
            amplitude * (0.3 + 0.75 * random.next()),
        ];
        for ((.., list), value) in lists.iter_mut().zip(values) {
            list.push(value);
        }
    }
    let samples: String = lists
        .iter()
        .map(|(path, unit, list)| {
            let words: Vec<String> = list
                .iter()
                .map(
                    |value| {
                        if unit.is_empty() { format!("{value:e}") } else { format!("\"{value:e} {unit}\"") }
                    },
                )
                .collect();
            format!("\"{path}\" = [{}]\n", words.join(", "))
        })
        .collect();
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 100
[instrument.actuator]
model = "rigid"
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[samples]
{samples}
[run]
periods = 400
measure = 20
accuracy = {accuracy:e}
"#
    );
    let mut scene = Scene::parse(Path::new("random.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    scene.output.observables = Observable::all().filter(|one| *one != Observable::Contacts).collect();
    scene
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((share * last).round() as usize).copied().unwrap_or(f64::NAN)
}

fn main() {
    let (mut count, mut seed, mut output) = (100, 1, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--instances" => count = value().parse().expect("a number of instances, for each law"),
            "--seed" => seed = value().parse().expect("a seed"),
            "-o" => output = Some(value()),
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    println!("{}, {count} random instances for each law, seed {seed}", processor());
    println!(
        "{:<6}{:>8}{:>6}{:>10}{:>10}{:>10}{:>8}{:>8}{:>10}{:>11}{:>12}",
        "law",
        "asked",
        "ok",
        "median",
        "95 %",
        "largest",
        "above",
        "above3",
        "low by 3",
        "steps/per.",
        "seconds"
    );
    let mut rows = Vec::new();
    for law in ["hertz", "dmt", "jkr"] {
        let mut truths = None;
        for accuracy in [1e-2, 1e-3, 1e-4] {
            let scene = scene(law, count, seed, accuracy);
            let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
            let truths = truths.get_or_insert_with(|| {
                // The strictest model for all: every mode that the finest accuracy asks for, and more.
                let plan = plan.richer(&(0..count as u32).collect::<Vec<_>>(), 1e-5);
                let reference = Reference { tolerance: 1e-10, ..Reference::default() };
                reference.run(&plan, &Progress::default()).expect("the plan can be run").results
            });
            let start = Instant::now();
            let run =
                control::run(&plan, &Cpu::default(), &Progress::default()).expect("the plan can be run");
            let seconds = start.elapsed().as_secs_f64();
            let (mut errors, mut low, mut steps) = (Vec::new(), 0, 0.0);
            for (i, truth) in truths.iter().enumerate() {
                let ours = &run.outcome.results[i];
                steps += f64::from(run.plan.cases[i].steps) / count as f64;
                if ours.status != Status::Ok || truth.status != Status::Ok {
                    continue;
                }
                let scales = Scales::of(&run.plan, i, &truth.measured);
                let error = worst(&plan.observables, &ours.measured, &truth.measured, &scales);
                low += usize::from(error > 3.0 * run.estimates[i].max(0.1 * accuracy));
                if error > accuracy {
                    println!(
                        "    instance {i}: {error:.1e}, estimated {:.1e}, {} steps",
                        run.estimates[i], run.plan.cases[i].steps
                    );
                }
                errors.push(error);
            }
            errors.sort_by(f64::total_cmp);
            let above = |times: f64| errors.iter().filter(|error| **error > times * accuracy).count();
            println!(
                "{law:<6}{accuracy:>8.0e}{:>6}{:>10.1e}{:>10.1e}{:>10.1e}{:>8}{:>8}{low:>10}{steps:>11.0}{seconds:>12.2}",
                errors.len(),
                quantile(&errors, 0.5),
                quantile(&errors, 0.95),
                quantile(&errors, 1.0),
                above(1.0),
                above(3.0),
            );
            rows.push(json!({
                "law": law,
                "accuracy": accuracy,
                "instances": count,
                "ok": errors.len(),
                "median": quantile(&errors, 0.5),
                "p95": quantile(&errors, 0.95),
                "largest": quantile(&errors, 1.0),
                "above_the_ask": above(1.0),
                "above_three_times_the_ask": above(3.0),
                "estimate_too_low_by_three": low,
                "mean_steps_per_period": steps,
                "seconds": seconds,
            }));
        }
    }
    if let Some(path) = output {
        let all =
            json!({ "processor": processor(), "date": afmsweep::store::now(), "seed": seed, "rows": rows });
        let text = serde_json::to_string_pretty(&all).expect("plain data");
        std::fs::write(&path, text + "\n").unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
