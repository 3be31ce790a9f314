//! What the page says of the problem, of the solvers and of how they were measured.

use crate::Arguments;
use crate::measure::{Devices, LONGEST};
use afmsweep::engine::{Engine, processor};
use std::collections::BTreeMap;

/// Paragraphs: words that stand out, and the rest.
pub fn story(
    arguments: &Arguments,
    devices: &Devices,
    versions: &BTreeMap<String, String>,
    counted: &[String],
) -> Vec<(String, String)> {
    let gpu = devices.gpu.as_ref().map_or_else(|| "none".to_owned(), Engine::device);
    let machine = format!("CPU: {}, one thread; GPU: {gpu}.", processor());
    let problem = format!(
        "One calibrated lever (40 N/m, 300 kHz, Q 100, three modes, driven at the tip to 20 nm) taps on {} random samples of 10 \
         MPa to 10 GPa, with adhesion of 5 to 50 mJ/m^2 (DMT, JKR), tips of 5 to 40 nm and gaps of 0.5 to 0.95 of the free \
         amplitude; 200 drive periods from steady free motion, the last 10 measured. Every solver gets the same six equations \
         per instance, the free motion in closed form taken out, as this crate takes it out (benches/precision/problem.rs has \
         them).",
        arguments.instances
    );
    let errors = format!(
        "Of an instance the worst of amplitude, phase and largest force (JKR: and loss), on the scales on which accuracy \
         counts, against the reference engine (order 8, events located, tolerance 1e-13) on the same equations. Instances that \
         the reference calls steady count: {}. The slow solvers take a part of the ensemble, spread over it: the Rust libraries \
         every fourth instance, heyoka and diffrax up to 64, SciPy {}; their times are per instance.",
        counted.join(", "),
        arguments.few
    );
    let times = "CPU-seconds of the process, all threads together, of whole runs with the measuring of the observables: the \
                 fastest of several runs, in this program's part taken in turns. On a software driver the GPU engine's time is CPU \
                 time too, on a real GPU it is wall time, marked as such. Compiling (shaders, heyoka, JAX) is not counted.";
    let ours = "Every instance at the steps of the setting, without error control.";
    let rk4 = "Classical, f64, eight instances in a register and two registers in flight (multiversion, fused multiply-add), \
               free motion from a table, contact skipped where no lane touches, the peak of the force by a quintic through the \
               step's ends. Under JKR the memory changes between steps, which makes it of first order.";
    let mut all = vec![
        ("Machine.", machine),
        ("Problem.", problem),
        ("Errors.", errors),
        ("Times.", times.to_owned()),
        ("This crate.", ours.to_owned()),
        ("RK4 by hand.", rk4.to_owned()),
    ];
    if cfg!(feature = "peers") {
        all.push(("Rust libraries.", libraries()));
    }
    let version = |name: &str| versions.get(name).cloned().unwrap_or_default();
    if !versions.is_empty() {
        all.push((
            "Python.",
            format!(
                "SciPy {}: solve_ivp with RK45 and DOP853, a right-hand side in plain Python, JKR by terminal events. heyoka {}: \
                 taylor_adaptive_batch over eight instances, the law switched by terminal events (with callbacks in Python), or \
                 without events by a contact rounded off over a small width. diffrax {}: Tsit5 and Dopri8 under vmap and jit in \
                 f64; JKR is left out, since an event ends a solve there.",
                version("scipy"),
                version("heyoka"),
                version("diffrax")
            ),
        ));
    }
    all.extend(devices.notes.iter().map(|note| ("Not run.", note.clone())));
    all.into_iter().map(|(lead, text)| (lead.to_owned(), text)).collect()
}

/// A library's version, from the lock file this was built with.
fn dependency(name: &str) -> String {
    let lock = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.lock"));
    let entry = lock.split("[[package]]").find(|entry| entry.contains(&format!("name = \"{name}\"\n")));
    let version =
        entry.and_then(|entry| entry.split("version = \"").nth(1)).and_then(|rest| rest.split('"').next());
    version.unwrap_or("").to_owned()
}

fn libraries() -> String {
    format!(
        "ode_solvers {} (Dopri5, Dop853) has no root finding: under JKR the run is stopped, the place of the change found on a \
         quintic and the solver sent there. Its Dop853 takes one stage at a wrong time and is of first order where the equations \
         depend on time; with time as one more unknown it is of full order, and so it is used. diffsol {}: Tsit45, its explicit \
         method, with its own root finding. Relative and absolute tolerance alike, no step above {LONGEST} rad, else the first \
         contact is passed over.",
        dependency("ode_solvers"),
        dependency("diffsol")
    )
}
