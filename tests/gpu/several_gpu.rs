//! Runs on several devices of one kind. Truth: the run on one of them, to the bit.
//!
//! Without two software adapters these tests are listed as ignored; a twin of the one there is (`twin`) is the second.

use crate::checks;
use crate::program::Desk;
use crate::shader::{bits, on, same, scene};
use afmsweep::engine::gpu::{AdapterReport, Gpu, alike};
use afmsweep::engine::{Engine, Progress};
use afmsweep::plan::Precision;
use afmsweep::store::read;
use afmsweep::sweep::Backend;
use afmsweep::{Results, Scene, Sweep};
use libtest_mimic::{Failed, Trial};
use rayon::prelude::*;
use std::path::Path;
use std::time::Duration;

/// The indices of two software adapters of one kind, as text.
#[derive(Clone)]
struct Pair([String; 2]);

impl Pair {
    fn of(found: &[AdapterReport]) -> Option<Self> {
        let soft: Vec<AdapterReport> =
            found.iter().filter(|one| one.software() && one.strict).cloned().collect();
        let kind = alike(&soft).into_iter().next()?;
        Some(Self([kind[0].to_string(), kind[1].to_string()]))
    }

    /// As `--device` takes them.
    fn both(&self) -> String {
        self.0.join(",")
    }

    fn one(&self) -> Gpu {
        Gpu::new(Some(&self.0[0])).expect("it was seen before")
    }

    /// Both, with work for both in the smallest class.
    fn two(&self) -> Gpu {
        let mut gpu = Gpu::new(Some(&self.both())).expect("they were seen before");
        gpu.least = 1;
        gpu
    }
}

/// However a run is cut.
fn any_deal_gives_the_same_bits(pair: &Pair) -> Result<(), Failed> {
    for (law, start, precision) in [
        ("jkr", "steady", Precision::F32),
        ("dmt", "rest", Precision::F32),
        ("dmt", "steady", Precision::F64),
    ] {
        let plan = checks::plan_in(&scene(law, start, 2, 128, 40), None, precision);
        let whole = on(&pair.one(), &plan).results;
        for (speeds, chunk) in
            [([1.0, 1.0], None), ([9.0, 1.0], None), ([1.0, 9.0], None), ([1.0, 1.0], Some(4))]
        {
            let mut gpu = pair.two();
            gpu.suppose(&speeds);
            gpu.chunk = chunk;
            let outcome = on(&gpu, &plan);
            let what = format!("{law}, {start}, {}, speeds {speeds:?}, chunks {chunk:?}", precision.name());
            assert!(outcome.notes.is_empty(), "{what}: {:?}", outcome.notes);
            same(&outcome.results, &whole, &what)?;
            let taken = gpu.taken();
            let all: u64 = taken.iter().sum();
            assert!(all == plan.instance_steps() && taken.iter().all(|one| *one > 0), "{what}: {taken:?}");
        }
    }
    Ok(())
}

/// The first device goes on with what the second one had, from where that was.
fn a_lost_device_s_work_goes_to_the_other(pair: &Pair) -> Result<(), Failed> {
    for start in ["steady", "rest"] {
        let plan = checks::plan_in(&scene("jkr", start, 2, 128, 60), None, Precision::F32);
        let whole = on(&pair.one(), &plan).results;
        let mut gpu = pair.two();
        (gpu.drill.only, gpu.drill.for_good) = (Some(1), true);
        (gpu.drill.lose_at, gpu.drill.times) = (Some(4), 1);
        gpu.drill.save_every = Some(Duration::ZERO);
        let outcome = on(&gpu, &plan);
        let told = outcome.notes.join("; ");
        let who = format!("adapter {}: the device was lost", pair.0[1]);
        assert!(told.contains(&who) && told.contains("from period") && !told.contains("period 0 "), "{told}");
        assert!(!told.contains("CPU") && !told.contains(&format!("adapter {}:", pair.0[0])), "{told}");
        same(&outcome.results, &whole, start)?;
        // Whatever comes after finds it shut, and goes on without it.
        let told = (0..4).flat_map(|_| {
            let again = on(&gpu, &plan);
            same(&again.results, &whole, &format!("{start}, again")).expect("the bits are the same");
            again.notes
        });
        let shut: Vec<String> =
            outcome.notes.iter().cloned().chain(told).filter(|note| note.contains("opened")).collect();
        let words =
            format!("adapter {}: the device cannot be opened (as drilled): going on without it", pair.0[1]);
        assert_eq!(shut, [words]);
        assert_eq!(gpu.taken()[1], 0);
    }
    Ok(())
}

