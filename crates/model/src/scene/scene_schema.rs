//! The JSON schema of scene files, made from the tables that reading goes by.
//!
//! Editors complete keys and show units by it. It is draft 7, which TOML editors know. Rules between keys are not in it.

use super::address::Address;
use super::axes::MOST_INSTANCES;
use super::axis_zip::LABEL;
use super::design_section::{KEYS as DESIGN_KEYS, LEVELS, MOST_LEVELS};
use super::json_schema::{list, object, text, unique, whole, with_required, word};
use super::levers;
use super::output::{ALL, BRANCHES, KEYS, OUTPUT_KEYS, SPECTRUM_KEYS, STARTS, WAVEFORM_KEYS, WAYS};
use super::params::{LawChoice, NeckModel, OutsideForce, Params, TipShape};
use super::paths::LAW;
use super::quantities::QUANTITIES;
use super::quantity::{Domain, Quantity};
use super::scene_reader::{BRANCHES_HELD, DRIVE_ON, MODELS, MOST_MODES, SECTIONS, SETPOINTS_OF, VISCOUS};
use super::uncertain_section::{KEYS as DISTRIBUTIONS, SIGMAS};
use super::{STEPPED_MODES, curve_section, outside_section};
use crate::design::DesignKind;
use crate::kernel::contact::TERMS;
use crate::kernel::contact::force_table::KNOTS;
use crate::observe::Observable;
use crate::units::Dimension;
use serde_json::{Map, Value, json};

/// Decimal digits of a size with at most one point, and an exponent.
const SIZE: &str = r"(\d+\.?\d*|\.\d+)([eE][-+\u2212]?\d+)?";
/// The prefixes of units.
const PREFIX: &str = "[yzafpnu\u{b5}\u{3bc}mckMGTPE]?";
/// The name of the definition of distributions.
const DISTRIBUTION: &str = "distribution";

/// The schema. `describe` tells what the key of a path means, as the documents have it.
pub fn schema(describe: &dyn Fn(&str) -> String) -> Value {
    let texts = Texts(describe);
    let section = |name: &'static str| {
        let value = match name {
            "title" => json!({ "type": "string" }),
            "instrument" => texts.instrument(),
            "sweep" => sweep(),
            "samples" => samples(),
            "uncertain" => varied(&|_| json!({ "$ref": format!("#/definitions/{DISTRIBUTION}") })),
            "design" => texts.design(),
            "curve" => curve(),
            "run" => texts.run(),
            "output" => texts.output(),
            other => object(texts.quantities(other)),
        };
        (name.to_owned(), texts.told(value, name))
    };
    let definition = |quantity: &'static Quantity| {
        (name(quantity), texts.told(with_default(one(quantity), quantity), quantity.path))
    };
    let mut definitions: Map<String, Value> = QUANTITIES.iter().map(definition).collect();
    definitions.insert(DISTRIBUTION.into(), distribution());
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of afmsweep",
        "description": "What oscillates over which sample, what varies, and what is measured.",
        "type": "object",
        "properties": SECTIONS.into_iter().map(section).collect::<Map<String, Value>>(),
        "additionalProperties": false,
        "definitions": definitions,
    })
}

/// What the keys of paths mean.
struct Texts<'a>(&'a dyn Fn(&str) -> String);

