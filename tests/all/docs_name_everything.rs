//! docs/scene.md names everything that a scene may have: keys with their units, defaults and ranges.
//! Truth: what the program answers to scenes that it refuses, and its lists of quantities.

use crate::scenes::outside_with;
use afmsweep::Scene;
use afmsweep::scene::{Domain, Params, QUANTITIES, Quantity};
use afmsweep::units::Dimension;
use std::path::Path;

/// A document of `docs/`.
pub struct Document {
    pub name: &'static str,
    pub text: String,
}

impl Document {
    pub fn open(name: &'static str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
        Self { name, text: std::fs::read_to_string(path).unwrap() }
    }

    /// The text below a heading, up to the next one; signs that begin a line of an example are no heading.
    pub fn section(&self, heading: &str) -> String {
        let (mut inside, mut fenced, mut found) = (false, false, String::new());
        for line in self.text.lines() {
            fenced ^= line.starts_with("```");
            if line.starts_with('#') && !fenced {
                inside = line.trim_start_matches('#').trim() == heading;
            } else if inside {
                found += line;
                found.push('\n');
            }
        }
        assert!(!found.is_empty(), "{}: no section {heading:?}", self.name);
        found
    }

    /// The cells of a table's row, of which the first is this name as code.
    pub fn row(&self, heading: &str, name: &str) -> Vec<String> {
        let section = self.section(heading);
        let begin = format!("| `{name}` |");
        let row = section.lines().find(|line| line.starts_with(&begin));
        let row = row.unwrap_or_else(|| panic!("{}: no row `{name}` in {heading:?}", self.name));
        row.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()
    }

    /// Whether a section says the word as code.
    pub fn says(&self, heading: &str, word: &str) {
        let section = self.section(heading);
        assert!(section.contains(&format!("`{word}`")), "{}: no `{word}` in {heading:?}", self.name);
    }
}

/// What is said of a scene that is refused.
fn refusal(text: &str) -> String {
    match Scene::parse(Path::new("scene.toml"), text) {
        Ok(_) => panic!("taken for a scene: {text}"),
        Err(error) => error.to_string(),
    }
}

/// What was expected in its place.
fn expected(text: &str) -> String {
    let said = refusal(text);
    let (_, rest) = said.split_once("; expected ").unwrap_or_else(|| panic!("{said}"));
    rest.to_owned()
}

/// The words or keys that the place of `zzz` may have.
fn choices(text: &str) -> Vec<String> {
    let said = expected(text);
    let list = said.strip_prefix("one of ").unwrap_or_else(|| panic!("{text}: {said}"));
    let list = list.split(';').next().unwrap();
    list.split(", ").map(|word| word.trim_matches('"').to_owned()).collect()
}

/// Every table of a scene, by its heading, and a scene that asks for a key it does not have.
const TABLES: [(&str, &str); 17] = [
    ("Top level", "zzz = 1"),
    ("`[instrument]`", "[instrument]\nzzz = 1"),
    ("`[instrument.actuator]`", "[instrument.actuator]\nzzz = 1"),
    ("`[instrument.cantilever]`", "[instrument.cantilever]\nzzz = 1"),
    ("`[instrument.cantilever]` `modes`", "[instrument.cantilever]\nmodes = [{ zzz = 1 }]"),
    ("`[instrument.tip]`", "[instrument.tip]\nzzz = 1"),
    ("`[sample]`", "[sample]\nzzz = 1"),
    ("`[contact]`", "[contact]\nzzz = 1"),
    (
        "`[[contact.outside]]`",
        "[contact]\nlaw = \"dmt\"\n[[contact.outside]]\nforce = \"hydration\"\nzzz = 1",
    ),
    ("`[drive]`", "[drive]\nzzz = 1"),
    ("`[approach]`", "[approach]\nzzz = 1"),
    ("`[design]`", "[design]\nzzz = 1"),
    ("`[curve]`", "[curve]\nzzz = 1"),
    ("`[run]`", "[run]\nzzz = 1"),
    ("`[output]`", "[output]\nzzz = 1"),
    ("`[output]` `waveforms`", "[output]\nwaveforms = { instances = [0], zzz = 1 }"),
    ("`[output]` `spectra`", "[output]\nspectra = { instances = [0], zzz = 1 }"),
];

#[test]
fn every_key_of_a_scene_has_its_row() {
    let scene = Document::open("scene.md");
    for (heading, text) in TABLES {
        choices(text).iter().for_each(|key| drop(scene.row(heading, key)));
    }
    for key in choices("[sweep]\n\"approach.gap\" = { zzz = 1 }") {
        scene.row("`[sweep]`", &key);
    }
}

