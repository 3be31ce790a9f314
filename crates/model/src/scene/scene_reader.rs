//! From the file's text to a checked scene: the sections of the instrument, the sample and the drive.

use super::address::Address;
use super::array_samples;
use super::draft::{Draft, GivenSamples, Said, SampleArrays, keys_of};
use super::levers::{self};
use super::params::*;
use super::paths::{BONDED, TIP_SHAPE, VISCOSITY_MODEL};
use super::scene_error::{Checked, Fault, Faults, SceneError};
use super::values::{self, Key, Value};
use super::{
    Scene, Steady, SweptAxes, curve_section, design_section, output, rules, setpoint_rules, sweep_section,
};
use crate::observe::Observable;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use toml::de::DeTable;

/// What stands at the top of a scene.
pub(super) const SECTIONS: [&str; 13] = [
    "title",
    "instrument",
    "sample",
    "contact",
    "drive",
    "approach",
    "sweep",
    "samples",
    "uncertain",
    "design",
    "curve",
    "run",
    "output",
];

/// Most lever modes a scene may list or ask for.
pub(super) const MOST_MODES: usize = 32;

/// Keywords of `instrument.actuator.model`.
pub(super) const MODELS: [(&str, ActuatorModel); 4] = [
    ("coupled", ActuatorModel::Coupled),
    ("prescribed", ActuatorModel::Prescribed),
    ("rigid", ActuatorModel::Rigid),
    ("as-printed", ActuatorModel::AsPrinted),
];
/// Keywords of `drive.on`.
pub(super) const DRIVE_ON: [(&str, DriveOn); 2] = [("actuator", DriveOn::Actuator), ("tip", DriveOn::Tip)];

/// Keywords of `approach.setpoint_branch`.
pub(super) const VISCOUS: [(&str, ViscosityModel); 2] =
    [("kelvin-voigt", ViscosityModel::KelvinVoigt), ("ad-hoc", ViscosityModel::AdHoc)];
pub(super) const BRANCHES_HELD: [(&str, ForceBranch); 2] =
    [("attractive", ForceBranch::Attractive), ("repulsive", ForceBranch::Repulsive)];

/// Keywords of `approach.setpoint_of`.
pub(super) const SETPOINTS_OF: [(&str, SetPointOf); 3] =
    [("tip", SetPointOf::Tip), ("deflection", SetPointOf::Deflection), ("phase", SetPointOf::Phase)];

/// Reads the text of a scene; `path` is named in messages and kept.
pub(super) fn parse(path: &Path, source: &str, samples: Option<SampleArrays>) -> Result<Scene, SceneError> {
    let (told, given) = match samples.map(|samples| array_samples::told(source, samples)) {
        Some((told, given)) => (Cow::Owned(told), Some(given)),
        None => (Cow::Borrowed(source), None),
    };
    let source = &*told;
    // Editors on Windows like to begin a file with a byte order mark; places are counted after it.
    let text = source.strip_prefix('\u{FEFF}').unwrap_or(source);
    let mut scene = parse_text(path, text, given).map_err(|faults| faults.in_file(path, text))?;
    scene.source = source.to_string();
    Ok(scene)
}

fn parse_text(path: &Path, source: &str, given: Option<GivenSamples>) -> Result<Scene, Faults> {
    if source.lines().all(|line| line.trim().is_empty() || line.trim_start().starts_with('#')) {
        return Err(Fault::whole("the scene file is empty")
            .expected(
                "at least one line, such as title = \"...\"; everything left out takes the preset's value",
            )
            .help("was the file saved?")
            .into());
    }
    let document = DeTable::parse(source).map_err(|error| not_toml(source, &error))?;
    read_document((path, source), document.get_ref(), given)
}

