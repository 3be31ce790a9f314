//! Errors beside steps for the contacts that no other solver here has: losses, other tips, layers, forces beside the contact.

use crate::answer::Errors;
use crate::measure::timed;
use crate::page_of_tables::{Part, write};
use crate::random::contact::{CONTACTS, Contact};
use crate::random::{Ranges, Wide, scene};
use afmsweep::engine::{Cpu, Engine, Model, Progress, Reference};
use afmsweep::observe::Observable;
use afmsweep::plan::{Plan, Precision};
use serde_json::{Value, json};

/// The lever of the other tables, damped so that a run settles soon; gaps within reach of the surface.
const FROM: Ranges = Ranges {
    quality: [9.0, 11.0],
    modulus: [10e6, 10e9],
    work: [5e-3, 50e-3],
    radius: [5e-9, 40e-9],
    amplitude: [20e-9; 2],
    gap: [0.5, 0.95],
    ..Ranges::USUAL
};
const RUN: &str = "periods = 60\nmeasure = 4\nmodes = 3\nsteps_per_period = 256";
const STEPS: [u32; 9] = [32, 64, 128, 256, 512, 1024, 2048, 4096, 8192];
const TOLERANCE: f64 = 1e-12;
const HEADING: &str = "Errors beside steps";

/// Every contact at each number of steps, into `folder`.
pub fn run(words: &[String], count: usize, seed: u64, folder: &str, command: &str) {
    let wanted = |contact: &&Contact| words.is_empty() || words.iter().any(|word| word == contact.word);
    let rows: Vec<Value> =
        CONTACTS.iter().filter(wanted).flat_map(|contact| rows(contact.word, count, seed)).collect();
    let text = format!(
        "{count} random instances of each contact: a calibrated lever (40 N/m, 300 kHz, Q 9 to 11, three modes, driven at the tip to \
         20 nm) on samples of 10 MPa to 10 GPa (with losses: to 5 GPa), work of adhesion 5 to 50 mJ/m^2, tips of 5 to 40 nm, gaps \
         of 0.5 to 0.95 of the free amplitude, and what the contact asks for beside, as in `cargo bench --bench accuracy`; 60 \
         periods, the last 4 measured, f64, without error control. Errors are the worst of amplitude, phase, least and largest \
         force and loss on its scale, against the reference engine with the same modes at a tolerance of {TOLERANCE:e}. The \
         order is by which power of the steps the median falls from the row before. Exact spheres and hyperboloids are a series in the \
         kernel and a closed form in the reference: their errors end where the two differ. Time is CPU time of one thread."
    );
    let columns = [
        ("contact", "contact"),
        ("steps", "steps a period"),
        ("counted", "steady"),
        ("median", "median error"),
        ("p95", "95 %"),
        ("largest", "largest"),
        ("order", "order"),
        ("microseconds", "us an instance"),
    ];
    write(folder, HEADING, command, &[Part { heading: HEADING, text: &text, columns: &columns, rows }]);
}

fn rows(word: &str, count: usize, seed: u64) -> Vec<Value> {
    let mut scene = scene(&Wide { law: word, count, seed, accuracy: 1e-2, from: FROM, run: RUN });
    scene.output.observables = vec![
        Observable::Amplitude,
        Observable::Phase,
        Observable::ForceMin,
        Observable::ForceMax,
        Observable::Dissipation,
    ];
    let plan = Plan::new(&scene, Precision::F64).unwrap_or_else(|error| panic!("{word}: {error}"));
    let reference = Reference { tolerance: TOLERANCE, model: Model::Kept };
    let truth = reference.run(&plan, &Progress::default()).expect("the plan can be run").results;
    let mut before: Option<f64> = None;
    let mut row = |steps: u32| {
        let plan = plan.clone().with_steps(|_| steps);
        let work = || Cpu::default().run(&plan, &Progress::default()).expect("the plan can be run").results;
        let (seconds, results) = timed("cpu", work);
        let ours = results.iter().enumerate().map(|(i, one)| (i, one.measured));
        let errors = Errors::of(&plan, &truth, ours);
        let order = before.replace(errors.median).map(|before| (before / errors.median).log2());
        let row = json!({
            "contact": word,
            "steps": steps,
            "counted": errors.counted,
            "median": errors.median,
            "p95": errors.p95,
            "largest": errors.largest,
            "order": order,
            "microseconds": 1e6 * seconds / count as f64,
        });
        println!("{row}");
        row
    };
    STEPS.into_iter().map(&mut row).collect()
}
