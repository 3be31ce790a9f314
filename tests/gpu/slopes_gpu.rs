//! Slopes of periods by the shader against the CPU's: every law, few and many modes, in f32 and f64, wherever instances
//! stand; whether a fault would be seen; and devices that fail on the way.
//!
//! Where a driver computes on the processor the bits are the same, elsewhere the numbers agree to rounding. Without any GPU
//! adapter these tests are listed as ignored.

use crate::checks;
use crate::shader::{self, CORNERS, gpu, laws, scene};
use afmsweep::engine::gpu::{AdapterReport, Gpu};
use afmsweep::engine::{Cpu, Engine, PeriodJacobian, PeriodJacobians, Progress};
use afmsweep::orbit::{self, PeriodicState};
use afmsweep::plan::{Plan, Precision, SectionState, StartState};
use afmsweep::scene::{QualityFactor, Steady};
use libtest_mimic::{Failed, Trial};
use std::time::Duration;

/// Periods before the slope is taken.
const WARM: u32 = 12;

/// What may be left out of the slopes: nothing, what a search leaves out, and more than that.
const LEAST: [f64; 3] = [0.0, 1e-6, 1e-3];

/// Where the instances of a scene are after some periods, as a plan of one period more.
fn begun(law: &str, modes: usize, precision: Precision) -> Plan {
    let steps = if modes > 4 { 512 } else { 128 };
    // Those as well that never reach the sample.
    let plan = checks::plan_in(&scene(law, "steady", modes, steps, 20), None, precision).stepping_all(steps);
    shader::from_there(&plan, &shader::after(&plan, WARM))
}

fn told(engine: &dyn Engine, plan: &Plan, least: f64) -> PeriodJacobians {
    engine.slopes(plan, &vec![least; plan.len()], &Progress::default()).expect("slopes are told")
}

/// Everything of an answer, to the bit.
fn bits(one: &Option<PeriodJacobian>) -> Vec<u64> {
    let Some(PeriodJacobian { end, slope }) = one else { return Vec::new() };
    let numbers = end.x.iter().chain(&end.u).chain(slope.iter()).map(|value| value.to_bits());
    numbers.chain([u64::from(end.touching), u64::from(end.finite)]).collect()
}

/// How many instances are the same; an error where one is not.
fn same(ours: &PeriodJacobians, theirs: &PeriodJacobians, what: &str) -> Result<usize, Failed> {
    assert_eq!(ours.all.len(), theirs.all.len());
    let wrong = ours.all.iter().zip(&theirs.all).position(|(a, b)| a.is_none() || bits(a) != bits(b));
    match wrong {
        None => Ok(ours.all.len()),
        Some(i) => Err(format!("{what}, instance {i}:\n{:?}\n{:?}", ours.all[i], theirs.all[i]).into()),
    }
}

/// Slopes that a kick has a part in: not those of the same instances without a sample.
fn kicked(law: &PeriodJacobians, free: &PeriodJacobians) -> usize {
    let slope = |one: &Option<PeriodJacobian>| one.as_ref().map(|one| one.slope.clone());
    law.all.iter().zip(&free.all).filter(|(a, b)| slope(a) != slope(b)).count()
}

fn same_bits(modes: usize, precision: Precision) -> Result<(), Failed> {
    let (gpu, cpu) = (gpu(), Cpu { strict: true });
    assert!(gpu.strict);
    let (mut all, mut acting) = (0, 0);
    let free = told(&cpu, &begun("none", modes, precision), 0.0);
    for law in laws() {
        let plan = begun(law, modes, precision);
        let what = format!("{law}, {modes} modes, {}", precision.name());
        let mut left_out = Vec::new();
        for least in LEAST {
            let ours = told(&gpu, &plan, least);
            assert!(ours.notes.is_empty(), "{what}: {:?}", ours.notes);
            let theirs = told(&cpu, &plan, least);
            all += same(&ours, &theirs, &format!("{what}, {least:e} left out"))?;
            left_out.push(theirs);
        }
        let own = kicked(&left_out[0], &free);
        assert!(law == "none" || own > plan.len() / 3, "{what}: the law acts on {own} of {}", plan.len());
        assert!(law != "dmt" || kicked(&left_out[0], &left_out[2]) > 0, "{what}: nothing was left out");
        acting += own;
    }
    println!("{modes} modes, {}: {all} of {all} slopes identical, a kick in {acting}", precision.name());
    Ok(())
}

