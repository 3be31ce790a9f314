//! Links between documents lead somewhere: to a file that the repository has, and to a heading that the file has.
//! Truth: the files, and the rule by which GitHub names headings.

use std::path::{Component, Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files that a clone has; none where that cannot be told.
fn kept() -> Option<Vec<PathBuf>> {
    let output = Command::new("git")
        .args(["ls-files", "-co", "--exclude-standard"])
        .current_dir(root())
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.lines().map(PathBuf::from).collect())
}

fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !name.starts_with('.') && name != "target" {
            documents(&path, found);
        } else if name.ends_with(".md") {
            found.push(path.strip_prefix(root()).unwrap().to_path_buf());
        }
    }
}

/// Text without its code, where brackets are no links.
fn prose(text: &str) -> String {
    let mut fenced = false;
    let mut kept = String::new();
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        if !fenced && !line.starts_with("    ") {
            kept += &line.split('`').step_by(2).collect::<Vec<_>>().join("``");
            kept.push('\n');
        }
    }
    kept
}

/// The targets of a text's links and pictures.
fn targets(text: &str) -> Vec<String> {
    let text = prose(text);
    let ends = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    ends.map(|(target, _)| target.to_owned()).filter(|target| !target.contains(' ')).collect()
}

/// What GitHub calls a heading in an address.
fn slug(heading: &str) -> String {
    let plain: String = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect();
    plain.trim().to_lowercase().replace(' ', "-")
}

fn headings(text: &str) -> Vec<String> {
    let mut fenced = false;
    let mut found = Vec::new();
    for line in text.lines() {
        fenced ^= line.starts_with("```");
        if line.starts_with('#') && !fenced {
            found.push(slug(line.trim_start_matches('#').trim()));
        }
    }
    found
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(plain.pop()),
            Component::Normal(name) => plain.push(name),
            _ => {}
        }
    }
    plain
}

/// What is wrong with the links of one document.
fn broken(document: &Path, text: &str, kept: Option<&[PathBuf]>) -> Vec<String> {
    let mut wrong = Vec::new();
    for target in targets(text) {
        if target.contains("://") || target.starts_with("mailto:") {
            continue;
        }
        let (path, heading) = target.split_once('#').unwrap_or((&target, ""));
        let file = match path {
            "" => document.to_path_buf(),
            path => plain(&document.parent().unwrap().join(path)),
        };
        let there = match kept {
            Some(kept) => kept.iter().any(|one| one.starts_with(&file)),
            None => root().join(&file).exists(),
        };
        if !there {
            wrong.push(format!("{}: {target} leads to no file of the repository", document.display()));
        } else if !heading.is_empty() {
            let text = std::fs::read_to_string(root().join(&file)).unwrap();
            if !headings(&text).iter().any(|one| one == heading) {
                wrong.push(format!("{}: {target} leads to no heading", document.display()));
            }
        }
    }
    wrong
}

#[test]
fn every_link_leads_to_a_file_and_a_heading_that_are_there() {
    let kept = kept();
    let mut all = Vec::new();
    documents(root(), &mut all);
    let tracked = |path: &PathBuf| kept.as_ref().is_none_or(|kept| kept.contains(path));
    all.retain(tracked);
    assert!(all.len() >= 15, "{all:?}");
    let read = |path: &PathBuf| std::fs::read_to_string(root().join(path)).unwrap();
    let wrong: Vec<String> = all.iter().flat_map(|path| broken(path, &read(path), kept.as_deref())).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let links: usize = all.iter().map(|path| targets(&read(path)).len()).sum();
    assert!(links > 100, "only {links} links were seen");
}

/// Truth: faults put in.
#[test]
fn a_link_that_leads_nowhere_is_seen() {
    let kept = kept();
    let check = |text: &str| broken(Path::new("docs/new.md"), text, kept.as_deref()).len();
    assert_eq!(
        check("[a](scene.md) [b](scene.md#run) [c](../README.md#installing) `[d](no.md)` [e](https://x.y)"),
        0
    );
    assert_eq!(check("[a](scene.m) [b](scene.md#walk) [c](../README#installing)"), 3);
    assert_eq!(check("```text\n[a](no.md)\n```\n![b](no.svg)"), 1);
}
