//! Pages: the same content as HTML to look at and as Markdown to read anywhere.

use std::fmt::Write;

/// A table with a caption: the first row is its head.
#[derive(Clone, Debug, Default)]
pub struct DocumentTable {
    pub caption: String,
    pub rows: Vec<Vec<String>>,
}

/// A piece of a [`Document`], in plain text: what is special to HTML or Markdown is escaped.
#[derive(Clone, Debug)]
pub enum Block {
    Heading(String),
    /// Words that stand out, then the rest; either may be empty.
    Paragraph {
        lead: String,
        text: String,
    },
    /// With its caption above it, if there is one.
    Table(DocumentTable),
    /// A picture in a file beside the page. Where its text is here too, the page holds it: neighbours stand side by side,
    /// and its colours follow the page's.
    Figure {
        file: String,
        caption: String,
        svg: Option<String>,
    },
    /// What a reader unfolds.
    Folded {
        summary: String,
        document: Document,
    },
}

/// A page: a title and what stands below it.
#[derive(Clone, Debug, Default)]
pub struct Document {
    pub title: String,
    pub blocks: Vec<Block>,
}

impl Document {
    /// A section's heading.
    pub fn heading(&mut self, text: &str) {
        self.blocks.push(Block::Heading(text.to_owned()));
    }

    /// A paragraph that begins with words that stand out, which may be empty.
    pub fn paragraph(&mut self, lead: &str, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph { lead: lead.to_owned(), text: text.into() });
    }

    /// A table.
    pub fn table(&mut self, caption: &str, rows: Vec<Vec<String>>) {
        self.blocks.push(Block::Table(DocumentTable { caption: caption.to_owned(), rows }));
    }

    /// A picture in a file beside the page.
    pub fn figure(&mut self, file: &str, caption: &str) {
        self.blocks.push(Block::Figure { file: file.to_owned(), caption: caption.to_owned(), svg: None });
    }

    /// A picture that the page holds; it is in a file beside it as well.
    pub fn picture(&mut self, file: &str, caption: &str, svg: &str) {
        let (file, caption) = (file.to_owned(), caption.to_owned());
        self.blocks.push(Block::Figure { file, caption, svg: Some(svg.to_owned()) });
    }

    /// Blocks below a line that unfolds them.
    pub fn fold(&mut self, summary: &str, document: Document) {
        self.blocks.push(Block::Folded { summary: summary.to_owned(), document });
    }

    /// The page as HTML; `generator` names the program's part that made it.
    pub fn html(&self, generator: &str) -> String {
        format!("{}{}{CLOSE}", open(&self.title, generator), self.body())
    }

    /// The blocks as HTML.
    fn body(&self) -> String {
        let mut page = String::new();
        let mut beside = false;
        // Writing to a String cannot fail.
        for block in &self.blocks {
            let held = matches!(block, Block::Figure { svg: Some(_), .. });
            if held != beside {
                page.push_str(if held { "<div class=\"pictures\">\n" } else { "</div>\n" });
                beside = held;
            }
            let _ = match block {
                Block::Heading(text) => writeln!(page, "<h2>{}</h2>", escape(text)),
                Block::Paragraph { lead, text } if lead.is_empty() => {
                    writeln!(page, "<p>{}</p>", escape(text))
                }
                Block::Paragraph { lead, text } => {
                    writeln!(page, "<p><b>{}</b> {}</p>", escape(lead), escape(text))
                }
                Block::Table(table) => {
                    if !table.caption.is_empty() {
                        let _ = writeln!(page, "<p class=\"caption\">{}</p>", escape(&table.caption));
                    }
                    write!(page, "{}", table.html())
                }
                Block::Figure { file, caption, svg: Some(svg) } => {
                    let (file, caption) = (escape(file), escape(caption));
                    writeln!(
                        page,
                        "<figure>\n<div class=\"wide\">{svg}</div>\n\
                         <figcaption>{caption}. <a href=\"{file}\">{file}</a></figcaption>\n</figure>"
                    )
                }
                Block::Folded { summary, document } => {
                    let (summary, body) = (escape(summary), document.body());
                    writeln!(page, "<details><summary>{summary}</summary>\n{body}</details>")
                }
                Block::Figure { file, caption, svg: None } => {
                    let (short, file) = (escape(brief(caption)), escape(file));
                    let caption = escape(caption);
                    writeln!(
                        page,
                        "<figure>\n<a href=\"{file}\"><img src=\"{file}\" alt=\"{short}\"/></a>\n\
                         <figcaption>{caption}</figcaption>\n</figure>"
                    )
                }
            };
        }
        if beside {
            page.push_str("</div>\n");
        }
        page
    }

    /// The page as Markdown.
    pub fn markdown(&self) -> String {
        let mut page = format!("# {}\n\n{}", plain(&self.title), self.text());
        page.truncate(page.trim_end().len());
        page.push('\n');
        page
    }

    /// The blocks as Markdown.
    fn text(&self) -> String {
        let mut page = String::new();
        for block in &self.blocks {
            let _ = match block {
                Block::Heading(text) => write!(page, "## {}\n\n", plain(text)),
                Block::Folded { summary, document } => {
                    write!(page, "## {}\n\n{}", plain(summary), document.text())
                }
                Block::Paragraph { lead, text } if lead.is_empty() => write!(page, "{}\n\n", plain(text)),
                Block::Paragraph { lead, text } => write!(page, "**{}** {}\n\n", plain(lead), plain(text)),
                Block::Table(table) => {
                    if !table.caption.is_empty() {
                        let _ = write!(page, "{}\n\n", plain(&table.caption));
                    }
                    writeln!(page, "{}", table.markdown())
                }
                Block::Figure { file, caption, .. } => {
                    let (short, caption) = (plain(brief(caption)), plain(caption));
                    write!(page, "![{short}]({file})\n\n*{caption}*\n\n")
                }
            };
        }
        page
    }
}