fn not_toml(source: &str, error: &toml::de::Error) -> Box<Fault> {
    let place = error.span().unwrap_or(0..0);
    let line_start =
        source.get(..place.start).map_or(0, |before| before.rfind('\n').map_or(0, |end| end + 1));
    let line = source.get(line_start..).unwrap_or("").lines().next().unwrap_or("");
    let value = line.split_once('=').map_or("", |(_, value)| value.trim_start());
    // The commonest slip of all: radius = 30 nm.
    let bare_unit = value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && value.split('#').next().unwrap_or("").contains(|c: char| c.is_ascii_alphabetic());
    let help = if error.message().contains("duplicate") {
        Some("keep one of the two".to_string())
    } else if bare_unit {
        let value = value.split('#').next().unwrap_or("").trim();
        Some(format!("a quantity with a unit is written in quotes: \"{}\"", crate::units::shortened(value)))
    } else if error.message().contains("must be quoted") {
        let word = value.split(['#', ',', '}', ']']).next().unwrap_or("").trim();
        (!word.is_empty()).then(|| format!("put the word in quotes: \"{}\"", crate::units::shortened(word)))
    } else {
        None
    };
    // The parser's own words: "what is wrong, expected this".
    let (message, expected) = error.message().split_once(", expected ").unwrap_or((error.message(), ""));
    let title = match message {
        "" => "the scene is not valid TOML".to_string(),
        message => format!("the scene is not valid TOML: {message}"),
    };
    let found = match source.get(place.clone()).unwrap_or("").trim() {
        "" if place.end >= source.len() => "found the end of the file".to_string(),
        "" => "found the end of the line or entry".to_string(),
        text => format!("found `{}`", crate::units::shortened(text)),
    };
    let expected = match expected {
        "" if message.contains("duplicate") => "each key once in its section",
        "" => "lines of the form key = value, and sections in brackets",
        words => words,
    };
    Fault::at(place, title)
        .label(found)
        .expected(expected)
        .help("check the brackets, quotes and equals signs here and just before")
        .maybe_help(help)
}

fn read_document(
    (path, source): (&Path, &str),
    document: &DeTable,
    given: Option<GivenSamples>,
) -> Result<Scene, Faults> {
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let mut draft = Draft { folder, given, ..Draft::default() };
    for key in document.keys().filter(|key| !SECTIONS.contains(&key.get_ref().as_ref())) {
        draft.faults.push(*values::unknown_key(key, "", &SECTIONS));
    }
    let title = document.get("title").and_then(|value| {
        let text = values::text(value, "title").map(str::to_string);
        draft.faults.take(text)
    });
    let mut sweep = draft.instance(document);
    setpoint_rules::name(&mut sweep, draft.params.approach.of);
    // What is not known of the instances cannot be wrong of the output.
    let known = draft.faults.is_empty();
    if known {
        rules::base(&mut draft);
        let checked = rules::check(&mut draft, &sweep);
        draft.faults.take(checked);
    }
    let searches = document.contains_key("curve") || draft.first_of(&setpoint_rules::PATHS).is_some();
    let usual = if searches { Steady::Search } else { Steady::Wait };
    let run = output::run(document.get("run"), usual, &mut draft);
    let checked = curve_section::check(document.get("run"), &run, &sweep);
    draft.faults.take(checked);
    let checked = setpoint_rules::check(document.get("run"), &run, &sweep, &draft);
    draft.faults.take(checked);
    let instances = known.then(|| sweep.len());
    let mut output = output::output(document.get("output"), &run, instances, &mut draft.faults);
    // The gap is what a set-point leads to.
    if draft.params.approach.held.is_some() && !output.observables.contains(&Observable::Gap) {
        output.observables.push(Observable::Gap);
    }
    if !draft.faults.is_empty() {
        return Err(draft.faults);
    }
    let stem = || path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Scene {
        path: path.to_path_buf(),
        source: source.to_string(),
        title: title.unwrap_or_else(stem),
        base: draft.params,
        sweep,
        run,
        output,
        lever: draft.lever.map(|(lever, _)| lever),
        drawn: draft.drawn,
        said: draft.said,
    })
}

impl Draft {
    pub fn say(&mut self, path: String, key: Range<usize>) {
        self.said.push(Said { path, key, swept: false });
    }

