//! `afmsweep check` as a user calls it.

use crate::program::{Desk, scene};
use afmsweep::observe::Status;
use afmsweep::store::{Results, Variable, Writer, read};
use std::path::{Path, PathBuf};

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

/// The same with a lever of one mode, which the reference is done with much sooner.
fn fast() -> String {
    one_mode().replace("periods = 400", "periods = 200")
}

fn one_mode() -> String {
    let beam = "stiffness = \"40 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 50";
    assert!(SMALL.contains(beam));
    let one = "modes = [{ stiffness = \"40 N/m\", frequency = \"300 kHz\", quality_factor = 50 }]";
    SMALL.replace(beam, one)
}

#[test]
fn every_engine_stands_beside_the_reference() {
    let desk = Desk::new();
    let path = desk.write("small.toml", &fast());
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
    let path = desk.write("small.toml", &fast());
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
    let path = desk.write("small.toml", &fast());
    desk.works(&["run", path.to_str().unwrap(), "-q"]);
    let file = desk.results(&path);
    let said = desk.works(&["check", file.to_str().unwrap(), "-i", "1"]);
    assert!(said.out.contains("file") && said.out.contains("cpu f64"), "{}", said.out);
}

/// What a results file of this scene holds, changed and written to another one.
fn changed(desk: &Desk, scene: &Path, name: &str, change: impl Fn(&mut Results)) -> PathBuf {
    let mut results = read(&desk.results(scene)).unwrap();
    change(&mut results);
    let path = desk.path(name);
    let mut writer = Writer::create(&path, &std::fs::read_to_string(scene).unwrap(), true).unwrap();
    writer.write(&results).unwrap();
    writer.finish().unwrap();
    path
}

fn amplitude(results: &mut Results) -> &mut Variable {
    results.variables.iter_mut().find(|variable| variable.name == "amplitude").unwrap()
}

#[test]
fn errors_above_the_accuracy_end_with_an_error() {
    let desk = Desk::new();
    let scene = desk.write("small.toml", &fast());
    desk.works(&["run", scene.to_str().unwrap(), "-q"]);
    let wrong = |results: &mut Results| amplitude(results).data[1] *= 1.01;
    let file = changed(&desk, &scene, "wrong.h5", wrong);
    let said = desk.call(&["check", file.to_str().unwrap()]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("above the accuracy asked for, 1e-3: file\n"), "{}", said.err);
    assert!(said.out.contains("largest error"), "the table comes first: {}", said.out);
}

#[test]
fn a_damaged_file_is_no_good_file() {
    let desk = Desk::new();
    let scene = desk.write("small.toml", &fast());
    desk.works(&["run", scene.to_str().unwrap(), "-q"]);
    let spoilt = changed(&desk, &scene, "spoilt.h5", |results| amplitude(results).data.fill(f64::NAN));
    desk.refuses(
        &["check", spoilt.to_str().unwrap()],
        &["`amplitude` of instance 0 is no number though", "(3 such"],
    );
    // Not among the instances that a check of one would look at.
    for instance in 0..3 {
        let one = |results: &mut Results| amplitude(results).data[instance] = f64::NAN;
        let file = changed(&desk, &scene, "one.h5", one);
        let place = format!("`amplitude` of instance {instance} is no number");
        desk.refuses(&["check", file.to_str().unwrap(), "-i", "1"], &[&place]);
    }
    let gone = |results: &mut Results| results.variables.retain(|variable| variable.name != "amplitude");
    let file = changed(&desk, &scene, "gone.h5", gone);
    desk.refuses(&["check", file.to_str().unwrap()], &["lacks amplitude"]);
}

/// Tapping that has not settled: file and engines call nothing ok, and there is nothing to hold against the reference.
#[test]
fn a_check_that_compares_nothing_fails() {
    let desk = Desk::new();
    let text = fast().replace("quality_factor = 50", "quality_factor = 100");
    let scene =
        desk.write("early.toml", &text.replace("periods = 200\nmeasure = 10", "periods = 30\nmeasure = 4"));
    let results = desk.run(&scene, &[]);
    assert!(results.status.iter().all(|status| *status == Status::NotSteady as u8));
    let file = desk.results(&scene);
    for (path, who) in [(&file, "the file"), (&scene, "the run")] {
        let said = desk.call(&["check", path.to_str().unwrap()]);
        assert_eq!(said.code, Some(1), "{}", said.out);
        let expected = format!("nothing could be compared: {who} calls none of the 3 instances ok");
        assert!(said.err.contains(&expected), "{}", said.err);
        assert!(said.out.contains("nothing compared"), "{}", said.out);
    }
    let spoilt = changed(&desk, &scene, "spoilt.h5", |results| amplitude(results).data.fill(f64::NAN));
    assert_eq!(desk.call(&["check", spoilt.to_str().unwrap()]).code, Some(1));
}

