//! `run` as a user calls it, and what it leaves in the results file.
//! Truth: the engine called directly, the contact laws, and sums over the waveforms.

use crate::program::{Desk, difference, scenes, variable};
use afmsweep::control::{self, RunResult};
use afmsweep::engine::{Cpu, Engine, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use afmsweep::store::{Attribute, Results, read};
use std::path::Path;

const TAPPING: &str = r#"
title = "Small tapping sweep"
[instrument.cantilever]
quality_factor = 30
[sample]
surface_energy = "20 mJ/m^2"
poisson_ratio = 0.3
[contact]
law = "dmt"
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "100 MPa", to = "10 GPa", points = 3, scale = "log" }
"approach.gap" = { values = ["12 nm", "16 nm"] }
[run]
periods = 200
measure = 20
[output]
observables = ["amplitude", "phase", "force_max", "force_min", "force_mean", "indentation_max", "contact_time", "dissipation", "virial", "contacts", "harmonic_amplitude"]
waveforms = { instances = [1, 4], samples_per_period = 256, periods = 3 }
"#;

/// The same scene by the library.
fn engine(path: &Path, precision: Precision, steps: Option<u32>) -> RunResult {
    let mut scene = Scene::load(path).unwrap();
    scene.run.steps_per_period = steps.or(scene.run.steps_per_period);
    let plan = Plan::new(&scene, precision).unwrap();
    control::run(&plan, &Cpu::default(), &Progress::default()).unwrap()
}

/// Every variable and status equals what the engine says, to the bit.
fn agrees(results: &Results, path: &Path, precision: Precision, steps: Option<u32>) {
    let RunResult { plan, results: finished, estimates, .. } = engine(path, precision, steps);
    assert_eq!(difference(variable(results, "error_estimate"), &estimates), 0.0, "{}", path.display());
    for observable in &plan.observables {
        let mut expected = vec![f64::NAN; observable.width() * finished.len()];
        for (row, one) in expected.chunks_exact_mut(observable.width()).zip(finished.iter()) {
            observable.write(&one.measured, row);
        }
        let stored = variable(results, observable.name());
        assert_eq!(difference(stored, &expected), 0.0, "{}: {}", path.display(), observable.name());
    }
    let statuses: Vec<u8> = finished.iter().map(|one| one.status as u8).collect();
    assert_eq!(results.status, statuses, "{}", path.display());
    let steps: Vec<u32> = plan.cases().map(|case| case.steps).collect();
    assert_eq!(results.steps_per_period, steps, "{}", path.display());
}

fn number(results: &Results, name: &str) -> f64 {
    let found = results.attributes.iter().find(|(key, _)| key == name);
    match found {
        Some((_, Attribute::Number(number))) => *number,
        other => panic!("{name}: {other:?}"),
    }
}

/// Every scene of the examples runs; of the large ones, thinned copies.
#[test]
fn every_example_runs_and_holds_what_the_engine_computed() {
    let desk = Desk::new();
    for path in scenes() {
        let text = std::fs::read_to_string(&path).unwrap();
        let few = |text: String, many: &str| text.replace(&format!("samples = {many}\n"), "samples = 64\n");
        let thinned = text.replace("points = 32", "points = 3").replace("samples = 65536 ", "samples = 64 ");
        let thinned = ["16384", "8192", "2048"].into_iter().fold(thinned, few);
        let name = path.file_name().unwrap().to_str().unwrap();
        let copy = if thinned == text { path.clone() } else { desk.write(name, &thinned) };
        let results = desk.run(&copy, &[]);
        agrees(&results, &copy, Precision::F64, None);
        let scene = Scene::load(&copy).unwrap();
        assert_eq!(results.title, scene.title);
        assert_eq!(results.axes.len(), scene.sweep.axes.len());
        for (stored, axis) in results.axes.iter().zip(&scene.sweep.axes) {
            assert_eq!(
                (&stored.name, &stored.units, &stored.values),
                (&axis.name, &axis.units, &axis.values)
            );
        }
        let Some(request) = scene.output.waveforms else {
            assert!(results.waveforms.is_none() && results.force_curves.is_empty(), "{name}");
            continue;
        };
        let waveforms = results.waveforms.unwrap();
        assert_eq!(waveforms.instances.len(), request.instances.len());
        let samples = (request.samples_per_period * request.periods) as usize;
        assert!(waveforms.time.iter().chain(&waveforms.force).all(|row| row.len() == samples));
        assert!(!results.force_curves.is_empty(), "{name}");
    }
}

