//! What beginning at neighbours' states costs and changes, against each case searched for by itself.
//!
//! `cargo bench --bench neighbours -- [--scene NAME] [--points N] [--audit N] [-o FOLDER]`; a line a scene and a quality
//! factor, and a page in FOLDER. The scene `quality` is that of all quality factors.

#[path = "../common/page.rs"]
mod page;
mod scenes;

use afmsweep::compare::{Scales, worst};
use afmsweep::observe::Status;
use afmsweep::{Audit, Backend, Scene, Sweep, SweepOutcome};
use cpu_time::ProcessTime;
use page::Part;
use serde_json::{Value, json};
use std::path::Path;

/// A run, its CPU time (s) and its instance-steps.
fn run(scene: &Scene, cold: bool) -> (SweepOutcome, f64) {
    let start = ProcessTime::now();
    let sweep =
        Sweep::new(scene.clone()).backend(Backend::Cpu).audit(Audit::None).cold(cold).threads(Some(1));
    let swept = sweep.run().unwrap_or_else(|error| panic!("{error}"));
    (swept, start.elapsed().as_secs_f64())
}

/// How the results of a scene differ from those of cold searches.
#[derive(Default)]
struct Apart {
    /// Differences on the scale of accuracy, of instances that both call ok with the same steps and modes.
    differences: Vec<(f64, usize)>,
    /// Instances that the two refine differently.
    refined: usize,
    /// Instances of another status.
    status: Vec<(usize, Status, Status)>,
    /// Estimates over those of cold searches.
    estimates: Vec<f64>,
}

fn apart(ours: &SweepOutcome, cold: &SweepOutcome) -> Apart {
    let mut apart = Apart::default();
    let plan = &cold.run.plan;
    for i in 0..plan.len() {
        let (a, b) = (&ours.run.results.get(i), &cold.run.results.get(i));
        if a.status != b.status {
            apart.status.push((i, a.status, b.status));
            continue;
        }
        if a.status != Status::Ok {
            continue;
        }
        let n = i as u32;
        let modes = |swept: &SweepOutcome| swept.run.plan.driven(n).kept.modes.clone();
        if ours.run.plan.steps(n) != plan.steps(n) || modes(ours) != modes(cold) {
            apart.refined += 1;
            continue;
        }
        let scales = Scales::of(plan, i, &b.measured);
        apart.differences.push((worst(&plan.observables, &a.measured, &b.measured, &scales), i));
        apart.estimates.push(ours.run.estimates[i] / cold.run.estimates[i]);
    }
    apart.differences.sort_by(|a, b| a.0.total_cmp(&b.0));
    apart.estimates.sort_by(f64::total_cmp);
    apart
}

fn share(sorted: &[f64], of: f64) -> f64 {
    sorted.get(((sorted.len().max(1) - 1) as f64 * of) as usize).copied().unwrap_or(f64::NAN)
}

/// Instances whose results differ by more than the accuracy, each in a line.
fn told(name: &str, ours: &SweepOutcome, cold: &SweepOutcome, apart: &Apart) -> Vec<Value> {
    let accuracy = cold.run.plan.run.accuracy;
    let one = |(difference, i): &(f64, usize)| {
        let of = |swept: &SweepOutcome| {
            let measured = &swept.run.results.get(*i).measured;
            format!("phase {:.1}, mean force {:.1e} N", measured.phase, measured.force_mean)
        };
        json!({ "scene": name, "instance": i, "difference": difference, "ours": of(ours), "cold": of(cold),
                "began_at_neighbours": ours.run.neighbour_started.get(*i).copied().unwrap_or(false) })
    };
    let others = apart.status.iter().map(|(i, ours, cold)| {
        json!({ "scene": name, "instance": i, "ours": ours.meaning(), "cold": cold.meaning() })
    });
    apart.differences.iter().filter(|one| one.0 > accuracy).map(one).chain(others).collect()
}

