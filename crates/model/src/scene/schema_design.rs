//! The schema's parts for uncertain quantities and designs.

use super::axes::MOST_INSTANCES;
use super::design_section::{KEYS, LEVELS, MOST_LEVELS};
use super::schema_parts::{object, told};
use super::uncertain_section::{KEYS as DISTRIBUTIONS, SIGMAS};
use crate::design::DesignKind;
use serde_json::{Map, Value, json};

/// The name of the definition of distributions.
pub(super) const DISTRIBUTION: &str = "distribution";

/// A distribution of any quantity. The units of its values only reading can judge.
pub(super) fn distribution() -> Value {
    let any = json!({ "type": ["string", "number"] });
    let sigma = json!({ "type": "number", "minimum": SIGMAS.0, "maximum": SIGMAS.1 });
    let of = |(word, keys): (&str, &[&str])| {
        let mut properties = Map::new();
        properties.insert(DISTRIBUTION.into(), json!({ "const": word }));
        for key in keys {
            let value = if *key == "sigma" { sigma.clone() } else { any.clone() };
            properties.insert((*key).into(), value);
        }
        let cut = ["normal", "lognormal"].contains(&word);
        let needed = keys.iter().filter(|key| !(cut && ["from", "to"].contains(key)));
        let required: Vec<&str> = [DISTRIBUTION].into_iter().chain(needed.copied()).collect();
        json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
    };
    json!({ "anyOf": DISTRIBUTIONS.map(of) })
}

/// `[design]`.
pub(super) fn design(describe: &dyn Fn(&str) -> String) -> Value {
    let whole = |least: u64, most: u64| json!({ "type": "integer", "minimum": least, "maximum": most });
    let path = || json!({ "type": "string", "minLength": 1 });
    let list = |items: Value| json!({ "type": "array", "minItems": 1, "items": items });
    let mut properties = Map::new();
    for (key, _) in KEYS {
        let value = match key {
            "kind" => json!({ "type": "string", "enum": DesignKind::WORDS.map(|(word, _)| word) }),
            "samples" => whole(1, MOST_INSTANCES as u64),
            "replicates" => whole(1, 1024),
            "seed" => json!({ "type": "integer", "minimum": 0, "default": 0 }),
            "correlation" => list(json!({
                "type": "array",
                "items": [path(), path(), { "type": "number", "minimum": -1, "maximum": 1 }],
                "minItems": 3,
                "maxItems": 3,
            })),
            "groups" => list(list(path())),
            "scramble" => json!({ "type": "boolean", "default": true }),
            "second_order" => json!({ "type": "boolean", "default": false }),
            "levels" => json!({ "type": "integer", "minimum": 2, "maximum": MOST_LEVELS, "default": LEVELS }),
            "names" => list(path()),
            _ => path(),
        };
        properties.insert(key.into(), told(value, &describe(&format!("design.{key}"))));
    }
    let mut design = object(properties);
    design["required"] = json!(["kind"]);
    design
}

/// `[samples]`: lists, or a file of them.
pub(super) fn samples(mut lists: Value) -> Value {
    lists["properties"]["file"] = json!({ "type": "string", "minLength": 1 });
    lists["properties"]["names"] = json!({ "type": "array", "minItems": 1, "items": { "type": "string" } });
    lists["dependencies"] = json!({ "names": ["file"] });
    lists
}
