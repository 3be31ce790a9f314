//! docs/results.md names whatever a results file holds.
//! Truth: the program's lists of observables and statuses, and files.

use crate::docs_name_everything::{CURVE, Document, LEVER};
use afmsweep::contact::Law;
use afmsweep::control::Arithmetic;
use afmsweep::record::{self, BRANCHES, Facts, JUMPS, WARNINGS};
use afmsweep::store::{Attribute, Results};
use afmsweep::sweep::SweepPhase;
use afmsweep::{Audit, Backend, Observable, Precision, Scene, Status, Sweep, SweepOutcome};
use hdf5::types::{FloatSize, IntSize, TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, Group};
use std::path::Path;

/// A searched grid with everything asked for, and a list whose instances have frequencies of their own.
fn runs() -> Vec<SweepOutcome> {
    let names: Vec<String> = Observable::all().map(|one| format!("\"{}\"", one.name())).collect();
    let output = format!(
        "[output]\nobservables = [{}]\nwaveforms = {{ instances = [0, 1] }}\nspectra = {{ instances = [0] }}\n",
        names.join(", ")
    );
    let grid = "[sweep]\n\"sample.youngs_modulus\" = { values = [\"1 GPa\", \"2 GPa\"] }\n";
    let list = "[samples]\n\"drive.frequency\" = [\"74 kHz\", \"75 kHz\"]\n";
    let run = |sweep: &str| {
        let scene = Scene::parse(Path::new("all.toml"), &format!("{LEVER}{output}{sweep}")).unwrap();
        Sweep::new(scene).backend(Backend::Cpu).audit(Audit::Instances(1)).run().unwrap()
    };
    let single = LEVER.replace("branches = \"both\"\n", "");
    let text = format!("{single}{CURVE}direction = \"both\"\n");
    let scene = Scene::parse(Path::new("curve.toml"), &text).unwrap();
    let curve = Sweep::new(scene).backend(Backend::Cpu).audit(Audit::None).run().unwrap();
    vec![run(grid), run(list), curve]
}

/// The results of a run that went through both precisions and was stopped.
fn mixed_and_stopped(swept: &SweepOutcome) -> Results {
    let run = &swept.run;
    let facts = Facts {
        device: String::new(),
        wall_time: 0.0,
        steps_taken: 0,
        rate: 0.0,
        neighbour_started: 0.0,
        plan: run.plan.summary(None).json().to_string(),
        command_line: String::new(),
        arithmetic: Arithmetic { of: vec![Precision::F32, Precision::F64], ..run.arithmetic.clone() },
    };
    let path = Path::new("all.toml");
    let scene = Scene::parse(path, swept.results.text("scene").unwrap()).unwrap();
    let mut results = record::results(&scene, &run.plan, &run.results, &facts).unwrap();
    results.attributes.extend(record::complete(&["audit"]));
    results
}

/// The type of a dataset as the document writes it.
fn kind(dataset: &Dataset) -> &'static str {
    match dataset.dtype().unwrap().to_descriptor().unwrap() {
        TypeDescriptor::Float(FloatSize::U8) => "f64",
        TypeDescriptor::Integer(IntSize::U4) => "i32",
        TypeDescriptor::Integer(IntSize::U8) => "i64",
        TypeDescriptor::Unsigned(IntSize::U1) => "u8",
        TypeDescriptor::Unsigned(IntSize::U4) => "u32",
        TypeDescriptor::VarLenUnicode => "text",
        other => panic!("{}: {other:?}", dataset.name()),
    }
}

fn text(dataset: &Dataset, name: &str) -> Option<String> {
    let attribute = dataset.attr(name).ok()?;
    Some(attribute.read_scalar::<VarLenUnicode>().unwrap().as_str().to_owned())
}

