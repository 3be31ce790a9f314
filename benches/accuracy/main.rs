//! Whether the accuracy asked for is met: random instances from wide ranges, run to several accuracies, held
//! against the reference engine one by one.
//!
//! `cargo bench --bench accuracy -- [--instances N] [--seed S] [-o FILE]`; the answer is a table, and JSON in FILE.

#[path = "../common/random.rs"]
mod random;

use afmsweep::compare::{Scales, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Engine, Progress, Reference, processor};
use afmsweep::observe::Status;
use afmsweep::plan::{Plan, Precision};
use random::{Wide, quantile, scene};
use serde_json::json;
use std::time::Instant;

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
            let run = "periods = 400\nmeasure = 20";
            let scene = scene(&Wide { law, count, seed, accuracy, quality: [10.0, 60.0], run });
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