/// A quality factor that no 300 periods settle: the search finds the states, and so does the reference.
#[test]
fn searched_states_stand_beside_the_references_own() {
    let desk = Desk::new();
    let text = one_mode()
        .replace("quality_factor = 50", "quality_factor = 450")
        .replace("periods = 400\nmeasure = 10", "steady = \"search\"")
        .replace("law = \"hertz\"", "law = \"dmt\"")
        .replace("[sample]", "[sample]\nsurface_energy = \"60 mJ/m^2\"")
        .replace(
            "\"instrument.tip.radius\" = { values = [\"5 nm\", \"10 nm\", \"20 nm\"] }",
            "\"approach.gap\" = { values = [\"8 nm\", \"14 nm\", \"23 nm\"] }",
        );
    let scene = desk.write("searched.toml", &text);
    desk.works(&["run", scene.to_str().unwrap(), "-q"]);
    let file = desk.results(&scene);
    let said = desk.works(&["check", file.to_str().unwrap()]).out;
    assert!(said.contains("the reference calls 3 of 3 instances ok; 2 of these touch the sample"), "{said}");
    let json = desk.json(&["check", file.to_str().unwrap(), "--json", "-q"]);
    for one in json["instances"].as_array().unwrap() {
        assert_eq!(one["reference"]["by"], "periodic state next to the run's");
    }
    let first = &json["largest"][0];
    assert_eq!(
        (first["engine"].as_str(), first["compared"].as_u64(), first["touching"].as_u64()),
        (Some("file"), Some(3), Some(2))
    );
    assert!(first["largest_error"].as_f64().unwrap() < 1e-3);
}

/// The paper's rod rings for ever where nothing damps it, and a stiff sample feels that: the run calls it not steady, and so does
/// its check.
#[test]
fn an_undamped_rod_is_not_steady_by_its_check_either() {
    let desk = Desk::new();
    let scene = desk.write(
        "rod.toml",
        "[instrument]\npreset = \"ha-fung-chen-2005\"\n[instrument.actuator]\nquality_factor = inf\n\
         [instrument.cantilever]\nquality_factor = 25\n\
         [instrument.tip]\nyoungs_modulus = \"130 GPa\"\nradius = \"40 nm\"\n[sample]\nyoungs_modulus = \"100 GPa\"\n\
         surface_energy = \"0 J/m^2\"\n[contact]\nlaw = \"dmt\"\n[drive]\nfrequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n\
         [approach]\ngap = \"17 nm\"\n[run]\nperiods = 80\nmeasure = 10\n[output]\nobservables = [\"amplitude\", \"force_max\"]\n",
    );
    let results = desk.run(&scene, &[]);
    assert_eq!(results.status, [Status::NotSteady as u8]);
    let said = desk.call(&["check", scene.to_str().unwrap(), "-q"]);
    assert_eq!(said.code, Some(1), "{}", said.out);
    assert!(said.err.contains("nothing could be compared"), "{}", said.err);
}

/// By content, not by name: TOML and HDF5 under any.
#[test]
fn a_results_file_may_have_any_name() {
    let desk = Desk::new();
    let scene = desk.write("small.toml", &fast());
    desk.works(&["run", scene.to_str().unwrap(), "-q"]);
    for name in ["grid.nc", "UP.H5", "plain", "data.toml"] {
        std::fs::copy(desk.results(&scene), desk.path(name)).unwrap();
        let said = desk.works(&["check", name, "-i", "1"]);
        assert!(said.out.contains("file"), "{name}: {}", said.out);
    }
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

/// A lever that has two states between 16 and 19 nm: points taken from the free oscillation could lie on another branch than
/// the one that the curve has led to.
#[test]
fn points_of_a_curve_are_followed_along_all_of_it() {
    let desk = Desk::new();
    let text = one_mode()
        .replace("law = \"hertz\"", "law = \"dmt\"")
        .replace("quality_factor = 50", "quality_factor = 300")
        .replace("youngs_modulus = \"2 GPa\"", "youngs_modulus = \"2 GPa\"\nsurface_energy = \"60 mJ/m^2\"")
        .replace("[approach]\ngap = \"14 nm\"\n", "");
    let (before, _) = text.split_once("[sweep]").unwrap();
    let text = format!(
        "{before}[curve]\nquantity = \"approach.gap\"\nfrom = \"20 nm\"\nto = \"14 nm\"\npoints = 7\ndirection = \"both\"\n\
         [run]\nsteady = \"search\"\n"
    );
    desk.write("curve.toml", &text);
    desk.works(&["run", "curve.toml", "-o", "curve.h5", "-q"]);
    let found = read(&desk.path("curve.h5")).unwrap();
    let jump = found.flags.iter().find(|one| one.name == "jump").unwrap();
    assert!(jump.data.contains(&1), "this curve is meant to have a jump");
    let said = desk.works(&["check", "curve.h5", "-i", "6", "--json"]);
    assert!(said.err.contains("along all 14 points"), "{}", said.err);
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(json["instances"].as_array().unwrap().len(), 6);
    for one in json["largest"].as_array().unwrap() {
        // f32 misses what it is not chosen for; the file and the CPU's f64 do not.
        if ["file", "cpu f64"].contains(&one["engine"].as_str().unwrap()) {
            assert!(one["largest_error"].as_f64().unwrap() < 1e-3, "{one}");
        }
    }
}
