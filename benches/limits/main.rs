//! What limits the engines: instance-steps per second as a share of the device's multiply-add peak, and how
//! the speed changes when a part is left out.
//!
//! `cargo bench --bench limits -- [--gpu] [--instances N] [--seconds S] [--threads N] [-o FILE]`; the answer is a
//! table, and JSON in FILE. On the CPU, the standard on one thread and on all is told last.

mod peak;
mod work;

use afmsweep::engine::gpu::Gpu;
use afmsweep::engine::{Cpu, Engine, Progress, on_threads, processor};
use afmsweep::observe::Observable;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{LawChoice, Scene};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// What is left out or put in, beside the standard: DMT, 4 modes, amplitude, phase and peak force.
struct Variant {
    name: &'static str,
    law: LawChoice,
    modes: usize,
    observables: &'static [Observable],
}

const FEW: &[Observable] = &[Observable::Amplitude, Observable::Phase, Observable::ForceMax];
const SWING: &[Observable] = &[Observable::Amplitude, Observable::Phase];
const ALL: &[Observable] = &[
    Observable::Amplitude,
    Observable::Phase,
    Observable::ForceMax,
    Observable::ForceMin,
    Observable::IndentationMax,
    Observable::ContactTime,
    Observable::Dissipation,
    Observable::Virial,
    Observable::HarmonicAmplitude,
];

const VARIANTS: &[Variant] = &[
    Variant { name: "standard", law: LawChoice::Dmt, modes: 4, observables: FEW },
    Variant { name: "swing alone", law: LawChoice::Dmt, modes: 4, observables: SWING },
    Variant { name: "every observable", law: LawChoice::Dmt, modes: 4, observables: ALL },
    Variant { name: "hertz", law: LawChoice::Hertz, modes: 4, observables: FEW },
    Variant { name: "jkr", law: LawChoice::Jkr, modes: 4, observables: FEW },
    Variant { name: "no sample", law: LawChoice::None, modes: 4, observables: FEW },
    Variant { name: "1 mode", law: LawChoice::Dmt, modes: 1, observables: FEW },
    Variant { name: "2 modes", law: LawChoice::Dmt, modes: 2, observables: FEW },
    Variant { name: "8 modes", law: LawChoice::Dmt, modes: 8, observables: FEW },
];

/// A calibrated lever tapping on soft to stiff samples, neighbours alike, as many as asked for.
fn scene(variant: &Variant, instances: usize) -> Scene {
    let side = (instances as f64).sqrt().round() as usize;
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 150
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "50 mJ/m^2"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "16 nm"
[sweep]
"sample.youngs_modulus" = {{ from = "100 MPa", to = "10 GPa", points = {side}, scale = "log" }}
"instrument.tip.radius" = {{ from = "5 nm", to = "40 nm", points = {side} }}
[run]
periods = 1000
measure = 50
modes = {}
steps_per_period = 256
"#,
        variant.modes
    );
    let mut scene = Scene::parse(Path::new("limits.toml"), &text).expect("the scene is right");
    scene.base.contact.law = variant.law;
    scene.output.observables = variant.observables.to_vec();
    scene
}

/// The plan with so many periods. Without a sample nothing would need stepping: there it is told to.
fn plan(variant: &Variant, instances: usize, precision: Precision) -> Plan {
    let plan = Plan::new(&scene(variant, instances), precision).expect("the scene can be planned");
    match variant.law {
        LawChoice::None => plan.stepping_all(256),
        _ => plan,
    }
}

/// Share of the periods that is measured.
const MEASURED: f64 = 0.25;

/// Instance-steps per second of runs that take about `seconds` longer than one of a single period: what is done once for an
/// instance is not counted, which on a fast device takes longer than many periods.
fn rate(plan: &Plan, engine: &dyn Engine, seconds: f64) -> f64 {
    let mut plan = plan.clone();
    let most = plan.run.periods;
    let mut run = |periods: u32| {
        (plan.run.periods, plan.run.measure) = (periods, (MEASURED * f64::from(periods)).max(1.0) as u32);
        let start = Instant::now();
        engine.run(&plan, &Progress::default()).expect("the plan can be run");
        (plan.instance_steps() as f64, start.elapsed().as_secs_f64())
    };
    run(1);
    let (once, set_up) = run(1);
    let mut periods = 4;
    loop {
        let (steps, took) = run(periods);
        let stepping = (took - set_up).max(1e-3 * seconds);
        if stepping > 0.5 * seconds || periods == most {
            let (_, again) = run(periods);
            return (steps - once) / (took.min(again) - set_up).max(1e-9);
        }
        periods =
            (f64::from(periods) * (seconds / stepping).clamp(1.5, 16.0)).ceil().min(f64::from(most)) as u32;
    }
}

