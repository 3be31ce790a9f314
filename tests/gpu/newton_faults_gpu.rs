//! What the comparison of searches by Newton's steps is worth: faults planted in the shader's text, one at a time, must each be
//! seen.
//!
//! Without a software GPU driver that computes in f64 these tests are listed as ignored.

use crate::newton_gpu::{WARM, begun, held, same, sought};
use crate::shader::{self, gpu};
use afmsweep::engine::gpu::{AdapterReport, Gpu};
use afmsweep::engine::{Cpu, NewtonResults, NewtonStarts};
use afmsweep::plan::Plan;
use libtest_mimic::{Failed, Trial};
use std::collections::BTreeMap;

/// A fault: a law, what it is, and how to plant it.
type Fault = (&'static str, &'static str, fn(String) -> String);

const FAULTS: &[Fault] = &[
    ("hertz", "a product added up in another order", |text| {
        text.replace("odd = (*a)[k + 1u] * (*b)[k + 1u] + odd;", "even = (*a)[k + 1u] * (*b)[k + 1u] + even;")
    }),
    ("dmt", "the slope's rows taken for its columns", |text| {
        text.replace(
            "return columns[at(row * NUMBERS + column, i)];",
            "return columns[at(column * NUMBERS + row, i)];",
        )
    }),
    ("hertz", "another pivot", |text| text.replace("if largest < size {", "if size < largest {")),
    ("dmt", "rows swapped without the right side", |text| text.replace("(*step)[pivot] = above;", "")),
    ("dmt", "divided in place of multiplied by the inverse", |text| {
        text.replace(
            "factors[entry(k, row, i)] * inverse",
            "factors[entry(k, row, i)] / factors[entry(k, k, i)]",
        )
    }),
    ("hertz", "a row left out of the elimination", |text| {
        text.replace("if row + 1u < job.count {", "if row + 2u < job.count {")
    }),
    ("hertz", "substituted from one row too few", |text| text.replace("if row >= k {", "if row + 1u >= k {")),
    ("dmt", "Newton's steps from the first", |text| {
        text.replace("let flows = time < NEWTON;", "let flows = false;")
    }),
    ("hertz", "times that do not grow", |text| text.replace("LONGER * gain", "gain")),
    ("dmt", "times that grow without a bound", |text| {
        text.replace("min(LONGER * gain, LONGEST)", "LONGER * gain")
    }),
    ("jkr", "a stride back", |text| {
        text.replace(
            "walks[at(STRIDE + k, i)] = (*step)[k] * times;",
            "walks[at(STRIDE + k, i)] = -(*step)[k] * times;",
        )
    }),
    ("dmt", "strides of any length", |text| text.replace("if longest < long {", "if false {")),
    ("jkr", "strides that climb refused from the first", |text| {
        text.replace("select(GAINS, HALF,", "select(GAINS, GAINS,")
    }),
    ("jkr", "Newton's steps that lead no nearer taken", |text| {
        text.replace("select(GAINS, HALF,", "select(HALF, HALF,")
    }),
    ("jkr", "strides not shortened", |text| {
        text.replace("put_stride(i, &stride, QUARTER);", "put_stride(i, &stride, ONE);")
    }),
    ("jkr", "a time kept where a stride was shortened", |text| {
        text.replace("min(QUARTER * walks[at(TIME, i)], NEWTON)", "min(walks[at(TIME, i)], NEWTON)")
    }),
    ("jkr", "tries counted on from place to place", |text| text.replace("walks[at(TRIES, i)] = ZERO;", "")),
    ("jkr", "given up without a last look", |text| {
        text.replace("var none: Numbers;\n        put_stride(i, &none, ONE);", "return LOST;")
    }),
    ("jkr", "the last look one stride on", |text| text.replace("        put_stride(i, &none, ONE);", "")),
    ("jkr", "any contact taken for the state's", |text| text.replace("!(memory && other)", "true")),
    ("hertz", "taken for found a step early", |text| {
        text.replace(
            "if finite(long) && !(near < long) {",
            "if finite(long) && !(HALF * near < TENTH * long) {",
        )
    }),
    ("hertz", "found without the last step", |text| text.replace("            move_by(i, &step);", "")),
    ("dmt", "near for far", |text| {
        text.replace("near * (ONE + steep) < walks", "TENTH * TENTH * near < walks")
    }),
    ("jkr", "enough is what is near", |text| {
        text.replace("let enough = cases[at(CASE_ENOUGH, i)]", "let enough = cases[at(CASE_NEAR, i)]")
    }),
    ("jkr", "rates left as they are", |text| {
        text.replace(
            "states[at(STATE_U_1, i)] = walks[at(MODES + 1u, i)] + walks[at(STRIDE + MODES + 1u, i)];",
            "",
        )
    }),
    ("jkr", "out of contact where a period begins", |text| {
        text.replace(
            "states[at(STATE_TOUCHING, i)] = cases[at(CASE_TOUCHING, i)];",
            "states[at(STATE_TOUCHING, i)] = ZERO;",
        )
    }),
    ("hertz", "steps since the last kick counted on", |text| text.replace("    marks[at(1u, i)] = 0u;", "")),
    ("dmt", "all stepped in each round", |text| {
        text.replace("if number >= going[job.round] {", "if number >= job.instances {")
            .replace("let i = going[listed(job.round, number)];", "let i = number;")
    }),
    ("dmt", "one left out in the second round", |text| {
        text.replace("nth >= going[job.round]", "nth >= going[job.round] - min(job.round, 1u)")
    }),
];

