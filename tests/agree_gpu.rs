//! The shader against the CPU: the same bits without a sample and the same numbers to rounding in contact, on a
//! driver that fuses nothing (Mesa's lavapipe); and runs that go wrong on the way.
//!
//! Without any GPU adapter these tests are listed as ignored.

mod checks;
mod support;

use afmsweep::engine::gpu::{Gpu, adapters};
use afmsweep::engine::{Cpu, Engine, Finished, Outcome, Progress};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use checks::{bounds, worst};
use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use std::time::Duration;

const LAWS: [&str; 4] = ["none", "hertz", "dmt", "jkr"];

/// A lever of `modes` modes over soft to stiff samples, from far away to pressed in.
fn scene(law: &str, start: &str, modes: usize, steps: u32, periods: u32) -> Scene {
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "20 mJ/m^2"
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "30 nm"
[approach]
gap = "22 nm"
[sweep]
"sample.youngs_modulus" = {{ values = ["300 MPa", "3 GPa", "30 GPa"] }}
"drive.frequency" = {{ values = ["74 kHz", "75 kHz"] }}
"approach.gap" = {{ values = ["-2 nm", "15 nm", "24 nm", "29.99 nm", "31 nm"] }}
[run]
start = "{start}"
periods = {periods}
measure = 5
modes = {modes}
steps_per_period = {steps}
"#
    );
    let mut scene = Scene::parse(Path::new("test.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    scene.output.observables = Observable::all().collect();
    scene
}

fn gpu() -> Gpu {
    Gpu::new(None).expect("an adapter was seen before")
}

fn cpu(plan: &Plan) -> Vec<Finished> {
    Cpu::default().run(plan, &Progress::default()).expect("the plan can be run").results
}

fn on(gpu: &Gpu, plan: &Plan) -> Outcome {
    gpu.run(plan, &Progress::default()).expect("the plan can be run")
}

/// Every number of a result, in order.
fn numbers(result: &Finished) -> Vec<f64> {
    let mut row = vec![0.0; 64];
    let mut all = Vec::new();
    for observable in Observable::all() {
        let width = observable.width();
        observable.write(&result.measured, &mut row[..width]);
        all.extend_from_slice(&row[..width]);
    }
    all
}

fn bits(result: &Finished) -> Vec<u64> {
    let numbers = numbers(result);
    std::iter::once(result.status as u64).chain(numbers.iter().map(|value| value.to_bits())).collect()
}

/// All instances, all observables; how many differ, and the first that does.
fn same(ours: &[Finished], theirs: &[Finished], what: &str) -> Result<usize, Failed> {
    assert_eq!(ours.len(), theirs.len());
    let wrong: Vec<usize> = (0..ours.len()).filter(|&i| bits(&ours[i]) != bits(&theirs[i])).collect();
    match wrong.first() {
        None => Ok(ours.len()),
        Some(&i) => Err(format!(
            "{what}: {} of {} instances differ; number {i}:\n{:?} {:?}\n{:?} {:?}",
            wrong.len(),
            ours.len(),
            ours[i].status,
            numbers(&ours[i]),
            theirs[i].status,
            numbers(&theirs[i]),
        )
        .into()),
    }
}

/// Every law, every observable, both starts: whole runs of more than 20,000 steps with that many modes.
///
/// Without a sample the bits are the same. In contact this driver's compiler takes sums and products apart in
/// its own way in places, which moves the last bits.
fn agrees(modes: usize, precision: Precision) -> Result<(), Failed> {
    let bound = match precision {
        Precision::F32 => bounds::SHADER_SINGLE,
        Precision::F64 => bounds::SHADER_DOUBLE,
    };
    let (mut compared, mut worst_seen, mut identical, mut all) = (0, 0.0, 0, 0);
    for law in LAWS {
        for start in ["steady", "rest"] {
            // 160 periods of 128 steps; with more than 4 modes the fastest needs 512.
            let steps = if modes > 4 { 512 } else { 128 };
            let scene = scene(law, start, modes, steps, 160);
            let plan = checks::plan_in(&scene, None, precision);
            let what = format!("{law}, {start}, {modes} modes, {}", precision.name());
            let outcome = on(&gpu(), &plan);
            assert!(outcome.notes.is_empty(), "{what}: {:?}", outcome.notes);
            let truths = cpu(&plan);
            if law == "none" {
                same(&outcome.results, &truths, &what)?;
                continue;
            }
            for (i, (ours, theirs)) in outcome.results.iter().zip(&truths).enumerate() {
                all += 1;
                identical += usize::from(bits(ours) == bits(theirs));
                // Which of them a response that just settles is called hangs on its last bits.
                let settling = [Status::Ok, Status::NotSteady];
                let near = settling.contains(&ours.status) && settling.contains(&theirs.status);
                assert!(near || ours.status == theirs.status, "{what}, instance {i}");
                if ours.status != Status::Ok || theirs.status != Status::Ok {
                    continue;
                }
                let truth = checks::outcome(&theirs.measured);
                let scales = checks::scales(&checks::plan_in(&steady(&scene), None, precision), i, &truth);
                let errors = checks::errors(&ours.measured, &truth, &scales);
                let (which, error) = worst(&errors);
                worst_seen = f64::max(worst_seen, error);
                if error > bound {
                    return Err(format!("{what}, instance {i}: {which} {}", checks::show(&errors)).into());
                }
                compared += 1;
            }
        }
    }
    println!(
        "{modes} modes, {}: {compared} steady instances, largest difference {worst_seen:.1e}; {identical} of {all} identical",
        precision.name()
    );
    assert!(compared >= 20, "only {compared} compared");
    Ok(())
}

/// The same scene from steady free motion, where a period's work has a scale.
fn steady(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.run.start = afmsweep::scene::Start::Steady;
    scene
}

fn chunks_change_no_bit() -> Result<(), Failed> {
    for start in ["steady", "rest"] {
        let plan = checks::plan_in(&scene("jkr", start, 2, 128, 20), None, Precision::F32);
        let whole = on(&gpu(), &plan).results;
        for chunk in [1, 7, 29] {
            let mut small = gpu();
            small.chunk = Some(chunk);
            same(&on(&small, &plan).results, &whole, &format!("{start}, chunks of {chunk}"))?;
        }
    }
    Ok(())
}

/// A period longer than the loops that lavapipe can do in one dispatch goes in parts.
fn long_periods_go_in_parts() -> Result<(), Failed> {
    let plan = checks::plan_in(&scene("none", "rest", 1, 40_000, 6), None, Precision::F32);
    same(&on(&gpu(), &plan).results, &cpu(&plan), "40,000 steps a period")?;
    Ok(())
}

fn a_lost_device_costs_nothing() -> Result<(), Failed> {
    for start in ["steady", "rest"] {
        let plan = checks::plan_in(&scene("jkr", start, 2, 128, 60), None, Precision::F32);
        let whole = on(&gpu(), &plan).results;
        // Once: a new device goes on. Always: the CPU does.
        for (times, words) in [(1, "new device"), (u32::MAX, "on the CPU")] {
            let mut frail = gpu();
            frail.drill.lose_at = Some(4);
            frail.drill.times = times;
            frail.drill.save_every = Some(Duration::ZERO);
            let outcome = on(&frail, &plan);
            let told = outcome.notes.join("; ");
            assert!(told.contains("device was lost") && told.contains(words), "{told}");
            assert!(told.contains("from period") && !told.contains("from period 0 on the CPU"), "{told}");
            // Another device of the same kind gives the same bits; the CPU only where nothing touches.
            let law_free = checks::plan_in(&scene("none", "rest", 2, 128, 60), None, Precision::F32);
            if times == 1 {
                same(&outcome.results, &whole, &format!("{start}, lost once"))?;
            } else {
                let mut frail = gpu();
                frail.drill.lose_at = Some(4);
                frail.drill.times = u32::MAX;
                frail.drill.save_every = Some(Duration::ZERO);
                same(&on(&frail, &law_free).results, &on(&gpu(), &law_free).results, "lost for good")?;
            }
        }
    }
    Ok(())
}

fn want_of_memory_makes_smaller_chunks() -> Result<(), Failed> {
    let plan = checks::plan_in(&scene("dmt", "steady", 2, 128, 20), None, Precision::F32);
    let mut small = gpu();
    small.drill.memory_for = Some(5);
    let outcome = on(&small, &plan);
    assert!(outcome.notes.iter().any(|note| note.contains("out of memory")), "{:?}", outcome.notes);
    same(&outcome.results, &on(&gpu(), &plan).results, "halved")?;
    Ok(())
}

/// Steps far too long for the contact: numbers overflow, and both say so of the same instances.
fn overflow_is_seen_alike() -> Result<(), Failed> {
    let mut scene = scene("hertz", "steady", 1, 16, 200);
    scene.base.instrument.tip.radius = 1.0;
    let plan = checks::plan_in(&scene, None, Precision::F32);
    let (ours, theirs) = (on(&gpu(), &plan).results, cpu(&plan));
    for (i, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        assert_eq!(a.status == Status::NonFinite, b.status == Status::NonFinite, "instance {i}");
    }
    let failed = ours.iter().filter(|one| one.status == Status::NonFinite).count();
    println!("{failed} instances without a number");
    assert!(failed > 0, "nothing overflowed: {:?}", ours.iter().map(|one| one.status).collect::<Vec<_>>());
    Ok(())
}

fn main() {
    let arguments = Arguments::from_args();
    let found = adapters();
    let any = !found.is_empty();
    // Bits are promised only where nothing is fused.
    let strict = found.len() == 1 && found[0].software();
    let double = found.iter().any(|one| one.double);
    match found.first() {
        None => println!("no GPU adapter here: every test of this file is ignored"),
        Some(_) => found.iter().for_each(|one| println!("adapter {}: {}", one.index, one.title())),
    }
    let mut tests = Vec::new();
    let mut add = |name: String, runs: bool, test: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        tests.push(Trial::test(name, test).with_ignored_flag(!runs));
    };
    for modes in 1..=8 {
        let name = format!("agrees_{modes}_modes_f32");
        add(name, strict, Box::new(move || agrees(modes, Precision::F32)));
    }
    for modes in [1, 4] {
        let name = format!("agrees_{modes}_modes_f64");
        add(name, strict && double, Box::new(move || agrees(modes, Precision::F64)));
    }
    add("chunks_change_no_bit".into(), any, Box::new(chunks_change_no_bit));
    add("long_periods_go_in_parts".into(), strict, Box::new(long_periods_go_in_parts));
    add("a_lost_device_costs_nothing".into(), strict, Box::new(a_lost_device_costs_nothing));
    add("want_of_memory_makes_smaller_chunks".into(), any, Box::new(want_of_memory_makes_smaller_chunks));
    add("overflow_is_seen_alike".into(), strict, Box::new(overflow_is_seen_alike));
    libtest_mimic::run(&arguments, tests).exit();
}
