//! Whether the accuracy asked for is met, and at what cost: random ensembles, the choice of steps, the choice of
//! modes, each against the reference engine.
//!
//! `cargo bench --bench accuracy -- [--part ensemble|contacts|levers|shaken|steps|modes|basis] [--law LAW] [--accuracy A] [--instances N] [--waits N] [--seed S] [-o FOLDER]`; the
//! answer is tables, and a page in FOLDER.

mod basis;
mod ensemble;
mod modes;
#[path = "../common/page.rs"]
mod page;
#[path = "../common/random.rs"]
mod random;
mod steps;

use afmsweep::engine::processor;
use page::Part;

/// Columns of the ensembles whose instances are others for each accuracy; the last is a time.
const OWN_LEVERS: [(&str, &str); 21] = [
    ("law", "law"),
    ("accuracy", "asked"),
    ("instances", "instances"),
    ("ok", "ok, with a truth"),
    ("free", "ok, never in contact"),
    ("no_truth", "ok, without a truth"),
    ("beyond_series", "ok, beyond the series"),
    ("accuracy_not_met", "accuracy_not_met"),
    ("not_steady", "not_steady"),
    ("unsteady_asked", "of them the reference was asked about"),
    ("unsteady_with_a_state", "and has a state for"),
    ("sensitive", "sensitive"),
    ("out_of_range", "out_of_range"),
    ("median", "median error"),
    ("p95", "95 %"),
    ("largest", "largest"),
    ("above_the_ask", "above the ask"),
    ("above_three_times_the_ask", "above 3 times"),
    ("estimate_too_low_by_three", "estimate too low by 3"),
    ("mean_steps_per_period", "mean steps per period"),
    ("seconds", "s"),
];