fn row(name: &str, ours: (&SweepOutcome, f64), cold: (&SweepOutcome, f64), apart: &Apart) -> Value {
    let count = cold.0.run.plan.len() as f64;
    let differences: Vec<f64> = apart.differences.iter().map(|one| one.0).collect();
    let accuracy = cold.0.run.plan.run.accuracy;
    json!({
        "scene": name,
        "instances": count,
        "steps_cold": cold.0.steps_taken as f64 / count,
        "steps": ours.0.steps_taken as f64 / count,
        "microseconds_cold": 1e6 * cold.1 / count,
        "microseconds": 1e6 * ours.1 / count,
        "started": ours.0.run.neighbour_started(),
        "compared": differences.len(),
        "median": share(&differences, 0.5),
        "most": share(&differences, 0.999),
        "largest": share(&differences, 1.0),
        "above": differences.iter().filter(|one| **one > accuracy).count(),
        "refined_differently": apart.refined,
        "status_differs": apart.status.len(),
        "estimate_least": share(&apart.estimates, 0.001),
        "estimate_most": share(&apart.estimates, 0.999),
    })
}

/// What a case costs with each quality factor.
fn by_quality(points: usize) -> Vec<Value> {
    let mut rows: Vec<Value> = Vec::new();
    for (quality, text) in scenes::qualities(points) {
        let scene = Scene::parse(Path::new("bench.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
        let (ours, seconds) = run(&scene, false);
        let run = &ours.run;
        let count = run.plan.len();
        let each = |all: f64| all / count as f64;
        let mut periods: Vec<f64> = run.periods.iter().map(|periods| f64::from(*periods)).collect();
        periods.sort_by(f64::total_cmp);
        let mean = each(periods.iter().sum());
        let steps = each(ours.steps_taken as f64);
        let over = |name: &str, value: f64| {
            value / rows.first().map_or(value, |row| row[name].as_f64().unwrap_or(f64::NAN))
        };
        let row = json!({
            "quality_factor": quality,
            "instances": count,
            "ok": (0..count).filter(|i| run.results.get(*i).status == Status::Ok).count(),
            "median_periods": share(&periods, 0.5),
            "p99_periods": share(&periods, 0.99),
            "slow": periods.iter().filter(|periods| **periods > SLOW).count(),
            "most_periods": share(&periods, 1.0),
            "mean_periods": mean,
            "periods_over_first": over("mean_periods", mean),
            "steps": steps,
            "steps_over_first": over("steps", steps),
            "microseconds": each(1e6 * seconds),
            "started": run.neighbour_started(),
        });
        println!("{row}");
        rows.push(row);
    }
    rows
}

/// Few searches from where neighbours lead to step so many periods.
const SLOW: f64 = 50.0;

/// The scene once more, of which the reference engine redoes so many random instances.
fn audited(name: &str, scene: &Scene, count: u32) -> Value {
    let sweep = Sweep::new(scene.clone()).backend(Backend::Cpu).audit(Audit::Instances(count));
    let verdict = sweep.run().unwrap_or_else(|error| panic!("{error}")).verdict;
    let worst = verdict.worst;
    json!({
        "scene": name,
        "audited": verdict.audited,
        "compared": verdict.compared,
        "touching": verdict.touching,
        "above": verdict.above,
        "worst": worst.map(|worst| worst.error),
        "of": worst.and_then(|worst| worst.observable).map(|observable| observable.name()),
        "estimate": worst.map(|worst| worst.estimate),
    })
}

fn main() {
    let given: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let (mut only, mut output, mut points, mut audit) = (None, None, 100_000, 0);
    let mut args = given.iter();
    while let Some(arg) = args.next() {
        let mut value = || args.next().unwrap_or_else(|| panic!("{arg} needs a value")).clone();
        match arg.as_str() {
            "--scene" => only = Some(value()),
            "--points" => points = value().parse().expect("--points: a number"),
            "--audit" => audit = value().parse().expect("--audit: a number"),
            "-o" => output = Some(value()),
            other => panic!("unknown option {other}: --scene NAME, --points N, --audit N, -o FOLDER"),
        }
    }
    let (mut rows, mut others, mut audits) = (Vec::new(), Vec::new(), Vec::new());
    for (name, text) in scenes::all(points) {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let scene = Scene::parse(Path::new("bench.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
        let (cold, ours) = (run(&scene, true), run(&scene, false));
        let apart = apart(&ours.0, &cold.0);
        let row = row(name, (&ours.0, ours.1), (&cold.0, cold.1), &apart);
        println!("{row}");
        let told = told(name, &ours.0, &cold.0, &apart);
        told.iter().take(20).for_each(|one| println!("  {one}"));
        rows.push(row);
        others.extend(told);
        if audit > 0 {
            audits.push(audited(name, &scene, audit));
            println!("  {}", audits[audits.len() - 1]);
        }
    }
    let all = only.as_ref().is_none_or(|only| only == "quality");
    let qualities = if all { by_quality(points) } else { Vec::new() };
    if let Some(output) = output {
        let command = format!("cargo bench --bench neighbours -- {}", given.join(" "));
        write(&output, &command, [rows, audits, others, qualities]);
    }
}

fn write(output: &str, command: &str, [rows, audits, others, qualities]: [Vec<Value>; 4]) {
    let costs = [
        ("scene", "scene"),
        ("instances", "instances"),
        ("steps_cold", "instance-steps each, cold"),
        ("steps", "from neighbours"),
        ("microseconds_cold", "CPU microseconds each, cold"),
        ("microseconds", "from neighbours"),
        ("started", "share begun at neighbours"),
    ];
    let differences = [
        ("scene", "scene"),
        ("compared", "compared"),
        ("median", "median"),
        ("most", "99.9 %"),
        ("largest", "largest"),
        ("above", "above the accuracy"),
        ("refined_differently", "refined differently"),
        ("status_differs", "another status"),
        ("estimate_least", "estimate over the cold one, 0.1 %"),
        ("estimate_most", "99.9 %"),
    ];
    let checked = [
        ("scene", "scene"),
        ("audited", "redone"),
        ("compared", "both ok"),
        ("touching", "of these touch the sample"),
        ("above", "above the accuracy"),
        ("worst", "largest error"),
        ("of", "of"),
        ("estimate", "its estimate"),
    ];
    let by_quality = [
        ("quality_factor", "quality factor"),
        ("instances", "instances"),
        ("ok", "ok"),
        ("started", "share begun at neighbours"),
        ("median_periods", "median periods"),
        ("p99_periods", "99 %"),
        ("slow", "slow ones"),
        ("most_periods", "most periods"),
        ("mean_periods", "mean periods"),
        ("periods_over_first", "over the first row's"),
        ("steps", "instance-steps each"),
        ("steps_over_first", "over the first row's"),
        ("microseconds", "CPU microseconds each"),
    ];
    let named = [
        ("scene", "scene"),
        ("instance", "instance"),
        ("difference", "difference"),
        ("began_at_neighbours", "begun at neighbours"),
        ("ours", "from neighbours"),
        ("cold", "cold"),
    ];
    let parts = [
        Part {
            heading: "What it costs",
            text: "Each scene is run twice on one thread: every instance searched for by itself (--cold), and as usual. \
                   Accuracy 1e-3; instance-steps count trials, searches and estimates; CPU time is of the whole run \
                   without its file.",
            columns: &costs,
            rows: rows.clone(),
        },
        Part {
            heading: "How far results differ",
            text: "The worst observable on its scale of accuracy, of the instances that both runs call ok with the same \
                   steps and modes.",
            columns: &differences,
            rows,
        },
        Part {
            heading: "Checked by the reference engine",
            text: "Random instances of each scene, redone by the reference engine: errors on the scale of accuracy, asked 1e-3.",
            columns: &checked,
            rows: audits,
        },
        Part {
            heading: "Against the quality factor",
            text: "The first scene's grid once more, with other quality factors of the lever. Periods are those of the last run of \
                   each case, as in the file's periods_stepped; instance-steps count all runs, trials and estimates too. A \
                   lever that rings longer needs more steps a period for the same accuracy. Slow ones are cases of more than 50 \
                   periods: no search from the start or from neighbours leads to a state, and their motion is followed in strides of \
                   many periods, or waited for.",
            columns: &by_quality,
            rows: qualities,
        },
        Part {
            heading: "Other states, one by one",
            text: "Instances whose results differ by more than the accuracy, or whose status differs.",
            columns: &named,
            rows: others,
        },
    ];
    page::write(output, "Beginning at neighbours' states", command, &parts);
}
