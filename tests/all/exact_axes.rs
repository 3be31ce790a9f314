//! Axes that are no single quantity: contact laws, and quantities that vary together.
//! Truth: the same cases written one by one, and the file read back.

use crate::program::Desk;
use afmsweep::control;
use afmsweep::engine::{Cpu, Progress};
use afmsweep::kernel::Law;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{DriveLevel, LawChoice, Params, Scene};
use afmsweep::store;
use std::path::Path;

const CASE: &str = r#"
title = "things"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 50
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "MODULUS"
poisson_ratio = 0.34
surface_energy = "ENERGY"
[contact]
law = "LAW"
[drive]
on = "tip"
frequency = "STIFF"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[run]
steady = "search"
modes = 1
steps_per_period = 128
"#;

const THINGS: &str = r#"
[sweep]
"contact.law" = { values = ["hertz", "dmt", "jkr"] }
[sweep.material]
label = ["soft one", "hard"]
"sample.youngs_modulus" = ["1 GPa", "3 GPa"]
"sample.surface_energy" = ["20 mJ/m^2", "60 mJ/m^2"]
"drive.frequency" = ["299 kHz", "300 kHz"]
"#;

fn case(law: &str, modulus: &str, energy: &str, frequency: &str) -> String {
    [("LAW", law), ("MODULUS", modulus), ("ENERGY", energy), ("STIFF", frequency)]
        .iter()
        .fold(CASE.to_owned(), |text, (name, value)| text.replace(name, value))
}

fn parse(text: &str) -> Scene {
    Scene::parse(Path::new("things.toml"), text).unwrap_or_else(|error| panic!("{error}"))
}

fn things() -> Scene {
    parse(&(case("auto", "2 GPa", "0 mJ/m^2", "300 kHz") + THINGS))
}

/// Each instance of the grid, with its case written out.
fn written() -> Vec<Scene> {
    let mut all = Vec::new();
    for law in ["hertz", "dmt", "jkr"] {
        all.push(parse(&case(law, "1 GPa", "20 mJ/m^2", "299 kHz")));
        all.push(parse(&case(law, "3 GPa", "60 mJ/m^2", "300 kHz")));
    }
    all
}

#[test]
fn places_along_such_axes_are_the_cases_written_one_by_one() {
    let grid = things();
    assert_eq!(grid.sweep.shape(), [3, 2]);
    let cases: Vec<Params> = written().iter().map(|scene| scene.instance(0)).collect();
    let ours: Vec<Params> = (0..grid.len()).map(|i| grid.instance(i)).collect();
    assert_eq!(ours, cases);
    assert_eq!(ours[4].contact.law, LawChoice::Jkr);
    assert_eq!(grid.described(5), " (law = \"jkr\", material = \"hard\")");
    let again = parse(&grid.resolved_toml());
    assert_eq!((again.sweep.clone(), again.base.clone()), (grid.sweep.clone(), grid.base.clone()));
}

#[test]
fn runs_over_such_axes_give_the_bits_of_the_cases() {
    let run = |scene: &Scene| {
        let plan = Plan::new(scene, Precision::F64).expect("the scene can be planned");
        control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs")
    };
    let whole = run(&things());
    for (i, scene) in written().iter().enumerate() {
        let one = run(scene);
        let (ours, alone) = (&whole.results.get(i), &one.results.get(0));
        assert_eq!(format!("{ours:?}"), format!("{alone:?}"), "instance {i}");
        let law = [Law::Hertz, Law::Dmt, Law::Jkr][i / 2];
        assert_eq!(whole.plan.contact(i as u32).law, law);
    }
}

