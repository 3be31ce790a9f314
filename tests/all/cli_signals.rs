//! Signals at any moment of a run. Truth: the run that no signal reaches, and the exit codes of shells.
#![cfg(unix)]

use crate::program::{Desk, Said, said, variable};
use afmsweep::observe::Status;
use afmsweep::store::{Attribute, NO_STATE, Results, partial_path, read};
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const SIGNALS: [(&str, i32, &str); 3] =
    [("-INT", 130, "interrupted"), ("-TERM", 143, "terminated"), ("-HUP", 129, "hung up")];

/// Searched, with second branches, waveforms and an audit: every phase that a run can have.
const BISTABLE: &str = r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 450
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 5, scale = "log" }
"sample.surface_energy" = { from = "10 mJ/m^2", to = "100 mJ/m^2", points = 7 }
"approach.gap" = { from = "10 nm", to = "18 nm", points = 5 }
[run]
steady = "search"
branches = "both"
[output]
observables = ["amplitude", "force_max"]
waveforms = { instances = [0], samples_per_period = 64, periods = 2 }
"#;

/// Starts the program and sends it a signal after so long; it may have ended before.
fn struck(desk: &Desk, arguments: &[&str], signal: &str, after: Duration) -> Said {
    let mut command = desk.command(arguments);
    // SAFETY: `signal` may be called between fork and exec. Where the tests are started by `nohup`, the program would
    // ignore hang-ups as well.
    unsafe {
        command.pre_exec(|| {
            libc::signal(libc::SIGHUP, libc::SIG_DFL);
            Ok(())
        });
    }
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(after);
    Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    said(child.wait_with_output().unwrap())
}

fn number(results: &Results, name: &str) -> Option<f64> {
    results.attributes.iter().find_map(|(key, value)| match value {
        Attribute::Number(number) if key == name => Some(*number),
        _ => None,
    })
}

/// Everything in a file but its texts.
fn numbers_of(results: &Results) -> Results {
    Results { attributes: Vec::new(), provenance: Vec::new(), ..results.clone() }
}

/// As printed, where no number is like itself as well.
fn alike(a: &impl std::fmt::Debug, b: &impl std::fmt::Debug) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

/// What the journal of `a.h5` or the like knows.
fn looked_into(desk: &Desk, name: &str) -> Results {
    let partial = format!("{name}.partial");
    desk.works(&["export", &partial, "-o", "soon.h5", "--overwrite"]);
    read(&desk.path("soon.h5")).unwrap()
}

/// Second states and audited instances that a run has found before it was stopped are those of the whole run.
fn assert_found_of(kept: &Results, whole: &Results) {
    if let (Some(ours), Some(theirs)) = (&kept.other_branch, &whole.other_branch) {
        let open = [Status::NotRun as u8, NO_STATE];
        for i in (0..ours.status.len()).filter(|i| !open.contains(&ours.status[*i])) {
            assert_eq!(ours.status[i], theirs.status[i], "second state of instance {i}");
            for (one, other) in ours.variables.iter().zip(&theirs.variables) {
                let width = one.harmonics.unwrap_or(1);
                let of = |data: &[f64]| format!("{:?}", &data[i * width..][..width]);
                assert_eq!(of(&one.data), of(&other.data), "{} of instance {i}", one.name);
            }
        }
    }
    if let (Some(ours), Some(theirs)) = (&kept.audit, &whole.audit) {
        let width = ours.observables.len();
        for (n, instance) in ours.instances.iter().enumerate() {
            let there =
                theirs.instances.iter().position(|one| one == instance).expect("the whole run has it");
            let of = |errors: &[f64], n: usize| format!("{:?}", &errors[n * width..][..width]);
            assert_eq!(of(&ours.errors, n), of(&theirs.errors, there), "audit of instance {instance}");
        }
    }
}

