//! The shader against the CPU, and runs that go wrong on the way.
//!
//! Where a driver computes on the processor (Mesa's lavapipe) and is told to round after each operation of
//! the text, the bits are the same: every law, every observable, every instance. Otherwise it may fuse and
//! reorder sums and products, and the numbers agree to rounding.
//!
//! Without any GPU adapter these tests are listed as ignored.

use crate::checks::{self, bounds, worst};
use crate::shader::{self, COMPOSED, CORNERS, cpu, gpu, laws, on, same, scene};
use afmsweep::engine::gpu::AdapterReport;
use afmsweep::engine::{Cpu, Engine, Progress};
use afmsweep::observe::Status;
use afmsweep::orbit::{self, OrbitSolution, PeriodicState};
use afmsweep::plan::{BasisRule, KeptMode, Precision};
use afmsweep::scene::{QualityFactor, Scene, Start, Steady};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::TAU;
use std::path::Path;
use std::time::Duration;

/// More than 20,000 steps; with more than 4 modes the fastest needs 512 a period.
fn long(law: &str, start: &str, modes: usize) -> Scene {
    let (steps, periods) = if modes > 4 { (512, 40) } else { (128, 160) };
    scene(law, start, modes, steps, periods)
}

/// The same bits for every law, every observable, both starts, every instance whatever its status.
fn same_bits(modes: usize, precision: Precision, composed: bool) -> Result<(), Failed> {
    let mut all = 0;
    for law in laws().into_iter().filter(|law| COMPOSED.contains(law) == composed) {
        for start in ["steady", "rest"] {
            let plan = checks::plan_in(&long(law, start, modes), None, precision);
            let what = format!("{law}, {start}, {modes} modes, {}", precision.name());
            let gpu = gpu();
            assert!(gpu.strict);
            let outcome = on(&gpu, &plan);
            assert!(outcome.notes.is_empty(), "{what}: {:?}", outcome.notes);
            all += same(&outcome.results, &cpu(&plan), &what)?;
        }
    }
    println!("{modes} modes, {}: {all} of {all} instances identical", precision.name());
    Ok(())
}

/// The same where steps meet fast oscillators by their means. What the shader reads off a lever then differs from a constant, and
/// a fault planted there shows.
fn same_bits_by_means(precision: Precision) -> Result<(), Failed> {
    let mut all = 0;
    for law in ["dmt", "jkr"] {
        for start in ["steady", "rest"] {
            let plan = checks::plan_in(&long(law, start, 4), None, precision);
            let rule = BasisRule::Contact {
                rate: 40.0 * plan.drives[0].free.omega,
                count: 4,
                elastic: true,
                resonant: false,
            };
            let wanted: Vec<(u32, BasisRule)> = plan.instances().map(|i| (i, rule)).collect();
            let plan = plan.with_bases_alone(&wanted);
            let driven = plan.driven(0);
            let step = TAU / (driven.free.omega * f64::from(plan.steps(0)));
            let is_mean = |mode: &KeptMode| driven.kept.stored_share(mode, step) != 1.0;
            assert!(driven.kept.modes.iter().any(is_mean) && !driven.kept.modes.iter().all(is_mean));
            let what = format!("{law}, {start}, by means, {}", precision.name());
            all += same(&on(&gpu(), &plan).results, &cpu(&plan), &what)?;
            let faults: [fn(String) -> String; 2] = [
                |text| text.replace("lever.corner", "TWENTY_FOURTH"),
                |text| text.replace("lever.mean_corner", "ZERO"),
            ];
            for (number, fault) in faults.into_iter().enumerate() {
                let mut faulty = gpu();
                faulty.drill.edit = Some(fault);
                let seen = same(&on(&faulty, &plan).results, &cpu(&plan), "planted").is_err();
                assert!(seen, "{what}: fault {number} is not seen");
            }
        }
    }
    println!("by means, {}: {all} of {all} instances identical", precision.name());
    Ok(())
}