#[test]
fn a_run_says_what_it_does_on_standard_error_alone() {
    let desk = Desk::new();
    let path = desk.write("tap.toml", TAPPING);
    let path = path.to_str().unwrap();
    let plain = desk.works(&["run", path]);
    assert_eq!(plain.out, "");
    assert!(plain.err.contains("6 instances") && plain.err.contains("wrote results/tap.h5"), "{}", plain.err);
    assert!(desk.path("results/tap.h5").is_file());
    assert!(!desk.path("results/tap.h5.partial").exists());
    // The same scene again is replaced without a question.
    let verbose = desk.works(&["run", path, "-v"]);
    assert_eq!(verbose.out, "");
    for word in ["free amplitude 20.000000 nm", "steps/period", "% of the tip's flexibility"] {
        assert!(verbose.err.contains(word), "-v does not say {word:?}: {}", verbose.err);
        assert!(!plain.err.contains(word), "{word:?} without -v: {}", plain.err);
    }
    let quiet = desk.works(&["run", path, "-q", "-o", "deep/down/here.nc"]);
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""));
    assert!(desk.path("deep/down/here.nc").is_file(), "missing folders are made");
}

#[test]
fn results_hold_the_scene_and_how_it_was_run() {
    let desk = Desk::new();
    let path = desk.write("tap.toml", TAPPING);
    let results = desk.run(&path, &[]);
    agrees(&results, &path, Precision::F64, None);
    assert_eq!(results.shape(), [3, 2]);
    assert_eq!(results.text("scene"), Some(TAPPING));
    assert_eq!(results.text("version"), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(results.text("precision"), Some("f64"));
    assert!(results.text("device").unwrap().contains("thread"));
    let plan: serde_json::Value = serde_json::from_str(results.text("plan").unwrap()).unwrap();
    assert_eq!(plan["instances"], 6);
    let steps: f64 = results.steps_per_period.iter().map(|steps| 200.0 * f64::from(*steps)).sum();
    assert_eq!(number(&results, "instance_steps"), steps);
    assert!(number(&results, "instance_steps_per_second") > 0.0);
    assert!(number(&results, "wall_time_seconds") > 0.0);
    // The resolved scene is a scene, and gives the same results to the bit.
    let resolved = desk.write("resolved.toml", results.text("scene_resolved").unwrap());
    let again = desk.run(&resolved, &[]);
    assert_eq!(again.variables, results.variables);
    assert_eq!(again.waveforms, results.waveforms);
    let harmonics = results.variables.iter().find(|one| one.name == "harmonic_amplitude").unwrap();
    assert_eq!(harmonics.harmonics, Some(10));
    let fundamentals: Vec<f64> = harmonics.data.iter().step_by(10).copied().collect();
    assert_eq!(difference(&fundamentals, variable(&results, "amplitude")), 0.0);
    let law = results.flags.iter().find(|flags| flags.name == "contact_law").unwrap();
    assert!(law.data.iter().all(|code| law.meanings[usize::from(*code)] == "dmt"));
}

/// Truth: the file of the same run, and the table of keys in docs/commands.md.
#[test]
fn the_json_object_tells_what_became_of_the_run() {
    let desk = Desk::new();
    desk.write("tap.toml", TAPPING);
    let said = desk.works(&["run", "tap.toml", "--json", "--audit", "2"]);
    assert!(said.err.contains("wrote results/tap.h5"), "messages as ever: {}", said.err);
    let object: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let results = read(&desk.path("results/tap.h5")).unwrap();
    assert_eq!(object["version"], 1);
    assert_eq!(object["file"], "results/tap.h5");
    assert_eq!(object["shape"], serde_json::json!([3, 2]));
    let ok = results.status.iter().filter(|code| **code == 0).count();
    assert_eq!(object["status"]["ok"], ok);
    assert_eq!(object["audit"]["instances"], number(&results, "audited"));
    assert_eq!(object["audit"]["worst"]["error"], number(&results, "audit_worst"));
    let mut known = variable(&results, "error_estimate").to_vec();
    known.sort_by(f64::total_cmp);
    assert_eq!(object["estimate"]["largest"], known[known.len() - 1]);
    let page = include_str!("../../docs/commands.md");
    let told = |key: &String| page.contains(&format!("`{key}`"));
    fn keys(value: &serde_json::Value) -> Vec<String> {
        let members = value.as_object().into_iter().flatten();
        members.flat_map(|(key, value)| keys(value).into_iter().chain([key.clone()])).collect()
    }
    let untold: Vec<String> = keys(&object).into_iter().filter(|key| !told(key)).collect();
    let statuses: Vec<String> = keys(&object["status"]);
    assert_eq!(
        untold.iter().filter(|key| !statuses.contains(key)).collect::<Vec<_>>(),
        Vec::<&String>::new()
    );
    assert_eq!(desk.call(&["run", "nothing.toml", "--json"]).out, "");
}

/// Truth: the run itself, made again from nothing but what its file says of it.
#[test]
fn the_resolved_scene_with_the_options_of_the_command_line_gives_the_same_bits() {
    let desk = Desk::new();
    let path = desk.write("tap it.toml", TAPPING);
    let options = ["--precision", "f32", "--no-estimate", "--steps-per-period", "300"];
    let results = desk.run(&path, &options);
    let line = results.text("command_line").unwrap();
    let called = format!("afmsweep run '{}' -q --no-audit {}", path.display(), options.join(" "));
    assert_eq!(line, called);
    assert!(results.text("source_revision").is_some_and(|revision| !revision.is_empty()));
    let resolved = desk.write("again.toml", results.text("scene_resolved").unwrap());
    let (_, told) = line.split_once("--no-audit ").unwrap();
    let again = desk.run(&resolved, &told.split(' ').collect::<Vec<_>>());
    // As bits: what was not estimated is NaN.
    let bits = |results: &Results| -> Vec<u64> {
        results.variables.iter().flat_map(|one| one.data.iter().map(|value| value.to_bits())).collect()
    };
    assert_eq!(bits(&again), bits(&results));
    assert_eq!(again.text("precision"), Some("f32"));
    // Without the options the numbers are others.
    assert_ne!(bits(&desk.run(&resolved, &[])), bits(&results));
}

#[test]
fn the_engines_arguments_reach_the_engine() {
    let desk = Desk::new();
    let path = desk.write("tap.toml", TAPPING);
    let single = desk.run(&path, &["--precision", "f32"]);
    agrees(&single, &path, Precision::F32, None);
    assert_eq!(single.text("precision"), Some("f32"));
    let finer = desk.run(&path, &["--steps-per-period", "1000", "--backend", "cpu"]);
    agrees(&finer, &path, Precision::F64, Some(1000));
    assert!(finer.steps_per_period.iter().all(|steps| *steps == 1000));
    assert!(difference(variable(&single, "amplitude"), variable(&finer, "amplitude")) > 1e-9);
    let one = desk.run(&path, &["--threads", "1"]);
    let three = desk.run(&path, &["--threads", "3"]);
    assert_eq!(one.variables, three.variables, "threads change nothing, to the bit");
    assert_eq!(one.waveforms, three.waveforms);
    assert!(three.text("device").unwrap().contains("3 threads"), "{:?}", three.text("device"));
}

#[test]
fn lists_and_single_cases_have_their_shapes() {
    let desk = Desk::new();
    let list = desk.write(
        "list.toml",
        "[samples]\n\"sample.youngs_modulus\" = [\"1 GPa\", \"2 GPa\", \"1 GPa\"]\n\
         \"approach.gap\" = [\"1 nm\", \"0 m\", \"1 nm\"]\n[run]\nperiods = 5\nmeasure = 2\n",
    );
    let results = desk.run(&list, &[]);
    agrees(&results, &list, Precision::F64, None);
    assert!(results.list);
    assert_eq!(results.shape(), [3]);
    assert_eq!(*results.axes[0].values, [1e9, 2e9, 1e9]);
    assert_eq!(results.axes[1].name, "approach_gap");
    for one in &results.variables {
        let rows: Vec<&[f64]> = one.data.chunks(one.data.len() / 3).collect();
        assert_eq!(difference(rows[0], rows[2]), 0.0, "{}: the same case twice", one.name);
    }
    assert!(results.waveforms.is_none());

    let bare = desk.write("bare.toml", "[run]\nperiods = 3\nmeasure = 1\n");
    let results = desk.run(&bare, &[]);
    agrees(&results, &bare, Precision::F64, None);
    assert!(results.shape().is_empty() && !results.list);
    assert_eq!(results.status.len(), 1);
    assert_eq!(results.title, "bare");
}

/// Without a contact the answer is the free motion, and a file is made all the same.
#[test]
fn a_tip_that_never_touches_moves_freely() {
    let desk = Desk::new();
    let path = desk.write(
        "free.toml",
        "[instrument.cantilever]\nquality_factor = 50\n[contact]\nlaw = \"hertz\"\n\
         [drive]\nfrequency = \"resonance\"\nfree_amplitude = \"5 nm\"\n[approach]\ngap = \"6 nm\"\n\
         [output]\nobservables = [\"amplitude\", \"contacts\", \"indentation_max\", \"force_max\"]\n\
         waveforms = { instances = [0], samples_per_period = 64, periods = 1 }\n",
    );
    let results = desk.run(&path, &[]);
    assert!((variable(&results, "amplitude")[0] / 5e-9 - 1.0).abs() < 1e-12);
    assert_eq!(variable(&results, "contacts"), [0.0]);
    assert_eq!(variable(&results, "force_max"), [0.0]);
    assert!(variable(&results, "indentation_max")[0].is_nan());
    assert_eq!((results.status[0], results.steps_per_period[0]), (Status::Ok as u8, 0));
    let waveforms = results.waveforms.unwrap();
    let largest = waveforms.tip_travel[0].iter().fold(0.0, |most: f64, travel| most.max(travel.abs()));
    assert!((largest / 5e-9 - 1.0).abs() < 2e-3, "{largest}");
    assert!(waveforms.force[0].iter().all(|force| *force == 0.0));
}

/// Drives that differ give each waveform its own times, a period of its own drive long.
#[test]
fn swept_drives_have_their_own_times() {
    let desk = Desk::new();
    let path = desk.write(
        "drives.toml",
        "[sweep]\n\"drive.frequency\" = { values = [\"20 kHz\", \"40 kHz\"] }\n\
         [run]\nstart = \"rest\"\nperiods = 4\nmeasure = 2\n\
         [output]\nwaveforms = { instances = [0, 1], samples_per_period = 32, periods = 4 }\n",
    );
    desk.run(&path, &[]);
    let waveforms = read(&desk.results(&path)).unwrap().waveforms.unwrap();
    assert_eq!(waveforms.time.len(), 2);
    for (row, frequency) in waveforms.time.iter().zip([20e3, 40e3]) {
        for (sample, time) in row.iter().enumerate() {
            let expected = sample as f64 / 32.0 / frequency;
            assert!((time - expected).abs() < 1e-12 / frequency, "{time} {expected}");
        }
    }
}

#[test]
fn a_report_is_made_from_the_results_file() {
    let desk = Desk::new();
    let path = desk.write("tap.toml", TAPPING);
    desk.run(&path, &[]);
    let said = desk.works(&["report", "results/tap.h5"]);
    assert_eq!(said.out, "");
    assert!(said.err.contains("results/tap/index.html"), "{}", said.err);
    let page = std::fs::read_to_string(desk.path("results/tap/index.html")).unwrap();
    assert!(page.contains("Small tapping sweep") && page.contains(".svg"));
    let quiet = desk.works(&["report", "results/tap.h5", "-o", "elsewhere", "-q"]);
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""));
    assert!(desk.path("elsewhere/index.html").is_file());
    desk.refuses(&["report", "tap.toml"], &["is no results file of afmsweep"]);
    desk.refuses(&["report", "nowhere.h5"], &["nowhere.h5: no such file"]);
}