#[test]
fn a_signal_at_any_moment_leaves_what_is_true() {
    let desk = Desk::new();
    desk.write("scene.toml", BISTABLE);
    let path = desk.path("a.h5");
    let arguments = ["run", "scene.toml", "-o", "a.h5", "--audit", "3"];
    let start = Instant::now();
    desk.works(&arguments);
    let lasts = start.elapsed();
    let (whole, bytes) = (read(&path).unwrap(), std::fs::read(&path).unwrap());
    assert_eq!(number(&whole, "complete"), Some(1.0));
    assert!(whole.other_branch.is_some() && whole.audit.is_some() && whole.waveforms.is_some());
    let (mut cut, mut ended) = (0, 0);
    for (n, (signal, code, word)) in SIGNALS.iter().cycle().take(9).enumerate() {
        std::fs::write(&path, &bytes).unwrap();
        let said = struck(&desk, &arguments, signal, lasts.mul_f64((n as f64 + 0.5) / 9.0));
        // No handler stands in the first moment of a program, and what came before it left nothing.
        if said.code.is_none() {
            continue;
        }
        if said.code == Some(0) {
            assert!(!partial_path(&path).exists());
            let again = read(&path).unwrap();
            assert_eq!(number(&again, "complete"), Some(1.0));
            assert!(alike(&again.variables, &whole.variables), "the observables differ");
            assert!(alike(&again.other_branch, &whole.other_branch), "the second branches differ");
            ended += 1;
            continue;
        }
        cut += 1;
        assert_eq!(said.code, Some(*code), "{signal}: {}", said.err);
        assert!(said.err.contains(&format!("error: {word} in the ")), "{}", said.err);
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "the earlier file is as it was");
        if !partial_path(&path).exists() {
            assert!(said.err.contains("before any instance was done; nothing was written"), "{}", said.err);
            continue;
        }
        let kept = looked_into(&desk, "a.h5");
        assert_eq!(number(&kept, "complete"), Some(0.0));
        let missing: Vec<&str> = kept.text("missing").unwrap().split(' ').collect();
        assert_eq!(kept.text("incomplete_phase"), Some(missing[0]), "{}", said.err);
        // Second states, audit and waveforms are made at the end of a run, from the states that the journal holds.
        assert!(missing.ends_with(&["branches", "audit", "waveforms"]), "{missing:?}");
        assert!(kept.waveforms.is_none());
        assert_found_of(&kept, &whole);
        let done = kept.status.iter().filter(|code| **code != Status::NotRun as u8).count();
        assert_eq!(done == kept.status.len(), missing[0] != "stepping" && missing[0] != "refinement");
        for (i, status) in kept.status.iter().enumerate().filter(|(_, one)| **one != Status::NotRun as u8) {
            assert_eq!(*status, whole.status[i], "instance {i}, {missing:?}");
            for name in ["amplitude", "force_max", "error_estimate"] {
                let (ours, theirs) = (variable(&kept, name)[i], variable(&whole, name)[i]);
                assert_eq!(ours.to_bits(), theirs.to_bits(), "{name} of instance {i}, {missing:?}");
            }
        }
        let resume = [&arguments[..], &["--resume"]].concat();
        desk.works(&resume);
        assert!(!partial_path(&path).exists());
        let again = read(&path).unwrap();
        assert!(alike(&numbers_of(&again), &numbers_of(&whole)), "what was gone on with differs");
    }
    assert!(cut > 0, "all nine runs had ended before their signals ({ended})");
}

/// A run that would last for minutes (a million steps of ten thousand lanes) ends soon, and its exit code says by what.
#[test]
fn every_signal_keeps_what_is_complete_of_a_long_run() {
    let desk = Desk::new();
    let text = "[sweep]\n\"approach.gap\" = { from = \"1 nm\", to = \"9 nm\", points = 40000 }\n\
                [contact]\nlaw = \"hertz\"\n[drive]\nfrequency = \"192 kHz\"\nvoltage = \"15 V\"\n\
                [instrument.cantilever]\nquality_factor = 1e5\n[run]\nperiods = 2000\nsteps_per_period = 512\n";
    desk.write("long.toml", text);
    for (signal, code, word) in SIGNALS {
        let arguments = ["run", "long.toml", "-o", "long.h5"];
        // On a loaded machine the first instances take longer.
        let mut strikes = [2, 4, 8, 16]
            .map(Duration::from_secs)
            .into_iter()
            .map(|after| struck(&desk, &arguments, signal, after));
        let said = strikes.find(|said| !said.err.contains("before any instance was done")).unwrap();
        assert_eq!(said.code, Some(code), "{}", said.err);
        assert!(said.err.contains(&format!("{word} in the stepping: ")), "{}", said.err);
        assert!(
            said.err.contains("of 40000 instances") && said.err.contains("long.h5.partial"),
            "{}",
            said.err
        );
        assert!(!desk.path("long.h5").exists());
        let kept = looked_into(&desk, "long.h5");
        std::fs::remove_file(desk.path("long.h5.partial")).unwrap();
        assert_eq!(kept.status.len(), 40_000);
        assert!(kept.status.contains(&(Status::NotRun as u8)));
        assert_eq!((number(&kept, "complete"), kept.text("incomplete_phase")), (Some(0.0), Some("stepping")));
    }
}

/// `nohup` starts a program with hang-ups ignored, and it goes on ignoring them.
#[test]
fn a_hang_up_that_is_ignored_stays_so() {
    let desk = Desk::new();
    desk.write("scene.toml", BISTABLE);
    let script = "trap '' HUP; exec \"$0\" run scene.toml -q -o a.h5 --audit 1";
    let mut command = Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_afmsweep")]).current_dir(desk.path("."));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap();
    let said = said(child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(number(&read(&desk.path("a.h5")).unwrap(), "complete"), Some(1.0));
}