fn main() {
    let (mut count, mut waits, mut seed, mut output) = (100, 20, 1, None);
    let (mut part, mut only) = (String::new(), ensemble::Only::default());
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--instances" => count = value().parse().expect("a number of instances, for each law"),
            "--waits" => waits = value().parse().expect("a number of instances, for each law"),
            "--seed" => seed = value().parse().expect("a seed"),
            "--part" => part = value(),
            "--law" => only.law = Some(value()),
            "--accuracy" => only.accuracy = Some(value().parse().expect("1e-2, 1e-3 or 1e-4")),
            "-o" => output = Some(value()),
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    assert!(
        ["", "ensemble", "contacts", "levers", "shaken", "steps", "modes", "basis"].contains(&part.as_str()),
        "no part {part}"
    );
    println!("{}", processor());
    let wanted = |name: &str| part.is_empty() || part == name;
    let parts = [
        Part {
            heading: "Whether the accuracy is met",
            text: "Random instances from wide ranges (samples of 10 MPa to 100 GPa, work of adhesion 1 mJ/m^2 to 0.2 J/m^2, tips of 5 to 100 nm, quality factors 10 to 60, free amplitudes 5 to 100 nm, gaps of 0.3 to 1.05 of them), every observable but the whole number of contacts, the precision left to the run as on the command line; errors are the worst observable's on its scale, against the reference engine with all modes: of each instance that the run for 1e-4 calls ok its own periodic state next to the run's. Some of them the reference also waited for, as the engines do (400 periods): the last column. Counted are instances that are ok and have a truth. An estimate is too low if the error is three times it, and above a tenth of the accuracy.",
            columns: &[
                ("law", "law"),
                ("accuracy", "asked"),
                ("instances", "instances"),
                ("ok", "ok"),
                ("median", "median error"),
                ("p95", "95 %"),
                ("largest", "largest"),
                ("above_the_ask", "above the ask"),
                ("above_three_times_the_ask", "above 3 times"),
                ("estimate_too_low_by_three", "estimate too low by 3"),
                ("mean_steps_per_period", "mean steps per period"),
                ("in_f32", "in f32"),
                ("seconds", "s"),
                ("waits_same", "waits to that state"),
                ("waits_steady", "of"),
            ],
            rows: if wanted("ensemble") {
                ensemble::run(&ensemble::USUAL, &only, count, waits, seed)
            } else {
                Vec::new()
            },
        },
        Part {
            heading: "The same for samples with losses, other tips, layers, and forces beside the contact",
            text: "Random instances as in the first table: samples with losses up to 5 GPa, retardation and relaxation times of 0.01 to 5 of a radian of the drive, instantaneous moduli of 1.1 to 10 times the slow one; half-angles of 10 to 70 degrees; layers of 0.5 to 50 radii; biases of 0.1 to 5 V at a cut-off of 0.3 to 3 nm, without a cone, and at 1 nm with one of 20 degrees and 12 um; screening lengths of 0.5 to 20 nm; hydration of 0.1 to 100 MPa over 0.2 to 1 nm; liquid necks of 1 to 30 nN that form at 0.1 to 1 nm and break at 1.2 to 8 times that, inverse-square and linear; a table of eight rows, alone and with a way out. Other instances for each accuracy; periodic states searched for, 200 periods waited where none is found. Truth as in the next table; those who sink in beyond the range of their law's series are not compared.",
            columns: &OWN_LEVERS[..OWN_LEVERS.len() - 1],
            rows: if wanted("contacts") {
                ensemble::run(&ensemble::CONTACTS, &only, count, waits, seed)
            } else {
                Vec::new()
            },
        },
        Part {
            heading: "The same for all kinds of levers",
            text: "Random instances as above, each with a lever of its own: 0.03 to 100 N/m, 10 kHz to 1 MHz, quality factors 1.5 to 1,000, samples of 1 MPa to 200 GPa, tips of 2 to 200 nm, free amplitudes of 1 to 200 nm, gaps of 0.2 to 1.05 of them; other instances for each accuracy; periodic states searched for, 200 periods waited where none is found. Truth: the reference's own periodic state next to the run's, or, where there is none, its own run of 200 periods; motion that never meets the sample needs no steps and is not compared. Of the instances that are not steady the reference was asked about some: whether there is a periodic state next to where the run ends.",
            columns: &OWN_LEVERS,
            rows: if wanted("levers") {
                ensemble::run(&ensemble::LEVERS, &only, count, waits, seed)
            } else {
                Vec::new()
            },
        },
        Part {
            heading: "The same for levers shaken at the base, off resonance",
            text: "Each instance with a lever of its own as above, from wider ranges: 0.02 to 300 N/m, 3 kHz to 3 MHz, quality factors 1.2 to 3,000, samples of 0.2 MPa to 400 GPa, tips of 1 to 500 nm with a mass of 0.001 to 0.3 of the lever's effective mass, free amplitudes of 0.5 to 300 nm; shaken at the base at 0.85 to 1.15 of the lever's frequency.",
            columns: &OWN_LEVERS,
            rows: if wanted("shaken") {
                ensemble::run(&ensemble::SHAKEN, &only, count, waits, seed)
            } else {
                Vec::new()
            },
        },
        Part {
            heading: "What the choice of steps costs",
            text: "For 1e-3: the cheapest number of steps for all instances that meets it for a sample of each scene, against the mean of the steps that each instance was given, and against all that was stepped, estimates included. Errors are the steps' alone.",
            columns: &[
                ("scene", "scene"),
                ("instances", "instances"),
                ("ok", "ok of the sample"),
                ("uniform_steps", "uniform steps"),
                ("uniform_error", "largest error"),
                ("chosen_mean_steps", "chosen, mean"),
                ("chosen_error", "largest error"),
                ("chosen_over_uniform", "chosen over uniform"),
                ("with_estimates_over_uniform", "with estimates over uniform"),
            ],
            rows: if wanted("steps") { steps::run(count.min(64), seed) } else { Vec::new() },
        },
        Part {
            heading: "What leaving modes out costs",
            text: "A calibrated lever on samples from soft to stiff: the reference engine with the kept oscillators against itself with all modes, beside what the run estimated.",
            columns: &[
                ("modes", "modes"),
                ("kept", "oscillators"),
                ("sample_modulus_pa", "sample, Pa"),
                ("measured", "measured, worst observable"),
                ("estimated", "estimated"),
                ("amplitude", "of the amplitude"),
                ("force_max", "of the largest force"),
            ],
            rows: if wanted("modes") { modes::run() } else { Vec::new() },
        },
        Part {
            heading: "The largest force by few oscillators",
            text: "A lever of 0.1 N/m and quality factor 3 on samples from soft to stiff: error of the largest force with so many of the lowest modes and nothing for the rest, and with so many oscillators of the reduction (modes that ring on, and a rational Krylov reduction of the tip's compliance by the others), all with 16,384 steps per period, against the reference engine. Seconds are of all five samples together.",
            columns: &[
                ("oscillators", "oscillators"),
                ("sample_modulus_pa", "sample, Pa"),
                ("contact_time", "in contact, of the period"),
                ("lowest_modes", "lowest modes"),
                ("reduction", "reduction"),
                ("seconds_lowest", "s"),
                ("seconds_reduction", "s"),
            ],
            rows: if wanted("basis") { basis::run() } else { Vec::new() },
        },
    ];
    if let Some(folder) = output {
        // Where the page is put is not part of what it says.
        let mut told: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
        if let Some(place) = told.iter().position(|word| word == "-o") {
            told.drain(place..place + 2);
        }
        let command = format!("cargo bench --bench accuracy -- {}", told.join(" "));
        page::write(&folder, "Accuracy asked for and met", &command, &parts);
    }
}