/// Pieces and dispatches, however small, change no bit.
fn pieces_change_no_bit() -> Result<(), Failed> {
    for law in ["dmt", "jkr"] {
        let plan = begun(law, 2, Precision::F64);
        let whole = told(&Cpu { strict: true }, &plan, 1e-6);
        for chunk in [1, 7, 29] {
            let mut small = gpu();
            small.chunk = Some(chunk);
            let ours = told(&small, &plan, 1e-6);
            assert!(ours.notes.is_empty(), "{:?}", ours.notes);
            same(&ours, &whole, &format!("{law}, pieces of {chunk}"))?;
        }
    }
    Ok(())
}

/// A period longer than the loops that lavapipe can do in one dispatch goes in parts.
fn long_periods_go_in_parts() -> Result<(), Failed> {
    let steps = 70_000;
    let plan =
        checks::plan_in(&scene("dmt", "steady", 1, steps, 6), None, Precision::F64).stepping_all(steps);
    let all: Vec<u32> = plan.instances().step_by(4).collect();
    let places = vec![StartState::from(SectionState::FREE); all.len()];
    let plan = plan.trial(&all, 1, 1).starting_at(places);
    let ours = told(&gpu(), &plan, 1e-6);
    assert!(ours.notes.is_empty(), "{:?}", ours.notes);
    same(&ours, &told(&Cpu { strict: true }, &plan, 1e-6), "70,000 steps a period")?;
    Ok(())
}

fn a_lost_device_changes_no_bit() -> Result<(), Failed> {
    let plan = begun("jkr", 3, Precision::F64);
    let whole = told(&Cpu { strict: true }, &plan, 0.0);
    for (times, words) in [(1, "new device"), (u32::MAX, "on the CPU")] {
        let mut frail = gpu();
        frail.drill.lose_at = Some(1);
        frail.drill.times = times;
        frail.drill.save_every = Some(Duration::ZERO);
        let ours = told(&frail, &plan, 0.0);
        let notes = ours.notes.join("; ");
        assert!(notes.contains("device was lost") && notes.contains(words), "{notes}");
        same(&ours, &whole, &format!("lost {times} times"))?;
    }
    let mut small = gpu();
    small.drill.memory_for = Some(5);
    let ours = told(&small, &plan, 0.0);
    assert!(ours.notes.iter().any(|note| note.contains("out of memory")), "{:?}", ours.notes);
    same(&ours, &whole, "halved")?;
    Ok(())
}

/// The same to rounding, where the driver may fuse and reorder: of nearly all instances, since a step's last bits may decide
/// on which branch of a law it is. A relaxing contact has more branches: it widens or not, above the dashpots or not.
fn agrees(precision: Precision) -> Result<(), Failed> {
    let bound = match precision {
        Precision::F32 => 1e-3,
        Precision::F64 => 1e-9,
    };
    for law in laws() {
        let plan = begun(law, 2, precision);
        let mut free = gpu();
        free.strict = false;
        let (ours, theirs) = (told(&free, &plan, 1e-6), told(&Cpu { strict: true }, &plan, 1e-6));
        let error = |(a, b): (&Option<PeriodJacobian>, &Option<PeriodJacobian>)| -> f64 {
            let (Some(a), Some(b)) = (a, b) else { return f64::INFINITY };
            let scale = b.slope.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
            let off = a.slope.iter().zip(&b.slope).map(|(a, b)| (a - b).abs());
            off.fold(0.0, |largest, off| if off > largest || off.is_nan() { off } else { largest }) / scale
        };
        let mut errors: Vec<f64> = ours.all.iter().zip(&theirs.all).map(error).collect();
        errors.sort_by(f64::total_cmp);
        let tenths = if plan.law(0).has_memory() { 8 } else { 9 };
        let (median, most) = (errors[errors.len() / 2], errors[errors.len() * tenths / 10]);
        let precision = precision.name();
        println!("{law}, {precision}: off by {median:.1e} in the median, {tenths} in ten by {most:.1e}");
        assert!(most < bound, "{law}: {errors:?}");
    }
    Ok(())
}

