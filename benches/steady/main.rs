//! The periodic state by waiting and by searching: what each costs, and whether both end in the same state.
//!
//! `cargo bench --bench steady -- [--instances N] [--same N] [--curves N] [--seed S] [-o FOLDER]`; three tables, and a page
//! in FOLDER.

mod curves;
#[path = "../common/page.rs"]
mod page;
#[path = "../common/random.rs"]
mod random;

use afmsweep::compare::{Scales, worst};
use afmsweep::engine::{Cpu, Finished, Progress, processor};
use afmsweep::observe::Status;
use afmsweep::orbit::{self, OrbitSolution};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Steady;
use page::Part;
use random::{Ranges, Wide, quantile, scene};
use serde_json::{Value, json};

const LAWS: [&str; 3] = ["hertz", "dmt", "jkr"];
const ACCURACY: f64 = 1e-3;

fn run(plan: &Plan) -> OrbitSolution {
    orbit::solve(plan, &[], &Cpu::default(), &Progress::default()).expect("the plan can be run")
}

fn plan(wide: &Wide, steady: Steady, periods: u32) -> Plan {
    let mut scene = scene(wide);
    (scene.run.steady, scene.run.periods) = (steady, periods);
    Plan::new(&scene, Precision::F64).expect("the scene can be planned")
}

/// Results by waiting, in ever longer runs, and after how many periods each had settled.
fn waited(wide: &Wide, most: u32) -> (Vec<Finished>, Vec<Option<u32>>) {
    let mut all = vec![Finished::NOT_RUN; wide.count];
    let mut after = vec![None; wide.count];
    let mut periods = 64;
    loop {
        let plan = plan(wide, Steady::Wait, periods);
        let left: Vec<u32> = (0..wide.count as u32).filter(|i| after[*i as usize].is_none()).collect();
        let results = run(&plan.part(&left)).outcome.results;
        for (i, finished) in left.into_iter().zip(results) {
            let i = i as usize;
            all[i] = finished;
            if finished.status == Status::Ok || plan.steps(i as u32) == 0 {
                after[i] = Some(periods);
            }
        }
        periods *= 2;
        if periods > most || after.iter().all(Option::is_some) {
            return (all, after);
        }
    }
}

