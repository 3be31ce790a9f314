//! What the comparison of bits is worth: faults planted in the shader's text, one at a time, must each be
//! seen. A constant moved by its last bit, operations in another order, a line left out.
//!
//! Without a software GPU driver these tests are listed as ignored.

use crate::checks;
use crate::shader::{self, cpu, gpu, on, same, scene};
use afmsweep::engine::gpu::AdapterReport;
use afmsweep::plan::Precision;
use libtest_mimic::{Failed, Trial};

/// A law, a fault, and how to plant it.
type Fault = (&'static str, &'static str, fn(String) -> String);

/// Replaces a piece of the shader's text; shaders/recorded/ shows what the program writes. Where the piece is not there, no fault
/// is planted, and none will be seen.
fn swap(text: &str, from: &str, to: &str) -> String {
    text.replace(from, to)
}

const FAULTS: &[Fault] = &[
    ("hertz", "TWELFTH one bit up", |text| shader::nudge(&text, "TWELFTH")),
    ("hertz", "TWENTY_FOURTH one bit up", |text| shader::nudge(&text, "TWENTY_FOURTH")),
    ("hertz", "HERTZ_ENERGY one bit up", |text| shader::nudge(&text, "HERTZ_ENERGY")),
    ("dmt", "HALF one bit up", |text| shader::nudge(&text, "HALF")),
    ("jkr", "JKR_TOUCH one bit up", |text| shader::nudge(&text, "JKR_TOUCH")),
    ("jkr", "JKR_WORK_0 one bit up", |text| shader::nudge(&text, "JKR_WORK_0")),
    ("jkr", "JKR_WORK_3 one bit up", |text| shader::nudge(&text, "JKR_WORK_3")),
    ("jkr", "JKR_WORK_8 one bit up", |text| shader::nudge(&text, "JKR_WORK_8")),
    ("jkr", "JKR_FORCE_2 one bit up", |text| shader::nudge(&text, "JKR_FORCE_2")),
    ("jkr", "JKR_FORCE_3 one bit up", |text| shader::nudge(&text, "JKR_FORCE_3")),
    ("hertz", "flow added up in another order", |text| {
        swap(&text, "(lever.m00_1 * state.x_1 + state.x_1)", "lever.m00_1 * state.x_1 + state.x_1")
    }),
    ("hertz", "modes added up in another order", |text| {
        swap(&text, "state.x_1 + state.x_2", "state.x_2 + state.x_1")
    }),
    ("dmt", "attraction multiplied out", |text| {
        let (from, to) = (
            "law.adhesion * (t15 * (ONE - t10) + t10)",
            "(law.adhesion * t15 * (ONE - t10) + law.adhesion * t10)",
        );
        swap(&text, from, to)
    }),
    ("jkr", "the guessed end for the end", |text| {
        swap(&text, "let t110 = t44 + t103;", "let t110 = t44 + t61;")
    }),
    ("jkr", "one of Halley's steps less", |text| swap(&text, "let t99 = t98 + ONE;", "let t99 = t94 + ONE;")),
    ("dmt", "TAIL_POLE one bit up", |text| shader::nudge(&text, "TAIL_POLE")),
    ("dmt", "kick without its shift", |text| swap(&text, "shift_x_0 * kick.shift", "shift_x_0 * ZERO")),
    ("jkr", "work of the shift left out", |text| swap(&text, "-t2 * kick.shift + t3", "t3")),
    ("jkr", "let go without its shift", |text| {
        swap(&text, "t13 = select(ZERO, t141, t16);", "t13 = select(ZERO, t141, t16 && !t86);")
    }),
    ("jkr", "memory taken before the step", |text| {
        swap(&text, "        kick.touching,\n", "        state.touching,\n")
    }),
    ("dmt", "samples of the parabola swapped", |text| {
        swap(&text, "sample.indentation - tally.last_0;", "sample.indentation - tally.last_1;")
    }),
    ("hertz", "contact time of the step before", |text| {
        swap(&text, "tally.time + sample.kick.contact", "tally.time + tally.touched")
    }),
    ("dmt", "a period's sums cleared before they are kept", |text| {
        let (close, clear) = (
            "store_run_sums(i, close_period(run_sums_of(i), tally));",
            "tally = tally_next_period(tally);\n            index = 0u;",
        );
        let without = swap(&text, close, "");
        swap(&without, clear, &format!("{clear}\n            {close}"))
    }),
    ("hertz", "wave of the next step", |text| {
        swap(&text, "waves[2u * index + 1u], decay", "waves[2u * index + 3u], decay")
    }),
    ("jkr", "centre added up in another order", |text| {
        swap(
            &text,
            "-t2 * TWENTY_FOURTH + (lever.mean_corner * kick.impulse + (met.steady + met.beyond))",
            "-t2 * TWENTY_FOURTH + met.steady + met.beyond + lever.mean_corner * kick.impulse",
        )
    }),
    ("sum", "the work at a row's begin for that at its end", |text| swap(&text, " + 9u]", " + 6u]")),
    ("sum-hysteretic", "breaks where it forms", |text| {
        swap(&text, "let t2 = select(law.forms, law.breaks, t1);", "let t2 = law.forms;")
    }),
    ("sum-hysteretic", "what remembers left out of the way to its end", |text| {
        swap(&text, "select(ZERO, law.scale_3 * (t13 * t12 + drives[t11 + 2u]), t1);", "ZERO;")
    }),
    ("sum-hysteretic", "force at the event for that on the way", |text| {
        swap(&text, "THIRD * (TWO * t37 + (", "THIRD * (TWO * t37 - (")
    }),
    ("sum-jkr", "a contact whose path no force bends", |text| {
        swap(&text, "let t24 = at.acceleration - t21;", "let t24 = at.acceleration;")
    }),
    ("sum-viscous", "forces met along a path without the contact's kick", |text| {
        swap(&text, "-QUARTER * (t51 + t21) + HALF * at.speed", "-QUARTER * t21 + HALF * at.speed")
    }),
    ("sum-relaxing", "bend of the path with the other sign", |text| {
        swap(&text, "return Kick(-(at.acceleration", "return Kick((at.acceleration")
    }),
];

