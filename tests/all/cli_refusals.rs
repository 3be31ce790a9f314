//! What the program refuses, and whether it says what to do about it.

use crate::program;
use crate::program::{Desk, scene};
use std::path::Path;

const SMALL: &str =
    "[sweep]\n\"approach.gap\" = { values = [\"0.3 nm\", \"1 nm\"] }\n[run]\nperiods = 3\nmeasure = 2\n";

fn bad(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/bad").join(name).to_str().unwrap().to_owned()
}

#[test]
fn a_bad_scene_is_shown_with_its_place() {
    let desk = Desk::new();
    let path = bad("unknown_unit.toml");
    for command in ["run", "plan", "modes", "force"] {
        let said = desk.refuses(
            &[command, &path],
            &["`sample.youngs_modulus`", &format!("--> {path}:5:18"), "^^^^^^^", "did you mean \"1 GPa\"?"],
        );
        assert!(said.err.contains("5 | youngs_modulus = \"1 Gpa\""), "{}", said.err);
        assert!(!desk.path("results").exists(), "refused before anything is made");
    }
    // Nothing on a terminal here, so NO_COLOR changes nothing; nor does it where it is set and empty.
    for value in ["1", ""] {
        let output = desk.command(&["run", &path]).env("NO_COLOR", value).output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(err, desk.call(&["run", &path]).err);
    }
    // Silence does not hide an error.
    desk.refuses(&["run", &path, "-q"], &["5:18"]);
}

#[test]
fn a_rounding_that_means_nothing_is_refused() {
    let desk = Desk::new();
    let output = desk.command(&["devices"]).env("AFMSWEEP_ROUNDING", "thrice").output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(err.contains("AFMSWEEP_ROUNDING is thrice: `once` or `twice` is expected"), "{err}");
}

#[test]
fn a_scene_that_is_not_there_is_named() {
    let desk = Desk::new();
    desk.refuses(&["run", "nowhere.toml"], &["nowhere.toml", "cannot read the scene", "check the name"]);
    desk.refuses(&["force", "."], &["cannot read the scene"]);
    desk.write("picture.toml", "\u{0}\u{1}");
    desk.refuses(&["plan", "picture.toml"], &["picture.toml:1:3"]);
    std::fs::write(desk.path("latin.toml"), b"title = \"\xe9\"\n").unwrap();
    desk.refuses(&["plan", "latin.toml"], &["latin.toml", "UTF-8"]);
}

#[test]
fn arguments_that_mean_nothing_end_with_code_2() {
    let desk = Desk::new();
    let path = scene("paper_fig4_hertz.toml");
    for (arguments, word) in [
        (vec!["run", &path, "--bakend", "cpu"], "--backend"),
        (vec!["run", &path, "--backend", "abacus"], "possible values: auto"),
        (vec!["run", &path, "--precision", "f16"], "f32, f64"),
        (vec!["run", &path, "--steps-per-period", "3"], "16..=1000000"),
        (vec!["run", &path, "--threads", "0"], "from 1 to 1024"),
        (vec!["run", &path, "-q", "-v"], "cannot be used with"),
        (vec!["run"], "<SCENE>"),
        (vec!["force", &path, "--indentation", "75"], "75"),
        (vec!["force", &path, "--indentation", "75 kHz"], "length"),
        (vec!["frobnicate"], "unrecognized subcommand"),
        (vec![], "Usage"),
    ] {
        let said = desk.call(&arguments);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{arguments:?}: {}", said.err);
        assert!(said.err.contains(word), "{arguments:?} does not say {word:?}:\n{}", said.err);
    }
}

#[test]
fn results_of_another_scene_are_not_replaced_unasked() {
    let desk = Desk::new();
    let (one, other) = (desk.write("one.toml", SMALL), desk.write("other.toml", &format!("# two\n{SMALL}")));
    let (one, other) = (one.to_str().unwrap(), other.to_str().unwrap());
    desk.works(&["run", one, "-o", "out.h5", "-q"]);
    let before = std::fs::read(desk.path("out.h5")).unwrap();
    desk.refuses(
        &["run", other, "-o", "out.h5"],
        &["out.h5 holds results of another scene", "--overwrite", "-o"],
    );
    assert_eq!(std::fs::read(desk.path("out.h5")).unwrap(), before);
    assert!(!desk.path("out.h5.partial").exists());
    desk.works(&["run", other, "-o", "out.h5", "-q", "--overwrite"]);
    let now = afmsweep::store::read(&desk.path("out.h5")).unwrap();
    assert_eq!(now.text("scene").unwrap(), format!("# two\n{SMALL}"));
    // A scene is no results file either; its own is safe whatever is said.
    desk.refuses(&["run", other, "-o", one], &["is no results file of afmsweep", "--overwrite"]);
    desk.refuses(&["run", one, "-o", one, "--overwrite"], &["is the scene itself", "-o"]);
    assert_eq!(std::fs::read_to_string(one).unwrap(), SMALL);
}

