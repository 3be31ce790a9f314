//! Typical mistakes and what the program answers: docs/mistakes.md. Truth: the program.
//!
//! `AFMSWEEP_WRITE=1 cargo test --test all cli_mistakes` writes the page anew, to be read before it is kept.

use crate::program::Desk;
use std::fmt::Write;
use std::path::Path;

/// A lever that runs; mistakes are made in it.
const LEVER: &str = r#"[instrument]
cantilever = { stiffness = "42 N/m", frequency = "300 kHz", quality_factor = 400 }
tip = { radius = "8 nm", youngs_modulus = "130 GPa", poisson_ratio = 0.28 }
[sample]
youngs_modulus = "2.7 GPa"
[contact]
law = "dmt"
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "16 nm"
[run]
steady = "search"
"#;

/// What is written wrongly in the scene: these words in place of those.
const SCENES: &[(&str, &str)] = &[
    ("youngs_modulus = \"2.7 GPa\"", "young_modulus = \"2.7 GPa\""),
    ("youngs_modulus = \"2.7 GPa\"", "E = \"2.7 GPa\""),
    ("stiffness = \"42 N/m\"", "k = \"42 N/m\""),
    ("quality_factor = 400", "Q = 400"),
    ("frequency = \"300 kHz\",", "f0 = \"300 kHz\","),
    ("gap = \"16 nm\"", "gap = 16"),
    ("gap = \"16 nm\"", "gap = \"16\""),
    ("gap = \"16 nm\"", "gap = 16 nm"),
    ("radius = \"8 nm\"", "radius = 8e-9"),
    ("youngs_modulus = \"2.7 GPa\"", "youngs_modulus = \"2.7 GPa\"\nbonded = false"),
    ("gap = \"16 nm\"", "gap = \"16 nN\""),
    ("gap = \"16 nm\"", "gap = \"16 nanometer\""),
    ("gap = \"16 nm\"", "gap = \"16 parsec\""),
    ("gap = \"16 nm\"", "gap = \"16,5 nm\""),
    ("gap = \"16 nm\"", "amplitude_ratio = 0.8"),
    ("gap = \"16 nm\"", "setpoint = 80"),
    ("gap = \"16 nm\"", "gap = \"16 nm\"\nsetpoint = 0.8"),
    ("gap = \"16 nm\"", "distance = \"16 nm\""),
    ("radius = \"8 nm\"", "radius = \"-8 nm\""),
    ("radius = \"8 nm\"", "radius = \"8 km\""),
    ("poisson_ratio = 0.28", "poisson_ratio = 0.6"),
    ("law = \"dmt\"", "law = \"DMT\""),
    ("law = \"dmt\"", "law = \"hertzian\""),
    ("law = \"dmt\"", "law = dmt"),
    ("steady = \"search\"", "steady = search"),
    ("steady = \"search\"", "accuracy = 0"),
    ("steady = \"search\"", "branches = \"both\""),
    ("steady = \"search\"", "threads = 8"),
    ("[sample]", "[samples]"),
    ("[contact]", "[contacts]"),
    ("stiffness = \"42 N/m\", ", ""),
    ("free_amplitude = \"20 nm\"", "free_amplitude = \"20 nm\"\nvoltage = \"1 V\""),
    ("[run]", "[sweep]\nsample.youngs_modulus = { values = [\"1 GPa\", \"2 GPa\"] }\n[run]"),
    ("[run]", "[sweep]\n\"drive.on\" = { values = [\"tip\", \"actuator\"] }\n[run]"),
    ("[run]", "[sweep]\n\"approach.gap\" = [\"1 nm\", \"2 nm\"]\n[run]"),
    ("[run]", "[sweep]\n\"approach.gap\" = { from = \"1 nm\", to = \"2 nm\", points = 1 }\n[run]"),
    ("[run]", "[output]\nobservables = [\"peak_force\"]\n[run]"),
    ("[run]", "[output]\nobservables = [\"energy\", \"phase_shift\"]\n[run]"),
    ("poisson_ratio = 0.28 }", "poisson_ratio = 0.28"),
];

/// What is wrong on the command line.
const CALLS: &[&[&str]] = &[
    &["run", "levr.toml"],
    &["run", "results/lever.h5"],
    &["run", "lever.toml", "--thread", "2"],
    &["run", "lever.toml", "--precision", "double"],
    &["run"],
    &["rum", "lever.toml"],
    &["report", "lever.toml"],
    &["report", "nothere.h5"],
    &["report", "results/lever.h5", "--x", "approach.gap"],
    &["run", "lever.toml", "-o", "notes.txt"],
    &["explain", "amplitud"],
];

/// The lines of an answer that say what is wrong, where, what was expected and what to do.
fn answer(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let wanted = ["error: ", "= expected: ", "= help: ", "tip: ", "help: ", "[possible values", "<SCENE>"];
    for line in text.lines().map(str::trim) {
        let wanted = wanted.iter().find(|start| line.starts_with(**start));
        if let Some(start) = wanted {
            let line = line.strip_prefix("= ").unwrap_or(line);
            let short: String = line.chars().take(150).collect();
            let end = if short.len() < line.len() { " ..." } else { "" };
            // What follows a list of names tells nothing new.
            if *start != "= expected: " || short.len() == line.len() {
                lines.push(format!("{short}{end}"));
            }
        }
    }
    lines.join("\n")
}

