//! Whether the accuracy asked for is met: random instances from wide ranges, run to several accuracies, held
//! against the reference engine one by one.

use crate::random::contact::{self, Contact};
use crate::random::{Ranges, Wide, quantile, scene};
use afmsweep::compare::{self, Scales, worst};
use afmsweep::control::{self, AuditedInstance, MemoryJournal, RunResult};
use afmsweep::engine::{Cpu, Engine, Finished, Progress, Reference, solve_near};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use serde_json::{Value, json};
use std::time::Instant;

const ALONE: [Contact; 3] = [Contact::alone("hertz"), Contact::alone("dmt"), Contact::alone("jkr")];
const ACCURACIES: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// An ensemble: its contacts, where its instances come from, and how they are run.
pub struct Ensemble {
    pub contacts: &'static [Contact<'static>],
    pub from: Ranges,
    /// Lines of `[run]`.
    pub run: &'static str,
    pub truth: Truth,
}

/// What the runs are held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// The same instances for each accuracy: the reference's states next to those of the run for the finest.
    Finest,
    /// Other instances for each accuracy: the reference's states next to the run's own.
    Own,
}

/// One lever in air, waited for long enough for the largest quality factor.
pub const USUAL: Ensemble = Ensemble {
    contacts: &ALONE,
    from: Ranges::USUAL,
    run: "periods = 400\nmeasure = 4",
    truth: Truth::Finest,
};
/// All kinds of levers, searched for.
pub const LEVERS: Ensemble = Ensemble {
    contacts: &ALONE,
    from: Ranges::LEVERS,
    run: "periods = 200\nmeasure = 4\nsteady = \"search\"",
    truth: Truth::Own,
};

/// All kinds of levers shaken at the base, most of them off resonance.
pub const SHAKEN: Ensemble = Ensemble { from: Ranges::SHAKEN, ..LEVERS };

/// That lever in air with losses, tips of other shapes, layers, and forces beside the contact, searched for.
pub const CONTACTS: Ensemble = Ensemble { contacts: &contact::CONTACTS, from: Ranges::USUAL, ..LEVERS };

/// Of the reference where it waits: three digits below the finest accuracy asked for.
const TOLERANCE: f64 = 1e-9;
/// And where it looks for the state next to a run's own.
const BESIDE: f64 = 1e-9;

/// What the reference makes of the ensemble: of every instance that the run to the finest accuracy calls ok its
/// own periodic state next to the run's, with all modes.
fn truths(wide: &Wide) -> Vec<Option<Finished>> {
    let (plan, start) = (plan(wide), Instant::now());
    let run = control::run(&plan, &Cpu::default(), &Progress::default()).expect("the plan can be run");
    println!("    {}: run for {:e} in {:.0} s", wide.law, wide.accuracy, start.elapsed().as_secs_f64());
    let audited = control::audit(&run, wide.count, &MemoryJournal::default(), &Progress::default())
        .expect("the plan can be run");
    println!("    {}: truths in {:.0} s", wide.law, start.elapsed().as_secs_f64());
    let mut truths = vec![None; wide.count];
    for one in audited.into_iter().filter(|one| one.reference.status == Status::Ok) {
        truths[one.instance as usize] = Some(one.reference);
    }
    truths
}

/// How many of the first instances the reference calls steady when it waits as the engines do, and how many of
/// those end in the state that stands for the truth.
fn waited(wide: &Wide, count: usize, truths: &[Option<Finished>]) -> (usize, usize) {
    let plan = plan(wide);
    let first: Vec<u32> =
        (0..count.min(wide.count) as u32).filter(|i| truths[*i as usize].is_some()).collect();
    let reference = Reference { tolerance: TOLERANCE, ..Reference::default() };
    let results =
        reference.run(&plan.part(&first), &Progress::default()).expect("the plan can be run").results;
    let (mut steady, mut same) = (0, 0);
    for (i, waited) in first.into_iter().zip(&results) {
        let truth = truths[i as usize].as_ref();
        let Some(truth) = truth.filter(|_| waited.status == Status::Ok) else { continue };
        let scales = Scales::of(&plan, i as usize, &truth.measured);
        let error = worst(&plan.observables, &waited.measured, &truth.measured, &scales);
        steady += 1;
        same += usize::from(error <= wide.accuracy);
        if error > wide.accuracy {
            println!("    instance {i}: {error:.1e} between the reference's waiting and its state");
        }
    }
    (steady, same)
}

fn plan(wide: &Wide) -> Plan {
    Plan::new(&scene(wide), Precision::F64).expect("the scene can be planned")
}

/// Of which law and for which accuracy rows are wanted; none stands for all.
#[derive(Clone, Debug, Default)]
pub struct Only {
    pub law: Option<String>,
    pub accuracy: Option<f64>,
}