/// The scenes that come with the program, as they are but for their waveforms and a large one's periods.
fn same_bits_in_every_scene(precision: Precision) -> Result<(), Failed> {
    for name in ["quickstart", "paper_fig4_hertz", "paper_fig4_dmt", "paper_fig4_jkr"] {
        let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut scene = Scene::load(Path::new(&path)).unwrap_or_else(|error| panic!("{error}"));
        // Thousands of instances; whole runs of few are `same_bits`.
        if scene.len() > 1 {
            scene.run.periods = 40;
        }
        let plan = checks::plan_in(&scene, None, precision);
        let count = same(&on(&gpu(), &plan).results, &cpu(&plan), name)?;
        println!("{name}, {}: {count} of {count} instances identical", precision.name());
    }
    Ok(())
}

/// The same numbers to rounding where the driver may fuse and reorder. Which of them a response that just
/// settles is called, steady or not, hangs on its last bits.
fn agrees(modes: usize, precision: Precision) -> Result<(), Failed> {
    let bound = match precision {
        Precision::F32 => bounds::SHADER_SINGLE,
        Precision::F64 => bounds::SHADER_DOUBLE,
    };
    let (mut compared, mut worst_seen) = (0, 0.0);
    for law in laws() {
        for start in ["steady", "rest"] {
            let scene = long(law, start, modes);
            let plan = checks::plan_in(&scene, None, precision);
            let what = format!("{law}, {start}, {modes} modes, {}", precision.name());
            let mut free = gpu();
            free.strict = false;
            let ours = on(&free, &plan).results;
            let scaled = checks::plan_in(&steady(&scene), None, precision);
            for (i, (ours, theirs)) in ours.iter().zip(&cpu(&plan)).enumerate() {
                let settling = [Status::Ok, Status::NotSteady];
                let near = settling.contains(&ours.status) && settling.contains(&theirs.status);
                assert!(near || ours.status == theirs.status, "{what}, instance {i}");
                if ours.status != Status::Ok || theirs.status != Status::Ok {
                    continue;
                }
                let truth = checks::outcome(&theirs.measured);
                let scales = checks::scales(&scaled, i, &truth);
                let errors = checks::errors(&ours.measured, &truth, &scales);
                let (which, error) = worst(&errors);
                worst_seen = f64::max(worst_seen, error);
                let widest = if plan.law(i as u32).has_memory() { bounds::SHADER_MEMORY } else { 1.0 };
                if error > widest * bound {
                    return Err(format!("{what}, instance {i}: {which} {}", checks::show(&errors)).into());
                }
                compared += 1;
            }
        }
    }
    println!(
        "{modes} modes, {}: {compared} steady instances, largest difference {worst_seen:.1e}",
        precision.name()
    );
    assert!(compared >= 20, "only {compared} compared");
    Ok(())
}

/// The same scene from steady free motion, where a period's work has a scale.
fn steady(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.run.start = Start::Steady;
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
            same(&outcome.results, &whole, &format!("{start}, lost {times} times"))?;
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
    let ours = on(&gpu(), &plan).results;
    same(&ours, &cpu(&plan), "overflow")?;
    let failed = ours.iter().filter(|one| one.status == Status::NonFinite).count();
    println!("{failed} instances without a number");
    assert!(failed > 0, "nothing overflowed: {:?}", ours.iter().map(|one| one.status).collect::<Vec<_>>());
    Ok(())
}