    /// Reads what is simulated: all sections but `[run]` and `[output]`.
    fn instance(&mut self, document: &DeTable) -> SweptAxes {
        if let Some(value) = document.get("instrument") {
            self.instrument(value);
        }
        if let Some(table) = self.section(document, "sample", &["bonded"])
            && let Some((key, value)) = table.get_key_value("bonded")
            && let Some(bonded) = self.faults.take(values::flag(value, BONDED))
        {
            self.params.sample.bonded = bonded;
            self.say(BONDED.to_owned(), key.span());
        }
        if let Some(table) =
            self.section(document, "contact", &["law", "viscosity_model", "table", "outside"])
        {
            if let Some(law) = self.choice(table, "contact.law", LawChoice::WORDS) {
                self.params.contact.law = law;
            }
            if let Some(model) = self.choice(table, VISCOSITY_MODEL, &VISCOUS) {
                self.params.contact.viscosity_model = model;
            }
            if let Some((key, value)) = table.get_key_value("outside") {
                let read = self.outside(key, value);
                self.faults.take(read);
            }
            if let Some((key, value)) = table.get_key_value("table") {
                let read = self.table(key, value);
                self.faults.take(read);
            }
        }
        if let Some(table) = self.section(document, "drive", &["on"])
            && let Some(on) = self.choice(table, "drive.on", &DRIVE_ON)
        {
            self.params.drive.on = on;
        }
        if let Some(table) = self.section(document, "approach", &["setpoint_branch", "setpoint_of"]) {
            self.params.approach.branch = self.choice(table, "approach.setpoint_branch", &BRANCHES_HELD);
            self.params.approach.of =
                self.choice(table, "approach.setpoint_of", &SETPOINTS_OF).unwrap_or_default();
        }
        let mut sweep = sweep_section::read(document, self);
        design_section::read(document, &mut sweep, self);
        curve_section::read(document, &mut sweep, self);
        sweep
    }

    /// Reads the word of a section's choice.
    fn choice<T: Copy>(&mut self, table: &DeTable, path: &str, words: &[(&str, T)]) -> Option<T> {
        let (key, value) = table.get_key_value(path.rsplit('.').next().unwrap_or(path))?;
        let word = self.faults.take(values::keyword(value, path, words))?;
        self.say(path.to_string(), key.span());
        Some(word)
    }

    /// Reads the quantities of one section of `parent`; keys in `special` are left to the caller.
    fn section<'a, 'i>(
        &mut self,
        parent: &'a DeTable<'i>,
        section: &str,
        special: &[&str],
    ) -> Option<&'a DeTable<'i>> {
        let name = section.rsplit('.').next().unwrap_or(section);
        let table = values::table(parent.get(name)?, section, &format!("a section [{section}]"));
        let table = self.faults.take(table)?;
        for (key, value) in table {
            if !special.contains(&key.get_ref().as_ref()) {
                let read = self.entry(key, value, section, special);
                self.faults.take(read);
            }
        }
        Some(table)
    }

    /// Reads one quantity of a section.
    fn entry(&mut self, key: &Key, value: &Value, section: &str, special: &[&str]) -> Checked<()> {
        let path = format!("{section}.{}", key.get_ref());
        let mut known = keys_of(section);
        // A quoted key with points in it could name an indexed quantity, which no section has.
        let address = Address::find(&path).filter(|_| known.contains(&key.get_ref().as_ref()));
        let Some(address) = address else {
            known.extend(special);
            return Err(values::unknown_key(key, section, &known));
        };
        if path == "drive.frequency" && value.get_ref().as_str() == Some("resonance") {
            self.params.drive.frequency = DriveFrequency::Resonance;
        } else if path == "instrument.cantilever.quality_factor" && value.get_ref().is_array() {
            self.params.instrument.cantilever.quality_factor = quality_factors(value, &path)?;
        } else {
            let number = values::quantity(value, address, &path).map_err(|fault| match path.as_str() {
                "drive.frequency" => fault
                    .maybe_help(resonance_meant(value).then(|| "did you mean \"resonance\"?".to_string())),
                _ => fault,
            })?;
            address.set(&mut self.params, number);
        }
        self.say(path, key.span());
        Ok(())
    }