/// Lost once, a device is opened anew and stays; lost both and again and again, the CPU goes on.
fn no_loss_costs_a_bit(pair: &Pair) -> Result<(), Failed> {
    let plan = checks::plan_in(&scene("dmt", "steady", 2, 128, 60), None, Precision::F32);
    let whole = on(&pair.one(), &plan).results;
    for (times, words) in [(1, "with whichever device is free"), (u32::MAX, "on the CPU")] {
        let mut gpu = pair.two();
        (gpu.drill.lose_at, gpu.drill.times) = (Some(4), times);
        gpu.drill.save_every = Some(Duration::ZERO);
        let outcome = on(&gpu, &plan);
        let told = outcome.notes.join("; ");
        assert!(told.contains("the device was lost") && told.contains(words), "{told}");
        same(&outcome.results, &whole, words)?;
    }
    Ok(())
}

/// Runs that start on the threads of one pool end, and give what each gives alone: on one device and on two.
fn runs_go_on_side_by_side(pair: &Pair) -> Result<(), Failed> {
    let plan = |law| checks::plan_in(&scene(law, "steady", 2, 128, 20), None, Precision::F32);
    let plans: Vec<_> = ["hertz", "dmt", "jkr", "none", "hertz", "dmt", "jkr"].map(plan).into();
    let alone: Vec<_> = plans.iter().map(|plan| on(&pair.one(), plan).results).collect();
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("there are threads");
        for gpu in [pair.one(), pair.two()] {
            let run = |plan| gpu.run(plan, &Progress::default()).expect("it runs").results;
            let together: Vec<_> = pool.install(|| plans.par_iter().map(run).collect());
            for (ours, theirs) in together.iter().zip(&alone) {
                same(ours, theirs, &format!("{threads} threads"))?;
            }
        }
    }
    Ok(())
}

/// Searched for by itself, waited for; begun at neighbours' states.
const SCENE: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }]
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 8, scale = "log" }
"approach.gap" = { from = "12 nm", to = "22 nm", points = POINTS }
[run]
steady = "STEADY"
periods = 600
[output]
observables = ["amplitude", "phase", "force_max"]
"#;

fn written(steady: &str, points: &str) -> String {
    SCENE.replace("STEADY", steady).replace("POINTS", points)
}

/// All numbers of results; no number is like itself as well.
fn numbers(results: Results) -> String {
    format!("{:?}", Results { attributes: Vec::new(), provenance: Vec::new(), ..results })
}

/// A whole sweep in portions, some of which have a device at a time.
fn whole_sweeps_are_alike(pair: &Pair) -> Result<(), Failed> {
    for (steady, points, portion) in
        [("search", "8", Some(9)), ("wait", "4", Some(5)), ("search", "200", None)]
    {
        let scene = Scene::parse(Path::new("two.toml"), &written(steady, points))?;
        let sweep = |device: &str| {
            let sweep = Sweep::new(scene.clone()).backend(Backend::Gpu).device(Some(device.into()));
            sweep.portion(portion).threads(Some(3)).audit(afmsweep::Audit::None).run().expect("it runs")
        };
        let (one, two) = (sweep(&pair.0[0]), sweep(&pair.both()));
        let note = two.run.notes.join("; ");
        assert!(
            note.contains("instance-steps on the GPUs: adapter")
                && (portion.is_none() || !note.contains(" 0 %")),
            "{note}"
        );
        let device = two.results.text("device").unwrap_or_default();
        let words = format!("adapters {} and {}", pair.0[0], pair.0[1]);
        assert!(device.starts_with("2 devices of one kind") && device.ends_with(&words), "{device}");
        assert!(two.run.neighbour_started() > 0.5 || points != "200");
        assert_eq!(one.run.results.len(), 8 * points.parse::<usize>()?);
        if numbers(one.results) != numbers(two.results) {
            return Err(format!("{steady}, {points} gaps: the results differ").into());
        }
    }
    Ok(())
}

