//! README is read in a few minutes. Truth: its own words, counted.

use std::fs;

/// Words of the whole page, as `wc -w` counts them, and of a sentence.
const MOST_WORDS: usize = 1100;
const MOST_IN_SENTENCE: usize = 35;

#[test]
fn it_is_short_and_so_are_its_sentences() {
    let text = fs::read_to_string("README.md").expect("README.md is there");
    let words = text.split_whitespace().count();
    assert!(words < MOST_WORDS, "{words} words");
    let mut prose = String::new();
    let mut code = false;
    for line in text.lines() {
        if line.starts_with("```") {
            code = !code;
        }
        // A heading, a table, a list's item or a block of code ends what stands before it.
        let apart = code
            || line.is_empty()
            || ["```", "|", "#", "- ", "!["].iter().any(|start| line.starts_with(start));
        prose += if apart { ".\n" } else { " " };
        if !(code || ["```", "|", "#", "!["].iter().any(|start| line.starts_with(start))) {
            prose += line;
        }
    }
    let prose = prose.replace('\n', " ").replace("? ", ". ");
    for sentence in prose.split(". ") {
        let count = sentence.split_whitespace().count();
        assert!(count <= MOST_IN_SENTENCE, "{count} words: {sentence}");
    }
}
