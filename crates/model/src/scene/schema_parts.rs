//! Pieces of the schema.

use serde_json::{Map, Value, json};

/// With a description, if there is one.
pub(super) fn told(mut value: Value, text: &str) -> Value {
    if let (Some(object), false) = (value.as_object_mut(), text.is_empty()) {
        object.insert("description".into(), text.into());
    }
    value
}

/// A table with these entries and no others.
pub(super) fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}
