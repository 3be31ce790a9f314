//! What a run costs as a user has it: the program itself, from start to file, over the size and the kind of the sweep.
//!
//! `cargo bench --bench size -- [--largest N] [--starts N] [--kinds] [-o FOLDER]`; tables, and a page in FOLDER. `--kinds` makes
//! another page: what kinds of sweep cost.

#[path = "../common/page.rs"]
mod page;
mod program;
mod sweep_kinds;

use page::Part;
use program::{Folder, Run};
use serde_json::{Value, json};

/// A sweep of `counts` over work of adhesion, modulus and radius.
#[derive(Clone, Copy)]
struct Scene<'a> {
    law: &'a str,
    /// More lines of `[instrument.tip]`, `[sample]` and `[contact]`.
    more: [&'a str; 3],
    counts: [usize; 3],
    modulus: &'a str,
    observables: &'a str,
    run: &'a str,
}

const SOFT: &str = r#"from = "0.1 GPa", to = "10 GPa""#;
const HARD: &str = r#"from = "1 GPa", to = "100 GPa""#;
const USUAL: &str = r#""amplitude", "phase", "force_max""#;

/// Contacts beside the three laws: what they are, their law, and their lines.
const CONTACTS: [(&str, &str, [&str; 3]); 8] = [
    ("dmt, viscous", "dmt", ["", LOSS, ""]),
    ("hertz, relaxing", "hertz", ["", RELAXES, ""]),
    ("dmt, exact sphere", "dmt", ["shape = \"sphere\"", "", ""]),
    ("dmt with a charged tip", "dmt", ["", "", CHARGES]),
    ("dmt with a liquid neck", "dmt", ["", "", NECK]),
    ("jkr with a charged tip", "jkr", ["", "", CHARGES]),
    ("dmt, viscous, with a charged tip", "dmt", ["", LOSS, CHARGES]),
    ("hertz, relaxing, with a charged tip", "hertz", ["", RELAXES, CHARGES]),
];
const LOSS: &str = "retardation_time = \"50 ns\"";
const RELAXES: &str = "instantaneous_modulus = \"20 GPa\"\nrelaxation_time = \"1 us\"";
const CHARGES: &str = "[[contact.outside]]\nforce = \"electrostatic\"\nbias = \"1 V\"\ncut_off = \"0.5 nm\"";
const NECK: &str = "[[contact.outside]]\nforce = \"capillary\"\nstrength = \"10 nN\"\nforms_at = \"0.4 nm\"\nbreaks_at = \"2 nm\"";