/// What no test should see: the same said otherwise.
const HARMLESS: &[Fault] = &[
    ("jkr", "nothing", |text| text),
    ("dmt", "factors swapped", |text| {
        text.replace("-share * by + factors[place]", "by * -share + factors[place]")
    }),
    ("hertz", "a list in the order of the threads", |text| {
        text.replace(
            "let i = going[listed(job.round, number)];",
            "let i = going[listed(job.round, going[job.round] - 1u - number)];",
        )
    }),
];

/// What a fault is looked for with, and what the CPU makes of it: by law.
type Truths = BTreeMap<&'static str, Vec<((Plan, NewtonStarts), NewtonResults)>>;

fn truths() -> Truths {
    let truth = |begun: (Plan, NewtonStarts)| {
        let truth = sought(&Cpu { strict: true }, &begun);
        (begun, truth)
    };
    let of = |law: &'static str| {
        let (plan, seeks) = begun(law, 3, WARM[0]);
        let with = |near, enough| NewtonStarts { near, enough, ..seeks.clone() };
        let mut all = vec![truth((plan.clone(), with(1e-7, 1e-4)))];
        if law == "jkr" {
            // Newton's steps from afar, to where the map is too rough for them.
            let mut seeks = with(0.0, 1e-2);
            seeks.all.iter_mut().for_each(|one| one.time = f64::INFINITY);
            all.extend([truth((plan, seeks)), truth(held())]);
        }
        (law, all)
    };
    ["hertz", "dmt", "jkr"].into_iter().map(of).collect()
}

fn seen((law, what, plant): &Fault, truths: &Truths) -> bool {
    let mut faulty: Gpu = gpu();
    faulty.drill.edit = Some(*plant);
    truths[law].iter().any(|(begun, truth)| {
        let ours = sought(&faulty, begun);
        !ours.notes.is_empty() || same(&ours, truth, what).is_err()
    })
}

fn every_fault_is_seen() -> Result<(), Failed> {
    let truths = truths();
    let missed: Vec<&str> =
        FAULTS.iter().filter(|fault| !seen(fault, &truths)).map(|fault| fault.1).collect();
    println!("{} of {} planted faults seen", FAULTS.len() - missed.len(), FAULTS.len());
    assert!(missed.is_empty(), "not seen: {missed:?}");
    let wrong: Vec<&str> =
        HARMLESS.iter().filter(|fault| seen(fault, &truths)).map(|fault| fault.1).collect();
    assert!(wrong.is_empty(), "seen: {wrong:?}");
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let runs = shader::exact(found) && found.iter().any(|one| one.double);
    vec![Trial::test("newton_every_fault_is_seen", every_fault_is_seen).with_ignored_flag(!runs)]
}
