//! What a run asks once its portions have ended (second states, audit, waveforms) is in its journal. Truth: the run that
//! nobody disturbs, to the bit.

use crate::cli_journal::{KINDS, LIST, TAPPING, assert_alike};
use crate::program::Desk;
use afmsweep::store::{ExistingFile, Journal, RecordKind, RunFile};
use afmsweep::sweep::{RunJournal, Share, Silent, SweepOutcome};
use afmsweep::{Audit, Backend, Scene, Sweep};
use std::path::Path;

fn sweep(text: &str, audit: Audit) -> Sweep {
    let scene = Scene::parse(Path::new("scene.toml"), text).unwrap();
    Sweep::new(scene).backend(Backend::Cpu).portion(Some(8)).audit(audit)
}

/// Runs a scene into `path`, which it puts in place only to `finish`; what is known of its journal is gone on with.
fn run(text: &str, audit: Audit, path: &Path, finish: bool) -> SweepOutcome {
    let sweep = sweep(text, audit);
    let (file, earlier) = RunFile::create(path, &sweep.scene().source, ExistingFile::GoneOnWith).unwrap();
    let keeper = RunJournal::of_run(file, earlier, Share::ALL, false).unwrap();
    let swept = sweep.run_into(&keeper, &Silent).unwrap().gathered().unwrap();
    assert!(swept.missing.is_empty());
    if finish {
        keeper.into_file().unwrap().finish(&swept.results).unwrap();
    }
    swept
}

fn kinds(journal: &Path) -> Vec<RecordKind> {
    let journal = Journal::read(std::fs::read(journal).unwrap()).unwrap();
    journal.records().map(|(kind, _)| kind).collect()
}

/// Bytes of a journal up to the end of each of its records.
fn ends(bytes: &[u8]) -> Vec<usize> {
    let sound = |end: &usize| Journal::read(bytes[..*end].to_vec()).is_ok_and(|one| one.torn() == 0);
    (1..=bytes.len()).filter(sound).collect()
}

/// A run that was killed before its file was put in place steps nothing again, and its audit redoes nothing.
#[test]
fn what_is_finished_is_not_done_again() {
    for (name, text, _) in KINDS {
        let desk = Desk::new();
        let (path, partial) = (desk.path("a.h5"), desk.path("a.h5.partial"));
        let whole = run(text, Audit::Instances(3), &path, false);
        let known = std::fs::read(&partial).unwrap();
        let of = |kind| kinds(&partial).into_iter().filter(|one| *one == kind).count();
        assert_eq!(of(RecordKind::Numbers), if text == TAPPING { 2 } else { 0 }, "{name}");
        assert!(of(RecordKind::Answers) >= 3, "{name}: {}", of(RecordKind::Answers));
        let again = run(text, Audit::Instances(3), &path, false);
        assert!(whole.steps_taken > 0);
        assert_eq!((again.steps_taken, again.verdict.audited), (0, 3), "{name}");
        assert_eq!(std::fs::read(&partial).unwrap().len(), known.len(), "{name}: nothing new is asked");
    }
}

/// Wherever in the work after the portions a run is killed.
#[test]
fn a_run_goes_on_from_any_record_to_the_same_file() {
    for text in [TAPPING, LIST] {
        let desk = Desk::new();
        let (path, partial) = (desk.path("a.h5"), desk.path("a.h5.partial"));
        run(text, Audit::Instances(4), &path, false);
        let whole = desk.path("whole.h5");
        run(text, Audit::Instances(4), &whole, true);
        let bytes = std::fs::read(&partial).unwrap();
        let all = kinds(&partial);
        let first = all.iter().position(|kind| *kind != RecordKind::Portion).unwrap();
        let ends = ends(&bytes);
        // One more than records: that of the header.
        assert_eq!(ends.len(), all.len() + 1);
        let mut steps = Vec::new();
        for end in ends[first..].iter().rev() {
            std::fs::write(&partial, &bytes[..*end]).unwrap();
            steps.push(run(text, Audit::Instances(4), &path, true).steps_taken);
            assert_alike(&whole, &path, &format!("cut after {end} bytes"));
            std::fs::remove_file(&path).unwrap();
        }
        assert_eq!(steps[0], 0);
        assert!(steps.is_sorted(), "{steps:?}");
    }
}

/// A torn record and a spoilt one are left out, and what they told is found again.
#[test]
fn spoilt_answers_are_found_again() {
    let desk = Desk::new();
    let (path, partial, whole) = (desk.path("a.h5"), desk.path("a.h5.partial"), desk.path("whole.h5"));
    run(TAPPING, Audit::Instances(4), &path, false);
    run(TAPPING, Audit::Instances(4), &whole, true);
    let bytes = std::fs::read(&partial).unwrap();
    let first = kinds(&partial).iter().position(|kind| *kind != RecordKind::Portion).unwrap();
    let from = ends(&bytes)[first];
    desk.write("scene.toml", TAPPING);
    for n in 0..8usize {
        let mut damaged = bytes.clone();
        let at = from + (n * 7919 + 5) * 104_729 % (bytes.len() - from);
        match n % 4 {
            3 => damaged.truncate(at),
            _ => damaged[at] ^= 1 << n,
        }
        std::fs::write(&partial, &damaged).unwrap();
        let arguments =
            ["run", "scene.toml", "-o", "a.h5", "--backend", "cpu", "--portion", "8", "--audit", "4"];
        let said = desk.works(&[&arguments[..], &["--resume"]].concat());
        assert!(said.err.contains("left out"), "{n}: {}", said.err);
        assert_alike(&whole, &path, &format!("damage {n} at {at}"));
        std::fs::remove_file(&path).unwrap();
    }
}

