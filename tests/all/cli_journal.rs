//! The journal of a run: killed, damaged, gone on with. Truth: the run that nobody disturbs, to the bit.

use crate::program::{Desk, said};
use afmsweep::Results;
use afmsweep::store::{Journal, RecordKind, partial_path, read};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Searched, with second branches and waveforms, some of it free of the sample.
pub const TAPPING: &str = r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 450
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 4, scale = "log" }
"sample.surface_energy" = { from = "10 mJ/m^2", to = "100 mJ/m^2", points = 5 }
"approach.gap" = { from = "10 nm", to = "25 nm", points = 5 }
[run]
steady = "search"
branches = "both"
[output]
observables = ["amplitude", "phase", "force_max", "indentation_max", "harmonic_amplitude"]
waveforms = { instances = [0, 7], samples_per_period = 32, periods = 2 }
"#;

/// Waited for, with a mode for each instance to need, as a list.
pub const LIST: &str = r#"
[instrument.cantilever]
stiffness = "2 N/m"
frequency = "75 kHz"
quality_factor = 60
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "75 kHz"
free_amplitude = "20 nm"
[approach]
gap = "14 nm"
[samples]
"sample.youngs_modulus" = ["0.3 GPa", "0.5 GPa", "1 GPa", "2 GPa", "3 GPa", "5 GPa", "10 GPa", "50 GPa"]
"instrument.tip.radius" = ["5 nm", "6 nm", "7 nm", "9 nm", "12 nm", "15 nm", "20 nm", "10 nm"]
[output]
observables = ["amplitude", "force_max", "dissipation"]
"#;

/// Followed there and back.
pub const CURVES: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 400 }]
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 70 }
[curve]
quantity = "approach.gap"
from = "22 nm"
to = "15 nm"
points = 4
direction = "both"
"#;

/// Held at set-points.
pub const HELD: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 400 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[approach]
setpoint = 0.8
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 12 }
"#;

/// The scenes, each with portions of so many instances.
pub const KINDS: [(&str, &str, &str); 4] =
    [("tapping", TAPPING, "8"), ("list", LIST, "2"), ("curves", CURVES, "100"), ("held", HELD, "3")];

/// Everything in two files is alike but their texts, as printed: no number is like itself as well.
pub fn assert_alike(a: &Path, b: &Path, what: &str) {
    let numbers = |path: &Path| {
        let results = read(path).unwrap();
        Results { attributes: Vec::new(), provenance: Vec::new(), ..results }
    };
    let (a, b) = (numbers(a), numbers(b));
    for (one, other) in a.variables.iter().zip(&b.variables) {
        assert_eq!(format!("{one:?}"), format!("{other:?}"), "{what}");
    }
    assert_eq!(format!("{a:?}"), format!("{b:?}"), "{what}");
}

/// Starts the program and kills it after so long; false if it had ended before.
fn killed(desk: &Desk, arguments: &[&str], after: Duration) -> bool {
    let mut command = desk.command(arguments);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(after);
    let ended = child.try_wait().unwrap().is_some();
    child.kill().unwrap();
    child.wait().unwrap();
    !ended
}

#[test]
fn a_run_killed_at_any_moment_goes_on_to_the_same_file() {
    let desk = Desk::new();
    let mut kills = 0;
    for (name, text, portion) in KINDS {
        let scene = format!("{name}.toml");
        desk.write(&scene, text);
        let arguments = ["run", &scene, "-q", "--audit", "2", "--portion", portion];
        let start = Instant::now();
        desk.works(&[&arguments[..], &["-o", "whole.h5", "--overwrite"]].concat());
        let lasts = start.elapsed();
        let resume = [&arguments[..], &["-o", "a.h5", "--resume"]].concat();
        for n in 0..4 {
            kills += usize::from(killed(&desk, &resume, lasts.mul_f64(0.15 + 0.2 * f64::from(n))));
        }
        desk.works(&resume);
        assert_alike(&desk.path("whole.h5"), &desk.path("a.h5"), name);
        assert!(!partial_path(&desk.path("a.h5")).exists());
        std::fs::remove_file(desk.path("a.h5")).unwrap();
    }
    assert!(kills > 4, "{kills}");
}