/// The search asks the same of the shader as of the CPU, and is answered the same.
fn searches_alike(precision: Precision) -> Result<(), Failed> {
    let mut scene = scene("jkr", "steady", 2, 128, 300);
    scene.run.steady = Steady::Search;
    scene.base.instrument.cantilever.quality_factor = QualityFactor::All(200.0);
    let plan = checks::plan_in(&scene, None, precision);
    let settle =
        |engine: &dyn Engine| orbit::solve(&plan, &[], engine, &Progress::default()).expect("it runs");
    let (ours, theirs) = (settle(&gpu()), settle(&Cpu { strict: true }));
    let count = same(&ours.outcome.results, &theirs.outcome.results, "search")?;
    assert_eq!(ours.found, theirs.found);
    let found = ours.found.iter().flatten().count();
    println!("{}: {count} of {count} instances identical, {found} found", precision.name());
    assert!(found > count / 2);
    Ok(())
}

/// Four curves on one mode, along the gap or the drive's frequency.
const CURVES: &str = r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 60 }]
[instrument.tip]
radius = "20 nm"
[sample]
youngs_modulus = "1 GPa"
surface_energy = "30 mJ/m^2"
[contact]
law = "LAW"
[drive]
on = "tip"
frequency = "300 kHz"
force = "6 nN"
[approach]
gap = "8.5 nm"
[sweep]
"sample.youngs_modulus" = { values = ["0.3 GPa", "1 GPa", "3 GPa", "10 GPa"] }
[curve]
quantity = "QUANTITY"
values = [VALUES]
direction = "both"
[run]
periods = 600
"#;