/// The standard on one thread and on `threads`, the best of short runs by turns.
fn scaling(arguments: &Arguments, precision: Precision) {
    let plan = plan(&VARIANTS[0], arguments.instances, precision);
    let mut best = [0.0f64; 2];
    for _ in 0..5 {
        for (best, threads) in best.iter_mut().zip([1, arguments.threads]) {
            let short = || rate(&plan, &Cpu::default(), 0.4 * arguments.seconds);
            *best = best.max(on_threads(Some(threads), short).expect("there are threads"));
        }
    }
    let peak = peak::cpu(precision, 1);
    // A multiply-add is two operations.
    let [least, most] =
        work::operations(&plan, MEASURED).map(|operations| 100.0 * best[0] * operations / (2.0 * peak));
    println!(
        "standard on one thread: {:.3e} steps/s, {least:.1} to {most:.1}% of one core's {peak:.3e} multiply-adds/s; on {}: {:.3e}, {:.2} times",
        best[0],
        arguments.threads,
        best[1],
        best[1] / best[0]
    );
}

struct Arguments {
    gpu: bool,
    instances: usize,
    seconds: f64,
    threads: usize,
    output: Option<String>,
}

fn arguments() -> Arguments {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all = Arguments { gpu: false, instances: 0, seconds: 0.5, threads, output: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--gpu" => all.gpu = true,
            "--instances" => all.instances = value().parse().expect("a number of instances"),
            "--seconds" => all.seconds = value().parse().expect("seconds"),
            "--threads" => all.threads = value().parse().expect("a number of threads"),
            "-o" => all.output = Some(value()),
            // cargo bench adds it.
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    if all.instances == 0 {
        // A GPU wants many; a processor's threads are busy with few, and runs of many periods hide their set-up.
        all.instances = if all.gpu { 1 << 20 } else { 4096 };
    }
    all
}

fn main() {
    let arguments = arguments();
    on_threads(Some(arguments.threads), || measure(&arguments)).expect("there are threads");
}

fn measure(arguments: &Arguments) {
    let mut rows = Vec::new();
    let engine: Box<dyn Engine> = match arguments.gpu {
        true => Box::new(Gpu::new(None).unwrap_or_else(|error| panic!("{error}"))),
        false => Box::new(Cpu::default()),
    };
    println!("{}", engine.device());
    for precision in [Precision::F32, Precision::F64] {
        let peak = match arguments.gpu {
            true => peak::gpu(precision),
            false => Some(peak::cpu(precision, arguments.threads)),
        };
        let Some(peak) = peak else {
            println!("{}: this adapter has none", precision.name());
            continue;
        };
        println!("\n{}: {:.3e} multiply-adds/s measured", precision.name(), peak);
        println!("{:<18}{:>14}{:>12}{:>15}{:>18}", "", "steps/s", "of standard", "operations", "of peak");
        let mut standard = f64::NAN;
        for variant in VARIANTS {
            let plan = plan(variant, arguments.instances, precision);
            let rate = rate(&plan, engine.as_ref(), arguments.seconds);
            if variant.name == "standard" {
                standard = rate;
            }
            let operations = work::operations(&plan, MEASURED);
            let shares = operations.map(|operations| rate * operations / (2.0 * peak));
            println!(
                "{:<18}{:>14.3e}{:>12.2}{:>15}{:>18}",
                variant.name,
                rate,
                rate / standard,
                format!("{:.0} to {:.0}", operations[0], operations[1]),
                format!("{:.1} to {:.1} %", 100.0 * shares[0], 100.0 * shares[1]),
            );
            rows.push(json!({
                "precision": precision.name(),
                "variant": variant.name,
                "instances": plan.len(),
                "instance_steps_per_second": rate,
                "operations_per_step": operations,
                "multiply_adds_per_second": peak,
                "share_of_peak": shares,
            }));
        }
    }
    if !arguments.gpu {
        println!();
        [Precision::F32, Precision::F64].iter().for_each(|precision| scaling(arguments, *precision));
    }
    if let Some(path) = &arguments.output {
        let all: Value = json!({
            "device": engine.device(),
            "processor": processor(),
            "date": afmsweep::store::now(),
            "note": "operations: + - * / sqrt min max abs of a step, with its observables' sums in a quarter of the periods: at least those of every step, at most those of every branch",
            "rows": rows,
        });
        let text = serde_json::to_string_pretty(&all).expect("plain data");
        std::fs::write(path, text + "\n").unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