/// A journal of portions that have ended, of this text as `tapping.toml`, at `a.h5.partial`; its bytes.
fn stopped(desk: &Desk, text: &str) -> Vec<u8> {
    desk.write("tapping.toml", text);
    let arguments = ["run", "tapping.toml", "-q", "-o", "a.h5", "--audit", "2", "--portion", "8"];
    for wait in (10..).step_by(10).map(Duration::from_millis) {
        killed(desk, &arguments, wait);
        if let Ok(bytes) = std::fs::read(desk.path("a.h5.partial")) {
            let journal = Journal::read(bytes.clone());
            if journal.is_ok_and(|journal| journal.records().count() >= 4) {
                return bytes;
            }
        }
        for name in ["a.h5", "a.h5.partial"] {
            let _ = std::fs::remove_file(desk.path(name));
        }
    }
    unreachable!("it ends some time")
}

#[test]
fn a_journal_is_gone_on_with_only_by_its_own_run() {
    let desk = Desk::new();
    let bytes = stopped(&desk, TAPPING);
    let run = ["run", "tapping.toml", "-q", "-o", "a.h5"];
    let with = |more: &[&'static str]| [&run[..], more].concat();
    desk.refuses(&run, &["a.h5.partial holds", "portions of a run of this scene", "--resume", "--overwrite"]);
    desk.refuses(
        &with(&["--resume", "--no-estimate"]),
        &["other options", "no estimates", "errors controlled"],
    );
    desk.refuses(&with(&["--resume", "--steps-per-period", "128"]), &["other options", "128"]);
    desk.refuses(&with(&["--resume", "--precision", "f32"]), &["other options", "precision f32"]);
    desk.refuses(&with(&["--resume", "--shard", "1/2"]), &["share 1/1", "1/2"]);
    desk.write("other.toml", &TAPPING.replace("26 N/m", "27 N/m"));
    desk.refuses(&["run", "other.toml", "-o", "a.h5", "--resume"], &["holds a run of another scene"]);
    desk.refuses(&["report", "a.h5.partial"], &["journal of a run that is not whole", "export", "--resume"]);
    assert_eq!(std::fs::read(desk.path("a.h5.partial")).unwrap(), bytes, "it is as it was");

    // Of another format.
    std::fs::write(desk.path("a.h5.partial"), [&b"afmjournal 1\n"[..], &bytes[13..]].concat()).unwrap();
    desk.refuses(&with(&["--resume"]), &["a.h5.partial", "another version of the program"]);
    desk.refuses(&["export", "a.h5.partial", "-o", "b.h5"], &["another version of the program"]);
    std::fs::write(desk.path("a.h5.partial"), &bytes).unwrap();

    // Of another kind of engine: the header says so.
    let other = altered(&bytes, "round once", "round 1.5 times");
    if other != bytes {
        std::fs::write(desk.path("a.h5.partial"), &other).unwrap();
        desk.refuses(&with(&["--resume"]), &["another kind of engine", "1.5 times", "--resume=anyway"]);
        desk.works(&with(&["--resume=anyway"]));
        let said = desk.works(&["run", "tapping.toml", "-o", "a.h5", "--resume"]);
        assert!(said.err.contains("a.h5 is whole"), "{}", said.err);
    }
}

/// A scene names the file of its forces: what is in the file belongs to the run.
#[test]
fn a_journal_is_gone_on_with_only_by_the_forces_it_began_with() {
    const FORCES: &str = "distance [nm], force [nN], force_retract [nN]\n5, 0, 0\n3, -0.05, -0.2\n1, -0.4, -0.9\n\
                          0.3, -0.9, -1\n0, -1, -1\n-2, -1, -1\n";
    let desk = Desk::new();
    desk.write("forces.csv", FORCES);
    let text = TAPPING.replace("law = \"dmt\"", "law = \"hertz\"\ntable = \"forces.csv\"");
    let bytes = stopped(&desk, &text);
    let resume = ["run", "tapping.toml", "-q", "-o", "a.h5", "--audit", "2", "--portion", "8", "--resume"];
    for (old, new) in [("-0.4,", "-0.5,"), ("-0.2\n", "-0.3\n"), ("0.3,", "0.4,")] {
        desk.write("forces.csv", &FORCES.replacen(old, new, 1));
        desk.refuses(&resume, &["a file that the scene names, of forces", "put the old file back"]);
    }
    assert_eq!(std::fs::read(desk.path("a.h5.partial")).unwrap(), bytes, "it is as it was");
    desk.write("forces.csv", FORCES);
    desk.works(&resume);
    let whole = ["run", "tapping.toml", "-q", "-o", "whole.h5", "--audit", "2", "--portion", "8"];
    desk.works(&whole);
    assert_alike(&desk.path("whole.h5"), &desk.path("a.h5"), "forces by numbers");
}

/// The journal with another header.
fn altered(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let journal = Journal::read(bytes.to_vec()).unwrap();
    let (before, header) = (journal.header(), journal.header().replace(from, to));
    let (start, rest) = (13, 13 + before.len() + 13);
    [&bytes[..start], &recorded(RecordKind::Header, header.as_bytes()), &bytes[rest..]].concat()
}

/// A record of a journal, with its sums.
fn recorded(kind: RecordKind, own: &[u8]) -> Vec<u8> {
    let mut record = (own.len() as u32).to_le_bytes().to_vec();
    record.push(kind as u8);
    let sum = crc32fast::hash(&[&record, own].concat());
    record.extend(crc32fast::hash(&record).to_le_bytes());
    record.extend(own);
    record.extend(sum.to_le_bytes());
    record
}

/// A record with right sums that tells of four thousand million instances takes no memory: its portion is run again.
#[cfg(unix)]
#[test]
fn a_portion_of_more_instances_than_there_are_is_run_again() {
    let desk = Desk::new();
    let bytes = stopped(&desk, TAPPING);
    desk.works(&["run", "tapping.toml", "-q", "-o", "whole.h5", "--audit", "2"]);
    let (number, flags, notes) = (0u64.to_le_bytes(), [1, 1, 0, 0], 0u32.to_le_bytes());
    let column = [&[0u8][..], &1u64.to_le_bytes()].concat().repeat(1000);
    let own = [&number[..], &flags, &u32::MAX.to_le_bytes(), &notes, &column].concat();
    std::fs::write(desk.path("a.h5.partial"), [bytes, recorded(RecordKind::Portion, &own)].concat()).unwrap();
    let resume = ["run", "tapping.toml", "-q", "-o", "a.h5", "--audit", "2", "--resume"];
    let limited = "ulimit -v 8000000; exec \"$0\" \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", limited, env!("CARGO_BIN_EXE_afmsweep")]).args(resume).current_dir(desk.path(""));
    let said = said(command.output().unwrap());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_alike(&desk.path("whole.h5"), &desk.path("a.h5"), "after a portion of too many");
}

