//! `afmsweep explain WORD`: what a word of a scene, of a results file or of a message means.
//!
//! Its answers are the rows of the tables in docs/scene.md and docs/results.md, which a test holds to the program.

use super::print;
use anyhow::bail;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep explain accuracy_not_met\n          afmsweep explain approach.gap"
)]
pub struct ExplainArgs {
    /// A key of a scene, an observable, a status, an attribute or a variable of a results file; without it, all words
    word: Option<String>,
}

const DOCUMENTS: [(&str, &str); 2] = [
    ("scene file", include_str!("../../docs/scene.md")),
    ("results file", include_str!("../../docs/results.md")),
];

/// A row of a table, and where it stands.
struct Row<'a> {
    document: &'a str,
    heading: &'a str,
    columns: Vec<&'a str>,
    cells: Vec<&'a str>,
}

pub fn main(args: &ExplainArgs) -> anyhow::Result<()> {
    let rows: Vec<Row> = DOCUMENTS.iter().flat_map(|(document, text)| rows(document, text)).collect();
    let Some(word) = &args.word else {
        let mut all: Vec<&str> = rows.iter().flat_map(|row| row.words()).collect();
        all.sort_unstable();
        all.dedup();
        return print(&(all.join("\n") + "\n"));
    };
    let found: Vec<String> = rows.iter().filter(|row| row.names(word)).map(Row::told).collect();
    if found.is_empty() {
        let like: Vec<&str> =
            rows.iter().flat_map(|row| row.words()).filter(|one| one.contains(&**word)).collect();
        match like.as_slice() {
            [] => {
                bail!("nothing is known of \"{word}\"; `afmsweep explain` without a word lists what there is")
            }
            some => bail!("nothing is called \"{word}\"; there is {}", some[..some.len().min(8)].join(", ")),
        }
    }
    print(&found.join("\n"))
}

/// The rows of all tables of a document.
fn rows<'a>(document: &'a str, text: &'a str) -> Vec<Row<'a>> {
    let (mut heading, mut columns, mut rows) = ("", Vec::new(), Vec::new());
    for line in text.lines() {
        if let Some(title) = line.strip_prefix('#') {
            heading = title.trim_start_matches('#').trim();
        }
        match cells(line) {
            None => columns.clear(),
            Some(cells) if columns.is_empty() => columns = cells,
            Some(cells) if cells.iter().all(|cell| cell.trim_matches(['-', ':']).is_empty()) => {}
            Some(cells) => rows.push(Row { document, heading, columns: columns.clone(), cells }),
        }
    }
    rows
}

/// The cells of a table's line.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

impl<'a> Row<'a> {
    /// The words in code style in the row's first two cells, where its name stands.
    fn words(&self) -> Vec<&'a str> {
        let quoted = |cell: &&'a str| cell.split('`').skip(1).step_by(2).collect::<Vec<_>>();
        let mut words: Vec<&str> = self.cells.iter().take(1).flat_map(quoted).collect();
        if words.is_empty() {
            words = self.cells.iter().skip(1).take(1).flat_map(quoted).collect();
        }
        words
    }

    /// Whether the row is about that word: its name, or a key with some or all of its path.
    fn names(&self, word: &str) -> bool {
        let path = self.heading.trim_matches(['`', '[', ']']);
        let under = |parent: &str| path == parent || path.ends_with(&format!(".{parent}"));
        let keyed = word.rsplit_once('.').filter(|(parent, _)| under(parent)).map(|(_, last)| last);
        self.words().iter().any(|one| *one == word || Some(*one) == keyed)
    }

    fn told(&self) -> String {
        let mut text = format!("{} ({}, {})\n", self.words().join(", "), self.document, plain(self.heading));
        for (column, cell) in
            self.columns.iter().zip(&self.cells).skip(1).filter(|(_, cell)| !cell.is_empty())
        {
            text += &format!("  {:<9} {}\n", format!("{}:", plain(column)), plain(cell));
        }
        text
    }
}

/// Text without the marks of code and of links.
fn plain(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some((before, words, after)) = link(rest) {
        plain += before;
        plain += words;
        rest = after;
    }
    (plain + rest).replace('`', "")
}

/// The first link of a text: what stands before it, its words, and what stands after it.
fn link(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('[')?;
    let (words, rest) = rest.split_once("](")?;
    let (_, after) = rest.split_once(')')?;
    Some((before, words, after))
}