/// A fault: a law, what it is, and how to plant it.
type Fault = (&'static str, &'static str, fn(String) -> String);

/// Faults of `law_slope`, as `afmsweep shader SCENE --entry kicks` shows it, and of the rest that only slopes show: all but the
/// constants are in what steps do not do.
const FAULTS: &[Fault] = &[
    ("hertz", "HALF one bit up", |text| shader::nudge(&text, "HALF")),
    ("hertz", "HERTZ_ENERGY one bit up", |text| shader::nudge(&text, "HERTZ_ENERGY")),
    ("dmt", "TAIL_POLE one bit up", |text| shader::nudge(&text, "TAIL_POLE")),
    ("jkr", "JKR_WORK_3 one bit up", |text| shader::nudge(&text, "JKR_WORK_3")),
    ("jkr", "JKR_TOUCH one bit up", |text| shader::nudge(&text, "JKR_TOUCH")),
    ("hertz", "a product's slope added up in another order", |text| {
        text.replace(
            "t77 * t91 + (t76 * (t77 + t73) + -(t73 * t72 + t72 * t73))",
            "t77 * t91 + t76 * (t77 + t73) + -(t73 * t72 + t72 * t73)",
        )
    }),
    ("hertz", "a quotient's slope divided in place of multiplied", |text| {
        text.replace("let t86 = t85 * t84;", "let t86 = t85 / t82;")
    }),
    ("hertz", "a root's slope from its square", |text| {
        text.replace("let t47 = HALF / max(t46, LEAST);", "let t47 = HALF * t46 / max(t37, LEAST);")
    }),
    ("dmt", "the wrong side of max", |text| {
        text.replace("let t21 = select(ZERO, ONE, t19);", "let t21 = select(ONE, ZERO, t19);")
    }),
    ("jkr", "shift without its slope", |text| {
        text.replace("if ZERO < abs(by_3)", "if false && ZERO < abs(by_3)")
    }),
    ("jkr", "contact before the step taken for that after it", |text| {
        text.replace("let touching = (*state).touching;", "let touching = ZERO;")
    }),
    ("dmt", "the step before taken for the step itself", |text| {
        text.replace("law_slope(law, here.at, here.touching)", "law_slope(law, after.at, after.touching)")
    }),
    ("dmt", "steps decided on by those before alone", |text| {
        text.replace("&& flat(here, after, little)", "")
    }),
    ("dmt", "the last step left out", |text| text.replace("select(end, end + 1u, end == job.steps)", "end")),
    ("hertz", "a step too few between two kicks", |text| {
        text.replace("since += 1u;", "if since > 0u { since += 1u; }")
    }),
    ("hertz", "the end without its flow", |text| {
        text.replace("if job.first + job.count == job.steps {", "if false {")
    }),
    ("hertz", "flow added up in another order", |text| {
        text.replace("(flow(power, 0u, 1u, row) * x_1 + x_1)", "flow(power, 0u, 1u, row) * x_1 + x_1")
    }),
    ("jkr", "acceleration added up in another order", |text| {
        text.replace("dragged = -drive(DRIVE_DRAG_1, row)", "pulled = -drive(DRIVE_DRAG_1, row)")
            .replace("(*column).u_1 + dragged", "(*column).u_1 + pulled")
    }),
];

