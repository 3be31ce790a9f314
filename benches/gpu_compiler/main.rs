//! What a real GPU's compiler makes of the shaders, without that GPU: registers, spills, waves, instructions of a step. Counted by
//! Mesa's RADV, which compiles for a card that it is told of (RADV_FORCE_FAMILY); nothing is run.
//!
//! `make gpu-compiler` holds every shader to what is kept, and fails where one is refused or got worse. `make gpu-compiler
//! KEEP=1` keeps what it finds: tables, and a page in results/gpu_compiler.

mod assembly;
mod device;
#[path = "../common/page.rs"]
mod page;

use afmsweep::engine::gpu::spirv;
use afmsweep::kernel::{Entry, Law, ShaderSpec, Wants};
use assembly::longest_loop;
use device::{Compiled, Device};
use page::Part;
use serde_json::{Value, json};
use std::time::Instant;

/// Numbers that must not grow, by their keys and what they are.
const KEPT: [(&str, &str); 3] =
    [("registers", "registers"), ("spilled", "spilled registers"), ("vector", "vector instructions a step")];
const HEADING: &str = "What the compiler makes of each shader";

/// A card, its compute units of 64 lanes, and its clock under load as its maker states it.
const CARDS: [(&str, f64, f64); 2] = [("Radeon RX 6900 XT", 80.0, 2.25e9), ("Radeon RX 6800", 60.0, 2.105e9)];

/// Shaders by name: parts of a run, its slopes, and the rounds of a search.
fn shaders() -> Vec<(&'static str, ShaderSpec)> {
    let extremes = Wants::EXTREMES;
    let runs = [
        ("settling", Entry::Sweep, extremes, false),
        ("measured", Entry::Sweep, extremes, true),
        ("slopes", Entry::Kicks, Wants::FUNDAMENTAL, false),
    ];
    let rounds = [
        ("all sums", Entry::Sweep, Wants::ALL, true),
        ("carry", Entry::Carry, Wants::FUNDAMENTAL, false),
        ("stride", Entry::Stride, extremes, true),
        ("walk", Entry::Walk, Wants::FUNDAMENTAL, false),
    ];
    let mut all = Vec::new();
    let decay = false;
    for (double, one_drive) in [(false, true), (false, false), (true, true), (true, false)] {
        for (name, entry, wants, measured) in runs {
            for law in Law::ALL {
                let more: &[usize] = if [Law::Hertz, Law::Dmt, Law::Jkr].contains(&law) { &[8] } else { &[] };
                for modes in [4].iter().chain(more) {
                    let modes = *modes;
                    let spec = ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive };
                    all.push((name, spec));
                }
            }
        }
        for (name, entry, wants, measured) in rounds {
            let (law, modes) = (Law::Dmt, 4);
            let spec = ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive };
            all.push((name, spec));
        }
        for modes in [16, 24] {
            let (law, entry, measured) = (Law::Dmt, Entry::Sweep, false);
            let wants = extremes;
            let spec = ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive };
            all.push(("settling", spec));
        }
    }
    all
}

/// What is printed, kept and compared of a shader.
fn row(head: &Value, compiled: &Compiled, seconds: f64) -> Value {
    let number =
        |name: &str| compiled.statistics.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
    let mut row = head.clone();
    row["registers"] = json!(number("VGPRs"));
    row["scalar"] = json!(number("SGPRs"));
    row["spilled"] = json!(number("Spilled VGPRs"));
    row["waves"] = json!(number("Subgroups per SIMD"));
    row["throughput"] = json!(number("Inverse Throughput"));
    row["bytes"] = json!(number("Code size"));
    let counted = longest_loop(&compiled.assembly);
    row["vector"] = json!(counted.map(|(all, _)| all.vector));
    row["least"] = json!(counted.map(|(_, least)| least.vector));
    row["quarter"] = json!(counted.map(|(all, _)| all.quarter));
    row["f64"] = json!(counted.map(|(all, _)| all.double));
    row["slots"] = json!(counted.map(|(_, least)| least.slots()));
    row["slots_all"] = json!(counted.map(|(all, _)| all.slots()));
    row["seconds"] = json!(seconds);
    row
}

/// What tells a row from the others.
fn label(row: &Value) -> String {
    let words = ["what", "law", "modes", "precision", "rounding", "drives"].map(|key| match &row[key] {
        Value::String(word) => word.clone(),
        other => other.to_string(),
    });
    words.join(", ")
}

/// Every shader's row, and what was refused.
fn compiled(device: &Device) -> (Vec<Value>, Vec<String>) {
    let (mut rows, mut refused) = (Vec::new(), Vec::new());
    for (what, spec) in shaders() {
        // Where lanes have several drives, rounding changes nothing that is not seen with one.
        let roundings: &[bool] = if spec.one_drive { &[true, false] } else { &[false] };
        for strict in roundings.iter().copied() {
            let head = json!({
                "driver": device.driver,
                "card": device.card,
                "what": what,
                "law": spec.law.name(),
                "modes": spec.modes,
                "precision": if spec.double { "f64" } else { "f32" },
                "drives": if spec.one_drive { "one" } else { "several" },
                "rounding": if strict { "each" } else { "fused" },
            });
            let start = Instant::now();
            let made = spirv(&spec.compose(), strict)
                .and_then(|words| device.compile(&spec, &words).map_err(|why| why.to_string()));
            match made {
                Ok(made) => {
                    let row = row(&head, &made, start.elapsed().as_secs_f64());
                    let of = |key: &str| row[key].to_string();
                    println!(
                        "{}: {} registers, {} spilled, {} waves, {} vector instructions a step, {:.1} s",
                        label(&row),
                        of("registers"),
                        of("spilled"),
                        of("waves"),
                        of("vector"),
                        start.elapsed().as_secs_f64()
                    );
                    rows.push(row);
                }
                Err(why) => refused.push(format!("{}: refused: {why}", label(&head))),
            }
        }
    }
    (rows, refused)
}

