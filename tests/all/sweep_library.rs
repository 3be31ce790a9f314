//! Whole runs by the library, against the file that they leave and against the program.

use crate::program::Desk;
use afmsweep::engine::{Engine, ProgressPhase as Stage};
use afmsweep::plan::Plan;
use afmsweep::store::read;
use afmsweep::sweep::SweepPhase;
use afmsweep::{Audit, Backend, Error, Observer, Scene, Status, Sweep, SweepOutcome};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

const SCENE: &str = r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[instrument.actuator]
model = "rigid"
[sample]
surface_energy = "20 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { values = ["1 GPa", "2 GPa"] }
"approach.gap" = { values = ["12 nm", "15 nm", "30 nm"] }
[run]
periods = 200
measure = 4
[output]
observables = ["amplitude", "harmonic_amplitude"]
waveforms = { instances = [1], samples_per_period = 32, periods = 1 }
"#;

fn scene() -> Scene {
    Scene::parse(Path::new("scene.toml"), SCENE).unwrap()
}

fn sweep() -> Sweep {
    Sweep::new(scene()).backend(Backend::Cpu).audit(Audit::None)
}

fn numbers(swept: &SweepOutcome) -> Vec<u64> {
    let variables = swept.results.variables.iter();
    variables.flat_map(|one| one.data.iter().map(|number| number.to_bits())).collect()
}

#[test]
fn observables_have_their_axes_and_are_what_the_programs_file_holds() {
    let desk = Desk::new();
    desk.write("scene.toml", SCENE);
    desk.works(&["run", "scene.toml", "-o", "out.h5", "--no-audit", "--backend", "cpu"]);
    let file = read(&desk.path("out.h5")).unwrap();
    let swept = sweep().run().unwrap();
    let amplitude = swept.results.observable("amplitude").unwrap();
    assert_eq!((amplitude.shape.as_slice(), amplitude.units), ([2, 3].as_slice(), "m"));
    let axes: Vec<&str> = amplitude.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(axes, ["sample_youngs_modulus", "approach_gap"]);
    assert_eq!(*amplitude.axes[1].values, [12e-9, 15e-9, 30e-9]);
    assert!(amplitude.values[0] < amplitude.values[1] && amplitude.values[1] < amplitude.values[2]);
    assert_eq!(swept.results.observable("harmonic_amplitude").unwrap().shape, [2, 3, 10]);
    assert!(swept.results.observable("virial").is_none());
    for one in &swept.results.variables {
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        let theirs = file.observable(&one.name).unwrap();
        assert!(same(theirs.values, &one.data) && theirs.values.len() == one.data.len(), "{}", one.name);
    }
    assert_eq!(file.waveforms, swept.results.waveforms);
    assert!(swept.missing.is_empty() && swept.verdict.met());
}

#[test]
fn results_that_are_written_are_read_back_alike() {
    let desk = Desk::new();
    let swept = sweep().run().unwrap();
    let path = desk.path("of_the_library.h5");
    swept.results.write(&path, false).unwrap();
    let back = read(&path).unwrap();
    assert_eq!(back.status, swept.results.status);
    assert_eq!(back.variables, swept.results.variables);
    // Of the same scene it is replaced; another one's file is left alone.
    swept.results.write(&path, false).unwrap();
    let mut other = swept.results.clone();
    other.provenance.retain(|(name, _)| name != "scene");
    let refused = other.write(&path, false).unwrap_err().to_string();
    assert!(refused.contains("of_the_library.h5"), "{refused}");
    other.write(&path, true).unwrap();
}

/// Threads that are told hold for planning, stepping and what comes after, under every engine.
#[test]
fn threads_are_those_of_the_whole_run() {
    struct Threads(AtomicUsize);
    impl Observer for Threads {
        fn planned(&self, _: &Plan, engine: &dyn Engine) {
            let here = rayon::current_num_threads();
            let said = if here == 1 { "1 thread".to_owned() } else { format!("{here} threads") };
            assert!(engine.device().contains(&said), "{}", engine.device());
            self.0.store(here, Ordering::Relaxed);
        }
    }
    let mut all = Vec::new();
    let mut short = scene();
    short.run.periods = 12;
    for backend in [Backend::Cpu, Backend::Reference] {
        for threads in [1, 3] {
            let seen = Threads(AtomicUsize::new(0));
            let sweep = Sweep::new(short.clone()).audit(Audit::None).backend(backend).threads(Some(threads));
            all.push(numbers(&sweep.run_with(&seen).unwrap()));
            assert_eq!(seen.0.into_inner(), threads);
        }
    }
    assert!(all[0] == all[1] && all[2] == all[3], "the number of threads changes results");
}

/// An observer that wants no more: before anything is done there is an error, later there is what was done.
#[test]
fn an_observer_can_stop_a_run() {
    struct Stop;
    impl Observer for Stop {
        fn progress(&self, _: &Stage) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    // A lever that rings for long settles in none of the periods that are done before somebody looks.
    let text = SCENE.replace("quality_factor = 30", "quality_factor = 1e5");
    let mut long = Scene::parse(Path::new("long.toml"), &text).unwrap();
    long.run.periods = 50_000_000;
    long.output.waveforms = None;
    let swept = Sweep::new(long.clone()).backend(Backend::Cpu).estimate(false).run_with(&Stop);
    let phase = match swept {
        Err(Error::Stopped(phase)) => phase,
        Ok(swept) => {
            // The instances that never meet the sample are done at once.
            assert!(swept.run.results.iter().any(|one| one.status == Status::NotRun));
            assert_eq!(swept.results.text("incomplete_phase"), Some("stepping"));
            swept.missing[0]
        }
        Err(other) => panic!("{other}"),
    };
    assert_eq!(phase, SweepPhase::Stepping);

    let stopped = Sweep::new(long).backend(Backend::Cpu);
    stopped.progress().stop();
    assert!(matches!(stopped.run(), Err(Error::Stopped(SweepPhase::Planning))));
}
