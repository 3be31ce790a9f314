//! Random curves there and back: followed, searched for point by point, and waited for point after point.

use crate::random::{Random, Ranges, quantile};
use crate::sorted;
use afmsweep::engine::{Cpu, Engine, Finished, Progress};
use afmsweep::observe::Status;
use afmsweep::orbit;
use afmsweep::plan::{Plan, Precision, SectionState, StartState};
use afmsweep::scene::Scene;
use serde_json::{Value, json};
use std::path::Path;

/// Points on one way, from above the free amplitude of 20 nm down.
const POINTS: usize = 77;
const GAPS: &str = r#"from = "21 nm", to = "2 nm", points = 77"#;
const ACCURACY: f64 = 1e-3;
/// Periods between two looks at what waits, and most looks.
const LOOK: u32 = 64;
const LOOKS: u32 = 64;
/// Results of one point that differ by more, in accuracies and free amplitudes, are other states.
const OTHER: f64 = 20.0;

/// One lever over `count` random samples, tips and quality factors, with these lines beside it.
fn scene(law: &str, count: usize, seed: u64, lines: &str) -> Scene {
    let mut random = Random(seed);
    let mut lists: [(&str, &str, [f64; 2], Vec<String>); 4] = [
        ("sample.youngs_modulus", " Pa", Ranges::USUAL.modulus, vec![]),
        ("sample.surface_energy", " J/m^2", [1e-3, 0.1], vec![]),
        ("instrument.tip.radius", " m", [5e-9, 50e-9], vec![]),
        ("instrument.cantilever.quality_factor", "", [20.0, 500.0], vec![]),
    ];
    for _ in 0..count {
        for (_, unit, [low, high], list) in &mut lists {
            let value = random.log(*low, *high);
            list.push(if unit.is_empty() { format!("{value:e}") } else { format!("\"{value:e}{unit}\"") });
        }
    }
    let list = |(path, .., list): &(&str, &str, [f64; 2], Vec<String>)| {
        format!("\"{path}\" = [{}]", list.join(", "))
    };
    let lists: Vec<String> = lists.iter().map(list).collect();
    let text = format!(
        r#"
[instrument.cantilever]
modes = [{{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 100 }}]
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
{lines}
[sweep.case]
{}
[output]
observables = ["amplitude", "force_mean"]
"#,
        lists.join("\n")
    );
    // The lever's quality factor is its one mode's.
    let text = text.replace(
        "\"instrument.cantilever.quality_factor\"",
        "\"instrument.cantilever.modes.0.quality_factor\"",
    );
    Scene::parse(Path::new("curves.toml"), &text).unwrap_or_else(|error| panic!("{error}"))
}

fn plan(law: &str, count: usize, seed: u64, lines: &str) -> Plan {
    let scene = scene(law, count, seed, lines);
    Plan::new(&scene, Precision::F64).expect("the scene can be planned")
}

/// Results and periods of each point, curve by curve in the order of its way there and back.
struct Points {
    results: Vec<Finished>,
    periods: Vec<u32>,
    jumps: Vec<bool>,
}

/// Places of a curve's points in the order in which it is followed; the way back goes through the same gaps.
fn way() -> impl Iterator<Item = usize> {
    (0..POINTS).chain((0..POINTS).rev())
}

fn followed(law: &str, count: usize, seed: u64) -> Points {
    let lines = format!(
        "[curve]\nquantity = \"approach.gap\"\n{}\ndirection = \"both\"\n[run]\nmeasure = 4\nsteps_per_period = 128\nperiods = 4000",
        GAPS.replace(", ", "\n")
    );
    let mut plan = plan(law, count, seed, &lines);
    let settled = orbit::solve_first(&mut plan, &Cpu::default(), &Progress::default()).expect("it runs");
    // The file has the way back in the order of the way there.
    let order: Vec<usize> = (0..count)
        .flat_map(|curve| {
            let first = curve * 2 * POINTS;
            (first..first + POINTS).chain((first + POINTS..first + 2 * POINTS).rev())
        })
        .collect();
    Points {
        results: order.iter().map(|i| settled.outcome.results[*i]).collect(),
        periods: order.iter().map(|i| settled.periods[*i]).collect(),
        jumps: order.iter().map(|i| settled.jumps[*i]).collect(),
    }
}

fn grid(steady: &str, periods: u32) -> String {
    format!(
        "[run]\nsteady = \"{steady}\"\nmeasure = 4\nsteps_per_period = 128\nperiods = {periods}\n[sweep]\n\"approach.gap\" = {{ {GAPS} }}"
    )
}

/// Periods of a search from the free oscillation at each point.
fn fresh(law: &str, count: usize, seed: u64) -> Vec<u32> {
    let plan = plan(law, count, seed, &grid("search", 4000));
    orbit::solve(&plan, &[], &Cpu::default(), &Progress::default()).expect("it runs").periods
}