/// Labels are texts, laws are called by name, and the quantities stand over the labels; a picture is chosen by them.
#[test]
fn files_call_the_places_by_their_names() {
    let desk = Desk::new();
    desk.write("things.toml", &(case("auto", "2 GPa", "0 mJ/m^2", "300 kHz") + THINGS));
    desk.works(&["run", "things.toml", "-o", "things.h5"]);
    let results = store::read(&desk.path("things.h5")).expect("it can be read");
    let [law, material] = &results.axes[..] else { panic!("{:?}", results.axes) };
    assert_eq!((law.name.as_str(), law.words.join(" ").as_str()), ("law", "hertz dmt jkr"));
    assert_eq!((material.name.as_str(), material.words.join("|").as_str()), ("material", "soft one|hard"));
    let columns: Vec<&str> = material.columns.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(columns, ["sample_youngs_modulus", "sample_surface_energy", "drive_frequency"]);
    assert_eq!(*material.columns[1].values, [0.02, 0.06]);
    assert_eq!(material.columns[1].scene_path, "sample.surface_energy");
    assert!(results.variables.iter().all(|one| !columns.contains(&one.name.as_str())));
    desk.works(&["report", "things.h5", "-o", "page", "--x", "material", "--at", "contact.law=dmt"]);
    let csv = std::fs::read_to_string(desk.path("page/amplitude.csv")).expect("numbers beside the picture");
    assert!(csv.contains("\n3,dmt,hard,") && csv.contains("\n0,hertz,soft one,"), "{csv}");
    let wrong = desk.refuses(&["report", "things.h5", "-o", "page", "--at", "material=PS"], &[]).err;
    assert!(wrong.contains("one of soft one, hard"), "{wrong}");
}

/// A list beside a grid or a curve: every point has every sample.
#[test]
fn samples_cross_with_a_grid_and_with_a_curve() {
    let lists = r#"
        [samples]
        "sample.youngs_modulus" = ["1 GPa", "3 GPa", "1 GPa"]
        "instrument.tip.radius" = ["8 nm", "10 nm", "12 nm"]
    "#;
    let base = case("dmt", "2 GPa", "20 mJ/m^2", "300 kHz");
    let grid = parse(
        &(base.clone() + "[sweep]\n\"drive.free_amplitude\" = { values = [\"10 nm\", \"20 nm\"] }" + lists),
    );
    assert_eq!(grid.sweep.shape(), [2, 3]);
    let (first, last) = (grid.instance(2), grid.instance(4));
    assert_eq!((first.sample.youngs_modulus, first.instrument.tip.radius), (1e9, 12e-9));
    assert_eq!((last.sample.youngs_modulus, last.instrument.tip.radius), (3e9, 10e-9));
    assert_eq!(first.drive.level, DriveLevel::FreeAmplitude(10e-9));
    assert_eq!(last.drive.level, DriveLevel::FreeAmplitude(20e-9));
    let curve = "[curve]\nquantity = \"approach.gap\"\nvalues = [\"19 nm\", \"18 nm\"]\ndirection = \"both\"";
    let curves = parse(&(base + lists + curve));
    let names: Vec<&str> = curves.sweep.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(
        (names.join(" ").as_str(), curves.sweep.shape()),
        ("sample direction approach_gap", vec![3, 2, 2])
    );
    for scene in [grid, curves] {
        let again = parse(&scene.resolved_toml());
        assert_eq!(again.sweep, scene.sweep);
    }
    let desk = Desk::new();
    let text = case("dmt", "2 GPa", "20 mJ/m^2", "300 kHz") + lists + curve;
    desk.write("lists.toml", &text.replace("steps_per_period = 128", "periods = 400"));
    desk.works(&["run", "lists.toml", "-o", "lists.h5"]);
    let results = store::read(&desk.path("lists.h5")).expect("it can be read");
    let columns: Vec<&[f64]> = results.axes[0].columns.iter().map(|one| one.values.as_slice()).collect();
    assert_eq!(columns, [&[1e9, 3e9, 1e9], &[8e-9, 10e-9, 12e-9]]);
    desk.works(&["report", "lists.h5", "-o", "page"]);
}