/// Curves are followed point by point on the device as on the CPU.
fn curves_alike() -> Result<(), Failed> {
    for (law, quantity, values) in [
        ("dmt", "approach.gap", r#""10 nm", "9.5 nm", "9 nm", "8.5 nm""#),
        ("jkr", "approach.gap", r#""8.5 nm", "7.5 nm", "6.5 nm""#),
        ("dmt", "drive.frequency", r#""299 kHz", "300 kHz", "301 kHz""#),
    ] {
        let text = CURVES.replace("LAW", law).replace("QUANTITY", quantity).replace("VALUES", values);
        let scene = Scene::parse(Path::new("curves.toml"), &text).expect("the scene is whole");
        let plan = checks::plan_in(&scene, None, Precision::F64);
        let settle = |engine: &dyn Engine| {
            orbit::solve_first(&mut plan.clone(), engine, &Progress::default()).expect("it runs")
        };
        let (ours, theirs) = (settle(&gpu()), settle(&Cpu { strict: true }));
        let count = same(&ours.outcome.results, &theirs.outcome.results, law)?;
        // What was waited for has no multiplier, which is no number and unlike itself.
        let states = |all: &OrbitSolution| -> Vec<_> {
            let one = |state: &PeriodicState| (state.section, state.floquet.multiplier.to_bits());
            all.found.iter().map(|state| state.as_deref().map(one)).collect()
        };
        assert!(states(&ours) == states(&theirs), "{law} over {quantity}");
        assert_eq!(ours.jumps, theirs.jumps);
        let found = ours.found.iter().flatten().filter(|state| state.is_solved()).count();
        println!("{law} over {quantity}: {count} of {count} points identical, {found} followed");
        assert!(found > count / 2);
    }
    Ok(())
}

const HELD: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }]
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "2 GPa"
poisson_ratio = 0.34
surface_energy = "40 mJ/m^2"
[contact]
law = "LAW"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "10 nm"
[approach]
BRANCH
[sweep]
"sample.youngs_modulus" = { values = ["0.5 GPa", "2 GPa"] }
"approach.QUANTITY" = { values = [VALUES] }
"#;

/// Set-points are approached and held on the device as on the CPU.
fn set_points_alike() -> Result<(), Failed> {
    for (law, branch, quantity, values) in [
        ("dmt", "", "setpoint", "0.6, 0.9"),
        ("dmt", "setpoint_branch = \"repulsive\"", "setpoint", "0.6, 0.9"),
        ("jkr", "", "force_setpoint", "\"2 nN\", \"5 nN\""),
    ] {
        let text = [("LAW", law), ("BRANCH", branch), ("QUANTITY", quantity), ("VALUES", values)]
            .iter()
            .fold(HELD.to_owned(), |text, (name, value)| text.replace(name, value));
        let scene = Scene::parse(Path::new("held.toml"), &text).expect("the scene is whole");
        let plan = checks::plan_in(&scene, None, Precision::F64);
        let settle = |engine: &dyn Engine| {
            orbit::solve_first(&mut plan.clone(), engine, &Progress::default()).expect("it runs")
        };
        let (ours, theirs) = (settle(&gpu()), settle(&Cpu { strict: true }));
        let count = same(&ours.outcome.results, &theirs.outcome.results, law)?;
        let held = ours.outcome.results.iter().filter(|one| one.measured.gap.is_finite()).count();
        println!("{law}, {quantity} {branch}: {count} of {count} identical, {held} held");
        assert!(held == count);
    }
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let (any, exact) = (!found.is_empty(), shader::exact(found));
    let double = found.iter().any(|one| one.double);
    let mut tests = Vec::new();
    let mut add = |name: String, runs: bool, test: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        tests.push(Trial::test(name, test).with_ignored_flag(!runs));
    };
    for modes in (1..=8).chain([10, 16, 24]) {
        let name = format!("same_bits_as_the_cpu_{modes}_modes_f32");
        let corner = exact && CORNERS.contains(&modes);
        add(name, corner, Box::new(move || same_bits(modes, Precision::F32, false)));
        let name = format!("same_bits_as_the_cpu_{modes}_modes_composed_f32");
        add(name, corner && modes <= 4, Box::new(move || same_bits(modes, Precision::F32, true)));
    }
    for modes in [1, 4, 8, 24] {
        let name = format!("same_bits_as_the_cpu_{modes}_modes_f64");
        add(name, exact && double, Box::new(move || same_bits(modes, Precision::F64, false)));
        let name = format!("same_bits_as_the_cpu_{modes}_modes_composed_f64");
        add(name, exact && double && modes <= 4, Box::new(move || same_bits(modes, Precision::F64, true)));
    }
    for precision in [Precision::F32, Precision::F64] {
        let name = format!("same_bits_as_the_cpu_by_means_{}", precision.name());
        let runs = exact && (double || precision == Precision::F32);
        add(name, runs, Box::new(move || same_bits_by_means(precision)));
    }
    let scenes = "same_bits_as_the_cpu_in_every_scene";
    add(format!("{scenes}_f32"), exact, Box::new(|| same_bits_in_every_scene(Precision::F32)));
    add(format!("{scenes}_f64"), exact && double, Box::new(|| same_bits_in_every_scene(Precision::F64)));
    for modes in [1, 4] {
        let name = format!("agrees_with_the_cpu_to_rounding_{modes}_modes_f32");
        // One mode alone agrees where four do; `make test-all` has both.
        add(name, any && modes == 4, Box::new(move || agrees(modes, Precision::F32)));
    }
    add(
        "agrees_with_the_cpu_to_rounding_2_modes_f64".into(),
        any && double,
        Box::new(|| agrees(2, Precision::F64)),
    );
    for precision in [Precision::F32, Precision::F64] {
        let name = format!("searches_as_the_cpu_does_{}", precision.name());
        add(name, exact && double, Box::new(move || searches_alike(precision)));
    }
    add("curves_as_the_cpu_does".into(), exact && double, Box::new(curves_alike));
    add("set_points_as_the_cpu_does".into(), exact && double, Box::new(set_points_alike));
    add("chunks_change_no_bit".into(), any, Box::new(chunks_change_no_bit));
    add("long_periods_go_in_parts".into(), exact, Box::new(long_periods_go_in_parts));
    add("a_lost_device_costs_nothing".into(), exact, Box::new(a_lost_device_costs_nothing));
    add("want_of_memory_makes_smaller_chunks".into(), any, Box::new(want_of_memory_makes_smaller_chunks));
    add("overflow_is_seen_alike".into(), exact, Box::new(overflow_is_seen_alike));
    tests
}