impl Texts<'_> {
    /// With the description of that path, if there is one.
    fn told(&self, mut value: Value, path: &str) -> Value {
        let text = (self.0)(path);
        if let (Some(object), false) = (value.as_object_mut(), text.is_empty()) {
            object.insert("description".into(), text.into());
        }
        value
    }

    /// The entries of a section, each with its description.
    fn entries<'k>(
        &self,
        section: &str,
        all: impl IntoIterator<Item = (&'k str, Value)>,
    ) -> Map<String, Value> {
        let entry =
            |(key, value): (&str, Value)| (key.to_owned(), self.told(value, &format!("{section}.{key}")));
        all.into_iter().map(entry).collect()
    }

    /// Likewise, what each key may have.
    fn keys<'k>(
        &self,
        section: &str,
        keys: impl IntoIterator<Item = &'k str>,
        value: impl Fn(&str) -> Value,
    ) -> Map<String, Value> {
        self.entries(section, keys.into_iter().map(|key| (key, value(key))))
    }

    /// The quantities of a section, with the choices among them.
    fn quantities(&self, section: &str) -> Map<String, Value> {
        let choices = match section {
            "instrument.actuator" => vec![("model", word(&MODELS))],
            "contact" => {
                vec![
                    ("law", word(LawChoice::WORDS)),
                    ("viscosity_model", word(&VISCOUS)),
                    ("table", json!({ "anyOf": [text(), force_lists()] })),
                    ("outside", self.outside()),
                ]
            }
            "sample" => vec![("bonded", json!({ "type": "boolean" }))],
            "instrument.tip" => vec![("shape", word(TipShape::WORDS))],
            "drive" => vec![("on", word(&DRIVE_ON))],
            "approach" => {
                vec![("setpoint_branch", word(&BRANCHES_HELD)), ("setpoint_of", word(&SETPOINTS_OF))]
            }
            "instrument.cantilever" => {
                let mode = object(self.quantities("instrument.cantilever.modes.#"));
                vec![("modes", up_to_most_modes(mode))]
            }
            _ => Vec::new(),
        };
        let own = QUANTITIES.iter().filter_map(|quantity| {
            let (home, key) = quantity.path.rsplit_once('.')?;
            let value = match quantity.path {
                "drive.frequency" => json!({ "anyOf": [named(quantity), { "const": "resonance" }] }),
                "instrument.cantilever.quality_factor" => {
                    json!({ "anyOf": [named(quantity), up_to_most_modes(named(quantity))] })
                }
                _ => named(quantity),
            };
            (home == section && key != "#").then(|| (key.to_owned(), value))
        });
        own.chain(self.entries(section, choices)).collect()
    }

    fn instrument(&self) -> Value {
        let parts = ["actuator", "cantilever", "tip"];
        let part = |key| (key, object(self.quantities(&format!("instrument.{key}"))));
        let preset = [("preset", word(&levers::presets()))];
        object(self.entries("instrument", preset.into_iter().chain(parts.map(part))))
    }

    /// `[[contact.outside]]`: each force with its own keys.
    fn outside(&self) -> Value {
        let force = |(word, force): &(&str, OutsideForce)| {
            let (known, _) = outside_section::keys(force);
            let all = self.quantities("contact.outside.#");
            let own = all.into_iter().filter(|(key, _)| known.contains(&key.as_str()));
            let model = force.remembers().then(|| ("model".to_owned(), self::word(&NeckModel::WORDS)));
            let properties =
                own.chain([("force".to_owned(), json!({ "const": word }))]).chain(model).collect();
            with_required(properties, &["force"])
        };
        let forces: Vec<Value> = OutsideForce::WORDS.iter().map(force).collect();
        json!({ "type": "array", "minItems": 1, "maxItems": TERMS, "items": { "anyOf": forces } })
    }

    fn design(&self) -> Value {
        let value = |key: &str| match key {
            "kind" => word(&DesignKind::WORDS),
            "samples" => whole(1, MOST_INSTANCES as u64),
            "replicates" => whole(1, 1024),
            "seed" => json!({ "type": "integer", "minimum": 0, "default": 0 }),
            "correlation" => list(json!({
                "type": "array",
                "items": [text(), text(), { "type": "number", "minimum": -1, "maximum": 1 }],
                "minItems": 3,
                "maxItems": 3,
            })),
            "groups" => list(list(text())),
            "scramble" => json!({ "type": "boolean", "default": true }),
            "second_order" => json!({ "type": "boolean", "default": false }),
            "levels" => json!({ "type": "integer", "minimum": 2, "maximum": MOST_LEVELS, "default": LEVELS }),
            "names" => list(text()),
            _ => text(),
        };
        with_required(self.keys("design", DESIGN_KEYS.map(|(key, _)| key), value), &["kind"])
    }

    fn run(&self) -> Value {
        object(self.keys("run", KEYS, |key| match key {
            "start" => word(&STARTS),
            "steady" => word(&WAYS),
            "branches" => word(&BRANCHES),
            "accuracy" => json!({ "type": "number", "minimum": 1e-9, "maximum": 0.5, "default": 1e-3 }),
            "modes" => whole(1, STEPPED_MODES as u64),
            "steps_per_period" => whole(16, 1_000_000),
            _ => whole(1, u64::from(u32::MAX)),
        }))
    }

    fn output(&self) -> Value {
        let names: Vec<&str> = Observable::all().map(Observable::name).collect();
        object(self.keys("output", OUTPUT_KEYS, |key| match key {
            "waveforms" => self.of_instances("output.waveforms", &WAVEFORM_KEYS),
            "spectra" => self.of_instances("output.spectra", &SPECTRUM_KEYS),
            _ => unique(json!({ "type": "string", "enum": names })),
        }))
    }

    /// A table of `[output]` that lists instances.
    fn of_instances(&self, section: &str, keys: &[&str]) -> Value {
        let value = |key: &str| match key {
            "instances" => {
                let numbers = unique(json!({ "type": "integer", "minimum": 0 }));
                json!({ "anyOf": [{ "const": ALL }, numbers] })
            }
            "samples_per_period" => whole(2, 65_536),
            _ => json!({ "type": "integer", "minimum": 1 }),
        };
        with_required(self.keys(section, keys.iter().copied(), value), &["instances"])
    }
}

