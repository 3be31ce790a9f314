//! Places in scenes that were no text: dictionaries have keys, and no lines.

/// What a scene is called that was given as text.
const TEXT: &str = "text";

/// Whether a reader of the message has this text before him.
fn has_lines(name: &str, source: &str) -> bool {
    let is_of = |text: String| !text.trim_end().is_empty() && source.starts_with(text.trim_end());
    name == TEXT || std::fs::read_to_string(name).is_ok_and(is_of)
}

/// A message with paths of keys in place of lines and columns, where the scene of this name and text has none to see.
pub fn keyed(message: &str, name: &str, source: &str) -> String {
    let place = format!("{name}:");
    if !message.contains(&place) || has_lines(name, source) {
        return message.to_owned();
    }
    let mut parts = message.split(&place);
    let mut told = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (line, rest) = number(part);
        let (column, after) = number(rest.strip_prefix(':').unwrap_or_default());
        match (line, column) {
            (Some(line), Some(_)) => told += &(key_of(source, line) + after),
            _ => told += &(place.clone() + part),
        }
    }
    told
}

/// The same for a line that begins with its place, which tells no path twice.
pub fn keyed_line(line: &str, name: &str, source: &str) -> String {
    let told = keyed(line, name, source);
    match told.split_once(": ") {
        Some((place, rest)) if rest.starts_with(place) => rest.to_owned(),
        _ => told,
    }
}

/// The number that a text begins with, and the rest.
fn number(text: &str) -> (Option<usize>, &str) {
    let rest = text.trim_start_matches(|one: char| one.is_ascii_digit());
    (text[..text.len() - rest.len()].parse().ok(), rest)
}

/// The path of the key in a line, from 1. The text has each key in a line of its own.
fn key_of(source: &str, line: usize) -> String {
    let (mut section, mut key) = ("", "");
    for text in source.lines().take(line) {
        key = "";
        match text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            Some(name) => section = name,
            None if text.starts_with("# samples") => (section, key) = ("samples", ""),
            None => key = text.split_once(" = ").map_or("", |(key, _)| key),
        }
    }
    let path = [section, key].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(".");
    path.replace('"', "")
}
