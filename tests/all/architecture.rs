//! The shape of the source: which way imports go, how long files and functions are, and that nothing unfinished is left.

use std::path::{Path, PathBuf};

/// Modules from the first to the last; a module imports only from those before it, and from none beside it. Between
/// crates it is Cargo that sees to it.
const ORDER: [&[&str]; 15] = [
    // The kernel is a crate of its own: what it may know is Cargo's to say.
    &["clock", "suggestion", "kernel", "reconstruction", "legendre", "matrix_product"],
    &["units", "observe", "design"],
    &["scene"],
    &["instrument", "contact", "periodic"],
    &["plan"],
    &["engine"],
    &["compare"],
    &["orbit"],
    &["control"],
    &["store"],
    &["record", "stats"],
    &["sweep"],
    &["report"],
    &["study", "bench"],
    &["cli"],
];

/// Beyond the order: modules that may import from these alone.
const NARROW: [(&str, &[&str]); 3] = [
    // The file's format does not depend on how results came about. The kernel has the names and codes of laws.
    ("store", &["kernel", "observe"]),
    // Pictures come from the results file alone.
    ("report", &["design", "observe", "reconstruction", "stats", "store", "suggestion", "units"]),
    // Statistics as well.
    ("stats", &["design", "observe", "store"]),
];

/// Words that stop the program or are left over from its making, and where one is meant: file, and why.
const LEFTOVERS: [&str; 8] =
    ["todo!", "unimplemented!", "dbg!", "panic!", "unreachable!", ".unwrap()", ".expect(", "FIXME"];
const MEANT: [(&str, &str, &str); 0] = [];

const LINES: usize = 400;

/// Lines of a function, from its name to its closing brace, and what it is given; of a tuple each member counts.
const FUNCTION_LINES: usize = 60;
const PARAMETERS: usize = 6;

pub fn sources(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.join(folder)];
    let mut files: Vec<PathBuf> = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false if path.extension().is_some_and(|extension| extension == "rs") => files.push(path),
                false => {}
            }
        }
    }
    files.sort();
    let name = |path: &PathBuf| path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
    files.iter().map(|path| (name(path), std::fs::read_to_string(path).unwrap())).collect()
}

/// The top module a source file belongs to: `src/cli/run.rs` to `cli`, `crates/data/src/units.rs` to `units`. A crate
/// that is one module bears its name: `crates/report/src/axis.rs` belongs to `report`.
fn module(file: &str) -> &str {
    let (name, inside) = match file.strip_prefix("crates/").and_then(|path| path.split_once("/src/")) {
        Some((name, inside)) => (Some(name), inside),
        None => (None, file.strip_prefix("src/").unwrap()),
    };
    let one = name.filter(|name| ORDER.concat().contains(name));
    one.unwrap_or_else(|| inside.split('/').next().unwrap().trim_end_matches(".rs"))
}

/// The roots of crates: each names its modules, and those of the crates below that it takes up. What builds one belongs
/// to none.
fn is_root(file: &str) -> bool {
    file.ends_with("src/lib.rs") || ["src/main.rs", "crates/core/build.rs"].contains(&file)
}

/// The source without comments and without the items under `#[cfg(test)]`, one entry for each line.
pub fn code(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut skipped: Option<usize> = None;
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        if let Some(depth) = skipped {
            let over = indent == depth && (line.trim_end().ends_with('}') || line.trim_end().ends_with(';'));
            skipped = (!over).then_some(depth);
            lines.push(String::new());
        } else if line.trim() == "#[cfg(test)]" {
            skipped = Some(indent);
            lines.push(String::new());
        } else {
            let uncommented = match line.find("//") {
                // Not the slashes of an address in a text.
                Some(at) if !line[..at].ends_with(':') => &line[..at],
                _ => line,
            };
            lines.push(uncommented.to_owned());
        }
    }
    lines
}

/// The top modules that a source names: after `crate::` or `afmsweep::`, alone or in braces.
fn imports(text: &str) -> Vec<String> {
    let code = code(text).join("\n");
    let mut found = Vec::new();
    for prefix in [
        "crate::",
        "afmsweep::",
        "afmsweep_core::",
        "afmsweep_data::",
        "afmsweep_model::",
        "afmsweep_report::",
    ] {
        for (at, _) in code.match_indices(prefix) {
            let rest = &code[at + prefix.len()..];
            match rest.strip_prefix('{') {
                None => found.push(word(rest)),
                Some(list) => {
                    let mut depth = 0;
                    let mut start = true;
                    for (i, letter) in list.char_indices() {
                        match letter {
                            '{' => depth += 1,
                            '}' if depth == 0 => break,
                            '}' => depth -= 1,
                            ',' if depth == 0 => start = true,
                            _ if start && letter.is_alphabetic() => {
                                found.push(word(&list[i..]));
                                start = false;
                            }
                            _ => {}
                        }
                    }
                }
            }
        }
    }
    found
}

