//! `afmsweep check` as a user calls it.

mod program;

use program::{Desk, scene};

const SMALL: &str = r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 50
[instrument.actuator]
model = "rigid"
[sample]
youngs_modulus = "2 GPa"
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "14 nm"
[sweep]
"instrument.tip.radius" = { values = ["5 nm", "10 nm", "20 nm"] }
[run]
periods = 400
measure = 10
"#;

#[test]
fn every_engine_stands_beside_the_reference() {
    let desk = Desk::new();
    let path = desk.write("small.toml", SMALL);
    let said = desk.works(&["check", path.to_str().unwrap()]);
    for word in ["3 of 3 instances", "gpu:"] {
        assert!(said.err.contains(word), "{word}: {}", said.err);
    }
    for word in [
        "instance 2: tip radius 20 nm; hertz",
        "reference",
        "cpu f64",
        "cpu f32",
        "force_max",
        "largest error",
    ] {
        assert!(said.out.contains(word), "{word}: {}", said.out);
    }
}

#[test]
fn json_holds_every_error_below_the_accuracy() {
    let desk = Desk::new();
    let path = desk.write("small.toml", SMALL);
    let json = desk.json(&["check", path.to_str().unwrap(), "-i", "2", "--json", "-q"]);
    assert_eq!(json["instances"].as_array().unwrap().len(), 2);
    for one in json["instances"].as_array().unwrap() {
        assert_eq!(one["reference"]["status"], "ok");
        let cpu = &one["engines"][0];
        assert_eq!(cpu["engine"], "cpu f64");
        let error = cpu["errors"]["amplitude"].as_f64().unwrap();
        assert!(0.0 < error && error < 1e-3, "{error}");
    }
    assert!(json["largest"][0]["largest_error"].as_f64().unwrap() < 1e-3);
}

#[test]
fn a_results_file_is_held_against_the_reference_too() {
    let desk = Desk::new();
    let path = desk.write("small.toml", SMALL);
    desk.works(&["run", path.to_str().unwrap(), "-q"]);
    let file = desk.results(&path);
    let said = desk.works(&["check", file.to_str().unwrap(), "-i", "1"]);
    assert!(said.out.contains("file") && said.out.contains("cpu f64"), "{}", said.out);
}

#[test]
fn errors_above_the_accuracy_end_with_an_error() {
    let desk = Desk::new();
    let coarse =
        SMALL.replace("periods = 400", "periods = 400\naccuracy = 1e-6\nsteps_per_period = 16\nmodes = 1");
    let path = desk.write("coarse.toml", &coarse);
    let said = desk.call(&["check", path.to_str().unwrap(), "-i", "1"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("above the accuracy asked for, 1e-6: cpu f64"), "{}", said.err);
    assert!(said.out.contains("largest error"), "the table comes first: {}", said.out);
}

#[test]
fn misuse_is_told() {
    let desk = Desk::new();
    desk.refuses(&["check", "nowhere.toml"], &["nowhere.toml"]);
    let text = desk.write("not.h5", "no results");
    desk.refuses(&["check", text.to_str().unwrap()], &["not.h5"]);
    let said = desk.call(&["check", &scene("quickstart.toml"), "-i", "0"]);
    assert_eq!(said.code, Some(2), "{}", said.err);
}
