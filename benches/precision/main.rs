//! Work-precision diagrams: error against time and steps for this crate's engines, the classical Runge-Kutta method
//! vectorised by hand and adaptive library solvers, on one reduced problem for each law, in one run.
//!
//! `cargo bench --features peers --bench precision -- [--instances N] [--few N] [--seed S] [--repeats N]
//! [--laws hertz,dmt,jkr] [--python PROGRAM] [--command TEXT] [-o DIR]`; without the feature Rust's libraries stay out.
//! With `--python`, the interpreter of an environment with `requirements.txt`, the solvers of `peers.py` take part
//! (`make peers` does it all). The answer is a table, and a page, a CSV and pictures in DIR, which say that TEXT made them.
//! With `--contacts` all other contacts take their place, by this crate's CPU engine alone.

mod answer;
mod contacts;
#[cfg(feature = "peers")]
mod diffsolve;
#[cfg(feature = "peers")]
mod dopri;
mod lanes;
mod law;
mod level;
mod measure;
mod page;
#[path = "../common/page.rs"]
mod page_of_tables;
mod problem;
mod python;
#[path = "../common/random.rs"]
mod random;
mod rk4;
mod settled;
mod story;
#[cfg(feature = "peers")]
mod walk;

use afmsweep::contact::Law;
use afmsweep::report::{check_folder, save};
use measure::{Devices, Point, measure};
use page::Story;
use problem::{LAWS, Problem, name};
use std::collections::BTreeMap;
use std::path::Path;
use story::story;

/// What was asked for.
pub struct Arguments {
    instances: usize,
    few: usize,
    seed: u64,
    repeats: u32,
    laws: Vec<String>,
    python: Option<String>,
    output: Option<String>,
    /// Contacts in place of the laws that other solvers have.
    contacts: bool,
    /// As it is to be told on the page.
    command: String,
}

impl Arguments {
    fn wants(&self, law: Law) -> bool {
        self.laws.is_empty() || self.laws.iter().any(|wanted| wanted == name(law))
    }
}

fn arguments() -> Arguments {
    let mut all = Arguments {
        instances: 256,
        few: 4,
        seed: 1,
        repeats: 3,
        laws: Vec::new(),
        python: None,
        output: None,
        contacts: false,
        command: "cargo bench --bench precision".to_owned(),
    };
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
            "--contacts" => all.contacts = true,
            "-o" => all.output = Some(value()),
            "--command" => all.command = value(),
            // cargo bench adds it.
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    all
}

fn main() {
    let arguments = arguments();
    // CPU-seconds of one thread are what is compared.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("nothing has started threads yet");
    if arguments.contacts {
        let Arguments { laws, instances, seed, output, command, .. } = &arguments;
        let folder = output.as_deref().expect("a folder by -o");
        return contacts::run(laws, *instances, *seed, folder, command);
    }
    let output = arguments.output.as_ref().map(Path::new);
    // Rather now than after all the work.
    if let Some(Err(error)) = output.map(|folder| check_folder(folder, page::GENERATOR)) {
        panic!("{error}");
    }
    let mut devices = Devices::find();
    let mut points = Vec::new();
    let mut versions = BTreeMap::new();
    let mut counted = Vec::new();
    let mut states = Vec::new();
    for law in LAWS {
        if !arguments.wants(law) {
            continue;
        }
        let problem = Problem::new(law, arguments.instances, arguments.few, arguments.seed);
        counted.push(format!("{} of {} under {}", problem.counted(), arguments.instances, problem.name));
        let mut found = measure(&problem, &mut devices, arguments.repeats);
        if let Some(interpreter) = &arguments.python {
            let (more, used) = python::measure(&problem, interpreter);
            found.extend(more);
            versions.extend(used);
        }
        let settled = settled::measure(&problem, arguments.repeats);
        for point in found.iter().chain(&settled.points) {
            print(point);
        }
        println!("{} periods waited: {:?}", problem.name, settled.waiting);
        states.push(settled);
        points.extend(found);
    }
    let Some(folder) = output else { return };
    let story = Story {
        command: arguments.command.clone(),
        date: afmsweep::store::now(),
        paragraphs: story(&arguments, &devices, &versions, &counted),
    };
    let written = save(folder, page::GENERATOR, &page::files(&points, &states, &story));
    written.unwrap_or_else(|error| panic!("{error}"));
    println!("{}", folder.join("README.md").display());
}

fn print(point: &Point) {
    println!(
        "{:<6}{:<20}{:<22}{:>8.0}{:>12.3e} s{:>10.1e}{:>10.1e}{:>10.1e}{:>6} counted{:>4} given up",
        point.law,
        point.solver,
        point.setting,
        point.steps.unwrap_or(f64::NAN),
        point.seconds,
        point.errors.median,
        point.errors.p95,
        point.errors.largest,
        point.errors.counted,
        point.failed
    );
}
