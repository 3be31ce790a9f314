//! The JSON schema of scene files, made from the tables that reading goes by.
//!
//! Editors complete keys and show units by it. It is draft 7, which TOML editors know. Rules between keys are not in it.

use super::address::Address;
use super::axis_zip::LABEL;
use super::curve_section;
use super::levers;
use super::output::{ALL, BRANCHES, KEYS, SPECTRUM_KEYS, STARTS, WAVEFORM_KEYS, WAYS};
use super::params::{LawChoice, Params};
use super::paths::LAW;
use super::quantities::QUANTITIES;
use super::quantity::{Domain, Quantity};
use super::scene_reader::{BRANCHES_HELD, DRIVE_ON, MODELS, MOST_MODES, SECTIONS, SETPOINTS_OF};
use super::schema_parts::{object, told};
use super::{STEPPED_MODES, schema_design};
use crate::observe::Observable;
use crate::units::Dimension;
use serde_json::{Map, Value, json};

/// Decimal digits of a size with at most one point, and an exponent.
const SIZE: &str = r"(\d+\.?\d*|\.\d+)([eE][-+\u2212]?\d+)?";
/// The prefixes of units.
const PREFIX: &str = "[yzafpnu\u{b5}\u{3bc}mckMGTPE]?";

/// The schema. `describe` tells what the key of a path means, as the documents have it.
pub fn schema(describe: &dyn Fn(&str) -> String) -> Value {
    let mut sections = Map::new();
    let home = |name: &str| Section { name, describe }.object();
    for name in SECTIONS {
        let value = match name {
            "title" => json!({ "type": "string" }),
            "instrument" => instrument(describe),
            "sweep" => sweep(),
            "samples" => schema_design::samples(varied(&listed)),
            "uncertain" => {
                varied(&|_| json!({ "$ref": format!("#/definitions/{}", schema_design::DISTRIBUTION) }))
            }
            "design" => schema_design::design(describe),
            "curve" => curve(),
            "run" => run(describe),
            "output" => output(describe),
            other => home(other),
        };
        sections.insert(name.into(), told(value, &describe(name)));
    }
    let definition = |quantity: &'static Quantity| {
        let value = with_default(one(quantity), quantity);
        (name(quantity), told(value, &describe(quantity.path)))
    };
    let mut definitions: Map<String, Value> = QUANTITIES.iter().map(definition).collect();
    definitions.insert(schema_design::DISTRIBUTION.into(), schema_design::distribution());
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of afmsweep",
        "description": "What oscillates over which sample, what varies, and what is measured.",
        "type": "object",
        "properties": sections,
        "additionalProperties": false,
        "definitions": definitions,
    })
}

/// One of these words.
fn word<T>(words: &[(&str, T)]) -> Value {
    let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    json!({ "type": "string", "enum": words })
}

/// A section of quantities, with the choices among them.
struct Section<'a> {
    name: &'a str,
    describe: &'a dyn Fn(&str) -> String,
}

impl Section<'_> {
    fn properties(&self) -> Map<String, Value> {
        let mut properties = Map::new();
        for quantity in QUANTITIES {
            let Some((home, key)) = quantity.path.rsplit_once('.') else { continue };
            if home == self.name && key != "#" {
                let value = match quantity.path {
                    "drive.frequency" => json!({ "anyOf": [named(quantity), { "const": "resonance" }] }),
                    "instrument.cantilever.quality_factor" => {
                        let list = json!({
                            "type": "array",
                            "minItems": 1,
                            "maxItems": MOST_MODES,
                            "items": named(quantity),
                        });
                        json!({ "anyOf": [named(quantity), list] })
                    }
                    _ => named(quantity),
                };
                properties.insert(key.into(), value);
            }
        }
        let choices = match self.name {
            "instrument.actuator" => vec![("model", word(&MODELS))],
            "contact" => vec![("law", word(LawChoice::WORDS))],
            "drive" => vec![("on", word(&DRIVE_ON))],
            "approach" => {
                vec![("setpoint_branch", word(&BRANCHES_HELD)), ("setpoint_of", word(&SETPOINTS_OF))]
            }
            _ => Vec::new(),
        };
        for (key, value) in choices {
            properties.insert(key.into(), told(value, &(self.describe)(&format!("{}.{key}", self.name))));
        }
        properties
    }

    fn object(&self) -> Value {
        object(self.properties())
    }
}

fn instrument(describe: &dyn Fn(&str) -> String) -> Value {
    let mut properties = Map::new();
    let preset = word(&levers::presets());
    properties.insert("preset".into(), told(preset, &describe("instrument.preset")));
    for name in ["instrument.actuator", "instrument.cantilever", "instrument.tip"] {
        let mut entries = Section { name, describe }.properties();
        if name == "instrument.cantilever" {
            let mode = Section { name: "instrument.cantilever.modes.#", describe }.properties();
            let mode = json!({
                "type": "object",
                "properties": mode,
                "additionalProperties": false,
            });
            let modes = json!({ "type": "array", "minItems": 1, "maxItems": MOST_MODES, "items": mode });
            entries.insert("modes".into(), told(modes, &describe("instrument.cantilever.modes")));
        }
        let key = name.rsplit('.').next().unwrap_or(name);
        properties.insert(key.into(), told(object(entries), &describe(name)));
    }
    object(properties)
}

