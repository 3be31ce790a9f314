//! Work-precision diagrams: error against time and steps for this crate's engines, the classical Runge-Kutta method
//! vectorised by hand and adaptive library solvers, on one reduced problem for each law, in one run.
//!
//! `cargo bench --bench precision -- [--instances N] [--few N] [--seed S] [--repeats N] [--laws hertz,dmt,jkr]
//! [--python PROGRAM] [-o DIR]`; with `--python`, the interpreter of an environment with `requirements.txt`, the solvers of
//! `peers.py` take part (`make peers` does it all). The answer is a table, and a page, a CSV and pictures in DIR.

mod answer;
mod diffsolve;
mod dopri;
mod lanes;
mod law;
mod measure;
mod problem;
mod rk4;
mod walk;

use measure::{Devices, measure};
use problem::{LAWS, Problem};

struct Arguments {
    instances: usize,
    few: usize,
    seed: u64,
    repeats: u32,
    laws: Vec<String>,
    python: Option<String>,
    output: Option<String>,
}

fn arguments() -> Arguments {
    let mut all =
        Arguments { instances: 256, few: 8, seed: 1, repeats: 5, laws: Vec::new(), python: None, output: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--instances" => all.instances = value().parse().expect("a number of instances"),
            "--few" => all.few = value().parse().expect("a number of instances for slow solvers"),
            "--seed" => all.seed = value().parse().expect("a seed"),
            "--repeats" => all.repeats = value().parse().expect("a number of rounds"),
            "--laws" => all.laws = value().split(',').map(str::to_owned).collect(),
            "--python" => all.python = Some(value()),
            "-o" => all.output = Some(value()),
            // cargo bench adds it.
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    all
}

fn main() {
    let arguments = arguments();
    let mut devices = Devices::find();
    for law in LAWS {
        let problem = Problem::new(law, arguments.instances, arguments.few, arguments.seed);
        if !arguments.laws.is_empty() && !arguments.laws.iter().any(|name| name == problem.name) {
            continue;
        }
        println!("{}: {} of {} instances count", problem.name, problem.counted(), arguments.instances);
        for point in measure(&problem, &mut devices, arguments.repeats, 1.0) {
            println!(
                "{:<20}{:<12}{:>8.0}{:>12.3e}{:>10.1e}{:>10.1e}{:>10.1e} failed {} counted {}",
                point.solver, point.setting, point.steps.unwrap_or(f64::NAN), point.seconds,
                point.errors.median, point.errors.p95, point.errors.largest, point.failed, point.errors.counted
            );
        }
    }
    println!("{:?}", devices.notes);
}