/// One share on one device, one on two; a journal begun on one and gone on with on two; and what is refused.
fn the_program_takes_several(pair: &Pair) -> Result<(), Failed> {
    let desk = Desk::new();
    let (one, both) = (pair.0[0].as_str(), pair.both());
    desk.write("two.toml", &written("search", "6"));
    let run = ["run", "two.toml", "-q", "--no-audit", "--portion", "6"];
    desk.works(&[&run[..], &["--device", one, "-o", "whole.h5"]].concat());
    desk.works(&[&run[..], &["--device", one, "--shard", "1/2"]].concat());
    desk.works(&[&run[..], &["--device", &both, "--shard", "2/2"]].concat());
    let shares = ["results/two.1-of-2.h5", "results/two.2-of-2.h5"];
    desk.works(&[&["merge", "-q", "--no-audit", "-o", "merged.h5"], &shares[..]].concat());
    let of = |name: &str| read(&desk.path(name)).map(numbers).map_err(|error| error.to_string());
    assert_eq!(of("whole.h5")?, of("merged.h5")?);

    let listed = desk.works(&["devices"]).out;
    assert!(listed.contains(&format!("of one kind: --device {both}")), "{listed}");
    let twice = format!("{one},{one}");
    for (wanted, words) in [(twice.as_str(), "twice"), ("0,99", "no GPU adapter `99`; there is: 0 ")] {
        let refused = desk.call(&[&run[..], &["--device", wanted, "-o", "no.h5"]].concat());
        assert!(refused.code == Some(1) && refused.err.contains(words), "{}", refused.err);
    }
    Ok(())
}

/// The bits of each instance differ from those of the next: the comparison is of something.
fn instances_differ(pair: &Pair) -> Result<(), Failed> {
    let plan = checks::plan_in(&scene("jkr", "steady", 2, 128, 40), None, Precision::F32);
    let results = on(&pair.one(), &plan).results;
    let alike = results.windows(2).filter(|two| bits(&two[0]) == bits(&two[1])).count();
    assert!(2 * alike < results.len(), "{alike} of {} are like their neighbour", results.len());
    Ok(())
}

/// A test by its name.
type Named = (&'static str, fn(&Pair) -> Result<(), Failed>);

/// The tests of this file, which run where two software adapters are.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let pair = Pair::of(found);
    if pair.is_none() && !found.is_empty() {
        println!("no second software adapter, nor a twin of the first: tests of several devices are ignored");
    }
    let all: [Named; 7] = [
        ("any_deal_gives_the_same_bits", any_deal_gives_the_same_bits),
        ("instances_differ", instances_differ),
        ("a_lost_device_s_work_goes_to_the_other", a_lost_device_s_work_goes_to_the_other),
        ("no_loss_costs_a_bit", no_loss_costs_a_bit),
        ("runs_go_on_side_by_side", runs_go_on_side_by_side),
        ("whole_sweeps_are_alike", whole_sweeps_are_alike),
        ("the_program_takes_several", the_program_takes_several),
    ];
    // The program is there where it was built.
    let built = Path::new(env!("CARGO_BIN_EXE_afmsweep")).exists();
    let one = |(name, test): Named| {
        let runs = pair.is_some() && (built || name != "the_program_takes_several");
        let pair = pair.clone();
        Trial::test(name, move || pair.map_or(Ok(()), |pair| test(&pair))).with_ignored_flag(!runs)
    };
    all.map(one).into()
}
