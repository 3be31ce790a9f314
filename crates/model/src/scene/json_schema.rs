//! Forms of a JSON schema.

use serde_json::{Map, Value, json};

/// A table with these entries and no others.
pub(super) fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Likewise, these of them needed.
pub(super) fn with_required(properties: Map<String, Value>, required: &[&str]) -> Value {
    let mut object = object(properties);
    object["required"] = json!(required);
    object
}

/// A list that is not empty.
pub(super) fn list(items: Value) -> Value {
    json!({ "type": "array", "minItems": 1, "items": items })
}

/// Likewise, no entry twice.
pub(super) fn unique(items: Value) -> Value {
    json!({ "type": "array", "minItems": 1, "uniqueItems": true, "items": items })
}

pub(super) fn whole(least: u64, most: u64) -> Value {
    json!({ "type": "integer", "minimum": least, "maximum": most })
}

/// A text that is not empty.
pub(super) fn text() -> Value {
    json!({ "type": "string", "minLength": 1 })
}

/// One of these words.
pub(super) fn word<T>(words: &[(&str, T)]) -> Value {
    let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    json!({ "type": "string", "enum": words })
}