impl Only {
    fn of<'a>(&'a self, contacts: &[Contact<'a>]) -> Vec<&'a str> {
        let all = || contacts.iter().map(|contact| contact.word).collect();
        self.law.as_deref().map_or_else(all, |law| vec![law])
    }

    fn wants(&self, accuracy: f64) -> bool {
        self.accuracy.is_none_or(|only| only == accuracy)
    }
}

/// The table, and its rows.
pub fn run(ensemble: &Ensemble, only: &Only, count: usize, waits: usize, seed: u64) -> Vec<Value> {
    println!("{count} random instances for each law, seed {seed}");
    println!(
        "{:<26}{:>8}{:>6}{:>9}{:>9}{:>9}{:>10}{:>10}{:>10}{:>8}{:>8}{:>10}{:>11}{:>8}{:>12}",
        "law",
        "asked",
        "ok",
        "not met",
        "unsteady",
        "no truth",
        "median",
        "95 %",
        "largest",
        "above",
        "above3",
        "low by 3",
        "steps/per.",
        "in f32",
        "seconds"
    );
    let mut rows = Vec::new();
    for law in only.of(ensemble.contacts) {
        let wide =
            |accuracy, seed| Wide { law, count, seed, accuracy, from: ensemble.from, run: ensemble.run };
        match ensemble.truth {
            Truth::Finest => {
                let finest = wide(ACCURACIES[2], seed);
                let truths = truths(&finest);
                let (steady, same) = waited(&finest, waits, &truths);
                println!(
                    "    {law}: {same} of {steady} waits of the reference end in the states taken for the truth"
                );
                rows.extend(ACCURACIES.into_iter().filter(|one| only.wants(*one)).map(|accuracy| {
                    let wide = wide(accuracy, seed);
                    let (run, seconds) = carried_out(&wide);
                    let mut row = row(&wide, &run, &truths, seconds);
                    (row["waits_steady"], row["waits_same"]) = (json!(steady), json!(same));
                    row
                }));
            }
            Truth::Own => rows.extend((seed..).zip(ACCURACIES).filter(|one| only.wants(one.1)).map(
                |(seed, accuracy)| {
                    let wide = wide(accuracy, seed);
                    let (run, seconds) = carried_out(&wide);
                    let truths = own_truths(&run);
                    let mut row = row(&wide, &run, &truths, seconds);
                    let [asked, states] = unsteady(&run, waits);
                    (row["unsteady_asked"], row["unsteady_with_a_state"]) = (json!(asked), json!(states));
                    row
                },
            )),
        }
    }
    rows
}

/// The run as the command line makes it, and its seconds.
fn carried_out(wide: &Wide) -> (RunResult, f64) {
    let mut plan = plan(wide);
    plan.precision_open = true;
    let start = Instant::now();
    let run = control::run(&plan, &Cpu::default(), &Progress::default()).expect("the plan can be run");
    (run, start.elapsed().as_secs_f64())
}

/// The reference's states next to those of a run, of every instance that it calls ok; where there is none, the
/// reference's own run as the scene says.
fn own_truths(run: &RunResult) -> Vec<Option<Finished>> {
    let (count, start) = (run.plan.len(), Instant::now());
    let audited = control::audit(run, count, &MemoryJournal::default(), &Progress::default())
        .expect("the plan can be run");
    let mut truths = vec![None; count];
    let mut without = Vec::new();
    for one in audited {
        match one.reference.status {
            Status::Ok => truths[one.instance as usize] = Some(one.reference),
            _ => without.push(one.instance),
        }
    }
    println!("    truths in {:.0} s, {} by waiting", start.elapsed().as_secs_f64(), without.len());
    let reference = Reference { tolerance: TOLERANCE, ..Reference::default() };
    let waited = reference.run(&run.plan.part(&without), &Progress::default()).expect("the plan can be run");
    for (i, truth) in without.into_iter().zip(&waited.results) {
        println!(
            "    instance {i} ({}): no state next to the run's, waiting: {}",
            parameters(&run.plan, i as usize),
            truth.status.meaning()
        );
        truths[i as usize] = (truth.status == Status::Ok).then_some(*truth);
    }
    truths
}

/// How many of the first instances that are not steady the reference was asked about, and next to the ends of how many
/// it finds a periodic state all the same.
fn unsteady(run: &RunResult, count: usize) -> [usize; 2] {
    let status = |i: &u32| run.results.get(*i as usize).status;
    let all = (0..run.plan.len() as u32).filter(|i| status(i) == Status::NotSteady);
    let first: Vec<u32> = all.take(count).collect();
    let audited = control::audit_of(run, &first, &MemoryJournal::default(), &Progress::default())
        .expect("the plan can be run");
    let with: Vec<&AuditedInstance> =
        audited.iter().filter(|one| one.reference.status == Status::Ok).collect();
    for one in &with {
        let i = one.instance as usize;
        println!("    instance {i} ({}): not steady, the reference finds a state", parameters(&run.plan, i));
    }
    [audited.len(), with.len()]
}

fn row(wide: &Wide, run: &RunResult, truths: &[Option<Finished>], seconds: f64) -> Value {
    let (Wide { law, count, accuracy, .. }, plan) = (*wide, &run.plan);
    let (mut errors, mut low, mut steps, mut others, mut beyond) = (Vec::new(), 0, 0.0, 0, 0);
    for (i, truth) in truths.iter().enumerate() {
        let ours = &run.results.get(i);
        steps += f64::from(run.plan.steps(i as u32)) / count as f64;
        let Some(truth) = truth.as_ref().filter(|_| ours.status == Status::Ok) else { continue };
        if run.plan.contact(i as u32).series_warning(truth.measured.indentation_max).is_some() {
            beyond += 1;
            continue;
        }
        let apart = |truth: &Finished| {
            let scales = Scales::of(&run.plan, i, &truth.measured);
            worst(&plan.observables, &ours.measured, &truth.measured, &scales)
        };
        let (mut truth, mut error) = (*truth, apart(truth));
        if error > accuracy
            && let Some(own) = beside(run, i as u32)
            && apart(&own) < error
        {
            // Of several states it has another one than the run to the finest accuracy.
            others += usize::from(apart(&own) <= accuracy);
            (truth, error) = (own, apart(&own));
        }
        let (truth, scales) = (&truth, Scales::of(&run.plan, i, &truth.measured));
        low += usize::from(error > 3.0 * run.estimates[i].max(0.1 * accuracy));
        if error > accuracy {
            let (estimate, steps) = (run.estimates[i], run.plan.steps(i as u32));
            let of = |one: &Observable| compare::error(*one, &ours.measured, &truth.measured, &scales);
            let whose = plan.observables.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
            println!(
                "    instance {i} ({}): {error:.1e}, estimated {estimate:.1e}, {steps} steps, {} oscillators, {}, in contact {:.4} of the period",
                parameters(&run.plan, i),
                run.plan.driven(i as u32).kept.modes.len(),
                whose.map_or("", |one| one.name()),
                truth.measured.contact_time,
            );
        }
        errors.push(error);
    }
    if beyond > 0 {
        println!("    {beyond} sink in beyond the range of their law's series and are left out");
    }
    errors.sort_by(f64::total_cmp);
    let single = run.arithmetic.of.iter().filter(|one| **one == Precision::F32).count();
    let above = |times: f64| errors.iter().filter(|error| **error > times * accuracy).count();
    let with = |status: Status| run.results.iter().filter(|one| one.status == status).count();
    // Motion without contact is known in closed form, by the run as by the reference.
    let free = (0..count)
        .filter(|i| run.plan.steps(*i as u32) == 0 && run.results.get(*i).status == Status::Ok)
        .count();
    let [median, p95, largest] = [0.5, 0.95, 1.0].map(|share| quantile(&errors, share));
    println!(
        "{law:<26}{accuracy:>8.0e}{:>6}{:>9}{:>9}{:>9}{median:>10.1e}{p95:>10.1e}{largest:>10.1e}{:>8}{:>8}{low:>10}{steps:>11.0}{single:>8}{seconds:>12.2}",
        errors.len(),
        with(Status::AccuracyNotMet),
        with(Status::NotSteady),
        with(Status::Ok) - errors.len() - free - beyond,
        above(1.0),
        above(3.0),
    );
    json!({
        "law": law,
        "accuracy": accuracy,
        "instances": count,
        "ok": errors.len(),
        "accuracy_not_met": with(Status::AccuracyNotMet),
        "not_steady": with(Status::NotSteady),
        "out_of_range": with(Status::OutOfRange),
        "sensitive": with(Status::Sensitive),
        "another_state": others,
        "free": free,
        "beyond_series": beyond,
        "no_truth": with(Status::Ok) - errors.len() - free - beyond,
        "median": median,
        "p95": p95,
        "largest": largest,
        "above_the_ask": above(1.0),
        "above_three_times_the_ask": above(3.0),
        "estimate_too_low_by_three": low,
        "mean_steps_per_period": steps,
        "in_f32": single,
        "seconds": seconds,
    })
}

/// The reference's periodic state next to the run's own, if there is one.
fn beside(run: &RunResult, instance: u32) -> Option<Finished> {
    let station = run.found.get(instance as usize)?.section;
    let reference = Reference { tolerance: BESIDE, ..Reference::default() };
    let found = solve_near(&run.plan, instance as usize, &station, &reference, &Progress::default());
    found.expect("the plan has the instance").filter(|one| one.status == Status::Ok)
}

/// What an instance is, to look at it by itself.
fn parameters(plan: &Plan, i: usize) -> String {
    let case = plan.case(i as u32);
    let driven = &plan.drives[case.drive as usize];
    let mode = &driven.instrument.modes[0];
    format!(
        "{:.3} N/m, {:.0} kHz, Q {:.1}, K {:.2e} Pa, w {:.1e} J/m^2, R {:.1} nm, A {:.1} nm, gap {:.3} A",
        mode.omega.powi(2) / (mode.tip * mode.force),
        driven.frequency() / 1e3,
        mode.quality_factor,
        case.contact.modulus,
        case.contact.work,
        1e9 * case.contact.radius,
        1e9 * driven.free_amplitude(),
        case.gap / driven.free_amplitude()
    )
}