/// What no test should see: the same said otherwise.
const HARMLESS: &[Fault] = &[
    ("jkr", "nothing", |text| text),
    ("dmt", "factors swapped", |text| text.replace("law.adhesion * t10", "t10 * law.adhesion")),
];

fn seen((law, _, plant): &Fault) -> bool {
    let plan = begun(law, 3, Precision::F32);
    let mut faulty: Gpu = gpu();
    faulty.drill.edit = Some(*plant);
    same(&told(&faulty, &plan, 1e-3), &told(&Cpu { strict: true }, &plan, 1e-3), "planted").is_err()
}

fn every_fault_is_seen() -> Result<(), Failed> {
    let missed: Vec<&str> = FAULTS.iter().filter(|fault| !seen(fault)).map(|fault| fault.1).collect();
    println!("{} of {} planted faults seen", FAULTS.len() - missed.len(), FAULTS.len());
    assert!(missed.is_empty(), "not seen: {missed:?}");
    let wrong: Vec<&str> = HARMLESS.iter().filter(|fault| seen(fault)).map(|fault| fault.1).collect();
    assert!(wrong.is_empty(), "seen: {wrong:?}");
    Ok(())
}

/// A search's slopes are those of the device: where these are wrong, its multipliers are.
fn searches_take_them_on_the_device() -> Result<(), Failed> {
    let mut scene = scene("jkr", "steady", 2, 128, 300);
    scene.run.steady = Steady::Search;
    scene.base.instrument.cantilever.quality_factor = QualityFactor::All(200.0);
    let plan = checks::plan_in(&scene, None, Precision::F64);
    let multipliers = |engine: &dyn Engine| -> Vec<Option<u64>> {
        let settled = orbit::solve(&plan, &[], engine, &Progress::default()).expect("it runs");
        let one = |state: &PeriodicState| state.floquet.multiplier.to_bits();
        settled.found.iter().map(|state| state.as_deref().map(one)).collect()
    };
    let theirs = multipliers(&Cpu { strict: true });
    assert!(multipliers(&gpu()) == theirs, "other multipliers than the CPU's");
    let mut faulty = gpu();
    faulty.drill.edit = Some(|text| text.replace("if job.first + job.count == job.steps {", "if false {"));
    let ours = multipliers(&faulty);
    let other = ours.iter().zip(&theirs).filter(|(a, b)| a != b).count();
    let found = theirs.iter().flatten().count();
    println!("{other} of {found} multipliers are others where the device's slopes are wrong");
    assert!(found > 10 && other > found / 2);
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let (any, exact) = (!found.is_empty(), shader::exact(found));
    let double = found.iter().any(|one| one.double);
    let mut tests = Vec::new();
    let mut add = |name: &str, runs: bool, test: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        tests.push(Trial::test(format!("tangents_{name}"), test).with_ignored_flag(!runs));
    };
    for precision in [Precision::F32, Precision::F64] {
        let runs = precision == Precision::F32 || double;
        for modes in [1, 2, 3, 4, 5, 6, 8, 10, 16, 24] {
            let name = format!("same_bits_as_the_cpu_{modes}_modes_{}", precision.name());
            let runs = exact && runs && CORNERS.contains(&modes);
            add(&name, runs, Box::new(move || same_bits(modes, precision)));
        }
        let name = format!("agree_with_the_cpu_to_rounding_{}", precision.name());
        add(&name, any && runs, Box::new(move || agrees(precision)));
    }
    add("pieces_change_no_bit", exact && double, Box::new(pieces_change_no_bit));
    add("long_periods_go_in_parts", exact && double, Box::new(long_periods_go_in_parts));
    add("a_lost_device_changes_no_bit", exact && double, Box::new(a_lost_device_changes_no_bit));
    add("are_the_devices_in_searches", exact && double, Box::new(searches_take_them_on_the_device));
    add("every_fault_is_seen", exact, Box::new(every_fault_is_seen));
    tests
}