#[test]
fn two_runs_on_one_journal_are_refused() {
    let desk = Desk::new();
    let text = TAPPING.replace("points = 5", "points = 60");
    desk.write("long.toml", &text);
    let arguments = ["run", "long.toml", "-o", "a.h5", "-q", "--portion", "16", "--resume"];
    let child = desk.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !desk.path("a.h5.partial").exists() && start.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(5));
    }
    desk.refuses(&arguments, &["another run is writing", "a.h5"]);
    let id = child.id().to_string();
    std::process::Command::new("kill").args(["-9", &id]).status().unwrap();
    child.wait_with_output().unwrap();
}

/// Bits that turn over, and ends that are cut off: what is spoilt is said and run again, or the journal is refused; the file
/// is that of the undisturbed run.
#[test]
fn a_damaged_journal_gives_the_same_file_or_is_refused() {
    let desk = Desk::new();
    let bytes = stopped(&desk, TAPPING);
    desk.works(&["run", "tapping.toml", "-q", "-o", "whole.h5", "--audit", "2"]);
    let resume = ["run", "tapping.toml", "-o", "a.h5", "--audit", "2", "--resume"];
    let mut refused = 0;
    for n in 0..12usize {
        let mut damaged = bytes.clone();
        let at = (n * 7919 + 13) * 104_729 % bytes.len();
        match n % 4 {
            3 => damaged.truncate(at.max(20)),
            _ => damaged[at] ^= 1 << (n % 8),
        }
        std::fs::write(desk.path("a.h5.partial"), &damaged).unwrap();
        let _ = std::fs::remove_file(desk.path("a.h5"));
        let said = said(desk.command(&resume).output().unwrap());
        if said.code == Some(0) {
            let told = said.err.contains("left out");
            let cut = Journal::read(damaged).is_ok_and(|one| one.torn() == 0 && one.spoilt == 0);
            assert!(told || cut, "{n}: {}", said.err);
            assert_alike(&desk.path("whole.h5"), &desk.path("a.h5"), &format!("damage {n} at {at}"));
        } else {
            refused += 1;
            assert!(said.err.contains("a.h5.partial"), "{}", said.err);
            assert!(!desk.path("a.h5").exists());
        }
    }
    assert!(refused < 12);
}