/// A table of forces in lists.
fn force_lists() -> Value {
    let column = || json!({ "type": "array", "minItems": 4, "maxItems": KNOTS - 1, "items": text() });
    let of = |place: &str| {
        let columns = [place, "force", "force_retract"].map(|key| (key.to_owned(), column()));
        with_required(columns.into_iter().collect(), &[place, "force"])
    };
    json!({ "anyOf": [of("indentation"), of("distance")] })
}

/// A list with an entry for each mode of the lever at most.
fn up_to_most_modes(items: Value) -> Value {
    json!({ "type": "array", "minItems": 1, "maxItems": MOST_MODES, "items": items })
}

/// A distribution of any quantity. The units of its values only reading can judge.
fn distribution() -> Value {
    let of = |(word, keys): (&str, &[&str])| {
        let value = |key: &str| match key {
            "sigma" => json!({ "type": "number", "minimum": SIGMAS.0, "maximum": SIGMAS.1 }),
            _ => json!({ "type": ["string", "number"] }),
        };
        let values = keys.iter().map(|key| ((*key).to_owned(), value(key)));
        let properties = values.chain([(DISTRIBUTION.to_owned(), json!({ "const": word }))]).collect();
        let cut = ["normal", "lognormal"].contains(&word);
        let needed = keys.iter().copied().filter(|key| !(cut && ["from", "to"].contains(key)));
        with_required(properties, &[DISTRIBUTION].into_iter().chain(needed).collect::<Vec<_>>())
    };
    json!({ "anyOf": DISTRIBUTIONS.map(of) })
}

/// Quantities by their paths, each with what `form` makes of its values.
fn varied(form: &dyn Fn(&Quantity) -> Value) -> Value {
    let (indexed, named): (Vec<&Quantity>, Vec<_>) =
        QUANTITIES.iter().partition(|one| one.path.contains('#'));
    let pattern = |path: &str| format!("^{}$", path.replace('.', r"\.").replace('#', "(0|[1-9][0-9]*)"));
    let all = |quantities: Vec<&Quantity>, key: &dyn Fn(&str) -> String| -> Map<String, Value> {
        quantities.into_iter().map(|one| (key(one.path), form(one))).collect()
    };
    json!({
        "type": "object",
        "properties": all(named, &str::to_owned),
        "patternProperties": all(indexed, &pattern),
        "additionalProperties": false,
        "minProperties": 1,
    })
}