    fn instrument(&mut self, value: &Value) {
        const KEYS: [&str; 4] = ["preset", "actuator", "cantilever", "tip"];
        let table = values::table(value, "instrument", "a section [instrument]");
        let Some(table) = self.faults.take(table) else { return };
        for key in table.keys().filter(|key| !KEYS.contains(&key.get_ref().as_ref())) {
            self.faults.push(*values::unknown_key(key, "instrument", &KEYS));
        }
        if let Some((key, value)) = table.get_key_value("preset") {
            let named = values::keyword(value, "instrument.preset", &levers::presets());
            if let Some(Some(lever)) = self.faults.take(named) {
                lever.put(&mut self.params.instrument);
                self.lever = Some((lever, key.span()));
            }
        }
        let paper = table.contains_key("preset") && self.lever.is_none();
        self.names_rod = paper || table.contains_key("actuator");
        if let Some(table) = self.section(table, "instrument.actuator", &["model"])
            && let Some(model) = self.choice(table, "instrument.actuator.model", &MODELS)
        {
            self.params.instrument.actuator.model = model;
        }
        if let Some(table) = self.section(table, "instrument.cantilever", &["modes"])
            && let Some((key, value)) = table.get_key_value("modes")
        {
            let read = self.modes(key, value);
            self.faults.take(read);
        }
        if let Some(table) = self.section(table, "instrument.tip", &["shape"])
            && let Some(shape) = self.choice(table, TIP_SHAPE, TipShape::WORDS)
        {
            self.params.instrument.tip.shape = shape;
        }
    }

    fn modes(&mut self, key: &Key, value: &Value) -> Checked<()> {
        const PATH: &str = "instrument.cantilever.modes";
        const KEYS: [&str; 4] = ["stiffness", "frequency", "quality_factor", "drive"];
        const FORM: &str =
            "a list such as [{ stiffness = \"2 N/m\", frequency = \"70 kHz\", quality_factor = 100 }]";
        let list = values::list(value, PATH, FORM)?;
        if list.len() > MOST_MODES {
            return Err(too_many_modes(value, PATH, list.len()));
        }
        self.say(PATH.to_string(), key.span());
        // Stiffness and frequency have no default; the rules refuse a mode that lacks one of them.
        let blank =
            LeverMode { stiffness: f64::NAN, frequency: f64::NAN, quality_factor: f64::INFINITY, drive: 1.0 };
        // Where the file says two things about the lever, the rules report it; until then the modes win.
        self.params.instrument.cantilever.lever = LeverSpec::Modes(vec![blank; list.len()]);
        for (index, mode) in list.iter().enumerate() {
            self.modes.push(mode.span());
            for (key, value) in values::table(mode, &format!("{PATH}.{index}"), FORM)? {
                let path = format!("{PATH}.{index}.{}", key.get_ref());
                let read = match Address::find(&path) {
                    None => Err(values::unknown_key(key, &format!("{PATH}.{index}"), &KEYS)),
                    Some(address) => values::quantity(value, address, &path).map(|value| (address, value)),
                };
                if let Some((address, value)) = self.faults.take(read) {
                    address.set(&mut self.params, value);
                    self.say(path, key.span());
                }
            }
        }
        Ok(())
    }
}

fn quality_factors(value: &Value, path: &str) -> Checked<QualityFactor> {
    let list = values::list(value, path, "a number, inf, or a list of them, first mode first")?;
    if list.len() > MOST_MODES {
        return Err(too_many_modes(value, path, list.len()));
    }
    let read = |(index, value): (usize, &Value)| {
        let path = format!("{path}.{index}");
        match Address::find(&path) {
            Some(address) => values::quantity(value, address, &path),
            None => Err(Fault::at(value.span(), format!("`{path}` is not a quantity"))),
        }
    };
    Ok(QualityFactor::PerMode(list.iter().enumerate().map(read).collect::<Checked<_>>()?))
}

fn too_many_modes(value: &Value, path: &str, count: usize) -> Box<Fault> {
    Fault::at(value.span(), format!("`{path}` lists too many modes"))
        .label(format!("found {count}"))
        .expected(format!("at most {MOST_MODES}"))
        .help("keep the lowest ones")
}

fn resonance_meant(value: &Value) -> bool {
    value.get_ref().as_str().is_some_and(|text| crate::suggestion::nearest(text, ["resonance"]).is_some())
}
