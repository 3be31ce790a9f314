//! Whether the accuracy asked for is met: random instances from wide ranges, run to several accuracies, held
//! against the reference engine one by one.

use crate::random::{Wide, quantile, scene};
use afmsweep::compare::{Scales, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Engine, Finished, Progress, Reference};
use afmsweep::observe::{HARMONICS, Measured, Status};
use afmsweep::plan::{Plan, Precision};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

const LAWS: [&str; 3] = ["hertz", "dmt", "jkr"];
const ACCURACIES: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Long enough for the largest quality factor to settle.
const RUN: &str = "periods = 400\nmeasure = 4";
const QUALITY: [f64; 2] = [10.0, 60.0];
/// Of the reference: three digits below the finest accuracy asked for.
const TOLERANCE: f64 = 1e-9;

/// The reference takes minutes: what it said stays in target/.
fn remembered(wide: &Wide) -> Vec<Finished> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/accuracy");
    let file = folder.join(format!("{}_{}_{}.json", wide.law, wide.count, wide.seed));
    let known: Option<Vec<Vec<Option<f64>>>> =
        std::fs::read_to_string(&file).ok().and_then(|text| serde_json::from_str(&text).ok());
    if let Some(rows) = known {
        println!("    {}: the reference's results of an earlier run", file.display());
        return rows.iter().map(|row| finished(row)).collect();
    }
    let truths = truths(wide);
    let rows: Vec<Vec<f64>> = truths.iter().map(row_of).collect();
    std::fs::create_dir_all(&folder).expect("a folder in target/");
    std::fs::write(&file, json!(rows).to_string()).expect("a file in target/");
    truths
}

fn row_of(one: &Finished) -> Vec<f64> {
    let m = &one.measured;
    let mut row = m.harmonics.to_vec();
    row.extend([m.phase, m.force_max, m.force_min, m.force_mean, m.indentation_max]);
    row.extend([m.contact_time, m.dissipation, m.virial, m.contacts, f64::from(one.status as u8)]);
    row
}

/// What is no number comes back as none.
fn finished(row: &[Option<f64>]) -> Finished {
    let at = |n: usize| row[n].unwrap_or(f64::NAN);
    let measured = Measured {
        harmonics: std::array::from_fn(at),
        phase: at(HARMONICS),
        force_max: at(HARMONICS + 1),
        force_min: at(HARMONICS + 2),
        force_mean: at(HARMONICS + 3),
        indentation_max: at(HARMONICS + 4),
        contact_time: at(HARMONICS + 5),
        dissipation: at(HARMONICS + 6),
        virial: at(HARMONICS + 7),
        contacts: at(HARMONICS + 8),
    };
    let status = Status::from_code(at(HARMONICS + 9) as u8).expect("a status");
    Finished { measured, status }
}

/// What the reference makes of the whole ensemble, waiting as the engines do.
fn truths(wide: &Wide) -> Vec<Finished> {
    let plan = Plan::new(&scene(wide), Precision::F64).expect("the scene can be planned");
    // The strictest model for all: every mode that the finest accuracy asks for, and more.
    let plan = plan.richer(&(0..wide.count as u32).collect::<Vec<_>>(), 1e-5);
    let reference = Reference { tolerance: TOLERANCE, ..Reference::default() };
    reference.run(&plan, &Progress::default()).expect("the plan can be run").results
}

/// The table, and its rows.
pub fn run(count: usize, seed: u64) -> Vec<Value> {
    println!("{count} random instances for each law, seed {seed}");
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
    for law in LAWS {
        let wide = |accuracy| Wide { law, count, seed, accuracy, quality: QUALITY, run: RUN };
        let truths = remembered(&wide(ACCURACIES[0]));
        for accuracy in ACCURACIES {
            rows.push(row(&wide(accuracy), &truths));
        }
    }
    rows
}

fn row(wide: &Wide, truths: &[Finished]) -> Value {
    let Wide { law, count, accuracy, .. } = *wide;
    let plan = Plan::new(&scene(wide), Precision::F64).expect("the scene can be planned");
    let start = Instant::now();
    let run = control::run(&plan, &Cpu::default(), &Progress::default()).expect("the plan can be run");
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
            let (estimate, steps) = (run.estimates[i], run.plan.cases[i].steps);
            println!("    instance {i}: {error:.1e}, estimated {estimate:.1e}, {steps} steps");
        }
        errors.push(error);
    }
    errors.sort_by(f64::total_cmp);
    let above = |times: f64| errors.iter().filter(|error| **error > times * accuracy).count();
    let [median, p95, largest] = [0.5, 0.95, 1.0].map(|share| quantile(&errors, share));
    println!(
        "{law:<6}{accuracy:>8.0e}{:>6}{median:>10.1e}{p95:>10.1e}{largest:>10.1e}{:>8}{:>8}{low:>10}{steps:>11.0}{seconds:>12.2}",
        errors.len(),
        above(1.0),
        above(3.0),
    );
    json!({
        "law": law,
        "accuracy": accuracy,
        "instances": count,
        "ok": errors.len(),
        "median": median,
        "p95": p95,
        "largest": largest,
        "above_the_ask": above(1.0),
        "above_three_times_the_ask": above(3.0),
        "estimate_too_low_by_three": low,
        "mean_steps_per_period": steps,
        "seconds": seconds,
    })
}