fn sorted(values: impl Iterator<Item = u32>) -> Vec<f64> {
    let mut all: Vec<f64> = values.map(f64::from).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Periods per instance, by quality factor, law and modes.
fn costs(count: usize, seed: u64) -> Vec<Value> {
    println!("periods until settled, {count} random instances each; waiting in runs of 64, 128, ... periods");
    println!(
        "{:>8} {:<6}{:>6} | {:>8}{:>9}{:>9} | {:>8}{:>9}{:>9}{:>9}",
        "Q", "law", "modes", "waiting:", "median", "settled", "search:", "median", "95 %", "found"
    );
    let mut rows = Vec::new();
    for quality in [100.0, 1e3, 1e4, 1e5] {
        for law in LAWS {
            for modes in [1, 2, 4] {
                let text = format!("measure = 4\nmodes = {modes}");
                let wide = Wide {
                    law,
                    count,
                    seed,
                    accuracy: ACCURACY,
                    from: Ranges { quality: [quality, quality * 1.001], ..Ranges::USUAL },
                    run: &text,
                };
                let most = (60.0 * quality) as u32;
                let (_, after) = waited(&wide, most);
                let plan = plan(&wide, Steady::Search, 2000);
                let stepped = |i: &usize| plan.steps(*i as u32) > 0;
                let search = run(&plan);
                let found: Vec<usize> =
                    (0..count).filter(stepped).filter(|i| search.found[*i].is_some()).collect();
                let spent = sorted(found.iter().map(|i| search.periods[*i]));
                let settled = sorted((0..count).filter(stepped).filter_map(|i| after[i]));
                let all = (0..count).filter(stepped).count();
                println!(
                    "{quality:>8.0} {law:<6}{modes:>6} | {:>8}{:>9.0}{:>9} | {:>8}{:>9.0}{:>9.0}{:>9}",
                    "",
                    quantile(&settled, 0.5),
                    format!("{}/{all}", settled.len()),
                    "",
                    quantile(&spent, 0.5),
                    quantile(&spent, 0.95),
                    format!("{}/{all}", found.len()),
                );
                rows.push(json!({
                    "quality_factor": quality, "law": law, "modes": modes, "instances": all,
                    "waiting_median_periods": quantile(&settled, 0.5), "waiting_settled": settled.len(),
                    "search_median_periods": quantile(&spent, 0.5),
                    "search_p95_periods": quantile(&spent, 0.95), "search_found": found.len(),
                }));
            }
        }
    }
    rows
}

/// How many of the instances that both settle end in the same state.
fn same(count: usize, seed: u64) -> Vec<Value> {
    println!("\nthe same state: {count} random instances, quality factors 10 to 1000, 3 modes");
    println!(
        "{:<6}{:>9}{:>9}{:>9}{:>9}{:>12}{:>12}",
        "law", "settled", "found", "both", "same", "other state", "found alone"
    );
    let mut rows = Vec::new();
    for law in LAWS {
        let part = count.div_ceil(LAWS.len());
        let wide = Wide {
            law,
            count: part,
            seed,
            accuracy: ACCURACY,
            from: Ranges { quality: [10.0, 1000.0], ..Ranges::USUAL },
            run: "measure = 4\nmodes = 3",
        };
        let (truth, after) = waited(&wide, 32_768);
        let plan = plan(&wide, Steady::Search, 2000);
        let search = run(&plan);
        let stepped: Vec<usize> = (0..part).filter(|i| plan.steps(*i as u32) > 0).collect();
        let found = |i: &usize| search.found[*i].is_some();
        let settled = |i: &usize| after[*i].is_some();
        let both: Vec<usize> = stepped.iter().copied().filter(|i| found(i) && settled(i)).collect();
        let mut other = Vec::new();
        for &i in &both {
            let (ours, theirs) = (&search.outcome.results[i].measured, &truth[i].measured);
            let error = worst(&plan.observables, ours, theirs, &Scales::of(&plan, i, theirs));
            if error > 5.0 * ACCURACY {
                other.push(i);
                println!(
                    "    {i}: {error:.1e}; amplitude {:.3} nm waited, {:.3} nm found, mean force {:.2e}, {:.2e} N, multiplier {:.5}, {} {} periods",
                    theirs.harmonics[0] * 1e9,
                    ours.harmonics[0] * 1e9,
                    theirs.force_mean,
                    ours.force_mean,
                    search.found[i].as_ref().map_or(f64::NAN, |place| place.floquet.multiplier),
                    after[i].unwrap_or(0),
                    search.periods[i],
                );
            }
        }
        let count_of = |keep: &dyn Fn(&usize) -> bool| stepped.iter().filter(|i| keep(i)).count();
        let alone = count_of(&|i| found(i) && !settled(i));
        println!(
            "{law:<6}{:>9}{:>9}{:>9}{:>9}{:>12}{alone:>12}",
            count_of(&settled),
            count_of(&found),
            both.len(),
            both.len() - other.len(),
            other.len(),
        );
        rows.push(json!({
            "law": law, "instances": stepped.len(), "settled": count_of(&settled), "found": count_of(&found),
            "both": both.len(), "same": both.len() - other.len(), "found_alone": alone,
        }));
    }
    rows
}

fn main() {
    let (mut count, mut many, mut lines, mut seed, mut output) = (32, 1000, 1000, 1, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--instances" => count = value().parse().expect("a number of instances, for each row"),
            "--same" => many = value().parse().expect("a number of instances, all laws together"),
            "--curves" => lines = value().parse().expect("a number of curves, for each law"),
            "--seed" => seed = value().parse().expect("a seed"),
            "-o" => output = Some(value()),
            "--bench" => {}
            other => panic!("unknown argument {other}"),
        }
    }
    println!("{}", processor());
    let costs = if count > 0 { costs(count, seed) } else { Vec::new() };
    let same = if many > 0 { same(many, seed) } else { Vec::new() };
    let curves = if lines > 0 { curves::curves(lines, seed) } else { Vec::new() };
    let parts = [
        Part {
            heading: "What a converged case costs",
            text: "Periods of the drive until an instance has settled to 1e-3, of random samples, tips, amplitudes and gaps (as in results/accuracy) at one quality factor: by waiting in runs of 64, 128, 256, ... periods up to 60 times the quality factor, and by searching, every evaluation of the period map and the periods run on counted. What is not found is waited for; under JKR it mostly has no state of one period, and waiting does not settle either.",
            columns: &[
                ("quality_factor", "quality factor"),
                ("law", "law"),
                ("modes", "modes"),
                ("instances", "instances"),
                ("waiting_settled", "settled by waiting"),
                ("waiting_median_periods", "median periods"),
                ("search_found", "found by searching"),
                ("search_median_periods", "median periods"),
                ("search_p95_periods", "95 %"),
            ],
            rows: costs,
        },
        Part {
            heading: "Whether both end in the same state",
            text: "Random instances with quality factors 10 to 1000 and three modes. The same state: every observable within five times the accuracy of 1e-3. Other states are told one by one when the bench runs: second branches of bistable points, and a few where waiting is called settled by its own measure a little early.",
            columns: &[
                ("law", "law"),
                ("instances", "instances"),
                ("settled", "settled by waiting"),
                ("found", "found by searching"),
                ("both", "both"),
                ("same", "the same state"),
                ("found_alone", "found alone"),
            ],
            rows: same,
        },
        Part {
            heading: "Along curves",
            text: "Periods of the drive per point of random approaches and retractions: one mode of 40 N/m, 300 kHz, 20 nm free, quality factors 20 to 500, random samples and tips; 77 gaps from 21 to 2 nm there and back, 128 steps a period. Followed: the state is carried from point to point, each state found is run on and measured. Fresh: a search from the free oscillation at each point, one way. Waited: each point from where the one before ended, with a look every 64 periods, at most 64 of them. Curves differ where the amplitude of a point that both call ok is another by more than 2 % of the free one; they are told one by one when the bench runs.",
            columns: &[
                ("law", "law"),
                ("curves", "curves"),
                ("points", "points"),
                ("followed_median", "followed: median"),
                ("followed_p95", "95 %"),
                ("fresh_median", "fresh: median"),
                ("fresh_p95", "95 %"),
                ("waited_median", "waited: median"),
                ("waited_p95", "95 %"),
                ("followed_ok", "followed: ok"),
                ("waited_ok", "waited: ok"),
                ("jumps", "jumps"),
                ("curves_that_differ", "curves that differ"),
                ("curves_that_end_elsewhere", "that end elsewhere"),
            ],
            rows: curves,
        },
    ];
    if let Some(folder) = output {
        let command = format!(
            "cargo bench --bench steady -- --instances {count} --same {many} --curves {lines} --seed {seed} -o {folder}"
        );
        page::write(&folder, "The periodic state, waited for and searched for", &command, &parts);
    }
}