fn word(text: &str) -> String {
    text.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

fn rank(module: &str) -> usize {
    let found = ORDER.iter().position(|rank| rank.contains(&module));
    found.unwrap_or_else(|| panic!("module {module} has no place in ORDER; give it one"))
}

/// What is wrong with the imports of a file of `from`.
fn wrong_imports(file: &str, from: &str, text: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    for to in imports(text) {
        // Code may name its own module from the top; what the root hands on (`afmsweep::Scene`) is for those on top.
        let handed_on = to.starts_with(char::is_uppercase);
        // A crate that is one module names its own files so.
        if Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("crates/{from}/src/{to}.rs")).exists() {
            continue;
        }
        if to == from || (handed_on && from == "cli") {
            continue;
        }
        if handed_on {
            wrong.push(format!("{file}: {from} imports {to} from the crate's root, not from its module"));
            continue;
        }
        if rank(&to) >= rank(from) {
            wrong.push(format!("{file}: {from} imports from {to}, which comes after it or stands beside it"));
        }
        let narrow = NARROW.iter().find(|(module, _)| *module == from);
        if narrow.is_some_and(|(_, allowed)| !allowed.contains(&to.as_str())) {
            wrong.push(format!("{file}: {from} imports from {to}, which it should not know"));
        }
    }
    wrong
}

fn leftovers(file: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in code(text).iter().enumerate() {
        for leftover in LEFTOVERS {
            let meant = MEANT.iter().any(|(path, what, _)| *path == file && *what == leftover);
            if line.contains(leftover) && !meant {
                found.push(format!("{file}:{}: {leftover}", number + 1));
            }
        }
    }
    found
}

/// A function: its name, its lines and what it is given besides itself.
struct Function {
    name: String,
    lines: usize,
    parameters: usize,
}

/// All functions of a source, as rustfmt lays them out: what closes one stands as far in as its beginning.
fn functions(text: &str) -> Vec<Function> {
    const BEFORE: [&str; 5] = ["pub", "const", "async", "unsafe", "extern"];
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let mut words = line
            .split_whitespace()
            .skip_while(|word| BEFORE.contains(word) || word.starts_with("pub(") || word.starts_with('"'));
        let (Some("fn"), Some(name)) = (words.next(), words.next()) else { continue };
        // Of its head the last line ends so, and no other: `fn f() {}` and `fn f();` are all head.
        let Some(head) = lines[at..].iter().position(|line| line.ends_with(['{', '}', ';'])) else {
            continue;
        };
        let end = format!("{}}}", &line[..line.len() - line.trim_start().len()]);
        let body = match lines[at + head].ends_with('{') {
            true => lines[at + head..].iter().position(|line| *line == end).unwrap_or_default(),
            false => 0,
        };
        let parameters = parameters(&lines[at..=at + head].join(" "));
        found.push(Function { name: word(name), lines: head + body + 1, parameters });
    }
    found
}

/// How much a function is given besides itself, by its head.
fn parameters(head: &str) -> usize {
    let head = head.replace("->", "");
    // Not the parentheses of a bound among the generic ones.
    let mut depth = 0;
    let is_open = |letter: char| {
        depth += usize::from(letter == '<');
        depth -= usize::from(letter == '>');
        letter == '(' && depth == 0
    };
    let Some((_, list)) = head.split_once(is_open) else { return 0 };
    let (mut depth, mut given, mut each) = (0, Vec::new(), String::new());
    for letter in list.chars() {
        match letter {
            ')' if depth == 0 => break,
            ',' if depth == 0 => given.push(std::mem::take(&mut each)),
            _ => {
                depth += usize::from("([<{".contains(letter));
                depth -= usize::from(")]>}".contains(letter));
                each.push(letter);
            }
        }
    }
    given.push(each);
    let members = |one: &String| match one.split(':').next().unwrap_or_default().trim() {
        "" | "self" | "mut self" | "&self" | "&mut self" => 0,
        tuple if tuple.starts_with('(') => tuple.matches(',').count() + 1,
        _ => 1,
    };
    given.iter().map(members).sum()
}

/// Which functions of a file are too long or are given too much.
fn overgrown(file: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for Function { name, lines, parameters } in functions(text) {
        if lines > FUNCTION_LINES {
            found.push(format!("{file}: {name} has {lines} lines"));
        }
        if parameters > PARAMETERS {
            found.push(format!("{file}: {name} has {parameters} parameters"));
        }
    }
    found
}

/// Files that are tests as a whole: their parents declare them so.
pub fn all_tests(file: &str) -> bool {
    file.ends_with("/tests.rs") || file.ends_with("_agree.rs")
}