/// Each point waited for from where the one before ended, all curves side by side. The gap changes at one stroke, which may
/// throw a tip off its branch that a slow approach would keep on it (`tests/all/agree_kicked.rs`).
fn waited(law: &str, count: usize, seed: u64) -> Points {
    let plan = plan(law, count, seed, &grid("wait", LOOK));
    let mut all = Points {
        results: vec![Finished::NOT_RUN; count * 2 * POINTS],
        periods: vec![0; count * 2 * POINTS],
        jumps: Vec::new(),
    };
    let mut ends: Vec<Option<SectionState>> = vec![None; count];
    for (number, place) in way().enumerate() {
        // The gap is the slower axis.
        let instance = |curve: usize| (place * count + curve) as u32;
        let mut left: Vec<usize> = (0..count).filter(|curve| plan.steps(instance(*curve)) > 0).collect();
        for _ in 0..LOOKS {
            let instances: Vec<u32> = left.iter().map(|curve| instance(*curve)).collect();
            let start =
                |curve: &usize| ends[*curve].unwrap_or_else(|| SectionState::free(&plan, instance(*curve)));
            let starts = left.iter().map(|curve| StartState::from(start(curve))).collect();
            let part = plan.part(&instances).starting_at(starts);
            let outcome = Cpu::default().run(&part, &Progress::default()).expect("it runs");
            for (n, &curve) in left.iter().enumerate() {
                let at = curve * 2 * POINTS + number;
                all.results[at] = outcome.results[n];
                all.periods[at] += LOOK;
                ends[curve] = outcome.ends[n].as_deref().copied();
            }
            left.retain(|curve| all.results[curve * 2 * POINTS + number].status == Status::NotSteady);
            if left.is_empty() {
                break;
            }
        }
    }
    all
}

/// Whether two results of a point are of different states.
fn other(a: &Finished, b: &Finished) -> bool {
    let apart = (a.measured.harmonics[0] - b.measured.harmonics[0]).abs();
    a.status == Status::Ok && b.status == Status::Ok && apart > OTHER * ACCURACY * 20e-9
}

/// `count` random curves under each law.
pub fn curves(count: usize, seed: u64) -> Vec<Value> {
    println!("\nperiods per point of {count} random curves under each law, {POINTS} points there and back");
    let mut rows = Vec::new();
    for law in ["hertz", "dmt", "jkr"] {
        let (followed, waited) = (followed(law, count, seed), waited(law, count, seed));
        let fresh = sorted(fresh(law, count, seed).into_iter().filter(|periods| *periods > 0));
        let spent = |points: &Points| sorted(points.periods.iter().copied().filter(|periods| *periods > 0));
        let (ours, theirs) = (spent(&followed), spent(&waited));
        let (mut apart, mut ended) = (0, 0);
        for curve in 0..count {
            let first = curve * 2 * POINTS;
            let differ = |n: &usize| other(&followed.results[first + n], &waited.results[first + n]);
            let all: Vec<usize> = (0..2 * POINTS).filter(differ).collect();
            let Some((from, to)) = all.first().zip(all.last()) else { continue };
            apart += 1;
            ended += usize::from(*to == 2 * POINTS - 1);
            let told = |n: usize| 1e9 * followed.results[first + n].measured.harmonics[0];
            println!(
                "    {law} {curve}: {} points of another state, numbers {from} to {to}; amplitude {:.3} nm followed, {:.3} nm waited",
                all.len(),
                told(*from),
                1e9 * waited.results[first + from].measured.harmonics[0],
            );
        }
        let steady = |points: &Points| points.results.iter().filter(|one| one.status == Status::Ok).count();
        let jumps = followed.jumps.iter().filter(|jump| **jump).count();
        println!(
            "{law:<6} followed {:.0} {:.0}, fresh {:.0} {:.0}, waited {:.0} {:.0}; {jumps} jumps, {apart} curves differ, {ended} at their end",
            quantile(&ours, 0.5),
            quantile(&ours, 0.95),
            quantile(&fresh, 0.5),
            quantile(&fresh, 0.95),
            quantile(&theirs, 0.5),
            quantile(&theirs, 0.95),
        );
        rows.push(json!({
            "law": law, "curves": count, "points": followed.results.len(),
            "followed_median": quantile(&ours, 0.5), "followed_p95": quantile(&ours, 0.95),
            "fresh_median": quantile(&fresh, 0.5), "fresh_p95": quantile(&fresh, 0.95),
            "waited_median": quantile(&theirs, 0.5), "waited_p95": quantile(&theirs, 0.95),
            "followed_ok": steady(&followed), "waited_ok": steady(&waited), "jumps": jumps,
            "curves_that_differ": apart, "curves_that_end_elsewhere": ended,
        }));
    }
    rows
}
