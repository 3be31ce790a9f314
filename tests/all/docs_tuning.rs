//! docs/tuning.md names the numbers that the program has. Truth: the source.

use crate::docs_name_everything::Document;
use std::path::Path;

/// The words of a cell that are code.
fn code(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// The words of a source file, given from the root or from `crates/core/src`.
fn words_of(root: &Path, file: &str) -> Vec<String> {
    let paths = [root.join("crates/core/src").join(file), root.join(file)];
    let text = paths.iter().find_map(|path| std::fs::read_to_string(path).ok());
    let text = text.unwrap_or_else(|| panic!("no file {file}"));
    let ends = |letter: char| !letter.is_alphanumeric() && letter != '_';
    text.split(ends).map(str::to_owned).collect()
}

#[test]
fn every_number_stands_where_the_table_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let document = Document::open("tuning.md");
    let mut missing = String::new();
    let mut named = 0;
    for row in document.text.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
        let files: Vec<&str> = code(cells[1]).filter(|word| word.ends_with(".rs")).collect();
        let files = if files.is_empty() { vec!["plan/policy.rs"] } else { files };
        let words: Vec<String> = files.iter().flat_map(|file| words_of(root, file)).collect();
        for name in code(cells[0]) {
            named += 1;
            if !words.iter().any(|word| word == name) {
                missing += &format!("{name} is not in {files:?}\n");
            }
        }
    }
    assert!(missing.is_empty() && named > 100, "{named} names\n{missing}");
}
