//! What `run` makes of its audits and estimates: statuses, warnings, attributes of the file, exit codes.
//! Truth: the reference engine, called directly.

use crate::program::{Desk, variable};
use afmsweep::compare::{Scales, worst};
use afmsweep::engine::{Engine, Progress, Reference, solve};
use afmsweep::observe::{Measured, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use afmsweep::store::{Attribute, Results, read};
use afmsweep::sweep::{AUDIT_SECONDS, AUDIT_SHARE};
use std::path::Path;

/// A lever of one mode on elastic samples.
const SCENE: &str = r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
modes = [{ stiffness = "5 N/m", frequency = "75 kHz", quality_factor = 20 }]
[instrument.tip]
radius = "10 nm"
[sample]
surface_energy = "0 J/m^2"
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[run]
periods = 120
measure = 4
[sweep]
"sample.youngs_modulus" = { values = ["50 MPa", "500 MPa", "5 GPa"] }
[output]
observables = ["amplitude", "force_max"]
"#;

/// The same with a second mode that is too fast for sixteen steps, which miss the accuracy everywhere.
fn beam() -> String {
    let one = "modes = [{ stiffness = \"5 N/m\", frequency = \"75 kHz\", quality_factor = 20 }]";
    let second = "{ stiffness = \"196 N/m\", frequency = \"470 kHz\", quality_factor = 20 }";
    assert!(SCENE.contains(one));
    SCENE.replace(one, &one.replace("}]", &format!("}}, {second}]")))
}

fn number(results: &Results, name: &str) -> f64 {
    let found = results.attributes.iter().find(|(key, _)| key == name);
    match found {
        Some((_, Attribute::Number(number))) => *number,
        other => panic!("{name}: {other:?}"),
    }
}

fn comment(results: &Results) -> &str {
    let found = results.comments.iter().find(|(name, _)| name == "error_estimate");
    &found.expect("the estimate has a comment").1
}

/// What the reference's own runs make of a scene's instances.
fn truths(scene: &Path) -> (Plan, Vec<Measured>) {
    let plan = Plan::new(&Scene::load(scene).unwrap(), Precision::F64).unwrap();
    let finished = Reference::default().run(&plan, &Progress::default()).unwrap().results;
    assert!(finished.iter().all(|one| one.status == Status::Ok));
    let measured = finished.iter().map(|one| one.measured).collect();
    (plan, measured)
}

/// The error of what the file has for an instance, by these.
fn error((plan, truths): &(Plan, Vec<Measured>), results: &Results, instance: usize) -> f64 {
    let truth = &truths[instance];
    let mut ours = Measured::NONE;
    ours.harmonics[0] = variable(results, "amplitude")[instance];
    ours.force_max = variable(results, "force_max")[instance];
    worst(&plan.observables, &ours, truth, &Scales::of(plan, instance, truth))
}

/// Steps so few that every instance misses the accuracy, run so that nothing but the audit can tell.
#[test]
fn an_audit_that_misses_is_marked_warned_of_and_told_in_the_file() {
    let desk = Desk::new();
    let scene = desk.write("coarse.toml", &beam().replace("5 GPa", "200 MPa"));
    let path = scene.to_str().unwrap();
    let said = desk.works(&["run", path, "--no-estimate", "--steps-per-period", "16", "--audit", "2"]);
    let results = read(&desk.results(&scene)).unwrap();
    let audited: Vec<usize> =
        results.audit.as_ref().unwrap().instances.iter().map(|instance| *instance as usize).collect();
    assert_eq!(audited.len(), 2);
    let mut largest: f64 = 0.0;
    let truths = truths(&scene);
    for instance in 0..3 {
        let redone = audited.contains(&instance);
        let expected = if redone { Status::AccuracyNotMet } else { Status::Ok };
        assert_eq!(results.status[instance], expected as u8, "instance {instance}");
        let error = error(&truths, &results, instance);
        assert!(error > 1e-3, "the case is none: {error:e}");
        largest = if redone { largest.max(error) } else { largest };
    }
    assert_eq!((number(&results, "audited"), number(&results, "audit_above")), (2.0, 2.0));
    assert_eq!(number(&results, "audit_touching"), 2.0);
    assert!((number(&results, "audit_worst") / largest - 1.0).abs() < 1e-3);
    let worst = format!("{largest:.1e} in force_max, nothing was estimated");
    for word in [
        "2 of 3 instances marked accuracy not met",
        "warning: 2 of 2 audited instances (100 %) miss the accuracy asked for, 1e-3; the worst is instance",
        "(sample Young's modulus ",
        &worst,
        "1 instance called ok were neither estimated nor audited",
    ] {
        assert!(said.err.contains(word), "{word}: {}", said.err);
    }
}

/// Twenty periods are too few for the paper's lever.
const NEVER_STEADY: &str = r#"
[drive]
free_amplitude = "1 nm"
frequency = "30 kHz"
[sweep]
"approach.gap" = { from = "0.1 nm", to = "0.9 nm", points = 5 }
[run]
periods = 20
measure = 5
"#;

#[test]
fn a_strict_run_ends_with_3_where_the_accuracy_is_missed_and_its_file_is_whole() {
    let desk = Desk::new();
    let scene = desk.write("strict.toml", &beam().replace("5 GPa", "200 MPa"));
    let path = scene.to_str().unwrap();
    let good = desk.works(&["run", path, "--strict", "--audit", "1", "-q"]);
    assert_eq!(good.err, "");
    let verdict = |results: &Results| results.text("accuracy_verdict").unwrap().to_owned();
    let words = verdict(&read(&desk.results(&scene)).unwrap());
    assert!(words.contains("nothing above it is known of the 3 instances called ok; audited 1"), "{words}");
    for (more, expected) in [
        (vec!["--no-estimate", "--steps-per-period", "16", "--audit", "1"], "1 of 1 audits are above"),
        (vec!["--steps-per-period", "16", "--no-audit"], "3 of 3 instances are marked accuracy_not_met"),
        (vec!["--no-estimate", "--no-audit"], "3 instances called ok were neither estimated nor audited"),
    ] {
        let mut arguments = vec!["run", path, "-q", "--strict"];
        arguments.extend(&more);
        let said = desk.call(&arguments);
        assert_eq!(said.code, Some(3), "{more:?}: {}", said.err);
        assert!(said.err.starts_with("error: ") && said.err.contains(expected), "{more:?}: {}", said.err);
        // Without being asked to, it ends well with the same file.
        let strict = read(&desk.results(&scene)).unwrap();
        assert!(verdict(&strict).contains(expected), "{}", verdict(&strict));
        arguments.retain(|word| *word != "--strict");
        desk.works(&arguments);
        let same = |results: &Results| format!("{:?}{:?}", results.variables, results.status);
        assert_eq!(same(&read(&desk.results(&scene)).unwrap()), same(&strict));
    }
    // The reference's own results are what others are measured by.
    desk.works(&["run", path, "--strict", "--backend", "reference", "-q"]);
    // Where no instance is ok, nothing is known to be accurate.
    desk.write("never.toml", NEVER_STEADY);
    let said = desk.call(&["run", "never.toml", "-q", "--strict"]);
    assert!(said.code == Some(3) && said.err.contains("no instance is called ok"), "{}", said.err);
    let told = desk.json(&["run", "never.toml", "-q", "--json", "--overwrite"]);
    assert_eq!((&told["accuracy_met"], &told["status"]["not_steady"]), (&false.into(), &5.into()), "{told}");
}

/// A gap beyond the free swing leaves the free motion, which needs no audit: it used to come out as an error of infinity.
#[test]
fn what_never_feels_the_sample_is_left_out_of_the_audit() {
    let desk = Desk::new();
    let away = desk.write("away.toml", &SCENE.replace("15 nm", "30 nm"));
    let said = desk.works(&["run", away.to_str().unwrap(), "--audit", "2", "--strict"]);
    assert!(said.err.contains("audit: nothing to redo: no instance feels the sample"), "{}", said.err);
    let results = read(&desk.results(&away)).unwrap();
    assert!(results.audit.is_none() && results.status == [Status::Ok as u8; 3]);
    assert_eq!(number(&results, "audited"), 0.0);
    let gaps = "\"approach.gap\" = { values = [\"30 nm\", \"28 nm\", \"15 nm\", \"26 nm\"] }";
    let youngs = "\"sample.youngs_modulus\" = { values = [\"50 MPa\", \"500 MPa\", \"5 GPa\"] }";
    assert!(SCENE.contains(youngs));
    let mixed = desk.write("mixed.toml", &SCENE.replace(youngs, gaps));
    let said = desk.works(&["run", mixed.to_str().unwrap(), "--audit", "4"]);
    assert!(
        said.err.contains("audit: 1 instance redone") && said.err.contains("1 of 1 touch"),
        "{}",
        said.err
    );
    let audit = read(&desk.results(&mixed)).unwrap().audit.unwrap();
    assert_eq!(audit.instances, [2]);
    assert!(audit.variables.iter().all(|one| one.data.iter().all(|value| value.is_finite())));
}

/// However short the run: where one touches the sample, one that does is redone.
#[test]
fn a_run_audits_one_that_touches_the_sample() {
    let desk = Desk::new();
    let gaps = "\"approach.gap\" = { from = \"15 nm\", to = \"25 nm\", points = 41 }";
    let youngs = "\"sample.youngs_modulus\" = { values = [\"50 MPa\", \"500 MPa\", \"5 GPa\"] }";
    // DMT attracts the tip where it does not touch.
    let text = SCENE.replace(youngs, gaps).replace("hertz", "dmt").replace("0 J/m^2", "20 mJ/m^2");
    let scene = desk.write("short.toml", &text);
    let said = desk.works(&["run", scene.to_str().unwrap()]);
    let results = read(&desk.results(&scene)).unwrap();
    assert!(number(&results, "audit_touching") >= 1.0, "{}", said.err);
}

/// The document, the help and the program name one allowance.
#[test]
fn the_audits_allowance_is_told_once() {
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let help = flat(&Desk::new().works(&["run", "--help"]).out);
    let page = include_str!("../../docs/accuracy.md");
    assert_eq!((AUDIT_SHARE, AUDIT_SECONDS), (0.1, 0.25));
    for text in [help, flat(page)] {
        assert!(text.contains("as many as a tenth of the run's time allows, or 0.25 s, and at least one that touches the sample"), "{text}");
    }
}

/// Steps that the user prescribes: the estimate is of the size of the error, and a miss is no `ok`.
#[test]
fn prescribed_steps_are_estimated() {
    let desk = Desk::new();
    let beam = beam();
    let mut met = 0;
    for (name, text) in [("one", SCENE), ("beam", beam.as_str())] {
        let truths = truths(&desk.write(&format!("{name}.toml"), text));
        for steps in ["16", "48", "128", "1024"] {
            let scene = desk.write(&format!("{name}_{steps}.toml"), text);
            let results = desk.run(&scene, &["--steps-per-period", steps]);
            for instance in 0..3 {
                let estimate = variable(&results, "error_estimate")[instance];
                let error = error(&truths, &results, instance);
                let status = Status::from_code(results.status[instance]).unwrap();
                if ![Status::Ok, Status::AccuracyNotMet].contains(&status) {
                    // A contact shorter than a few steps has a status of its own.
                    assert_eq!((status, steps), (Status::OutOfRange, "16"), "{name} {instance}");
                    continue;
                }
                println!("{name} {steps} {instance}: off by {error:.1e}, estimated {estimate:.1e}");
                assert!(
                    error < 3.0 * estimate.max(1e-4),
                    "{name} {steps} {instance}: {error:e}, {estimate:e}"
                );
                let ok = status == Status::Ok;
                assert_eq!(ok, estimate <= 1e-3, "{name} {steps} {instance}: {estimate:e}");
                assert!(!ok || error <= 1e-3, "{name} {steps} {instance}: ok and off by {error:e}");
                met += usize::from(ok);
            }
            assert_eq!(results.steps_per_period, [steps.parse::<u32>().unwrap(); 3]);
            assert!(
                comment(&results).contains("the steps that the scene prescribes"),
                "{}",
                comment(&results)
            );
        }
    }
    assert!(met >= 9, "{met} ok: estimates far too large");
}

/// Where nothing is estimated, the file says why.
#[test]
fn a_missing_estimate_has_its_reason_in_the_file() {
    let desk = Desk::new();
    let scene = desk.write("reasons.toml", SCENE);
    for (more, reason) in [
        (vec!["--no-estimate"], "NaN: nothing was estimated, as the run was told to"),
        (vec!["--backend", "reference"], "NaN: nothing is estimated of the reference engine"),
        (vec![], "by two runs with different numbers of steps"),
    ] {
        let results = desk.run(&scene, &more);
        assert!(comment(&results).starts_with(reason), "{}", comment(&results));
        let none = variable(&results, "error_estimate").iter().all(|estimate| estimate.is_nan());
        assert_eq!(none, reason.starts_with("NaN"));
    }
}

/// The reference leaves modes out too: where a stiff contact makes that more than the accuracy asked for, its word is not
/// enough, and the run says so.
#[test]
fn an_accuracy_finer_than_the_references_own_is_told() {
    let desk = Desk::new();
    let lever = "modes = [{ stiffness = \"5 N/m\", frequency = \"75 kHz\", quality_factor = 20 }]";
    let text = SCENE
        .replace(lever, "stiffness = \"0.05 N/m\"\nfrequency = \"75 kHz\"\nquality_factor = 20")
        .replace("measure = 4", "measure = 4\naccuracy = 1e-7");
    for (name, text, told) in [
        ("beam", text.clone(), true),
        ("mode", SCENE.replace("measure = 4", "measure = 4\naccuracy = 1e-7"), false),
    ] {
        let scene = desk.write(&format!("{name}.toml"), &text);
        let said = desk.works(&["run", scene.to_str().unwrap(), "--audit", "3", "--no-estimate"]).err;
        assert_eq!(
            said.contains("the reference itself may be off by more than 1e-7"),
            told,
            "{name}: {said}"
        );
    }
    let plan = Plan::new(&Scene::load(&desk.path("beam.toml")).unwrap(), Precision::F64).unwrap();
    let work = solve(&plan, 2, &Reference::default()).unwrap().1;
    assert!(0.0 < work.left_out && work.left_out <= 1e-6);
}
