//! Whether the accuracy asked for is met, and at what cost: random ensembles, the choice of steps, the choice of
//! modes, each against the reference engine.
//!
//! `cargo bench --bench accuracy -- [--part ensemble|steps|modes] [--instances N] [--seed S] [-o FILE]`; the answer
//! is tables, and JSON in FILE.

mod ensemble;
mod modes;
#[path = "../common/random.rs"]
mod random;
mod steps;

use afmsweep::engine::processor;
use serde_json::json;

fn main() {
    let (mut count, mut seed, mut part, mut output) = (100, 1, String::new(), None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--instances" => count = value().parse().expect("a number of instances, for each law"),
            "--seed" => seed = value().parse().expect("a seed"),
            "--part" => part = value(),
            "-o" => output = Some(value()),
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    assert!(["", "ensemble", "steps", "modes"].contains(&part.as_str()), "no part {part}");
    println!("{}", processor());
    let wanted = |name: &str| part.is_empty() || part == name;
    let ensemble = if wanted("ensemble") { ensemble::run(count, seed) } else { Vec::new() };
    let steps = if wanted("steps") { steps::run(count.min(64), seed) } else { Vec::new() };
    let modes = if wanted("modes") { modes::run() } else { Vec::new() };
    if let Some(path) = output {
        let all = json!({
            "processor": processor(), "date": afmsweep::store::now(), "seed": seed,
            "ensemble": ensemble, "steps": steps, "modes": modes,
        });
        let text = serde_json::to_string_pretty(&all).expect("plain data");
        std::fs::write(&path, text + "\n").unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
