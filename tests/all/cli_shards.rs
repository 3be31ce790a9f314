//! Shares of a run and their merge. Truth: the run of the whole, to the bit.

use crate::cli_journal::{KINDS, TAPPING, assert_alike};
use crate::program::Desk;
use afmsweep::store::{Attribute, read};

#[test]
fn shares_merged_are_the_run_of_the_whole() {
    let desk = Desk::new();
    for (name, text, _) in KINDS {
        let scene = format!("{name}.toml");
        desk.write(&scene, text);
        desk.works(&["run", &scene, "-q", "--audit", "2", "-o", "whole.h5", "--overwrite"]);
        let choices = format!("{name}.choices.toml");
        desk.works(&["prepare", &scene, "-o", &choices]);
        let mut files = Vec::new();
        for k in 1..=3 {
            let share = format!("{k}/3");
            // One of them chooses for itself, and so chooses the same.
            let given = if k == 2 { vec![] } else { vec!["--choices", &choices] };
            let threads = ["1", "2", "3"][k - 1];
            let arguments = [&["run", &scene, "-q", "--shard", &share, "--threads", threads], &given[..]];
            desk.works(&arguments.concat());
            files.push(format!("results/{name}.{k}-of-3.h5"));
        }
        files.rotate_left(1);
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let merge = [&["merge"], &files[..], &["-o", "merged.h5", "--audit", "2", "--overwrite"]];
        desk.works(&merge.concat());
        assert_alike(&desk.path("whole.h5"), &desk.path("merged.h5"), name);
    }
}

/// A design of two blocks, whose samples begin at one another's states.
const DESIGN: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 100 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "10 GPa" }
"approach.gap" = { distribution = "uniform", from = "13 nm", to = "16 nm" }
[design]
kind = "monte-carlo"
samples = 33000
[run]
steady = "search"
[output]
observables = ["amplitude", "phase"]
"#;

#[test]
fn shares_of_a_design_are_the_run_of_the_whole() {
    let desk = Desk::new();
    desk.write("design.toml", DESIGN);
    desk.works(&["run", "design.toml", "-q", "--no-audit", "--threads", "1", "-o", "whole.h5"]);
    for share in ["1/2", "2/2"] {
        desk.works(&["run", "design.toml", "-q", "--no-audit", "--shard", share, "--threads", "2"]);
    }
    let files = ["results/design.1-of-2.h5", "results/design.2-of-2.h5"];
    desk.works(&["merge", files[0], files[1], "--no-audit", "-o", "merged.h5"]);
    let whole = read(&desk.path("whole.h5")).unwrap();
    let begun = whole.attributes.iter().find(|(name, _)| name == "neighbour_started").unwrap();
    assert!(matches!(begun.1, Attribute::Number(share) if share > 0.9), "{begun:?}");
    assert_alike(&desk.path("whole.h5"), &desk.path("merged.h5"), "design");
}

/// A design of less than a block is the work of one share where its samples begin at one another's states, and of all
/// where `prepare --cold` says that they do not.
#[test]
fn cold_choices_divide_small_designs() {
    let desk = Desk::new();
    desk.write("design.toml", &DESIGN.replace("33000", "1200"));
    let all = ["run", "design.toml", "-q", "--no-audit", "--cold", "--portion", "200", "-o", "whole.h5"];
    desk.works(&all);
    desk.works(&["prepare", "design.toml", "--cold", "--portion", "200", "-o", "cold.toml"]);
    let mut files = Vec::new();
    for k in 1..=3 {
        let (share, file) = (format!("{k}/3"), format!("results/design.{k}-of-3.h5"));
        desk.works(&["run", "design.toml", "-q", "--shard", &share, "--choices", "cold.toml"]);
        desk.works(&["export", &file, "-o", "part.h5", "--overwrite"]);
        let part = read(&desk.path("part.h5")).unwrap();
        let amplitude = part.variables.iter().find(|one| one.name == "amplitude").unwrap();
        let done = amplitude.data.iter().filter(|value| value.is_finite()).count();
        assert_eq!(done, 400, "share {k}");
        files.push(file);
    }
    desk.works(&["merge", &files[0], &files[1], &files[2], "--no-audit", "-o", "merged.h5"]);
    assert_alike(&desk.path("whole.h5"), &desk.path("merged.h5"), "cold design");
}

#[test]
fn a_merge_names_what_is_missing_and_how_to_make_it() {
    let desk = Desk::new();
    desk.write("tapping.toml", TAPPING);
    desk.write("other.toml", &TAPPING.replace("26 N/m", "27 N/m"));
    let run = |scene: &str, share: &str, more: &[&str]| {
        desk.works(&[&["run", scene, "-q", "--shard", share], more].concat());
    };
    let file = |name: &str| desk.path("results").join(name).to_str().unwrap().to_owned();
    for k in 1..=4 {
        run("tapping.toml", &format!("{k}/4"), &[]);
    }
    run("other.toml", "2/4", &[]);
    run("tapping.toml", "1/3", &[]);
    let [a, b, c, d] = [1, 2, 3, 4].map(|k| file(&format!("tapping.{k}-of-4.h5")));
    let merge = |files: &[&str], words: &[&str]| {
        desk.refuses(&[&["merge", "-o", "m.h5"], files].concat(), words);
        assert!(!desk.path("m.h5").exists() && !desk.path("m.h5.partial").exists());
    };
    merge(
        &[&a, &c],
        &[
            "2 shares are missing",
            "share 2/4 has no file here: afmsweep run tapping.toml -q --shard 2/4 --resume",
            "share 4/4",
        ],
    );
    // A name that does not follow the share is not proposed for another one, whose run would replace the file.
    run("tapping.toml", "2/2", &["-o", "own.h5"]);
    let proposed =
        "share 1/2 has no file here: afmsweep run tapping.toml -q --shard 1/2 -o own.1-of-2.h5 --resume";
    merge(&["own.h5"], &[proposed]);
    let other = ["run", "tapping.toml", "-q", "--shard", "1/2", "-o", "own.h5", "--resume"];
    desk.refuses(&other, &["own.h5 holds share 2/2 of a run, and this run is share 1/2", "--overwrite"]);
    merge(&[&a, &b, &c, &d, &b], &["are both share 2/4"]);
    merge(&[&a, &file("other.2-of-4.h5"), &c, &d], &["are not of one run"]);
    merge(&[&file("tapping.1-of-3.h5"), &b], &["are not of one run"]);
    merge(&["tapping.toml"], &["tapping.toml is no results file", "no HDF5 file"]);
    desk.works(&["run", "tapping.toml", "-q", "-o", "whole.h5", "--no-audit"]);
    merge(&["whole.h5"], &["whole results, not a share"]);
    let onto = ["merge", &a, &b, &c, &d, "-o", &c];
    desk.refuses(&onto, &["tapping.3-of-4.h5 is one of the shares", "another name"]);
    let torn = std::fs::read(&b).unwrap();
    std::fs::write(&b, &torn[..torn.len() / 2]).unwrap();
    merge(&[&a, &b, &c, &d], &[&b, "cut short"]);
    std::fs::remove_file(&b).unwrap();
    desk.works(&["run", "tapping.toml", "-q", "--shard", "2/4", "--resume"]);
    desk.works(&["merge", "-o", "m.h5", &a, &b, &c, &d, "--no-audit"]);
    assert_alike(&desk.path("whole.h5"), &desk.path("m.h5"), "made again");
}
