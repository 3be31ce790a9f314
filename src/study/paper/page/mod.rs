//! The page: what holds, what does not, and why. Its text is `page.txt`, with each number where it stands: every number comes
//! from [`Numbers`], and every verdict from a comparison of them.

mod claims;
mod comparison_tables;

use super::super::Numbers;
use crate::report::{Document, shown};

/// Paragraphs, headings, pictures and tables, with a blank line between two. `{key:3}` is a number to three digits, `{key:3%}` a
/// share as a percentage, `{key:3;}` the smallest, the median and the largest, `{key:times}` a count, `{claim?}` a verdict.
const TEXT: &str = include_str!("page.txt");

/// A page without its text.
fn titled() -> Document {
    Document { title: "The paper, reproduced and questioned".into(), ..Document::default() }
}

/// What stands in a folder before the study is done.
pub(super) fn placeholder(generator: &str) -> (String, String) {
    let mut document = titled();
    document.paragraph("Not finished.", "The study was stopped before its page was written; make it again.");
    ("index.html".into(), document.html(generator))
}

/// The whole page; `machine` is its one line that differs from machine to machine.
pub(super) fn document(n: &Numbers, machine: &str) -> Document {
    let mut numbers = n.clone();
    claims::derive(&mut numbers);
    let n = &numbers;
    let mut page = titled();
    for block in TEXT.trim_end().split("\n\n") {
        let text = filled(n, &block.replace('\n', " "));
        if let Some((name, words)) = text.strip_prefix('[').and_then(|text| text.split_once(']')) {
            let caption = words.split(" | ").next().unwrap_or_default().trim();
            match name {
                "machine" => page.paragraph("", machine),
                "table" => page.table(caption, rows(n, block)),
                "table numbers" => page.table(caption, comparison_tables::table_1(n)),
                "table choices" => page.table(caption, comparison_tables::choices(n)),
                "table figure_4" => page.table(caption, comparison_tables::figure_4(n)),
                file => page.figure(file, caption),
            }
        } else if let Some(heading) = text.strip_prefix("## ") {
            page.heading(heading);
        } else {
            let led = text.strip_prefix("**").and_then(|text| text.split_once("** "));
            let (lead, text) = led.unwrap_or(("", &text));
            page.paragraph(lead, text);
        }
    }
    page
}

/// The cells of a table's lines, each of which begins with a bar.
fn rows(n: &Numbers, block: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.split('|').map(|cell| filled(n, cell.trim())).collect();
    block.lines().filter_map(|line| line.strip_prefix('|')).map(cells).collect()
}

/// A text with its numbers put in.
fn filled(n: &Numbers, text: &str) -> String {
    let mut parts = text.split('{');
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for (place, rest) in parts.filter_map(|part| part.split_once('}')) {
        whole += &told(n, place);
        whole += rest;
    }
    whole
}

/// What stands in a place of the text.
fn told(n: &Numbers, place: &str) -> String {
    let (key, form) = place.split_once(':').unwrap_or((place, ""));
    let digits = form.trim_end_matches(['%', ';']).parse().unwrap_or(0);
    match form.chars().last() {
        None => claims::verdict(n, key.trim_end_matches('?')).to_owned(),
        Some('%') => percent(n.get(key), digits),
        Some(';') => {
            ["least", "median", "most"].map(|one| n.shown(&format!("{key}.{one}"), digits)).join("; ")
        }
        Some('s') if n.get(key) == 1.0 => "once".to_owned(),
        Some('s') => format!("{} times", shown(n.get(key), "1", 3)),
        _ => n.shown(key, digits),
    }
}

/// A share as a percentage.
fn percent(share: f64, digits: usize) -> String {
    format!("{} %", shown(100.0 * share, "1", digits))
}