#[test]
fn every_word_that_a_choice_may_have_is_told() {
    let scene = Document::open("scene.md");
    for (heading, key, text) in [
        ("`[instrument.actuator]`", "model", "[instrument.actuator]\nmodel = \"zzz\""),
        ("`[contact]`", "law", "[contact]\nlaw = \"zzz\""),
        ("`[[contact.outside]]`", "force", "[contact]\n[[contact.outside]]\nforce = \"zzz\""),
        ("`[drive]`", "on", "[drive]\non = \"zzz\""),
        ("`[curve]`", "quantity", "[curve]\nquantity = \"zzz\""),
        ("`[design]`", "kind", "[design]\nkind = \"zzz\""),
        ("`[curve]`", "direction", &format!("{CURVE}direction = \"zzz\"")),
        ("`[run]`", "start", "[run]\nstart = \"zzz\""),
        ("`[run]`", "steady", "[run]\nsteady = \"zzz\""),
        ("`[run]`", "branches", "[run]\nbranches = \"zzz\""),
        (
            "`[sweep]`",
            "scale",
            "[sweep]\n\"approach.gap\" = { from = \"1 nm\", to = \"2 nm\", points = 2, scale = \"zzz\" }",
        ),
    ] {
        let row = scene.row(heading, key).join(" ");
        for word in choices(text) {
            assert!(row.contains(&format!("`\"{word}\"`")), "{heading} {key}: {word} is not told");
        }
    }
    for observable in choices("[output]\nobservables = [\"zzz\"]") {
        scene.says("`[output]`", &observable);
    }
}

/// The heading of a quantity's table and its key there.
fn place_of(quantity: &Quantity) -> (String, &'static str) {
    let (section, key) = quantity.path.rsplit_once('.').unwrap();
    match section.strip_suffix(".modes.#") {
        Some(section) => (format!("`[{section}]` `modes`"), key),
        None if section == "contact.outside.#" => ("`[[contact.outside]]`".to_owned(), key),
        None => (format!("`[{section}]`"), key),
    }
}

/// A scene with a value that no such quantity has.
fn impossible(quantity: &Quantity) -> String {
    let (section, key) = quantity.path.rsplit_once('.').unwrap();
    let value = match quantity.dimension {
        Dimension::Dimensionless => "1e300".to_owned(),
        other => format!("\"1e300 {}\"", other.si_unit()),
    };
    match section.strip_suffix(".modes.#") {
        Some(section) => format!("[{section}]\nmodes = [{{ {key} = {value} }}]"),
        None if section == "contact.outside.#" => {
            format!("{}{key} = {value}\n", outside_with(quantity.path))
        }
        None => format!("[{section}]\n{key} = {value}"),
    }
}

#[test]
fn every_quantity_has_its_unit_default_and_range() {
    let scene = Document::open("scene.md");
    let preset = Params::default();
    // Quality factors that are listed have the row of the one for all modes.
    for quantity in QUANTITIES.iter().filter(|one| !one.path.ends_with(".#")) {
        let (heading, key) = place_of(quantity);
        let [_, unit, default, range, usual, _] = &scene.row(&heading, key)[..] else {
            panic!("{}: the row has not six cells", quantity.path);
        };
        assert_eq!(*unit, format!("`{}`", quantity.dimension.si_unit()), "{}", quantity.path);
        let address = afmsweep::scene::Address::find(&quantity.path.replace('#', "0")).unwrap();
        if let Some(value) = address.get(&preset) {
            let written = address.written(value);
            assert!(default.contains(&format!("`{written}`")), "{}: {default}, not {written}", quantity.path);
        }
        if matches!(quantity.domain, Domain::PoissonRatio | Domain::SetPoint | Domain::HalfAngle)
            || key == "drive"
        {
            assert_eq!(*range, quantity.domain.described(), "{}", quantity.path);
            continue;
        }
        // "a size from 1 uPa to 1 PPa, or inf; from 10 Pa to 2 TPa is usual; check ..."
        let said = expected(&impossible(quantity));
        let mut parts = said.strip_prefix("a size ").unwrap_or_else(|| panic!("{said}")).split("; ");
        let sizes = parts.next().unwrap().trim_end_matches(", or inf");
        let ordinary = parts.next().unwrap().trim_end_matches(" is usual");
        assert!(range.contains(sizes), "{}: {range}, not {sizes}", quantity.path);
        assert_eq!(usual, ordinary, "{}", quantity.path);
        for (word, value) in [("zero", 0.0), ("inf", f64::INFINITY), ("either sign", -1.0)] {
            assert_eq!(range.contains(word), quantity.domain.holds(value), "{}: {range}", quantity.path);
        }
    }
}

#[test]
fn defaults_of_run_and_output_are_those_of_an_empty_scene() {
    let scene = Document::open("scene.md");
    let resolved = Scene::parse(Path::new("scene.toml"), "title = \"x\"").unwrap().resolved_toml();
    let (_, rest) = resolved.split_once("[run]\n").unwrap();
    for line in rest.lines() {
        let heading = if line.starts_with("observables") { "`[output]`" } else { "`[run]`" };
        let Some((key, value)) = line.split_once(" = ") else { continue };
        let default = &scene.row(heading, key)[1];
        assert!(default.contains(&format!("`{value}`")), "{key}: {default}, not {value}");
    }
}

#[test]
fn examples_of_scenes_are_scenes() {
    let scene = Document::open("scene.md");
    let examples: Vec<&str> = scene.text.split("```toml\n").skip(1).collect();
    assert!(examples.len() > 12, "{}", examples.len());
    for example in examples {
        let text = example.split("```").next().unwrap();
        if let Err(error) = Scene::parse(Path::new("example.toml"), text) {
            panic!("{}\n{text}", error.render(false));
        }
    }
}

pub const CURVE: &str =
    "[curve]\nquantity = \"approach.gap\"\nfrom = \"16 nm\"\nto = \"15 nm\"\npoints = 2\n";

pub const LEVER: &str = r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[sample]
surface_energy = "20 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[run]
steady = "search"
branches = "both"
"#;