impl DocumentTable {
    /// As HTML, without the caption.
    pub(super) fn html(&self) -> String {
        let mut text = String::from("<div class=\"wide\"><table>\n");
        for (number, cells) in self.rows.iter().enumerate() {
            let tag = if number == 0 { "th" } else { "td" };
            text.push_str("<tr>");
            for cell in cells {
                let _ = write!(text, "<{tag}>{}</{tag}>", escape(cell));
            }
            text.push_str("</tr>\n");
        }
        text.push_str("</table></div>\n");
        text
    }

    /// As Markdown, without the caption.
    pub(super) fn markdown(&self) -> String {
        let mut text = String::new();
        for (number, cells) in self.rows.iter().enumerate() {
            let cells: Vec<String> = cells.iter().map(|cell| plain(cell)).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
            if number == 0 {
                let _ = writeln!(text, "|{}", "---|".repeat(cells.len()));
            }
        }
        text
    }
}

/// The beginning of a caption, for readers to whom the picture is described.
fn brief(caption: &str) -> &str {
    caption.split(['.', ':', ';']).next().unwrap_or(caption)
}

/// Text for HTML, quotes included.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // Other control characters are not allowed in any page.
            c if c.is_control() && !matches!(c, '\n' | '\t' | '\r') => escaped.push('\u{fffd}'),
            c if turns(c) => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Letters that turn the direction of what follows: a name could be read as another.
fn turns(letter: char) -> bool {
    matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text as code in Markdown, on one line: between more backticks than it holds in a row.
pub(super) fn code(text: &str) -> String {
    let shown = |c: char| match c {
        c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') || turns(c) => '\u{fffd}',
        c => c,
    };
    let text: String = text.chars().map(shown).collect();
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    let fence = "`".repeat(longest + 1);
    // Spaces at both ends are taken off again, and keep backticks at the ends apart from the fence.
    if longest == 0 { format!("`{text}`") } else { format!("{fence} {text} {fence}") }
}

/// Text that Markdown takes as it is, on one line.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}') || turns(letter) {
            plain.push(' ');
            continue;
        }
        if "\\`*[]<>|#&~$".contains(letter) {
            plain.push('\\');
        }
        plain.push(letter);
    }
    plain
}

/// A page's head and title; [`CLOSE`] ends it.
pub(super) fn open(title: &str, generator: &str) -> String {
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"generator\" content=\"{generator}\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>{}</style>\n</head>\n<body>\n<h1>{title}</h1>\n",
        include_str!("page.css").lines().collect::<String>()
    )
}

pub(super) const CLOSE: &str = "</body>\n</html>\n";