/// Axes of quantities and of contact laws, and quantities that vary together under a name of their own.
fn sweep() -> Value {
    let mut sweep = varied(&axis);
    let mut together = varied(&listed);
    together["properties"][LAW] = list(word(LawChoice::WORDS));
    together["properties"][LABEL] = unique(text());
    together["not"] = json!({ "required": [LABEL], "maxProperties": 1 });
    sweep["properties"][LAW] = values_alone(unique(word(LawChoice::WORDS)));
    sweep["patternProperties"]["^[a-z][a-z0-9_]*$"] = together;
    sweep
}

/// `[samples]`: lists, or a file of them.
fn samples() -> Value {
    let mut lists = varied(&listed);
    lists["properties"]["file"] = text();
    lists["properties"]["names"] = list(json!({ "type": "string" }));
    lists["dependencies"] = json!({ "names": ["file"] });
    lists
}

/// An axis value by value.
fn values_alone(values: Value) -> Value {
    with_required(Map::from_iter([("values".to_owned(), values)]), &["values"])
}

/// The entries of an axis from one end to the other.
fn range(end: Value) -> Map<String, Value> {
    let scale = word(&[("lin", ()), ("log", ())]);
    let points = json!({ "type": "integer", "minimum": 2 });
    let all = [("from", end.clone()), ("to", end), ("points", points), ("scale", scale)];
    all.map(|(key, value)| (key.to_owned(), value)).into_iter().collect()
}

/// An axis of a grid: from one end to the other, or value by value.
fn axis(quantity: &Quantity) -> Value {
    let range = with_required(range(named(quantity)), &["from", "to", "points"]);
    json!({ "anyOf": [range, values_alone(listed(quantity))] })
}

/// An axis of one quantity of several, and its direction.
fn curve() -> Value {
    let quantities = || QUANTITIES.iter().filter(|one| curve_section::QUANTITIES.contains(&one.path));
    let paths: Vec<&str> = quantities().map(|one| one.path).collect();
    let any = json!({ "anyOf": quantities().map(named).collect::<Vec<Value>>() });
    let mut curve = with_required(range(any.clone()), &["quantity"]);
    curve["properties"]["quantity"] = json!({ "type": "string", "enum": paths });
    curve["properties"]["values"] = list(any);
    curve["properties"]["direction"] = word(&curve_section::DIRECTIONS);
    curve["oneOf"] = json!([{ "required": ["from", "to", "points"] }, { "required": ["values"] }]);
    curve
}

fn listed(quantity: &Quantity) -> Value {
    list(named(quantity))
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
    let example = quantity.dimension.example().trim_matches('"');
    let text = json!({ "type": "string", "pattern": size, "examples": [example] });
    match quantity.domain {
        Domain::PositiveOrInfinite => json!({ "anyOf": [text, infinite()] }),
        _ => text,
    }
}

/// A number without unit.
fn number(domain: Domain) -> Value {
    match domain {
        Domain::Finite => json!({ "type": "number" }),
        Domain::NonNegative => json!({ "type": "number", "minimum": 0 }),
        Domain::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Domain::SetPoint | Domain::HalfAngle => {
            json!({ "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": domain.ends().1 })
        }
        Domain::PoissonRatio => json!({ "type": "number", "exclusiveMinimum": -1, "maximum": 0.5 }),
        Domain::QualityFactor | Domain::PositiveOrInfinite => {
            json!({ "anyOf": [{ "type": "number", "exclusiveMinimum": domain.ends().0 }, infinite()] })
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
    let symbol = match dimension {
        Dimension::Length => "m|\u{c5}|\u{212b}|angstrom",
        Dimension::Mass => "g",
        Dimension::Angle => return format!("deg|degree|\u{b0}|{expression}"),
        Dimension::Pressure => "(Pa|bar)",
        other if other.si_unit().chars().all(char::is_alphabetic) => other.si_unit(),
        _ => return expression.to_owned(),
    };
    format!("{PREFIX}{symbol}|{expression}")
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