/// A dataset's row has its type and units, and every word of its codes stands below the same heading or that of statuses.
fn dataset_is_told(document: &Document, heading: &str, dataset: &Dataset) {
    for name in dataset.attr_names().unwrap() {
        document.row("Attributes of datasets", &name);
    }
    let path = dataset.name();
    let name = path.rsplit('/').next().unwrap();
    let repeated = heading == "Group `audit`" || heading == "Group `other_branch`";
    let row = match Observable::from_name(name) {
        Some(_) if repeated => document.row(heading, "<observable>"),
        _ => document.row(heading, name),
    };
    assert!(row[1].contains(kind(dataset)), "{heading} {name}: {row:?} is no {}", kind(dataset));
    if let Some(units) = text(dataset, "units").filter(|_| row[0] != "`<observable>`") {
        assert!(row[3].contains(&format!("`{units}`")), "{heading} {name}: {row:?} has not {units}");
    }
    for word in text(dataset, "flag_meanings").unwrap_or_default().split(' ').filter(|word| !word.is_empty())
    {
        let heading = if name.ends_with("status") { "Statuses" } else { heading };
        document.says(heading, word);
    }
}

fn group_is_told(document: &Document, heading: &str, group: &Group, axes: &[&str]) {
    for name in group.member_names().unwrap() {
        if let Ok(inner) = group.group(&name) {
            document.row("Groups", &name);
            group_is_told(document, &format!("Group `{name}`"), &inner, axes);
        } else if !axes.contains(&name.as_str()) {
            dataset_is_told(document, heading, &group.dataset(&name).unwrap());
        }
    }
}

fn keys_of(value: &serde_json::Value, keys: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(map) => map.iter().for_each(|(key, value)| {
            keys.push(key.clone());
            keys_of(value, keys);
        }),
        serde_json::Value::Array(list) => list.iter().for_each(|value| keys_of(value, keys)),
        _ => {}
    }
}

#[test]
fn everything_in_a_results_file_is_told() {
    let document = Document::open("results.md");
    let folder = tempfile::tempdir().unwrap();
    let swept = runs();
    let stopped = mixed_and_stopped(&swept[0]);
    let all = swept.iter().map(|one| &one.results).chain([&stopped]);
    for (number, results) in all.enumerate() {
        let path = folder.path().join(format!("{number}.h5"));
        results.write(&path, false).unwrap();
        let file = hdf5::File::open(&path).unwrap();
        for name in file.attr_names().unwrap() {
            let row = document.row("Root attributes", &name);
            let number = results
                .attributes
                .iter()
                .any(|(key, value)| *key == name && matches!(value, Attribute::Number(_)));
            assert_eq!(row[1], if number { "f64" } else { "text" }, "{name}");
        }
        for name in file.group("provenance").unwrap().attr_names().unwrap() {
            document.row("Group `provenance`", &name);
        }
        let axes: Vec<&str> = results.axes.iter().map(|axis| axis.name.as_str()).collect();
        group_is_told(&document, "Variables", &file.group("/").unwrap(), &axes);
        let mut keys = Vec::new();
        keys_of(&serde_json::from_str(results.text("plan").unwrap()).unwrap(), &mut keys);
        keys.iter().for_each(|key| document.says("The plan", key));
    }
    // Where nothing is left out by the runs themselves.
    let searched = &swept[0].results;
    assert!(searched.other_branch.is_some() && searched.audit.is_some() && searched.waveforms.is_some());
    assert!(searched.spectra.is_some());
    assert!(!searched.force_curves.is_empty() && stopped.flags.iter().any(|flags| flags.name == "precision"));
}

#[test]
fn every_status_and_every_other_word_is_told() {
    let document = Document::open("results.md");
    for status in Status::ALL {
        let row = document.row("Statuses", status.meaning());
        assert_eq!(row[1], (status as u8).to_string(), "{}", status.meaning());
    }
    let laws: Vec<&str> = Law::ALL.iter().map(|law| law.name()).collect();
    for word in laws.iter().chain(&BRANCHES).chain(&WARNINGS).chain(&JUMPS).chain(&["forward", "backward"]) {
        document.says("Variables", word);
    }
    for phase in [
        SweepPhase::Planning,
        SweepPhase::Stepping,
        SweepPhase::Refinement,
        SweepPhase::Branches,
        SweepPhase::Audit,
        SweepPhase::Waveforms,
        SweepPhase::Spectra,
    ] {
        document.says("An incomplete file", phase.word());
    }
    for observable in Observable::all() {
        let row = document.row("Variables", observable.name());
        assert_eq!(row[3], format!("`{}`", observable.units()), "{}", observable.name());
    }
}
