//! What the choice of steps costs, against the cheapest number of steps for all that meets the accuracy.

use crate::random::{Ranges, Wide, scene};
use afmsweep::compare::{Scales, choose, worst};
use afmsweep::control;
use afmsweep::engine::{Cpu, Engine, Finished, Model, Progress, Reference};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{Scene, Steady};
use serde_json::{Value, json};
use std::path::Path;

/// Numbers of steps tried for all.
const UNIFORM: [u32; 16] = [16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536, 2048, 4096];

/// Instances of a random scene.
const MANY: usize = 1000;

fn quickstart() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/quickstart.toml");
    Scene::load(&path).expect("the scene")
}

fn random(law: &str, count: usize, seed: u64) -> Scene {
    let run = "periods = 400\nmeasure = 4";
    scene(&Wide { law, count, seed, accuracy: 1e-3, from: Ranges::USUAL, run })
}

/// The largest error of the instances that both call ok, and how many those are.
fn largest(plan: &Plan, ours: &[Finished], truths: &[Finished]) -> (f64, usize) {
    let mut found = (0.0f64, 0);
    for (i, (ours, truth)) in ours.iter().zip(truths).enumerate() {
        if ours.status == Status::NonFinite || ours.status == Status::OutOfRange {
            found.0 = f64::INFINITY;
        }
        if ours.status == Status::Ok && truth.status == Status::Ok {
            let scales = Scales::of(plan, i, &truth.measured);
            let error = worst(&plan.observables, &ours.measured, &truth.measured, &scales);
            found = (found.0.max(error), found.1 + 1);
        }
    }
    found
}

/// The table, and its rows: `count` instances of each scene.
pub fn run(count: usize, seed: u64) -> Vec<Value> {
    println!(
        "\nsteps chosen, against the cheapest uniform number that meets 1e-3; {count} instances of each scene"
    );
    println!(
        "{:<12}{:>5}{:>9}{:>9}{:>11}{:>9}{:>15}{:>15}",
        "scene", "ok", "uniform", "error", "chosen", "error", "of uniform", "with estimates"
    );
    let scenes = [
        ("quickstart", quickstart()),
        ("dmt", random("dmt", MANY, seed)),
        ("jkr", random("jkr", MANY, seed)),
    ];
    scenes.into_iter().map(|(name, scene)| row(name, scene, count)).collect()
}

fn row(name: &str, mut scene: Scene, count: usize) -> Value {
    scene.output.observables = Observable::all().filter(|one| *one != Observable::Contacts).collect();
    scene.run.steady = Steady::Wait;
    let whole = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
    let instances = choose(&whole, count, 1);
    let (cpu, progress) = (Cpu::default(), Progress::default());
    let run = control::run(&whole, &cpu, &progress).expect("the plan can be run");
    // What steps cost, with the modes chosen: the reference integrates the same oscillators.
    let chosen = run.plan.part(&instances);
    let reference = Reference { tolerance: 1e-9, model: Model::Kept };
    let truths = reference.run(&chosen, &Progress::default()).expect("the plan can be run").results;
    let ran: Vec<Finished> = instances.iter().map(|i| run.results.get(*i as usize)).collect();
    let (error, ok) = largest(&chosen, &ran, &truths);
    let accuracy = scene.run.accuracy;
    let mut uniform = (0, f64::INFINITY);
    for steps in UNIFORM {
        let plan = chosen.clone().with_steps(|_| steps);
        let results = cpu.run(&plan, &Progress::default()).expect("the plan can be run").results;
        let (error, counted) = largest(&plan, &results, &truths);
        if error <= accuracy && counted >= ok {
            uniform = (steps, error);
            break;
        }
    }
    // Over all instances of the scene.
    let stepped: Vec<f64> =
        run.plan.cases().filter(|case| case.steps > 0).map(|case| f64::from(case.steps)).collect();
    let count = stepped.len() as f64;
    let mean = stepped.iter().sum::<f64>() / count;
    let all = progress.steps() as f64 / count / f64::from(whole.run.periods);
    let per = |steps: f64| steps / f64::from(uniform.0);
    println!(
        "{name:<12}{ok:>5}{:>9}{:>9.1e}{mean:>11.0}{error:>9.1e}{:>15.2}{:>15.2}",
        uniform.0,
        uniform.1,
        per(mean),
        per(all)
    );
    json!({
        "scene": name, "instances": count, "ok": ok, "uniform_steps": uniform.0, "uniform_error": uniform.1,
        "chosen_mean_steps": mean, "chosen_error": error, "chosen_over_uniform": per(mean),
        "with_estimates_over_uniform": per(all),
    })
}