/// Where a shader got worse than what is kept, or is not kept.
fn worse(rows: &[Value], kept: &[Value]) -> Vec<String> {
    let mut told = Vec::new();
    for row in rows {
        let name = label(row);
        let Some(before) = kept.iter().find(|kept| label(kept) == name) else {
            told.push(format!("{name}: not kept"));
            continue;
        };
        for (key, what) in KEPT {
            if row[key].as_u64() > before[key].as_u64() {
                told.push(format!("{name}: {} {what}, kept are {}", row[key], before[key]));
            }
        }
    }
    told
}

/// Instance-steps a second by these counts: no memory, no waiting, every lane busy.
fn rates(rows: &[Value]) -> Vec<Value> {
    let settles = |row: &&Value| row["what"] == "settling" && row["modes"] == 4 && row["drives"] == "one";
    let mut rates = Vec::new();
    for (card, units, clock) in CARDS {
        for row in rows.iter().filter(settles) {
            let rate = |key: &str| row[key].as_f64().map(|slots| units * 64.0 * clock / slots);
            let mut one = row.clone();
            one["named_card"] = json!(card);
            one["out_of_contact"] = json!(rate("slots"));
            one["in_contact"] = json!(rate("slots_all"));
            rates.push(one);
        }
    }
    rates
}

fn keep(folder: &str, device: &Device, rows: &[Value]) {
    let made = format!(
        "{} for {}; nothing was run on a card. Rounding: each operation of the text rounds by itself, as in runs that have to equal the CPU to the bit, or sums and products may be fused. \
         Instructions are those of one turn of the longest loop, which is the one over steps in all but the rounds of a search (stride, walk), all branches together; the least is where no lane touches. \
         Drives: one whose constants a workgroup reads once, or several, which each lane reads by itself; inverse throughput is the compiler's own estimate for the whole shader. \
         Settling: the part of a run before it is measured; measured: amplitude, phase and extremes; all sums: every observable; slopes, carry: the Jacobian of a period map.",
        device.driver, device.card
    );
    let parts = [
        Part {
            heading: HEADING,
            text: &made,
            columns: &[
                ("what", "shader"),
                ("law", "law"),
                ("modes", "modes"),
                ("precision", "precision"),
                ("drives", "drives"),
                ("rounding", "rounding"),
                ("registers", "registers"),
                ("spilled", "spilled"),
                ("waves", "waves a SIMD"),
                ("vector", "vector instructions a step"),
                ("least", "the least"),
                ("throughput", "inverse throughput"),
                ("quarter", "at a quarter of the rate"),
                ("f64", "in f64"),
                ("bytes", "bytes of code"),
                ("seconds", "s to compile"),
            ],
            rows: rows.to_vec(),
        },
        Part {
            heading: "Instance-steps a second by these counts",
            text: "Counted, not run: lanes times clock over the issue slots of a settling step of 4 modes; a slow instruction takes four, one in f64 sixteen; no memory, no waiting, every lane busy. In contact: as if each step went through all branches.",
            columns: &[
                ("named_card", "card"),
                ("law", "law"),
                ("precision", "precision"),
                ("rounding", "rounding"),
                ("out_of_contact", "out of contact"),
                ("in_contact", "in contact"),
            ],
            rows: rates(rows),
        },
    ];
    page::write(folder, "Shaders by a GPU's compiler", "make gpu-compiler KEEP=1", &parts);
}

fn main() {
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    let (mut against, mut folder) = (None, None);
    while let Some(word) = words.next() {
        let value = words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--against" => against = Some(value),
            "-o" => folder = Some(value),
            other => panic!("unknown option {other}: --against FOLDER, -o FOLDER"),
        }
    }
    let device = Device::open().unwrap_or_else(|why| {
        eprintln!("no compiler: {why}");
        std::process::exit(1);
    });
    println!("{} for {}", device.driver, device.card);
    let (rows, mut told) = compiled(&device);
    if let Some(folder) = folder {
        keep(&folder, &device, &rows);
    }
    if let Some(folder) = against {
        let path = std::path::Path::new(&folder).join("numbers.json");
        let text = std::fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
        let kept: Value = serde_json::from_str(&text).expect("numbers.json is JSON");
        let kept = kept[HEADING].as_array().map_or(&[][..], Vec::as_slice);
        let other = kept.iter().find(|row| row["driver"] != device.driver || row["card"] != device.card);
        match other {
            Some(row) => {
                println!("NOT COMPARED: kept are the counts of {} for {}", row["driver"], row["card"])
            }
            None => told.extend(worse(&rows, kept)),
        }
    }
    println!("{} pipelines made, {} complaints", rows.len(), told.len());
    told.iter().for_each(|one| println!("{one}"));
    if !told.is_empty() {
        eprintln!(
            "a shader was refused, got worse, or is not kept; `make gpu-compiler KEEP=1` keeps what is so by intent"
        );
        std::process::exit(1);
    }
}
