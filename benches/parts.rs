//! Times of the parts of a run. `cargo bench --bench parts`

use afmsweep::engine::{Cpu, Engine, Progress, Reference, solve_near};
use afmsweep::orbit;
use afmsweep::plan::{Plan, Precision, SectionState};
use afmsweep::scene::Scene;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;

/// The README's scene under another law and with other lines in `[run]`.
fn scene(law: &str, run: &str) -> Scene {
    let text = std::fs::read_to_string("scenes/quickstart.toml").expect("the scene of the README");
    let text =
        text.replace("law = \"dmt\"", &format!("law = \"{law}\"")).replace("[run]", &format!("[run]\n{run}"));
    let text = if law == "dmt" { text } else { text.replace("decay_length = \"0.3 nm\"", "") };
    Scene::parse(Path::new("quickstart.toml"), &text).expect("the scene is whole")
}

/// The plan of every fortieth of its instances.
fn plan(law: &str, run: &str, precision: Precision) -> Plan {
    let plan = Plan::new(&scene(law, run), precision).expect("the scene can be planned");
    let some: Vec<u32> = (0..plan.len() as u32).step_by(40).collect();
    plan.part(&some)
}

/// All on one core: the numbers are to be compared, not to be good.
fn one_core() {
    // The first benchmark asks for it, the others find it done.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
}

fn before_stepping(c: &mut Criterion) {
    one_core();
    let mut group = c.benchmark_group("before");
    group.bench_function("scene read", |b| b.iter(|| black_box(scene("dmt", ""))));
    let read = scene("dmt", "");
    group.bench_function("plan of 4096 instances", |b| {
        b.iter(|| black_box(Plan::new(&read, Precision::F64).expect("the scene can be planned")));
    });
    group.finish();
}

fn stepping(c: &mut Criterion) {
    one_core();
    let engine = Cpu::default();
    let mut group = c.benchmark_group("32 periods on one core");
    for law in ["hertz", "dmt", "jkr"] {
        for precision in [Precision::F32, Precision::F64] {
            let mut plan = plan(law, "modes = 4", precision);
            (plan.run.periods, plan.run.measure) = (32, 4);
            group.throughput(Throughput::Elements(plan.instance_steps()));
            group.bench_function(format!("{law} {}", precision.name()), |b| {
                b.iter(|| engine.run(&plan, &Progress::default()).expect("the plan can be run"));
            });
        }
    }
    group.finish();
}

fn periodic_states(c: &mut Criterion) {
    one_core();
    let engine = Cpu::default();
    let mut group = c.benchmark_group("periodic states");
    for law in ["hertz", "dmt", "jkr"] {
        let plan = plan(law, "steady = \"search\"", Precision::F64);
        group.throughput(Throughput::Elements(plan.len() as u64));
        group.bench_function(law, |b| {
            b.iter(|| orbit::solve(&plan, &[], &engine, &Progress::default()).expect("the plan can be run"));
        });
    }
    group.finish();
}

fn reference(c: &mut Criterion) {
    let plan = plan("dmt", "steady = \"search\"", Precision::F64);
    let found =
        orbit::solve(&plan, &[], &Cpu::default(), &Progress::default()).expect("the plan can be run").found;
    let place = found.iter().position(Option::is_some).expect("some state was found");
    let station: SectionState = found[place].as_ref().map(|state| state.section).expect("it was found");
    c.bench_function("reference beside a state", |b| {
        b.iter(|| solve_near(&plan, place, &station, &Reference::default(), &Progress::default()));
    });
}

criterion_group! {
    name = parts;
    config = Criterion::default().sample_size(10);
    targets = before_stepping, stepping, periodic_states, reference
}
criterion_main!(parts);
