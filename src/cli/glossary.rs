//! What words mean: the rows of the tables in docs/scene.md and docs/results.md, which a test holds to the program.

use afmsweep::report::capital;

const DOCUMENTS: [(&str, &str); 2] = [
    ("scene file", include_str!("../../docs/scene.md")),
    ("results file", include_str!("../../docs/results.md")),
];

/// A row of a table, and where it stands.
pub(super) struct GlossaryRow<'a> {
    document: &'a str,
    heading: &'a str,
    columns: Vec<&'a str>,
    cells: Vec<&'a str>,
}

/// The rows of all tables of both documents.
pub(super) fn all() -> Vec<GlossaryRow<'static>> {
    DOCUMENTS.iter().flat_map(|(document, text)| rows(document, text)).collect()
}

/// What the key of this path means, as the table of its section has it: a sentence or several.
pub(super) fn of_key(rows: &[GlossaryRow], path: &str) -> String {
    let path = path.replace(".#", "");
    let (table, key) = path.rsplit_once('.').unwrap_or(("", &path));
    let row = rows
        .iter()
        .find(|row| row.document == DOCUMENTS[0].0 && row.table() == table && row.words() == [key]);
    row.map_or_else(String::new, GlossaryRow::sentences)
}

/// The rows of all tables of a document.
fn rows<'a>(document: &'a str, text: &'a str) -> Vec<GlossaryRow<'a>> {
    let (mut heading, mut columns, mut rows) = ("", Vec::new(), Vec::new());
    for line in text.lines() {
        if let Some(title) = line.strip_prefix('#') {
            heading = title.trim_start_matches('#').trim();
        }
        match cells(line) {
            None => columns.clear(),
            Some(cells) if columns.is_empty() => columns = cells,
            Some(cells) if cells.iter().all(|cell| cell.trim_matches(['-', ':']).is_empty()) => {}
            Some(cells) => rows.push(GlossaryRow { document, heading, columns: columns.clone(), cells }),
        }
    }
    rows
}

/// The cells of a table's line.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

impl<'a> GlossaryRow<'a> {
    /// The words in code style in the row's first two cells, where its name stands.
    pub fn words(&self) -> Vec<&'a str> {
        let quoted = |cell: &&'a str| cell.split('`').skip(1).step_by(2).collect::<Vec<_>>();
        let mut words: Vec<&str> = self.cells.iter().take(1).flat_map(quoted).collect();
        if words.is_empty() {
            words = self.cells.iter().skip(1).take(1).flat_map(quoted).collect();
        }
        words
    }

    /// The path of the table of a scene whose keys the rows are; empty at the top level.
    fn table(&self) -> String {
        let path = self.heading.replace(['`', '[', ']'], "").replace(' ', ".");
        if path == "Top.level" { String::new() } else { path }
    }

    /// Whether the row is about that word: its name, or a key with some or all of its path.
    pub fn names(&self, word: &str) -> bool {
        let path = self.table();
        let under = |parent: &str| path == parent || path.ends_with(&format!(".{parent}"));
        let keyed = word.rsplit_once('.').filter(|(parent, _)| under(parent)).map(|(_, last)| last);
        // Values of keys stand in quotation marks, which nobody asks with.
        self.words().iter().any(|one| one.trim_matches('"') == word || *one == word || Some(*one) == keyed)
    }

    /// The meaning first, then unit, default and ranges.
    fn sentences(&self) -> String {
        let cells = || {
            self.columns.iter().zip(&self.cells).skip(1).filter(|(_, cell)| {
                !matches!(**cell, "" | "-" | "word" | "table" | "see below" | "see there")
            })
        };
        let meaning = cells().filter(|(column, _)| **column == "meaning").map(|(_, cell)| plain(cell));
        let others = cells().filter(|(column, _)| **column != "meaning");
        let others = others.map(|(column, cell)| format!("{}: {}.", capital(&plain(column)), plain(cell)));
        meaning.chain(others).collect::<Vec<_>>().join(" ")
    }

    pub fn told(&self) -> String {
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
