//! The study's page in the repository beside the one a test has just made.

use afmsweep::study::paper::MACHINE_LINE;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder in the repository.
pub fn kept() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("results/paper")
}

/// A file as kept and as made in `folder`.
pub fn both(name: &str, folder: &Path) -> (String, String) {
    let read =
        |folder: &Path| fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    (read(&kept()), read(folder))
}

/// Words and numbers of a text, in turn.
fn pieces(text: &str) -> Vec<&str> {
    let digit = |c: char| c.is_ascii_digit() || c == '.';
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| digit(c) != digit(first)).unwrap_or(rest.len());
        pieces.push(&rest[..end]);
        rest = &rest[end..];
    }
    pieces
}

/// The same words, and numbers that differ by no more than `units` of their last digit.
#[track_caller]
pub fn same(kept: &str, now: &str, units: f64, name: &str) {
    let (kept, now) = (pieces(kept), pieces(now));
    for (i, (a, b)) in kept.iter().zip(&now).enumerate() {
        let near = match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(x), Ok(y)) => {
                let places = a.split_once('.').map_or(0, |(_, after)| after.len());
                (x - y).abs() <= units * 1.001 * 10f64.powi(-(places as i32))
            }
            _ => false,
        };
        let from = i.saturating_sub(8);
        assert!(
            a == b || near,
            "{name} in results/paper is not what the command writes; it has {:?}, written is {:?}",
            kept[from..=i].concat(),
            now[from..=i].concat()
        );
    }
    assert_eq!(kept.len(), now.len(), "{name} has another length than what the command writes");
}

/// A page's lines but the one that tells of the machine, up to the ensemble or from there on.
pub fn lines(text: &str, ensemble: bool) -> String {
    let (before, after) = text.split_once("5. What the paper could not do").unwrap();
    let part = if ensemble { after } else { before };
    part.lines().filter(|line| !line.contains(MACHINE_LINE)).collect::<Vec<_>>().join("\n")
}

/// Pictures are the same shapes in the same places; of a map, whose cells on stiff samples may tell one
/// processor's last digit from another's, all but a fiftieth of the lines.
#[track_caller]
pub fn same_picture(name: &str, folder: &Path) {
    let (kept, now) = both(name, folder);
    roxmltree::Document::parse(&now).unwrap_or_else(|error| panic!("{name}: {error}"));
    if !name.starts_with("ensemble") {
        return same(&kept, &now, 3.0, name);
    }
    let mut counts: BTreeMap<&str, i64> = BTreeMap::new();
    kept.lines().for_each(|line| *counts.entry(line).or_default() += 1);
    now.lines().for_each(|line| *counts.entry(line).or_default() -= 1);
    let other: i64 = counts.values().map(|count| count.abs()).sum();
    assert!(other as usize <= kept.lines().count() / 50, "{name}: {other} lines differ from the command's");
}
