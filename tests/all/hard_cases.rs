//! Scenes at the ends of what can be asked for (tests/hard/, each with its reason), run as a user would.
//!
//! Each ends in one of two ways: every observable within the accuracy that the scene asks for, held
//! against the reference engine, or a status that says why not. And no estimate of an error is far too low.

use crate::checks;
use afmsweep::compare::{Scales, error};
use afmsweep::control::{self, RunResult};
use afmsweep::engine::{Cpu, Finished, Progress, Reference, solve};
use afmsweep::observe::{Measured, Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{DriveLevel, Scene, Steady};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// Error per step of the reference, which has more digits than any case asks for: that of an audit for 1e-3. With 1e-11 the
/// same cases pass, in more than twice the time.
const TOLERANCE: f64 = 1e-8;

/// An estimate is too low where the error is so many times it and more than a tenth of the accuracy asked for.
const TOO_LOW: f64 = 3.0;

#[derive(Clone, Copy, Debug)]
enum Expect {
    /// Ok by both engines, errors within the accuracy asked for, and the case is what it is meant to be.
    Within(fn(&Measured) -> bool),
    /// A status; if it is `NotSteady` the reference has to say so too.
    Says(Status),
    /// The same without the reference, whose steps follow the fastest of all modes; in f64 and in f32.
    SaysAlone([Status; 2]),
}

use Expect::{Says, SaysAlone, Within};

const CASES: &[(&str, Expect)] = &[
    ("adhesion_0", Within(taps)),
    ("adhesion_1e-6", Within(taps)),
    ("adhesion_1", Within(taps)),
    ("adhesion_1_dmt", Within(taps)),
    ("adhesion_1_stiff", Within(taps)),
    ("amplitude_1_pm", Within(stays_off)),
    // A loss of nothing is a sum of large terms beside a drive's work of 1e-24 J.
    ("amplitude_1_pm_single", Within(stays_off)),
    ("amplitude_5_um", Within(taps)),
    ("branch_attractive", Within(|m| stays_off(m) && m.phase > 90.0)),
    ("branch_repulsive", Within(|m| taps(m) && m.phase < 90.0)),
    ("contact_every_second", Says(Status::NotSteady)),
    ("contact_too_short", Says(Status::OutOfRange)),
    ("decay_10_fm", Within(taps)),
    ("decay_1_pm", Within(taps)),
    ("drive_above", Within(taps)),
    ("drive_below", Within(taps)),
    ("drive_second_mode", Within(taps)),
    ("gap_negative", Within(holds_on)),
    ("gap_zero", Within(taps)),
    // At the plan's own steps a contact of two steps and less.
    ("graze_1e-3", Within(taps)),
    ("graze_1e-6", Within(taps)),
    ("graze_jkr", Within(taps)),
    ("hits_by_turns", Says(Status::NotSteady)),
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
    // f32 cannot hold the free motion and takes what is no number for "not in contact": its estimate tells.
    ("overflow_single", SaysAlone([Status::NonFinite, Status::AccuracyNotMet])),
    ("q_1e5", Says(Status::NotSteady)),
    ("q_1e5_overtone", Says(Status::NotSteady)),
    // Waiting two million periods ends there too: off the surface, on the attractive branch.
    ("q_1e5_search", Within(|m| stays_off(m) && m.phase > 90.0)),
    ("q_1e5_overtone_search", Within(taps)),
    ("q_infinite", Says(Status::NotSteady)),
    // Stiff contacts ring modes that the plan alone would not keep, which the largest force shows.
    ("radius_10_um", Within(taps)),
    ("radius_10_um_jkr", Within(taps)),
    ("radius_1_nm", Within(taps)),
    ("rod_damped", Within(taps)),
    ("rod_met", Within(taps)),
    ("rod_resonance", Within(taps)),
    // The rod's undamped modes ring on for ever.
    ("rod_undamped", Says(Status::NotSteady)),
    ("sample_1_kpa", Within(taps)),
    ("sample_1_tpa", Within(taps)),
    ("sample_1_tpa_jkr", Within(taps)),
    ("snap_in", Within(holds_on)),
    ("snap_in_jkr", Within(holds_on)),
    // A contact shorter than a step throws the tip out of all bounds.
    ("too_few_steps", Says(Status::NonFinite)),
    // Sixteen contacts and more of a lever that rings between them.
    ("bounces_dmt", Within(touches)),
    ("bounces_hertz", Within(touches)),
    ("bounces_jkr", Within(touches)),
    ("soft_0.03_dmt", Within(touches)),
    ("soft_0.03_hertz", Within(touches)),
    ("soft_0.03_jkr", Within(touches)),
    ("soft_0.05_dmt", Within(touches)),
    ("soft_0.05_graze", Within(touches)),
    ("soft_0.05_jkr", Within(touches)),
    ("soft_0.09_stuck", Within(touches)),
    ("soft_0.19_jkr", Within(touches)),
    ("soft_0.1_dmt", Within(touches)),
    ("soft_0.1_hertz", Within(touches)),
    ("soft_0.1_jkr", Within(touches)),
    ("soft_0.2_hertz", Within(touches)),
    ("soft_0.3_dmt", Within(touches)),
    ("soft_0.3_jkr", Within(touches)),
    ("soft_0.5_dmt", Within(touches)),
    ("soft_0.5_hertz", Within(touches)),
    ("soft_0.5_jkr", Within(touches)),
    ("soft_1_dmt", Within(touches)),
    ("soft_1_hertz", Within(touches)),
    ("soft_1_jkr", Within(touches)),
    ("tip_mass_dmt", Within(touches)),
    ("tip_mass_jkr", Within(touches)),
    ("tip_mass_light", Within(touches)),
    ("tip_mass_soft", Within(touches)),
    ("tip_mass_stiff", Within(touches)),
];

fn touches(m: &Measured) -> bool {
    m.contact_time > 0.0
}

fn taps(m: &Measured) -> bool {
    m.contacts == 1.0 && m.contact_time > 0.0 && m.contact_time < 0.9
}

fn holds_on(m: &Measured) -> bool {
    m.contacts == 0.0 && m.contact_time == 1.0
}

fn stays_off(m: &Measured) -> bool {
    m.contacts == 0.0 && m.contact_time == 0.0
}

/// The largest error on the documented scales and whose it is.
fn errors(plan: &Plan, ours: &Finished, truth: &Finished) -> (f64, Option<Observable>) {
    let scales = Scales::of(plan, 0, &truth.measured);
    let mut worst = (0.0, None);
    for observable in &plan.observables {
        let error = error(*observable, &ours.measured, &truth.measured, &scales);
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > worst.0 {
            worst = (error, Some(*observable));
        }
    }
    worst
}

/// As `afmsweep run` does it.
fn controlled(plan: &Plan) -> RunResult {
    control::run(plan, &Cpu::default(), &Progress::default()).expect("the plan can be run")
}

fn truth(plan: &Plan) -> Finished {
    let options = Reference { tolerance: TOLERANCE, ..Reference::default() };
    if plan.run.steady == Steady::Search {
        let run = control::by_reference(plan, &options, &Progress::default());
        return run.expect("the instance can be solved").outcome.results[0];
    }
    solve(plan, 0, &options).expect("the instance can be solved").0
}

/// Lengths that no scene may say: so many times those of the file.
const BEYOND: &[(&str, f64)] = &[("overflow", 1e31), ("overflow_pressed", 1e4), ("overflow_single", 1e33)];

fn load(name: &str) -> Scene {
    let path = Path::new("tests/hard").join(format!("{name}.toml"));
    let mut scene = Scene::load(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    scene.output.observables = Observable::all().collect();
    if let Some((_, times)) = BEYOND.iter().find(|(one, _)| *one == name) {
        scene.base.approach.gap *= times;
        if name != "overflow_pressed"
            && let DriveLevel::FreeAmplitude(amplitude) = &mut scene.base.drive.level
        {
            *amplitude *= times;
        }
    }
    scene
}

/// A line of the table, and what is wrong with the case.
fn judge(name: &str, expect: Expect) -> (String, Vec<String>) {
    let begun = Instant::now();
    let mut wrong = Vec::new();
    let scene = load(name);
    let double = checks::plan(&scene, None);
    let accuracy = double.run.accuracy;
    // The other statuses say nothing that the reference would know, and its steps follow the fastest mode for long.
    let compared = matches!(expect, Within(_) | Says(Status::NotSteady));
    let reference = compared.then(|| truth(&double));
    let mut line = format!("{name:<20}");
    for precision in [Precision::F64, Precision::F32] {
        let run = controlled(&double.clone().in_precision(precision));
        let (plan, finished, estimate) = (run.plan, run.results.get(0), run.estimates[0]);
        let mut say = |text: String| wrong.push(format!("{name}, {}: {text}", precision.name()));
        let found = reference.as_ref().map(|truth| errors(&plan, &finished, truth));
        if precision == Precision::F64 {
            let theirs = reference.as_ref().map_or("-", |truth| truth.status.meaning());
            let (ours, steps) = (finished.status.meaning(), plan.steps(0));
            line += &format!(" {ours:<13}{theirs:<12}{steps:>5} {estimate:>8.1e} ");
        }
        let (error, which) = found.unwrap_or((f64::NAN, None));
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
        if error > accuracy {
            say(format!("{which:?} off by {error:.2e}"));
        }
        if error > TOO_LOW * estimate.max(0.1 * accuracy) {
            say(format!("{which:?} off by {error:.1e}, estimated {estimate:.1e}"));
        }
        if let Within(is_meant) = expect
            && !is_meant(&finished.measured)
        {
            say(format!("not the case meant: {:?}", finished.measured));
        }
    }
    line += &format!(" {accuracy:5.0e} {:6.2} s", begun.elapsed().as_secs_f64());
    (line, wrong)
}

#[test]
fn accurate_or_a_status_that_says_why_not() {
    let mut rows: Vec<_> = CASES.par_iter().map(|(name, expect)| judge(name, *expect)).collect();
    println!(
        "case, status (f64), the reference's, steps, estimated error; largest error in f64 and in f32 and whose; bound"
    );
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