/// The reference engine by its name: the library's own answer to the bit, close to the CPU engine's.
#[test]
fn reference_backend() {
    let desk = Desk::new();
    let scene = desk.write(
        "small.toml",
        "[instrument.actuator]\nmodel = \"rigid\"\n[instrument.cantilever]\n\
         modes = [{ stiffness = \"5 N/m\", frequency = \"75 kHz\", quality_factor = 20 }]\n\
         [contact]\nlaw = \"hertz\"\n[drive]\non = \"tip\"\nfrequency = \"75 kHz\"\n\
         free_amplitude = \"20 nm\"\n[approach]\ngap = \"15 nm\"\n[run]\nperiods = 60\nmeasure = 4\n\
         [sweep]\n\"sample.youngs_modulus\" = { values = [\"50 MPa\", \"500 MPa\"] }\n\
         [output]\nobservables = [\"amplitude\", \"force_max\"]\n",
    );
    let results = desk.run(&scene, &["--backend", "reference", "--threads", "1"]);
    let device = results.attributes.iter().find(|(name, _)| name == "device").unwrap();
    assert!(matches!(&device.1, Attribute::Text(text) if text.starts_with("reference integrator, DOP853")));
    let plan = Plan::new(&Scene::load(&scene).unwrap(), Precision::F64).unwrap();
    let expected = Reference::default().run(&plan, &Progress::default()).unwrap().results;
    let stepped = engine(&scene, Precision::F64, None).results;
    for (i, (own, other)) in expected.iter().zip(stepped.iter()).enumerate() {
        assert_eq!(variable(&results, "amplitude")[i], own.measured.harmonics[0]);
        assert_eq!(variable(&results, "force_max")[i], own.measured.force_max);
        assert!((own.measured.harmonics[0] - other.measured.harmonics[0]).abs() < 1e-3 * 20e-9);
        assert_ne!(own.measured.harmonics[0], other.measured.harmonics[0]);
    }
}