#[test]
fn imports_go_one_way() {
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (file, text) in ["src", "crates"].into_iter().flat_map(sources) {
        // Tests may look anywhere for their truth.
        if is_root(&file) || all_tests(&file) || module(&file) == "kernel" {
            continue;
        }
        seen += imports(&text).len();
        wrong.extend(wrong_imports(&file, module(&file), &text));
    }
    assert!(seen > 80, "only {seen} imports seen");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The check itself, on made-up files.
#[test]
fn wrong_imports_are_seen() {
    for (from, text) in [
        ("scene", "use crate::plan::Plan;\n"),
        ("contact", "fn f() -> crate::instrument::Mode {}\n"),
        ("plan", "use crate::{\n    contact::{Contact, Law},\n    engine::Cpu,\n};\n"),
        ("store", "use crate::scene::Scene;\n"),
        ("report", "use crate::plan::Plan;\n"),
        ("engine", "#[cfg(test)]\nmod tests;\nuse crate::record::Facts;\n"),
    ] {
        assert!(!wrong_imports("made_up.rs", from, text).is_empty(), "{from}: {text}");
    }
    for (from, text) in [
        ("plan", "use crate::{contact::{Contact, Law}, scene};\nuse crate::plan::Class;\n"),
        ("scene", "// use crate::plan::Plan\n"),
        ("contact", "#[cfg(test)]\nmod tests {\n    use crate::engine::Cpu;\n}\n"),
    ] {
        assert_eq!(wrong_imports("made_up.rs", from, text), [""; 0], "{from}: {text}");
    }
}

#[test]
fn files_stay_short() {
    let long: Vec<String> = ["src", "crates", "python", "tests"]
        .into_iter()
        .flat_map(sources)
        .filter(|(_, text)| text.lines().count() > LINES)
        .map(|(file, text)| format!("{file}: {} lines", text.lines().count()))
        .collect();
    assert!(long.is_empty(), "over {LINES} lines:\n{}", long.join("\n"));
}

#[test]
fn functions_stay_short() {
    let sources: Vec<_> = ["src", "crates", "python"].into_iter().flat_map(sources).collect();
    let seen: usize = sources.iter().map(|(_, text)| functions(text).len()).sum();
    assert!(seen > 1500, "only {seen} functions seen");
    let found: Vec<String> = sources.iter().flat_map(|(file, text)| overgrown(file, text)).collect();
    assert!(
        found.is_empty(),
        "over {FUNCTION_LINES} lines or {PARAMETERS} parameters:\n{}",
        found.join("\n")
    );
}

/// The check itself, on made-up functions.
#[test]
fn overgrown_functions_are_seen() {
    let of = |head: &str, lines: usize| format!("{head} {{\n{}}}\n", "    x();\n".repeat(lines - 2));
    let inside = |text: String| {
        let lines: String = text.lines().map(|line| format!("    {line}\n")).collect();
        format!("impl A {{\n{lines}}}\n")
    };
    for (text, what) in [
        (of("fn f()", 61), "f has 61 lines"),
        (of("pub(super) const fn f<F: Fn(u8) -> u8>(x: F) -> u8", 61), "f has 61 lines"),
        (of("fn f(\n    x: u8,\n) -> u8\nwhere\n    u8: Copy,\n", 56), "f has 61 lines"),
        (inside(of("pub fn f(&self)", 61)), "f has 61 lines"),
        (of("fn f(a: u8, b: u8, c: u8, d: u8, e: u8, f: u8, g: u8)", 3), "f has 7 parameters"),
        (of("fn f((a, b): (u8, u8), c: [u8; 2], d: u8, e: u8, f: u8, g: u8)", 3), "f has 7 parameters"),
        (
            inside(of(
                "fn f(\n    &self,\n    (a, b, c): (u8, u8, u8),\n    (d, e): (u8, u8),\n    f: u8,\n    g: u8,\n)",
                3,
            )),
            "f has 7 parameters",
        ),
        (
            "fn f<F: Fn(u8, u8) -> u8>(a: F, b: u8, c: u8, d: u8, e: u8, f: u8, g: u8);\n".into(),
            "f has 7 parameters",
        ),
    ] {
        assert_eq!(overgrown("made_up.rs", &text), [format!("made_up.rs: {what}")], "{text}");
    }
    for text in [
        of("fn f()", 60),
        inside(of("fn f()", 60)),
        of("fn f<F: Fn(u8, u8, u8) -> u8>(&self, a: (u8, u8), b: F, c: u8, d: [u8; 2], e: u8, (f): (u8))", 3),
        of("fn f()", 40) + &of("fn g()", 40),
        "fn f() {}\n".to_owned() + &of("struct A", 90),
    ] {
        assert_eq!(overgrown("made_up.rs", &text), [""; 0], "{text}");
    }
}

#[test]
fn nothing_unfinished_is_left() {
    let found: Vec<String> = ["src", "crates", "python"]
        .into_iter()
        .flat_map(sources)
        .filter(|(file, _)| !all_tests(file))
        .flat_map(|(file, text)| leftovers(&file, &text))
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
    for (file, leftover, why) in MEANT {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        assert!(text.contains(leftover) && !why.is_empty(), "{file} has no {leftover} any more");
    }
    assert_eq!(leftovers("a.rs", "fn f() {\n    x.unwrap();\n}\n"), ["a.rs:2: .unwrap()"]);
    assert_eq!(leftovers("a.rs", "#[cfg(test)]\nmod tests {\n    x.unwrap();\n}\n/// todo!\n"), [""; 0]);
}
