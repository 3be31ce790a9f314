//! No file of the source imports another that leads back to it. The root of a module (`mod.rs`) does not count: it names
//! its files, and holds what they share.

use crate::architecture::{all_tests, code, sources};
use std::collections::{BTreeMap, BTreeSet};

type Path = Vec<String>;

/// The files of a crate by their place in it, and what the roots of modules give on under other names.
struct Crate {
    code: BTreeMap<Path, String>,
    given_on: BTreeMap<Path, BTreeMap<String, Path>>,
}

fn words(path: &str) -> Path {
    path.split("::").map(|word| word.trim().to_owned()).collect()
}

/// `a::{b, c::{d, e as f}}` as the paths it stands for.
fn paths(tree: &str) -> Vec<Path> {
    let tree = tree.trim();
    let Some((before, rest)) = tree.split_once('{') else {
        return vec![words(tree.split(" as ").next().unwrap_or(tree))];
    };
    let (mut found, mut depth, mut start) = (Vec::new(), 0, 0);
    let inside = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    let parts = inside.char_indices().chain([(inside.len(), ',')]);
    for (at, letter) in parts {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inside[start..at].trim().is_empty() {
                    found.extend(paths(&format!("{before}{}", inside[start..at].trim())));
                }
                start = at + 1;
            }
            _ => {}
        }
    }
    found
}

/// The trees of all `use` of a source: those that begin so, up to the semicolon.
fn trees<'a>(text: &'a str, begin: &str) -> Vec<&'a str> {
    let lines = text.match_indices(begin).filter(|(at, _)| text[..*at].rsplit('\n').next() == Some(""));
    lines.filter_map(|(at, _)| text[at + begin.len()..].split_once(';')).map(|(tree, _)| tree).collect()
}

impl Crate {
    fn of(files: &[(String, String)], root: &str) -> Self {
        let mut all = Self { code: BTreeMap::new(), given_on: BTreeMap::new() };
        for (file, text) in files.iter().filter(|(file, _)| !all_tests(file)) {
            let stem = file.trim_start_matches(root).trim_end_matches(".rs").trim_start_matches('/');
            let place: Path = stem.split('/').map(str::to_owned).collect();
            let place = match place.last().map(String::as_str) {
                Some("mod" | "lib" | "main") => place[..place.len() - 1].to_vec(),
                _ => place,
            };
            let text = code(text).join("\n");
            let mut on = BTreeMap::new();
            for begin in ["pub use ", "pub(crate) use ", "pub(super) use "] {
                for path in trees(&text, begin).into_iter().flat_map(paths) {
                    let path = if path[0] == "self" { path[1..].to_vec() } else { path };
                    on.insert(path.last().cloned().unwrap_or_default(), path);
                }
            }
            all.given_on.insert(place.clone(), on);
            all.code.insert(place, text);
        }
        all
    }

    /// The file that a path leads to, as it is written in another; none outside the crate.
    fn file(&self, from: &Path, path: &[String]) -> Option<Path> {
        let mut rest = path;
        let mut place = match path.first()?.as_str() {
            "crate" => Path::new(),
            _ => from.clone(),
        };
        while let Some(word @ ("crate" | "self" | "super")) = rest.first().map(String::as_str) {
            if word == "super" {
                place.pop();
            }
            rest = &rest[1..];
        }
        if rest.len() == path.len() && !self.code.contains_key(&[&place[..], &rest[..1]].concat()) {
            return None;
        }
        while let Some(word) = rest.first() {
            let below = [&place[..], std::slice::from_ref(word)].concat();
            if !self.code.contains_key(&below) {
                break;
            }
            (place, rest) = (below, &rest[1..]);
        }
        let on = rest.first().and_then(|word| self.given_on.get(&place)?.get(word));
        match on {
            Some(on) if on.as_slice() != path => self.file(&place, on).or(Some(place)),
            _ => Some(place),
        }
    }

    /// Which files each file imports from, roots left out.
    fn imports(&self) -> BTreeMap<&Path, BTreeSet<Path>> {
        let is_root =
            |place: &Path| self.code.keys().any(|one| one.len() > place.len() && one.starts_with(place));
        let of = |(place, text): (_, &String)| {
            let used = trees(text, "use ").into_iter().flat_map(paths);
            let written = ["super::", "crate::"].into_iter().flat_map(|begin| text.match_indices(begin)).map(
                |(at, _)| {
                    let end =
                        text[at..].find(|letter: char| !(letter.is_alphanumeric() || "_:".contains(letter)));
                    words(text[at..at + end.unwrap_or(0)].trim_end_matches(':'))
                },
            );
            let files = used.chain(written).filter_map(|path| self.file(place, &path));
            (place, files.filter(|other| other != place && !is_root(other)).collect())
        };
        self.code.iter().filter(|(place, _)| !is_root(place)).map(of).collect()
    }
}

/// A way from a file back to itself.
fn circle(imports: &BTreeMap<&Path, BTreeSet<Path>>) -> Option<Vec<Path>> {
    let mut done = BTreeSet::new();
    fn go(
        at: &Path,
        way: &mut Vec<Path>,
        done: &mut BTreeSet<Path>,
        imports: &BTreeMap<&Path, BTreeSet<Path>>,
    ) -> Option<Vec<Path>> {
        if let Some(first) = way.iter().position(|one| one == at) {
            return Some(way[first..].to_vec());
        }
        if !done.insert(at.clone()) {
            return None;
        }
        way.push(at.clone());
        let found = imports.get(at).into_iter().flatten().find_map(|next| go(next, way, done, imports));
        way.pop();
        found
    }
    imports.keys().find_map(|at| go(at, &mut Vec::new(), &mut done, imports))
}

#[test]
fn no_file_leads_back_to_itself() {
    let crates = [
        ("src", 30),
        ("crates/core/src", 270),
        ("crates/data/src", 45),
        ("crates/kernel/src", 30),
        ("crates/model/src", 140),
        ("crates/report/src", 75),
    ];
    for (root, least) in crates {
        let all = Crate::of(&sources(root), root);
        let imports = all.imports();
        let seen: usize = imports.values().map(BTreeSet::len).sum();
        assert!(seen > least, "{root}: only {seen} imports between files seen");
        assert_eq!(circle(&imports), None, "{root}");
    }
}

/// The check itself, on made-up files.
#[test]
fn circles_are_seen() {
    let file = |name: &str, text: &str| (format!("src/{name}.rs"), text.to_owned());
    let room = file("room/mod", "mod a;\nmod b;\npub use b::{B, C};\n");
    for (a, b, wrong) in [
        ("use super::b::B;\n", "use super::a::A;\n", true),
        ("use super::B;\n", "fn f() -> super::a::A {}\n", true),
        ("use crate::room::{D, b::{B, C}};\n", "use super::a;\n", true),
        ("use super::b::B;\n", "#[cfg(test)]\nmod tests {\n    use super::super::a::A;\n}\n", false),
        ("use super::b::B;\n", "use super::D;\n", false),
    ] {
        let files = [room.clone(), file("room/a", a), file("room/b", b)];
        let all = Crate::of(&files, "src");
        assert_eq!(circle(&all.imports()).is_some(), wrong, "{a}{b}");
    }
}
