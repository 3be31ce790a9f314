//! What the comparison of searches is worth: faults planted in the shader's text, one at a time, must each be seen.
//!
//! Without a software GPU driver that computes in f64 these tests are listed as ignored.

use crate::shader::{self, gpu};
use crate::strides_gpu::{WARM, guessed, led, same};
use afmsweep::engine::Cpu;
use afmsweep::engine::gpu::{AdapterReport, Gpu};
use libtest_mimic::{Failed, Trial};

/// A fault: a law, what it is, and how to plant it.
type Fault = (&'static str, &'static str, fn(String) -> String);

const FAULTS: &[Fault] = &[
    ("hertz", "a product added up in another order", |text| {
        text.replace("odd = (*a)[k + 1u] * (*b)[k + 1u] + odd;", "even = (*a)[k + 1u] * (*b)[k + 1u] + even;")
    }),
    ("hertz", "a column added up in another order", |text| {
        text.replace("odd = second * (*taken)[k + 1u] + odd;", "even = second * (*taken)[k + 1u] + even;")
    }),
    ("dmt", "the matrix's rows taken for its columns", |text| {
        text.replace("at(column * NUMBERS + row, i)", "at(row * NUMBERS + column, i)")
    }),
    ("dmt", "no correction of the matrix", |text| text.replace("        correct(i, &undone, &along);", "")),
    ("jkr", "a stride by the matrix before its correction", |text| {
        text.replace("scale(&next, square * share);", "")
    }),
    ("dmt", "a correction of the other sign", |text| {
        text.replace("(square - product(", "(square + product(")
    }),
    ("hertz", "a correction with each stride but the second", |text| {
        text.replace("let strode = job.round > 0u;", "let strode = job.round > 1u;")
    }),
    ("dmt", "a stride back", |text| text.replace("places[at(k, i)] + next[k]", "places[at(k, i)] - next[k]")),
    ("jkr", "rates left as they are", |text| {
        text.replace("states[at(STATE_U_1, i)] = places[at(HALF_NUMBERS + 1u, i)];", "")
    }),
    ("hertz", "sums of the period before kept", |text| {
        text.replace("    store_run_sums(i, begin_run());", "")
    }),
    ("dmt", "free motion alone before the first sample", |text| {
        text.replace("-(cases[at(CASE_STILL, i)] + beyond)", "-cases[at(CASE_STILL, i)]")
    }),
    ("dmt", "strides of any length", |text| text.replace("|| FARTHEST < left", "")),
    ("jkr", "any contact taken for the state's", |text| text.replace("!(memory && other)", "true")),
    ("hertz", "taken for found a stride early", |text| {
        text.replace(
            "if !(cases[at(CASE_NEAR, i)] < left) {",
            "if !(cases[at(CASE_NEAR, i)] < TENTH * left) {",
        )
    }),
    ("hertz", "no bound on the distance", |text| {
        text.replace("finite(bound) && !(cases[at(CASE_SURE, i)] < bound)", "true")
    }),
    ("dmt", "all stepped in each round", |text| {
        text.replace("if number >= going[job.round] {", "if number >= job.instances {")
            .replace("let i = going[listed(job.round, number)];", "let i = number;")
    }),
    ("dmt", "one left out in the second round", |text| {
        text.replace("number >= going[job.round]", "number >= going[job.round] - min(job.round, 1u)")
    }),
];

/// What no test should see: the same said otherwise.
const HARMLESS: &[Fault] = &[
    ("jkr", "nothing", |text| text),
    ("dmt", "factors swapped", |text| text.replace("(*undone)[k] * times", "times * (*undone)[k]")),
    ("hertz", "a list in the order of the threads", |text| {
        text.replace(
            "let i = going[listed(job.round, number)];",
            "let i = going[listed(job.round, going[job.round] - 1u - number)];",
        )
    }),
];

fn seen((law, _, plant): &Fault) -> bool {
    let (plan, mut guesses) = guessed(law, 3, WARM[0]);
    // In the wrong contact.
    guesses.all.iter_mut().step_by(4).for_each(|one| one.touching = !one.touching);
    let mut faulty: Gpu = gpu();
    faulty.drill.edit = Some(*plant);
    // The length of the last stride decides, or the bound on the distance.
    [(1e-7, 1e-3), (1e-3, 1e-5)].into_iter().any(|goal| {
        (guesses.near, guesses.sure) = goal;
        let begun = (plan.clone(), guesses.clone());
        let ours = led(&faulty, &begun);
        !ours.1.notes.is_empty() || same(&ours, &led(&Cpu { strict: true }, &begun), "planted").is_err()
    })
}

fn every_fault_is_seen() -> Result<(), Failed> {
    let missed: Vec<&str> = FAULTS.iter().filter(|fault| !seen(fault)).map(|fault| fault.1).collect();
    println!("{} of {} planted faults seen", FAULTS.len() - missed.len(), FAULTS.len());
    assert!(missed.is_empty(), "not seen: {missed:?}");
    let wrong: Vec<&str> = HARMLESS.iter().filter(|fault| seen(fault)).map(|fault| fault.1).collect();
    assert!(wrong.is_empty(), "seen: {wrong:?}");
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let runs = shader::exact(found) && found.iter().any(|one| one.double);
    vec![Trial::test("strides_every_fault_is_seen", every_fault_is_seen).with_ignored_flag(!runs)]
}