/// The default audit is ended by time: what it has redone and spent counts, so it does not begin anew.
#[test]
fn an_audit_ended_by_time_is_over_when_its_time_is() {
    let desk = Desk::new();
    let path = desk.path("a.h5");
    let whole = run(LIST, Audit::Auto, &path, false);
    assert!(whole.verdict.audited > 0);
    let again = run(LIST, Audit::Auto, &path, true);
    let table = |swept: &SweepOutcome| format!("{:?}", swept.results.audit);
    assert_eq!(table(&whole), table(&again));
}

/// Looking in shows second states and audited instances that are known, and says what is missing.
#[test]
fn a_look_into_the_journal_shows_what_is_found() {
    let desk = Desk::new();
    let (path, partial) = (desk.path("a.h5"), desk.path("a.h5.partial"));
    let whole = run(TAPPING, Audit::Instances(4), &path, false);
    let bytes = std::fs::read(&partial).unwrap();
    let looked = |end: usize| {
        let journal = Journal::read(bytes[..end].to_vec()).unwrap();
        let keeper = RunJournal::of_journals(vec![journal], Share::ALL).unwrap();
        sweep(TAPPING, Audit::Auto).look_into(&keeper).unwrap().gathered().unwrap()
    };
    let all = looked(bytes.len());
    let words: Vec<&str> = all.missing.iter().map(|phase| phase.word()).collect();
    assert_eq!(words, ["branches", "audit", "waveforms"]);
    let (ours, theirs) = (&all.results, &whole.results);
    assert_eq!(format!("{:?}", ours.other_branch), format!("{:?}", theirs.other_branch));
    assert_eq!(format!("{:?}", ours.audit), format!("{:?}", theirs.audit));
    // Of states whose errors were not looked at yet nothing is said to be known.
    let first = kinds(&partial).iter().position(|kind| *kind != RecordKind::Portion).unwrap();
    let some = looked(ends(&bytes)[first]);
    assert!(some.results.audit.is_none());
    let known = some.others.unwrap().orbits;
    assert!(!known.is_empty());
    assert!(known.iter().all(|one| one.finished.status == afmsweep::Status::NotRun), "{known:?}");
}

/// Wherever a merge is cut short in what it asks of all shares together, the next one goes on: nothing that is known is done
/// again, and the file is that of one run. Truth: the run that was not divided.
#[test]
fn a_merge_goes_on_from_any_record_to_the_same_file() {
    let desk = Desk::new();
    desk.write("scene.toml", TAPPING);
    let audit = ["--audit", "4", "--backend", "cpu"];
    desk.works(&[&["run", "scene.toml", "-q", "-o", "whole.h5"], &audit[..]].concat());
    for share in ["1/2", "2/2"] {
        desk.works(&["run", "scene.toml", "-q", "--backend", "cpu", "--shard", share]);
    }
    let files = ["results/scene.1-of-2.h5", "results/scene.2-of-2.h5"];
    let (path, partial) = (desk.path("merged.h5"), desk.path("merged.h5.partial"));
    // As the program merges, but for the file at its end.
    let merge = || {
        let journals: Vec<Journal> =
            files.iter().map(|file| afmsweep::store::open_journal(&desk.path(file)).unwrap()).collect();
        let prepared = afmsweep::sweep::read_header(journals[0].header()).unwrap().0;
        let sweep = Sweep::new(prepared.scene().unwrap()).told_as(&prepared).audit(Audit::Instances(4));
        let file = RunFile::create(&path, prepared.scene_text(), ExistingFile::GoneOnWith).unwrap();
        let keeper = RunJournal::of_merge(journals, Share { number: 1, of: 2 }, file).unwrap();
        let swept = sweep.run_into(&keeper, &Silent).unwrap().gathered().unwrap();
        assert!(swept.missing.is_empty());
        (swept.steps_taken, swept.verdict.audited)
    };
    let (steps, audited) = merge();
    let bytes = std::fs::read(&partial).unwrap();
    assert!(steps > 0 && audited == 4);
    assert!(kinds(&partial).contains(&RecordKind::Answers) && kinds(&partial).contains(&RecordKind::Numbers));
    assert_eq!(merge(), (0, 4), "nothing is stepped again");
    assert_eq!(std::fs::read(&partial).unwrap(), bytes, "nothing new is asked");
    let words = ["merge", files[0], files[1], "-o", "merged.h5", "--audit", "4"];
    let ends = ends(&bytes);
    for (n, end) in ends.iter().enumerate().step_by(3).chain([(ends.len() - 1, &bytes.len())]) {
        std::fs::write(&partial, &bytes[..*end]).unwrap();
        let said = desk.works(&words);
        assert_eq!(said.err.contains("goes on with"), n > 0, "{n}: {}", said.err);
        assert_alike(&desk.path("whole.h5"), &path, &format!("cut after record {n}"));
        assert!(!partial.exists());
        std::fs::remove_file(&path).unwrap();
    }
    // A run does not go on with it.
    std::fs::write(&partial, &bytes).unwrap();
    desk.refuses(&["run", "scene.toml", "-o", "merged.h5", "--resume"], &["journal of a merge"]);
    assert_eq!(std::fs::read(&partial).unwrap(), bytes);
}
