//! The schema's parts for uncertain quantities and designs.

use super::design::{KEYS, LEVELS, MOST_LEVELS};
use super::quantity::Quantity;
use super::schema::{named, object, told};
use super::sweep::MOST_INSTANCES;
use super::uncertain::SIGMAS;
use crate::design::Kind;
use serde_json::{Map, Value, json};

/// A distribution of a quantity.
pub(super) fn distribution(quantity: &Quantity) -> Value {
    let percent = json!({ "type": "string", "pattern": r"^\s*(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*%\s*$" });
    let sigma = json!({ "type": "number", "minimum": SIGMAS.0, "maximum": SIGMAS.1 });
    // Of a spread only the unit counts: that of the quantity, or a share of the mean.
    let spread = json!({ "anyOf": [percent, { "type": ["string", "number"] }] });
    let of = |word: &str, keys: &[&str], free: &[&str]| {
        let mut properties = Map::new();
        properties.insert("distribution".into(), json!({ "const": word }));
        for key in keys.iter().chain(free) {
            let value = match *key {
                "sd" => spread.clone(),
                "sigma" => sigma.clone(),
                _ => named(quantity),
            };
            properties.insert((*key).into(), value);
        }
        let mut required = vec!["distribution"];
        required.extend(keys);
        json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
    };
    json!({ "anyOf": [
        of("normal", &["mean", "sd"], &["from", "to"]),
        of("uniform", &["from", "to"], &[]),
        of("lognormal", &["median", "sigma"], &["from", "to"]),
        of("loguniform", &["from", "to"], &[]),
        of("triangular", &["from", "mode", "to"], &[]),
    ] })
}

/// `[design]`.
pub(super) fn design(describe: &dyn Fn(&str) -> String) -> Value {
    let whole = |least: u64, most: u64| json!({ "type": "integer", "minimum": least, "maximum": most });
    let path = || json!({ "type": "string", "minLength": 1 });
    let list = |items: Value| json!({ "type": "array", "minItems": 1, "items": items });
    let mut properties = Map::new();
    for (key, _) in KEYS {
        let value = match key {
            "kind" => json!({ "type": "string", "enum": Kind::WORDS.map(|(word, _)| word) }),
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
pub(super) fn samples(lists: Value) -> Value {
    let file = json!({
        "type": "object",
        "properties": {
            "file": { "type": "string", "minLength": 1 },
            "names": { "type": "array", "minItems": 1, "items": { "type": "string" } },
        },
        "required": ["file"],
        "additionalProperties": false,
    });
    json!({ "anyOf": [lists, file] })
}