impl Scene<'_> {
    fn text(&self) -> String {
        let decay = if self.law == "dmt" { "decay_length = \"0.3 nm\"" } else { "" };
        let [adhesion, modulus, radius] = self.counts;
        let [tip, sample, contact] = self.more;
        let axis = |count: usize, path: &str, range: &str| match count {
            0 | 1 => String::new(),
            _ => format!("\"{path}\" = {{ {range}, points = {count}, scale = \"log\" }}\n"),
        };
        let sweep = [
            axis(adhesion, "sample.surface_energy", r#"from = "1 mJ/m^2", to = "100 mJ/m^2""#),
            axis(modulus, "sample.youngs_modulus", self.modulus),
            axis(radius, "instrument.tip.radius", r#"from = "5 nm", to = "40 nm""#),
        ]
        .concat();
        let sweep = if sweep.is_empty() { sweep } else { format!("[sweep]\n{sweep}") };
        format!(
            r#"
[instrument]
preset = "ha-fung-chen-2005"
[instrument.actuator]
quality_factor = 100
[instrument.cantilever]
quality_factor = 150
[instrument.tip]
radius = "20 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
{tip}
[sample]
youngs_modulus = "2 GPa"
poisson_ratio = 0.3
surface_energy = "20 mJ/m^2"
{sample}
[contact]
law = "{}"
{decay}
{contact}
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "17 nm"
{sweep}
[run]
periods = 480
measure = 20
accuracy = 1e-3
{}
[output]
observables = [{}]
"#,
            self.law, self.run, self.observables
        )
    }
}

const SEARCHED: &str = "steady = \"search\"";

/// About `count` instances on three axes.
fn cube(count: usize) -> [usize; 3] {
    match count {
        1_000_000 => [100, 100, 100],
        100_000 => [40, 50, 50],
        10_000 => [20, 20, 25],
        1_000 => [10, 10, 10],
        _ => [4, 5, 5],
    }
}

fn row(mut head: Value, run: &Run) -> Value {
    let per_instance = (run.stepping.max(1e-9)) / run.instances.max(1) as f64;
    for (key, value) in [
        ("wall_s", json!(run.wall)),
        ("stepping_s", json!(run.stepping)),
        ("share", json!(run.stepping / run.wall)),
        ("microseconds_each", json!(1e6 * per_instance)),
        ("rate", json!(run.rate)),
        ("memory_mb", json!(run.memory_mb)),
        ("estimate", json!(run.largest_estimate)),
        ("doubtful", json!(run.doubtful)),
    ] {
        head[key] = value;
    }
    println!("{head}");
    head
}

fn sizes(folder: &Folder, largest: usize) -> Vec<Value> {
    let mut rows = Vec::new();
    for (law, modulus, named) in [
        ("dmt", SOFT, "0.1 to 10"),
        ("jkr", SOFT, "0.1 to 10"),
        ("dmt", HARD, "1 to 100"),
        ("jkr", HARD, "1 to 100"),
    ] {
        for count in [100, 1_000, 10_000, 100_000, 1_000_000].into_iter().filter(|count| *count <= largest) {
            let counts = cube(count);
            let text =
                Scene { law, more: [""; 3], counts, modulus, observables: USUAL, run: SEARCHED }.text();
            let run = folder.run(&text, &["--no-audit"]);
            let mut one = row(json!({ "law": law, "modulus_gpa": named, "instances": run.instances }), &run);
            parts(&mut one, &run);
            rows.push(one);
        }
    }
    rows
}

/// What each instance costs, part by part: microseconds of one core. What is no part of them is plans, results, records.
fn parts(row: &mut Value, run: &Run) {
    let each = |seconds: Option<f64>| seconds.map(|s| 1e6 * s / run.instances.max(1) as f64);
    row["steps_each"] = json!(run.number(&["instance_steps_taken"]).map(|n| n / run.instances.max(1) as f64));
    row["fell_back"] = json!(run.number(&["neighbour_started"]).map(|share| 1.0 - share));
    row["core_us"] = json!(each(run.number(&["processor_time_s"])));
    for part in ["steps", "algebra", "constants"] {
        row[format!("{part}_us")] = json!(each(run.number(&["busy_time_s", part])));
    }
    row["planning_us"] = json!(each(run.number(&["planning_time_s"])));
    row["file_us"] = json!(each(run.number(&["writing_time_s"])));
}

/// Ten thousand instances of a law and what it observes once, waited for 480 periods of 192 steps.
fn once(folder: &Folder, what: &str, (law, more): (&str, [&str; 3]), kind: (&str, usize, &[&str])) -> Value {
    let (observables, modes, options) = kind;
    let run = format!("modes = {modes}\nsteps_per_period = 192");
    let scene = Scene { law, more, counts: cube(10_000), modulus: SOFT, observables, run: &run };
    let options = [&["--no-estimate", "--no-audit"], options].concat();
    row(json!({ "what": what }), &folder.run(&scene.text(), &options))
}

/// What an instance costs in sweeps of many kinds.
fn sweeps(folder: &Folder) -> Vec<Value> {
    let one = |(what, text): (String, String)| {
        let run = folder.run(&text, &["--no-audit"]);
        let mut told = json!({ "what": what, "instances": run.instances });
        parts(&mut told, &run);
        row(told, &run)
    };
    sweep_kinds::all().into_iter().map(one).collect()
}

fn kinds(folder: &Folder) -> Vec<Value> {
    let (plain, single) = ([""; 3], ["--precision", "f32"]);
    let mut rows = Vec::new();
    for modes in 1..=8 {
        let what = format!("dmt, {modes} modes, f32");
        rows.push(once(folder, &what, ("dmt", plain), (USUAL, modes, &single)));
    }
    let laws = ["hertz", "dmt", "jkr"].map(|law| (law, law, plain));
    for (name, law, more) in laws.into_iter().chain(CONTACTS) {
        for precision in ["f32", "f64"] {
            let what = format!("{name}, 4 modes, {precision}");
            rows.push(once(folder, &what, (law, more), (USUAL, 4, &["--precision", precision])));
        }
    }
    for observable in [
        "amplitude",
        "phase",
        "force_max",
        "force_min",
        "indentation_max",
        "contact_time",
        "contacts",
        "force_mean",
        "dissipation",
        "virial",
        "harmonic_amplitude",
    ] {
        let what = format!("dmt, 4 modes, f32, {observable} alone");
        rows.push(once(folder, &what, ("dmt", plain), (&format!("\"{observable}\""), 4, &single)));
    }
    for threads in ["1", "2"] {
        let what = format!("dmt, 4 modes, f32, threads {threads}");
        let options = ["--precision", "f32", "--threads", threads];
        rows.push(once(folder, &what, ("dmt", plain), (USUAL, 4, &options)));
    }
    rows
}

/// From start to file: one instance, many times; quickstart with and without an audit.
fn ends(folder: &Folder, starts: usize) -> Vec<Value> {
    let one = Scene {
        law: "dmt",
        more: [""; 3],
        counts: [1, 1, 1],
        modulus: SOFT,
        observables: USUAL,
        run: SEARCHED,
    };
    let one = one.text();
    let mut walls: Vec<Run> =
        (0..starts.max(1)).map(|_| folder.run(&one, &["--backend", "cpu", "--no-audit"])).collect();
    walls.sort_by(|a, b| a.outside.total_cmp(&b.outside));
    let middle = &walls[walls.len() / 2];
    let mut rows = Vec::new();
    let mut first = row(json!({ "what": "one instance, searched, the middle of many starts" }), middle);
    first["outside_s"] = json!(middle.outside);
    rows.push(first);
    let quick = std::fs::read_to_string("scenes/quickstart.toml").expect("the scene of the README");
    for (what, options) in [
        ("quickstart", vec!["--backend", "cpu"]),
        ("quickstart, no audit", vec!["--backend", "cpu", "--no-audit"]),
        ("quickstart, no audit, f64", vec!["--backend", "cpu", "--no-audit", "--precision", "f64"]),
    ] {
        let run = folder.run(&quick, &options);
        let mut one = row(json!({ "what": what }), &run);
        one["outside_s"] = json!(run.outside);
        rows.push(one);
    }
    rows
}

fn main() {
    let mut args = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let (mut largest, mut starts, mut kinds_alone, mut output) = (1_000_000, 21, false, None);
    let given: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    while let Some(arg) = args.next() {
        let mut value = || args.next().unwrap_or_else(|| panic!("{arg} needs a value"));
        match arg.as_str() {
            "--largest" => largest = value().parse().expect("--largest: a number"),
            "--starts" => starts = value().parse().expect("--starts: a number"),
            "--kinds" => kinds_alone = true,
            "-o" => output = Some(value()),
            other => panic!("unknown option {other}: --largest N, --starts N, --kinds, -o FOLDER"),
        }
    }
    let folder = Folder::new();
    let costs: &[(&str, &str)] = &[
        ("wall_s", "wall, s"),
        ("stepping_s", "of it stepping, s"),
        ("share", "share"),
        ("microseconds_each", "microseconds per instance"),
        ("memory_mb", "memory at most, MB"),
        ("estimate", "largest estimated error"),
        ("doubtful", "not called ok"),
    ];
    let with = |head: &[(&'static str, &'static str)]| -> Vec<(&str, &str)> { [head, costs].concat() };
    let size_columns = with(&[("law", "law"), ("modulus_gpa", "modulus, GPa"), ("instances", "instances")]);
    let part_columns = [
        ("law", "law"),
        ("modulus_gpa", "modulus, GPa"),
        ("instances", "instances"),
        ("steps_each", "instance-steps"),
        ("fell_back", "searched for by itself"),
        ("core_us", "core-microseconds"),
        ("steps_us", "steps"),
        ("algebra_us", "algebra"),
        ("constants_us", "constants"),
        ("planning_us", "planning"),
        ("file_us", "writing"),
    ];
    let sweep_columns = [
        ("what", "what"),
        ("instances", "instances"),
        ("steps_each", "instance-steps each"),
        ("core_us", "core-microseconds each"),
        ("wall_s", "wall, s"),
        ("fell_back", "searched for by itself"),
        ("estimate", "largest estimated error"),
        ("doubtful", "not called ok"),
    ];
    let of_sweeps = |rows| Part {
        heading: "Over kinds of sweep",
        text: "Levers of 300 kHz with a free amplitude of 40 nm and, where nothing else is said, a quality factor of 200, on \
               samples of 1 to 100 GPa at gaps of 16 to 38 nm, accuracy 1e-3. Designs are Sobol's, in four quantities, or in \
               six with the lever's. Set-points are 0.4 to 0.95 of the amplitude; curves are 100, of 100 points each way.",
        columns: &sweep_columns,
        rows,
    };
    let write = |parts: &[Part]| {
        if let Some(output) = &output {
            let command = format!("cargo bench --bench size -- {}", given.join(" "));
            page::write(output, "Cost against size", &command, parts);
        }
    };
    if kinds_alone {
        return write(&[of_sweeps(sweeps(&folder))]);
    }
    let of_sizes = sizes(&folder, largest);
    let kind_columns =
        [("what", "what"), ("stepping_s", "stepping, s"), ("rate", "instance-steps per second")];
    let end_columns = with(&[("what", "what"), ("outside_s", "process, s")]);
    let parts = [
        Part {
            heading: "Over the number of instances",
            text: "afmsweep run --no-audit: each a converged tapping case (quality factor 150, free \
                   amplitude 20 nm, gap 17 nm, accuracy 1e-3; amplitude, phase, largest force), periodic states \
                   searched for, modes and steps by estimate.",
            columns: &size_columns,
            rows: of_sizes.clone(),
        },
        Part {
            heading: "Where the processor's time goes",
            text: "Of the same runs, for each instance: instance-steps, trials and estimates among them; the share that was \
                   searched for by itself; microseconds of one core, user and system, and of them those that its threads \
                   spent stepping, in the algebra of guesses and searches, and in making constants; planning and writing by \
                   the clock. The rest is plans of parts, results and the journal. \
                   Few instances carry the start of the program and the trials.",
            columns: &part_columns,
            rows: of_sizes.clone(),
        },
        Part {
            heading: "Over modes, laws, observables, threads",
            text: "10,000 instances once, 480 periods of 192 steps: what a step costs.",
            columns: &kind_columns,
            rows: kinds(&folder),
        },
        Part {
            heading: "From start to file",
            text: "Process: from its start to its end, as a shell sees it.",
            columns: &end_columns,
            rows: ends(&folder, starts),
        },
    ];
    write(&parts);
}