/// Faults that no test should see: the text says the same.
const HARMLESS: &[Fault] = &[
    ("jkr", "nothing", |text| text),
    ("hertz", "factors swapped", |text| {
        swap(&text, "lever.corner * kick.impulse + met.beyond", "kick.impulse * lever.corner + met.beyond")
    }),
];

/// Whether the comparison sees it.
fn seen((law, _, plant): &Fault) -> bool {
    let plan = checks::plan_in(&scene(law, "steady", 3, 64, 80), None, Precision::F32);
    let mut faulty = gpu();
    faulty.drill.edit = Some(*plant);
    same(&on(&faulty, &plan).results, &cpu(&plan), "planted").is_err()
}

fn every_fault_is_seen() -> Result<(), Failed> {
    let missed: Vec<&str> = FAULTS.iter().filter(|fault| !seen(fault)).map(|fault| fault.1).collect();
    println!("{} of {} planted faults seen", FAULTS.len() - missed.len(), FAULTS.len());
    assert!(missed.is_empty(), "not seen: {missed:?}");
    Ok(())
}

fn nothing_else_is() -> Result<(), Failed> {
    let wrong: Vec<&str> = HARMLESS.iter().filter(|fault| seen(fault)).map(|fault| fault.1).collect();
    assert!(wrong.is_empty(), "seen: {wrong:?}");
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let ignored = !shader::exact(found);
    vec![
        Trial::test("every_fault_is_seen", every_fault_is_seen).with_ignored_flag(ignored),
        Trial::test("nothing_else_is", nothing_else_is).with_ignored_flag(ignored),
    ]
}
