//! docs/scene.md and docs/results.md name everything there is: the keys of a scene with their units, defaults and
//! ranges, and whatever a results file holds.
//! Truth: what the program answers to scenes that it refuses, its lists of quantities, observables and statuses, and files.

use afmsweep::contact::Law;
use afmsweep::control::Arithmetic;
use afmsweep::record::{self, BRANCHES, Facts, JUMPS, WARNINGS};
use afmsweep::scene::{Domain, Params, QUANTITIES, Quantity};
use afmsweep::store::{Attribute, Results};
use afmsweep::sweep::Phase;
use afmsweep::units::Dimension;
use afmsweep::{Audit, Backend, Observable, Precision, Scene, Status, Sweep, Swept};
use hdf5::types::{FloatSize, IntSize, TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, Group};
use std::path::Path;

/// A document of `docs/`.
struct Document {
    name: &'static str,
    text: String,
}

impl Document {
    fn open(name: &'static str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
        Self { name, text: std::fs::read_to_string(path).unwrap() }
    }

    /// The text below a heading, up to the next one; signs that begin a line of an example are no heading.
    fn section(&self, heading: &str) -> String {
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
    fn row(&self, heading: &str, name: &str) -> Vec<String> {
        let section = self.section(heading);
        let begin = format!("| `{name}` |");
        let row = section.lines().find(|line| line.starts_with(&begin));
        let row = row.unwrap_or_else(|| panic!("{}: no row `{name}` in {heading:?}", self.name));
        row.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()
    }

    /// Whether a section says the word as code.
    fn says(&self, heading: &str, word: &str) {
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
const TABLES: [(&str, &str); 15] = [
    ("Top level", "zzz = 1"),
    ("`[instrument]`", "[instrument]\nzzz = 1"),
    ("`[instrument.actuator]`", "[instrument.actuator]\nzzz = 1"),
    ("`[instrument.cantilever]`", "[instrument.cantilever]\nzzz = 1"),
    ("`[instrument.cantilever]` `modes`", "[instrument.cantilever]\nmodes = [{ zzz = 1 }]"),
    ("`[instrument.tip]`", "[instrument.tip]\nzzz = 1"),
    ("`[sample]`", "[sample]\nzzz = 1"),
    ("`[contact]`", "[contact]\nzzz = 1"),
    ("`[drive]`", "[drive]\nzzz = 1"),
    ("`[approach]`", "[approach]\nzzz = 1"),
    ("`[design]`", "[design]\nzzz = 1"),
    ("`[curve]`", "[curve]\nzzz = 1"),
    ("`[run]`", "[run]\nzzz = 1"),
    ("`[output]`", "[output]\nzzz = 1"),
    ("`[output]` `waveforms`", "[output]\nwaveforms = { instances = [0], zzz = 1 }"),
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
        if matches!(quantity.domain, Domain::PoissonRatio | Domain::Share) || key == "drive" {
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

const CURVE: &str = "[curve]\nquantity = \"approach.gap\"\nfrom = \"16 nm\"\nto = \"15 nm\"\npoints = 2\n";

const LEVER: &str = r#"
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

/// A searched grid with everything asked for, and a list whose instances have frequencies of their own.
fn runs() -> Vec<Swept> {
    let names: Vec<String> = Observable::all().map(|one| format!("\"{}\"", one.name())).collect();
    let output =
        format!("[output]\nobservables = [{}]\nwaveforms = {{ instances = [0, 1] }}\n", names.join(", "));
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
fn mixed_and_stopped(swept: &Swept) -> Results {
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
    let mut results = record::results(&scene, &run.plan, &run.outcome, &facts);
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
    for phase in
        [Phase::Planning, Phase::Stepping, Phase::Refinement, Phase::Branches, Phase::Audit, Phase::Waveforms]
    {
        document.says("An incomplete file", phase.word());
    }
    for observable in Observable::all() {
        let row = document.row("Variables", observable.name());
        assert_eq!(row[3], format!("`{}`", observable.units()), "{}", observable.name());
    }
}