/// Quantities by their paths, each with what `form` makes of its values.
fn varied(form: &dyn Fn(&Quantity) -> Value) -> Value {
    let (mut named, mut indexed) = (Map::new(), Map::new());
    for quantity in QUANTITIES {
        let value = form(quantity);
        match quantity.path.contains('#') {
            true => {
                let pattern = quantity.path.replace('.', r"\.").replace('#', "(0|[1-9][0-9]*)");
                indexed.insert(format!("^{pattern}$"), value)
            }
            false => named.insert(quantity.path.into(), value),
        };
    }
    json!({
        "type": "object",
        "properties": named,
        "patternProperties": indexed,
        "additionalProperties": false,
        "minProperties": 1,
    })
}

/// Axes of quantities and of contact laws, and quantities that vary together under a name of their own.
fn sweep() -> Value {
    let mut sweep = varied(&axis);
    let mut together = varied(&listed);
    let laws =
        json!({ "type": "array", "minItems": 1, "uniqueItems": true, "items": word(LawChoice::WORDS) });
    together["properties"][LAW] = json!({ "type": "array", "minItems": 1, "items": word(LawChoice::WORDS) });
    together["properties"][LABEL] = json!({
        "type": "array",
        "minItems": 1,
        "uniqueItems": true,
        "items": { "type": "string", "minLength": 1 },
    });
    together["minProperties"] = json!(1);
    together["not"] = json!({ "required": [LABEL], "maxProperties": 1 });
    sweep["properties"][LAW] = json!({
        "type": "object",
        "properties": { "values": laws },
        "required": ["values"],
        "additionalProperties": false,
    });
    sweep["patternProperties"]["^[a-z][a-z0-9_]*$"] = together;
    sweep
}

/// An axis of a grid: from one end to the other, or value by value.
fn axis(quantity: &Quantity) -> Value {
    let range = json!({
        "type": "object",
        "properties": {
            "from": named(quantity),
            "to": named(quantity),
            "points": { "type": "integer", "minimum": 2 },
            "scale": { "type": "string", "enum": ["lin", "log"] },
        },
        "required": ["from", "to", "points"],
        "additionalProperties": false,
    });
    let values = json!({
        "type": "object",
        "properties": { "values": listed(quantity) },
        "required": ["values"],
        "additionalProperties": false,
    });
    json!({ "anyOf": [range, values] })
}

/// An axis of one quantity of several, and its direction.
fn curve() -> Value {
    let quantities = || QUANTITIES.iter().filter(|one| curve_section::QUANTITIES.contains(&one.path));
    let paths: Vec<&str> = quantities().map(|one| one.path).collect();
    let any = || json!({ "anyOf": quantities().map(named).collect::<Vec<Value>>() });
    json!({
        "type": "object",
        "properties": {
            "quantity": { "type": "string", "enum": paths },
            "from": any(),
            "to": any(),
            "points": { "type": "integer", "minimum": 2 },
            "scale": { "type": "string", "enum": ["lin", "log"] },
            "values": { "type": "array", "minItems": 1, "items": any() },
            "direction": word(&curve_section::DIRECTIONS),
        },
        "required": ["quantity"],
        "oneOf": [{ "required": ["from", "to", "points"] }, { "required": ["values"] }],
        "additionalProperties": false,
    })
}

fn listed(quantity: &Quantity) -> Value {
    json!({ "type": "array", "minItems": 1, "items": named(quantity) })
}

/// A reference to what values of a quantity are.
fn named(quantity: &Quantity) -> Value {
    json!({ "$ref": format!("#/definitions/{}", name(quantity)) })
}

/// Its name among the definitions: an index has a letter, for the sign is taken in references.
fn name(quantity: &Quantity) -> String {
    quantity.path.replace('#', "N")
}

/// What values of a quantity are.
fn one(quantity: &Quantity) -> Value {
    if quantity.dimension == Dimension::Dimensionless {
        return number(quantity.domain);
    }
    let sign = if quantity.domain == Domain::Finite { "[-+\u{2212}]?" } else { r"\+?" };
    let size = format!(r"^\s*{sign}{SIZE}\s*({})\s*$", units(quantity.dimension));
    let text = json!({ "type": "string", "pattern": size, "examples": [example(quantity.dimension)] });
    match quantity.domain {
        Domain::PositiveOrInfinite => json!({ "anyOf": [text, infinite()] }),
        _ => text,
    }
}

fn example(dimension: Dimension) -> String {
    dimension.example().trim_matches('"').to_owned()
}

