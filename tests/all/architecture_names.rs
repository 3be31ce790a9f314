//! Names: a file is called by a noun that no other file has, a type by a name that no other type has.

use crate::architecture::{code, sources};
use std::collections::BTreeMap;

/// Participles, prepositions and adjectives: alone they say of what kind a thing is, not which thing.
const NO_NOUNS: [&str; 72] = [
    "about",
    "after",
    "again",
    "against",
    "around",
    "asked",
    "before",
    "begin",
    "begun",
    "beside",
    "between",
    "beyond",
    "borne",
    "busy",
    "carried",
    "choose",
    "chosen",
    "coarse",
    "coded",
    "compiled",
    "decide",
    "described",
    "drawn",
    "ended",
    "filled",
    "first",
    "fixed",
    "follow",
    "found",
    "given",
    "halved",
    "kept",
    "known",
    "last",
    "late",
    "led",
    "left",
    "lost",
    "lossless",
    "measured",
    "met",
    "missed",
    "near",
    "next",
    "nothing",
    "now",
    "on",
    "one",
    "other",
    "others",
    "own",
    "packed",
    "partial",
    "planned",
    "prepared",
    "prescribed",
    "quoted",
    "ran",
    "recalled",
    "refused",
    "resolved",
    "saved",
    "scaled",
    "scattered",
    "second",
    "seconds",
    "sensitive",
    "slow",
    "solved",
    "stopped",
    "told",
    "unfinished",
];

/// Files that go in pairs: the kernel's and the GPU engine's are called as those of the shader and of the engine that they are
/// the other side of.
fn is_a_twin(file: &str) -> bool {
    ["crates/kernel/", "crates/core/src/engine/gpu/"].iter().any(|folder| file.starts_with(folder))
}

fn stem(file: &str) -> &str {
    file.rsplit('/').next().unwrap_or(file).trim_end_matches(".rs")
}

fn all() -> Vec<(String, String)> {
    let all = ["src", "crates", "python"].into_iter().flat_map(sources);
    all.filter(|(file, _)| file.starts_with("src/") || file.contains("/src/")).collect()
}

/// What more than one file has, with these files.
fn shared(names: impl Iterator<Item = (String, String)>) -> Vec<String> {
    let mut by_name: BTreeMap<String, Vec<String>> = BTreeMap::new();
    names.for_each(|(name, file)| by_name.entry(name).or_default().push(file));
    let several = by_name.into_iter().filter(|(_, files)| files.len() > 1);
    several.map(|(name, files)| format!("{name}: {}", files.join(", "))).collect()
}

/// The types of a source that other files can name; of a twin only those that other modules can, and of the kernel's laws
/// none: by the list of laws a law has the same name in the kernel as among the static curves.
fn types(file: &str, text: &str) -> Vec<String> {
    if file.starts_with("crates/kernel/src/contact/") {
        return Vec::new();
    }
    let name = |line: &String| {
        let line = line.trim_start().strip_prefix("pub")?;
        let line = match line.strip_prefix('(') {
            Some(_) if is_a_twin(file) => return None,
            Some(line) => line.split_once(')')?.1,
            None => line,
        };
        let (kind, rest) = line.trim_start().split_once(' ')?;
        let is_type = ["struct", "enum", "trait", "type", "union"].contains(&kind);
        let end = rest.find(|letter: char| !letter.is_alphanumeric() && letter != '_').unwrap_or(rest.len());
        is_type.then(|| rest[..end].to_owned())
    };
    code(text).iter().filter_map(name).collect()
}

#[test]
fn no_two_files_share_a_name() {
    let one_of_many = |file: &str| ["mod", "lib", "main", "tests"].contains(&stem(file)) || is_a_twin(file);
    let files: Vec<String> =
        all().into_iter().map(|(file, _)| file).filter(|file| !one_of_many(file)).collect();
    assert!(files.len() > 300, "only {} files seen", files.len());
    let found = shared(files.into_iter().map(|file| (stem(&file).to_owned(), file)));
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn files_are_called_by_nouns() {
    let found: Vec<String> =
        all().into_iter().map(|(file, _)| file).filter(|file| NO_NOUNS.contains(&stem(file))).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_two_types_share_a_name() {
    let each = |(file, text): (String, String)| {
        types(&file, &text).into_iter().map(move |name| (name, file.clone())).collect::<Vec<_>>()
    };
    let names: Vec<(String, String)> = all().into_iter().flat_map(each).collect();
    assert!(names.len() > 400, "only {} types seen", names.len());
    let found = shared(names.into_iter());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The checks themselves, on made-up sources.
#[test]
fn names_are_seen() {
    let text = "pub struct A<T>(T);\n    pub(super) enum B {}\npub(crate) trait C: Send {}\nstruct D;\n\
        #[cfg(test)]\nmod tests {\n    pub struct E;\n}\npub type F = u8;\npub const G: u8 = 1;\n";
    assert_eq!(types("src/a.rs", text), ["A", "B", "C", "F"]);
    assert_eq!(types("crates/kernel/src/a.rs", text), ["A", "F"]);
    let pair = |name: &str, file: &str| (name.to_owned(), file.to_owned());
    let found = shared([pair("a", "x"), pair("b", "x"), pair("a", "y")].into_iter());
    assert_eq!(found, ["a: x, y"]);
}