/// The audit stands in the file and in the closing lines, and is left out where the user says so.
#[test]
fn errors_are_estimated_and_audited() {
    let desk = Desk::new();
    let scene = desk.write(
        "audited.toml",
        "[instrument.actuator]\nmodel = \"rigid\"\n[instrument.cantilever]\n\
         modes = [{ stiffness = \"5 N/m\", frequency = \"75 kHz\", quality_factor = 20 }]\n\
         [contact]\nlaw = \"hertz\"\n[drive]\non = \"tip\"\nfrequency = \"75 kHz\"\n\
         free_amplitude = \"20 nm\"\n[approach]\ngap = \"15 nm\"\n[run]\nperiods = 120\nmeasure = 4\n\
         [sweep]\n\"sample.youngs_modulus\" = { values = [\"50 MPa\", \"500 MPa\", \"5 GPa\"] }\n\
         [output]\nobservables = [\"amplitude\", \"force_max\"]\n",
    );
    let path = scene.to_str().unwrap();
    let said = desk.works(&["run", path, "--audit", "2"]);
    assert!(said.err.contains("estimated error: median"), "{}", said.err);
    assert!(
        said.err.contains("audit: 2 instances redone by the reference engine, largest error"),
        "{}",
        said.err
    );
    let results = read(&desk.results(&scene)).unwrap();
    let audit = results.audit.as_ref().unwrap();
    assert_eq!(audit.instances.len(), 2);
    let of = |name: &str| &audit.variables.iter().find(|variable| variable.name == name).unwrap().data;
    assert_eq!(audit.observables, ["amplitude", "force_max"]);
    for (row, instance) in audit.instances.iter().enumerate() {
        let (ours, truth) = (variable(&results, "amplitude")[*instance as usize], of("amplitude")[row]);
        let [error, of_force] = [audit.errors[2 * row], audit.errors[2 * row + 1]];
        assert!(((ours - truth).abs() / 20e-9 - error).abs() < 1e-12 && error < 1e-3, "{error}");
        let estimate = variable(&results, "error_estimate")[*instance as usize];
        assert!(of_force < 3.0 * estimate && estimate <= 1e-3);
    }
    let said = desk.works(&["run", path, "--no-audit"]);
    assert!(!said.err.contains("audit:") && said.err.contains("estimated error"), "{}", said.err);
    assert!(read(&desk.results(&scene)).unwrap().audit.is_none());
    let said = desk.works(&["run", path, "--no-audit", "--no-estimate"]);
    assert!(!said.err.contains("estimated error"), "{}", said.err);
    let results = read(&desk.results(&scene)).unwrap();
    assert!(variable(&results, "error_estimate").iter().all(|estimate| estimate.is_nan()));
    assert_eq!(desk.call(&["run", path, "--audit", "2", "--no-audit"]).code, Some(2));
}