/// A number without unit.
fn number(domain: Domain) -> Value {
    match domain {
        Domain::Finite => json!({ "type": "number" }),
        Domain::NonNegative => json!({ "type": "number", "minimum": 0 }),
        Domain::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Domain::SetPoint => json!({ "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 360 }),
        Domain::PoissonRatio => json!({ "type": "number", "exclusiveMinimum": -1, "maximum": 0.5 }),
        Domain::QualityFactor | Domain::PositiveOrInfinite => {
            let least = if domain == Domain::QualityFactor { 0.5 } else { 0.0 };
            json!({ "anyOf": [{ "type": "number", "exclusiveMinimum": least }, infinite()] })
        }
    }
}

/// `inf`, as a number or a text.
fn infinite() -> Value {
    json!({ "anyOf": [
        { "type": "string", "pattern": r"^\s*\+?inf(\s.*)?$" },
        { "type": "number", "exclusiveMinimum": f64::MAX },
    ] })
}

/// Units of a dimension: its symbol with a prefix, or any expression of several, which only reading can judge.
fn units(dimension: Dimension) -> String {
    let expression = r"[^\s\d][^\s]*[\^/\u00b2\u00b3*\u00b7].*|[^\s\d]+\s+[^\s\d].*";
    match dimension {
        Dimension::Length => format!("{PREFIX}m|\u{c5}|\u{212b}|angstrom|{expression}"),
        Dimension::Time => format!("{PREFIX}s|{expression}"),
        Dimension::Mass => format!("{PREFIX}g|{expression}"),
        Dimension::Frequency => format!("{PREFIX}Hz|{expression}"),
        Dimension::Force => format!("{PREFIX}N|{expression}"),
        Dimension::Pressure => format!("{PREFIX}(Pa|bar)|{expression}"),
        Dimension::Energy => format!("{PREFIX}J|{expression}"),
        Dimension::Voltage => format!("{PREFIX}V|{expression}"),
        _ => expression.to_owned(),
    }
}

/// With the preset's value, where there is one.
fn with_default(mut value: Value, quantity: &'static Quantity) -> Value {
    let address = Address { quantity, index: 0 };
    let preset = address.get(&Params::default()).filter(|number| number.is_finite());
    if let (Some(number), Some(object)) = (preset, value.as_object_mut()) {
        let written = address.written(number);
        let default: Value = serde_json::from_str(&written).unwrap_or_else(|_| written.into());
        object.insert("default".into(), default);
    }
    value
}

fn run(describe: &dyn Fn(&str) -> String) -> Value {
    let whole = |least: u64, most: u64| json!({ "type": "integer", "minimum": least, "maximum": most });
    let mut properties = Map::new();
    for key in KEYS {
        let value = match key {
            "start" => word(&STARTS),
            "steady" => word(&WAYS),
            "branches" => word(&BRANCHES),
            "accuracy" => json!({ "type": "number", "minimum": 1e-9, "maximum": 0.5, "default": 1e-3 }),
            "modes" => whole(1, STEPPED_MODES as u64),
            "steps_per_period" => whole(16, 1_000_000),
            _ => whole(1, u64::from(u32::MAX)),
        };
        properties.insert(key.into(), told(value, &describe(&format!("run.{key}"))));
    }
    object(properties)
}

fn output(describe: &dyn Fn(&str) -> String) -> Value {
    let names: Vec<&str> = Observable::all().map(Observable::name).collect();
    let observables = json!({
        "type": "array",
        "minItems": 1,
        "uniqueItems": true,
        "items": { "type": "string", "enum": names },
    });
    let mut properties = Map::new();
    properties.insert("observables".into(), told(observables, &describe("output.observables")));
    for (name, keys) in [("waveforms", &WAVEFORM_KEYS[..]), ("spectra", &SPECTRUM_KEYS[..])] {
        properties.insert(name.into(), of_instances(name, keys, describe));
    }
    object(properties)
}

/// A table of `[output]` that lists instances.
fn of_instances(name: &str, keys: &[&str], describe: &dyn Fn(&str) -> String) -> Value {
    let mut entries = Map::new();
    for key in keys {
        let value = match *key {
            "instances" => json!({ "anyOf": [
                { "const": ALL },
                {
                    "type": "array",
                    "minItems": 1,
                    "uniqueItems": true,
                    "items": { "type": "integer", "minimum": 0 },
                },
            ] }),
            "samples_per_period" => json!({ "type": "integer", "minimum": 2, "maximum": 65_536 }),
            _ => json!({ "type": "integer", "minimum": 1 }),
        };
        entries.insert((*key).into(), told(value, &describe(&format!("output.{name}.{key}"))));
    }
    let mut table = object(entries);
    if let Some(object) = table.as_object_mut() {
        object.insert("required".into(), json!(["instances"]));
    }
    told(table, &describe(&format!("output.{name}")))
}
