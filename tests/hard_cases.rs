//! Scenes at the ends of what can be asked for (tests/hard/, each with its reason), run as a user would.
//!
//! Each ends in one of two ways: every observable within the accuracy that the scene asks for, held
//! against the reference engine, or a status that says why not. Where neither holds the case stands here
//! as a known miss, with its error in a band, so that it is noticed when that changes.

mod checks;
mod support;

use afmsweep::compare::{Scales, error};
use afmsweep::engine::{Finished, Model, Reference, solve};
use afmsweep::observe::{Measured, Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use rayon::prelude::*;
use std::path::Path;

/// Error per step of the reference, which has more digits than any case asks for.
const TOLERANCE: f64 = 1e-11;

#[derive(Clone, Copy, Debug)]
enum Expect {
    /// Ok by both engines, errors within the accuracy asked for, and the case is what it is meant to be.
    Within(fn(&Measured) -> bool),
    /// A status; if it is `NotSteady` the reference has to say so too.
    Says(Status),
    /// The same without the reference, whose steps follow the fastest of all modes; in f64 and in f32.
    SaysAlone([Status; 2]),
    /// Ok, with one observable off by more than was asked for, but within this band.
    Miss(Observable, [f64; 2], Cause),
    /// Within the accuracy in f64, off like this in f32.
    MissSingle(Observable, [f64; 2]),
}

/// What a known miss comes from; the test makes sure of it.
#[derive(Clone, Copy, Debug)]
enum Cause {
    /// The choice of modes: against the reference on the kept oscillators nothing is off.
    Modes,
    /// The steps: with 16 times as many nothing is off.
    Steps,
}

use Cause::{Modes, Steps};
use Expect::{Miss, MissSingle, Says, SaysAlone, Within};
use Observable::{ContactTime, Dissipation, ForceMax};

const CASES: &[(&str, Expect)] = &[
    ("adhesion_0", Within(taps)),
    ("adhesion_1e-6", Within(taps)),
    ("adhesion_1", Within(taps)),
    ("adhesion_1_dmt", Within(taps)),
    ("adhesion_1_stiff", Miss(ForceMax, [1.1e-3, 1.5e-3], Modes)),
    ("amplitude_1_pm", Within(stays_off)),
    // Rounding: a loss of nothing is a sum of large terms beside a drive's work of 1e-24 J.
    ("amplitude_1_pm_single", MissSingle(Dissipation, [1.0e-3, 1.9e-3])),
    ("amplitude_5_um", Within(taps)),
    ("branch_attractive", Within(|m| stays_off(m) && m.phase > 90.0)),
    ("branch_repulsive", Within(|m| taps(m) && m.phase < 90.0)),
    ("contact_too_short", Says(Status::OutOfRange)),
    ("decay_10_fm", Within(taps)),
    ("decay_1_pm", Within(taps)),
    ("drive_above", Within(taps)),
    ("drive_below", Within(taps)),
    ("drive_second_mode", Within(taps)),
    ("gap_negative", Within(holds_on)),
    ("gap_zero", Within(taps)),
    // A contact of two steps and less: its time is known to a third of a step.
    ("graze_1e-3", Miss(ContactTime, [1.1e-3, 1.5e-3], Steps)),
    ("graze_1e-6", Miss(ContactTime, [1.8e-3, 2.6e-3], Steps)),
    ("graze_jkr", Within(taps)),
    ("jkr_edge_between", Says(Status::NotSteady)),
    ("jkr_edge_held", Within(holds_on)),
    ("jkr_edge_lets_go", Within(taps)),
    ("jkr_held", Within(holds_on)),
    ("jkr_of_the_paper", SaysAlone([Status::NotSteady; 2])),
    ("lever_0.01", Within(taps)),
    ("lever_2000", Within(stays_off)),
    ("lever_2000_tapping", Within(taps)),
    ("million_steps", Within(taps)),
    ("not_settled", Says(Status::NotSteady)),
    ("overflow", SaysAlone([Status::NonFinite, Status::OutOfRange])),
    ("overflow_pressed", SaysAlone([Status::NonFinite; 2])),
    // Known miss: f32 cannot hold the free motion and takes what is no number for "not in contact".
    ("overflow_single", SaysAlone([Status::NonFinite, Status::Ok])),
    ("q_1e5", Says(Status::NotSteady)),
    ("q_1e5_overtone", Says(Status::NotSteady)),
    ("q_infinite", Says(Status::NotSteady)),
    // Stiff contacts: the residual oscillator stands for modes that ring at other frequencies, which the
    // largest force shows; and an undamped rod has narrow resonances that are not kept.
    ("radius_10_um", Miss(ForceMax, [3.2e-3, 4.2e-3], Modes)),
    ("radius_10_um_jkr", Within(taps)),
    ("radius_1_nm", Within(taps)),
    ("rod_damped", Miss(ForceMax, [4.1e-3, 5.1e-3], Modes)),
    ("rod_resonance", Within(taps)),
    ("rod_undamped", Miss(ForceMax, [5.5e-3, 6.6e-3], Modes)),
    ("sample_1_kpa", Within(taps)),
    ("sample_1_tpa", Miss(ForceMax, [1.5e-2, 1.9e-2], Modes)),
    ("sample_1_tpa_jkr", Miss(ForceMax, [1.5e-2, 1.9e-2], Modes)),
    ("snap_in", Within(holds_on)),
    ("snap_in_jkr", Within(holds_on)),
    // A contact shorter than a step throws the tip out of all bounds.
    ("too_few_steps", Says(Status::NonFinite)),
];

fn taps(m: &Measured) -> bool {
    m.contacts == 1.0 && m.contact_time > 0.0 && m.contact_time < 0.9
}

fn holds_on(m: &Measured) -> bool {
    m.contacts == 0.0 && m.contact_time == 1.0
}

fn stays_off(m: &Measured) -> bool {
    m.contacts == 0.0 && m.contact_time == 0.0
}

/// The largest error on the documented scales and whose it is, and the largest of the others.
fn errors(plan: &Plan, ours: &Finished, truth: &Finished) -> (f64, Option<Observable>, f64) {
    let scales = Scales::of(plan, 0, &truth.measured);
    let mut worst = (0.0, None, 0.0);
    for observable in &plan.observables {
        let error = error(*observable, &ours.measured, &truth.measured, &scales);
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > worst.0 {
            worst = (error, Some(*observable), worst.0);
        } else {
            worst.2 = worst.2.max(error);
        }
    }
    worst
}

fn truth(plan: &Plan, model: Model) -> Finished {
    let options = Reference { tolerance: TOLERANCE, model, ..Reference::default() };
    solve(plan, 0, &options).expect("the instance can be solved").0
}

fn load(name: &str) -> Scene {
    let path = Path::new("tests/hard").join(format!("{name}.toml"));
    let mut scene = Scene::load(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    scene.output.observables = Observable::all().collect();
    scene
}

/// A line of the table, and what is wrong with the case.
fn judge(name: &str, expect: Expect) -> (String, Vec<String>) {
    let mut wrong = Vec::new();
    let scene = load(name);
    let double = checks::plan(&scene, None);
    let accuracy = double.run.accuracy;
    let alone = matches!(expect, SaysAlone(_));
    let reference = (!alone).then(|| truth(&double, Model::Whole));
    let mut line = format!("{name:<20}");
    for precision in [Precision::F64, Precision::F32] {
        let plan = Plan { precision, ..double.clone() };
        let finished = checks::run(&plan)[0];
        let mut say = |text: String| wrong.push(format!("{name}, {}: {text}", precision.name()));
        let found = reference.as_ref().map(|truth| errors(&plan, &finished, truth));
        if precision == Precision::F64 {
            let theirs = reference.as_ref().map_or("-", |truth| truth.status.meaning());
            let (ours, steps) = (finished.status.meaning(), plan.cases[0].steps);
            line += &format!(" {ours:<13}{theirs:<12}{steps:>5} ");
        }
        let (error, which, others) = found.unwrap_or((f64::NAN, None, f64::NAN));
        let off = if error.is_finite() { format!("{error:.1e}") } else { "-".into() };
        line += &format!(" {off:>8} {:<18}", which.map_or("-", Observable::name));
        let says = match expect {
            Says(status) => Some(status),
            SaysAlone(both) => Some(both[usize::from(precision == Precision::F32)]),
            _ => None,
        };
        if let Some(status) = says {
            if finished.status != status {
                say(format!("{}, not {}", finished.status.meaning(), status.meaning()));
            }
            if let Some(truth) = reference
                && status == Status::NotSteady
                && truth.status != status
            {
                say(format!("the reference says {}", truth.status.meaning()));
            }
            continue;
        }
        if finished.status != Status::Ok || reference.is_none_or(|truth| truth.status != Status::Ok) {
            say(format!("{}, not ok, or the reference is not", finished.status.meaning()));
        }
        let expect = match expect {
            MissSingle(..) if precision == Precision::F64 => Within(|_| true),
            other => other,
        };
        match expect {
            Within(is_meant) => {
                if error > accuracy {
                    say(format!("{which:?} off by {error:.2e}"));
                }
                if !is_meant(&finished.measured) {
                    say(format!("not the case meant: {:?}", finished.measured));
                }
            }
            Miss(observable, band, _) | MissSingle(observable, band) => {
                if which != Some(observable) || error < band[0] || error > band[1] || others > accuracy {
                    say(format!("{which:?} off by {error:.2e}, others {others:.2e}; known {band:?}"));
                }
            }
            Says(_) | SaysAlone(_) => {}
        }
    }
    line += &format!(" {accuracy:5.0e}");
    if let Miss(_, _, cause) = expect {
        let (plan, truth) = match cause {
            Modes => (double, truth(&checks::plan(&scene, None), Model::Kept)),
            Steps => (checks::plan(&scene, Some(16 * double.cases[0].steps)), reference.expect("it ran")),
        };
        let (error, which, _) = errors(&plan, &checks::run(&plan)[0], &truth);
        line += &format!("  known miss by its {cause:?}, without it {error:.1e}").to_lowercase();
        if error > accuracy {
            wrong.push(format!("{name}: not its {cause:?}, {which:?} still off by {error:.2e}"));
        }
    }
    (line, wrong)
}

#[test]
fn accurate_or_a_status_that_says_why_not() {
    let mut rows: Vec<_> = CASES.par_iter().map(|(name, expect)| judge(name, *expect)).collect();
    println!("case, status (f64), the reference's, steps; largest error in f64 and in f32 and whose; bound");
    rows.iter().for_each(|(line, _)| println!("{line}"));
    let wrong: Vec<String> = rows.iter_mut().flat_map(|(_, wrong)| wrong.drain(..)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_scene_is_a_case_and_says_why_it_is_hard() {
    let mut files: Vec<String> = std::fs::read_dir("tests/hard")
        .expect("there are hard scenes")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    files.sort();
    let mut names: Vec<String> = CASES.iter().map(|(name, _)| format!("{name}.toml")).collect();
    names.sort();
    assert_eq!(files, names);
    for name in names {
        let text = std::fs::read_to_string(Path::new("tests/hard").join(&name)).expect("the scene");
        assert!(text.lines().any(|line| line.starts_with("# ")), "{name} gives no reason");
    }
}
