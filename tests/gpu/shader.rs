//! Runs on the GPU and on the CPU, and how to compare them bit by bit.

use crate::checks;
use crate::twin;
use afmsweep::contact::Law;
use afmsweep::engine::gpu::{AdapterReport, Gpu, adapters};
use afmsweep::engine::{Cpu, Engine, Finished, Outcome, Progress};
use afmsweep::observe::Observable;
use afmsweep::plan::{Plan, SectionState, StartState};
use afmsweep::scene::{Scene, TipShape, Viscosity, ViscosityModel};
use libtest_mimic::Failed;
use std::path::Path;

/// Numbers of modes whose shaders every commit is held to: few and many, written out and in a loop. The tests of other numbers
/// are marked as ignored; `make test-all` runs them.
pub const CORNERS: [usize; 4] = [1, 4, 8, 24];

/// Laws that are a contact of another law and the tables of a sum. Every commit holds them to one and to four modes, where their
/// shaders are compiled in seconds; the numbers between and beyond are for `make test-all`.
pub const COMPOSED: [&str; 3] = ["sum-jkr", "sum-viscous", "sum-relaxing"];

pub fn laws() -> [&'static str; Law::ALL.len()] {
    Law::ALL.map(Law::name)
}

/// A lever of `modes` modes over soft to stiff samples, from far away to pressed in. Of more than 8 they are a list, close
/// enough together to be stepped with few steps.
pub fn scene(law: &str, start: &str, modes: usize, steps: u32, periods: u32) -> Scene {
    // A law's memory is one of the state's modes.
    let memory = Law::from_name(law).is_some_and(Law::has_memory);
    let modes = if memory { (modes - 1).max(1) } else { modes };
    let lever = match modes {
        0..=8 => "stiffness = \"10 N/m\"\nfrequency = \"75 kHz\"\nquality_factor = 30".to_owned(),
        _ => {
            let mode = |k: usize| {
                let (stiffness, frequency) = (10 * (1 + k * k), 75.0 * (1.0 + 0.7 * k as f64));
                format!(
                    "{{ stiffness = \"{stiffness} N/m\", frequency = \"{frequency} kHz\", quality_factor = 30 }}"
                )
            };
            format!("modes = [{}]", (0..modes).map(mode).collect::<Vec<_>>().join(", "))
        }
    };
    let word = checks::law_word(law);
    let text = format!(
        r#"
[instrument.cantilever]
{lever}
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "20 mJ/m^2"
[contact]
law = "{word}"
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
    if law.starts_with("sum") {
        scene.base.contact.outside = checks::outside_forces(law);
    }
    if law.ends_with("-relaxing") {
        scene.base.sample.viscosity = Viscosity::Relaxing { modulus: 6e10, time: 2e-7 };
    } else if law.ends_with("-shaped") {
        // Of each kind of power one; under DMT's attraction a sphere.
        let shapes = [TipShape::Sphere, TipShape::Cone, TipShape::Punch, TipShape::Hyperboloid];
        let shape = if word == "dmt" { TipShape::Sphere } else { shapes[modes % 4] };
        (scene.base.instrument.tip.shape, scene.base.instrument.tip.half_angle) = (shape, Some(70.0));
    } else if law.ends_with("-viscous") {
        scene.base.sample.viscosity = Viscosity::RetardationTime(2e-7);
        // Both forms.
        let form = if modes.is_multiple_of(2) { ViscosityModel::AdHoc } else { ViscosityModel::KelvinVoigt };
        scene.base.contact.viscosity_model = form;
    }
    scene
}

/// Where a plan's instances are after some periods from steady free motion, by the CPU.
pub fn after(plan: &Plan, periods: u32) -> Vec<SectionState> {
    let all: Vec<u32> = plan.instances().collect();
    let first = plan.instances().map(|i| {
        let touching = plan.case(i).contact.next_contact(-plan.case(i).gap, false);
        StartState::from(SectionState { touching, ..SectionState::FREE })
    });
    let warm = plan.trial(&all, periods, 1).starting_at(first.collect());
    let ends = Cpu { strict: true }.run(&warm, &Progress::default()).expect("the plan can be run").ends;
    ends.into_iter().map(|end| *end.expect("each was stepped")).collect()
}

/// One period of a plan's instances from where these are.
pub fn from_there(plan: &Plan, places: &[SectionState]) -> Plan {
    let all: Vec<u32> = plan.instances().collect();
    plan.trial(&all, 1, 1).starting_at(places.iter().copied().map(StartState::from).collect())
}

pub fn gpu() -> Gpu {
    Gpu::new(None).expect("an adapter was seen before")
}

/// The adapters, told; and without Mesa's words about the missing display.
pub fn found() -> Vec<AdapterReport> {
    // SAFETY: called first of all, before there are threads.
    unsafe {
        std::env::set_var("NODEVICE_SELECT", "1");
        twin::add();
    }
    let found = adapters();
    if found.is_empty() {
        println!("no GPU adapter here: every test here is ignored");
    }
    found.iter().for_each(|one| println!("adapter {}: {}", one.index, one.title()));
    found
}

/// Whether the adapters round as the processor does: software drivers, told not to fuse.
pub fn exact(found: &[AdapterReport]) -> bool {
    !found.is_empty() && found.iter().all(|one| one.software() && one.strict)
}

/// Rounded after each operation, as the shader does where it is told to.
pub fn cpu(plan: &Plan) -> Vec<Finished> {
    Cpu { strict: true }.run(plan, &Progress::default()).expect("the plan can be run").results
}

pub fn on(gpu: &Gpu, plan: &Plan) -> Outcome {
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

pub fn bits(result: &Finished) -> Vec<u64> {
    let numbers = numbers(result);
    std::iter::once(result.status as u64).chain(numbers.iter().map(|value| value.to_bits())).collect()
}

/// All instances, all observables; how many differ, and the first that does.
pub fn same(ours: &[Finished], theirs: &[Finished], what: &str) -> Result<usize, Failed> {
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

/// Moves a constant of the head by one unit in its last place.
pub fn nudge(text: &str, name: &str) -> String {
    let from = format!("const {name}: real = ");
    let start = text.find(&from).expect("the head names it") + from.len();
    let end = start + text[start..].find("f;").expect("an f32 literal");
    let value: f32 = text[start..end].parse().expect("a number");
    let moved = f32::from_bits(value.to_bits() + 1);
    format!("{}{moved:?}{}", &text[..start], &text[end..])
}