fn page() -> String {
    let desk = Desk::new();
    let mut page = "# Mistakes and answers\n\nWhat the program says to typical mistakes: its first lines, without the \
                    marked place in the file. Several\nmistakes of one scene are told together. A test holds this page to the \
                    program.\n\nAs rustc and ruff do, it marks the place, says what it expected and proposes a word. Unlike ruff \
                    it mends nothing\nby itself. Where rustc has a number for each error to look up, `afmsweep explain WORD` takes the \
                    words of the message.\nText that is no TOML is one mistake, as a syntax error is to rustc.\n\n## In a scene\n"
        .to_owned();
    desk.write("lever.toml", LEVER);
    desk.works(&["run", "lever.toml", "-q", "--no-audit"]);
    for (right, wrong) in SCENES {
        assert_eq!(LEVER.matches(right).count(), 1, "{right}");
        desk.write("wrong.toml", &LEVER.replacen(right, wrong, 1));
        let said = desk.call(&["plan", "wrong.toml"]);
        assert_eq!(said.code, Some(1), "{wrong} is taken: {}", said.out);
        // A scene's mistake is shown at its place.
        assert!(said.err.contains("wrong.toml:"), "{wrong}: {}", said.err);
        let written = if wrong.is_empty() { format!("without {right}") } else { (*wrong).to_owned() };
        let _ = write!(page, "\n```text\n{}\n\n{}\n```\n", written.trim(), answer(&said.err));
    }
    page += "\n## On the command line\n";
    desk.write("notes.txt", "mine\n");
    for call in CALLS {
        let said = desk.call(call);
        assert!(matches!(said.code, Some(1 | 2)), "{call:?}: {}", said.out);
        let _ = write!(page, "\n```text\nafmsweep {}\n\n{}\n```\n", call.join(" "), answer(&said.err));
    }
    page
}

#[test]
fn the_page_of_mistakes_has_what_the_program_answers() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/mistakes.md");
    let page = page();
    if std::env::var_os("AFMSWEEP_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), page);
    assert!(SCENES.len() + CALLS.len() >= 40);
    // Every answer says what is wrong, and of a scene also what to do.
    let (scenes, calls) = page.split_once("## On the command line").unwrap();
    assert_eq!(scenes.matches("\nerror: ").count(), SCENES.len() + 1, "one scene has two mistakes");
    assert_eq!(scenes.matches("\nhelp: ").count(), scenes.matches("\nerror: ").count());
    assert_eq!(calls.matches("\nerror: ").count(), CALLS.len());
}

/// Truth: the mistakes put in.
#[test]
fn all_mistakes_of_a_scene_are_told_at_once_in_their_order() {
    let desk = Desk::new();
    let wrong = LEVER
        .replace("quality_factor = 400", "Q = 400")
        .replace("\"2.7 GPa\"", "\"2.7 GPb\"")
        .replace("\"dmt\"", "\"dmtt\"")
        .replace("gap =", "gab =")
        .replace("[run]", "[output]\nobservables = [\"phase\", \"phasor\"]\n[run]\nperiods = 0");
    desk.write("wrong.toml", &wrong);
    let text = desk.refuses(&["plan", "wrong.toml"], &[]).err;
    let titles: Vec<&str> = text.lines().filter(|line| line.starts_with("error: ")).collect();
    let expected = ["`Q`", "youngs_modulus", "contact.law", "`gab`", "output.observables", "run.periods"];
    assert_eq!(titles.len(), expected.len(), "{text}");
    for (title, word) in titles.iter().zip(expected) {
        assert!(title.contains(word), "{title}: {word}");
    }
    assert!(text.trim_end().ends_with("6 mistakes"), "{text}");
    // What hangs on a wrong line is not told as a mistake of its own: the lever that lacks its quality factor, the run.
    assert!(!text.contains("undamped"), "{text}");
    // Once these are mended, rules between keys are looked at.
    let half =
        LEVER.replace("stiffness = \"42 N/m\", ", "").replace("steady = \"search\"", "steady = \"find\"");
    desk.write("half.toml", &half);
    let text = desk.refuses(&["plan", "half.toml"], &["stiffness", "run.steady", "2 mistakes"]).err;
    assert_eq!(text.matches("error: ").count(), 2, "{text}");
}

#[test]
fn a_word_of_others_is_explained_by_what_it_is_called_here() {
    let desk = Desk::new();
    let text = desk.works(&["explain", "peak_force"]).out;
    assert!(
        text.starts_with("peak_force: here that is force_max\n") && text.contains("Largest force"),
        "{text}"
    );
    assert!(desk.works(&["explain", "amplitude_ratio"]).out.contains("here that is setpoint"));
}
