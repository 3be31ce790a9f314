//! Texts as TOML writes them.

/// A TOML string, whatever it contains.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_string()).to_string()
}