#[test]
fn places_that_cannot_hold_results_are_refused_before_the_run() {
    let desk = Desk::new();
    let small = desk.write("small.toml", SMALL);
    let small = small.to_str().unwrap();
    std::fs::create_dir(desk.path("folder")).unwrap();
    desk.write("file", "text");
    desk.refuses(&["run", small, "-o", "folder"], &["folder is a folder", "-o"]);
    let said =
        desk.refuses(&["run", small, "-o", "file/out.h5"], &["a file stands where a folder is needed"]);
    assert_eq!(said.err.matches("os error").count(), 1, "told once: {}", said.err);
    desk.refuses(&["run", small, "-o", "nowhere/.."], &["names no file"]);
    // The default folder's name is taken.
    desk.write("results", "text");
    desk.refuses(&["run", small], &["results", "a file stands where a folder is needed", "-o"]);
    assert_eq!(std::fs::read_to_string(desk.path("results")).unwrap(), "text");
}

/// Permissions bind only ordinary users; the superuser's turn is the kernel's own tree.
#[cfg(target_os = "linux")]
#[test]
fn folders_without_permission_are_refused() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    let small = desk.write("small.toml", SMALL);
    let small = small.to_str().unwrap();
    let locked = desk.path("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o500)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        desk.refuses(&["run", small, "-o", "/proc/afmsweep/out.h5"], &["cannot make the folder", "-o"]);
    } else {
        desk.refuses(
            &["run", small, "-o", "locked/out.h5"],
            &["Permission denied", "change its permissions"],
        );
    }
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o700)).unwrap();
}

/// A folder that is not there is one all the same; the scene is safe behind a hard link and at the partial name too.
#[test]
fn names_that_are_no_files_and_names_of_the_scene_are_refused() {
    let desk = Desk::new();
    let small = desk.write("small.toml", SMALL);
    let path = small.to_str().unwrap();
    desk.refuses(&["run", path, "-o", "newdir/"], &["newdir/ is a folder", "newdir/results.h5"]);
    assert!(!desk.path("newdir").exists() && !desk.path("newdir.partial").exists());
    desk.refuses(&["run", path, "-o", "-"], &["give -o a name"]);
    std::fs::hard_link(&small, desk.path("hard.toml")).unwrap();
    desk.refuses(&["run", path, "-o", "hard.toml", "--overwrite"], &["is the scene itself"]);
    desk.write("a.h5.partial", SMALL);
    desk.refuses(&["run", "a.h5.partial", "-o", "a.h5", "--overwrite"], &["is the scene itself"]);
    let said = desk.works(&["run", path, "-o", "typo/a.h5", "--no-audit"]);
    assert!(said.err.contains("made the folder typo\n"), "{}", said.err);
    let said = desk.works(&["run", path, "-o", "typo/a.h5", "--no-audit"]);
    assert!(!said.err.contains("made the folder"), "{}", said.err);
}

/// Two programs may write into one log: each message is one write, which a socket of datagrams tells.
#[cfg(unix)]
#[test]
fn a_message_is_written_in_one_piece() {
    use std::os::{fd::OwnedFd, unix::net::UnixDatagram};
    let desk = Desk::new();
    let (ours, theirs) = UnixDatagram::pair().unwrap();
    let mut command = desk.command(&["run", "a\nb.toml", "-o", "-"]);
    command.stderr(OwnedFd::from(theirs)).status().unwrap();
    drop(command);
    let mut packet = [0; 4096];
    let length = ours.recv(&mut packet).unwrap();
    let text = String::from_utf8_lossy(&packet[..length]);
    assert!(text.starts_with("error: ") && text.ends_with('\n'), "{text:?}");
    ours.set_nonblocking(true).unwrap();
    assert!(ours.recv(&mut packet).is_err(), "there was more of it");
}

/// A help text that nobody got is no success.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_written_is_an_error() {
    let desk = Desk::new();
    for arguments in [["--help"], ["--version"]] {
        desk.works(&arguments);
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = desk.command(&arguments).stdout(full).output().unwrap();
        let said = program::said(output);
        assert_eq!(said.code, Some(1), "{arguments:?}: {}", said.err);
        assert!(said.err.contains("cannot write to standard output"), "{}", said.err);
    }
}
