//! What is wrong with a scene file, where, and what to write instead.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why a scene cannot be used: all its mistakes as far as they do not hang together, with their places in the file.
///
/// `Display` gives one line for each (`file:line:column: what is wrong; expected ...; what to do`), for logs and
/// for wrapping; [`SceneError::render`] shows the lines of the file with the places marked.
#[derive(Clone)]
pub struct SceneError(Box<Report>);

#[derive(Clone, Debug)]
struct Report {
    path: PathBuf,
    source: String,
    /// In the order of the file, never empty.
    faults: Vec<Fault>,
}

/// Mistakes shown at most: who has more begins with these.
const MOST: usize = 20;

/// The mistakes found so far. Reading goes on after each that leaves the rest to be judged.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<Fault>);

impl Faults {
    /// What was read, or none and one mistake more.
    pub fn take<T>(&mut self, read: Checked<T>) -> Option<T> {
        read.map_err(|fault| self.0.push(*fault)).ok()
    }

    pub fn push(&mut self, fault: Fault) {
        self.0.push(fault);
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Ties them to the file they were found in.
    pub fn in_file(mut self, path: &Path, source: &str) -> SceneError {
        self.0.sort_by_key(|fault| fault.place.as_ref().map_or(0, |place| place.start));
        SceneError(Box::new(Report { path: path.to_path_buf(), source: source.to_string(), faults: self.0 }))
    }
}

impl From<Box<Fault>> for Faults {
    fn from(fault: Box<Fault>) -> Self {
        Self(vec![*fault])
    }
}

/// A fault found in a scene's text, not yet tied to its file.
#[derive(Clone, Debug)]
pub(super) struct Fault {
    /// What is wrong, in one sentence without a full stop.
    title: String,
    /// Byte range in the source; `None` where the file as a whole is at fault.
    place: Option<Range<usize>>,
    /// What was found, under the marks.
    label: String,
    expected: Option<String>,
    help: Option<String>,
    /// Other places that matter, each with a word.
    related: Vec<(Range<usize>, String)>,
}

/// Result of reading a part of a scene.
pub(super) type Checked<T> = Result<T, Box<Fault>>;

impl Fault {
    /// A fault at a byte range of the source.
    pub fn at(place: Range<usize>, title: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            title: title.into(),
            place: Some(place),
            label: String::new(),
            expected: None,
            help: None,
            related: Vec::new(),
        })
    }

    /// A fault of the file as a whole.
    pub fn whole(title: impl Into<String>) -> Box<Self> {
        let mut fault = Self::at(0..0, title);
        fault.place = None;
        fault
    }

    pub fn label(mut self: Box<Self>, label: impl Into<String>) -> Box<Self> {
        self.label = label.into();
        self
    }

    pub fn expected(mut self: Box<Self>, expected: impl Into<String>) -> Box<Self> {
        self.expected = Some(expected.into());
        self
    }

    pub fn help(mut self: Box<Self>, help: impl Into<String>) -> Box<Self> {
        self.help = Some(help.into());
        self
    }

    /// Like [`Fault::help`], for a suggestion that there may not be.
    pub fn maybe_help(mut self: Box<Self>, help: Option<String>) -> Box<Self> {
        self.help = help.or(self.help);
        self
    }

    pub fn related(mut self: Box<Self>, place: Range<usize>, label: impl Into<String>) -> Box<Self> {
        self.related.push((place, label.into()));
        self
    }

    /// Ties the fault to the file it was found in.
    pub fn in_file(self: Box<Self>, path: &Path, source: &str) -> SceneError {
        Faults::from(self).in_file(path, source)
    }
}

impl SceneError {
    /// The file at fault.
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// The text at fault.
    pub fn source(&self) -> &str {
        &self.0.source
    }

    /// What is wrong, without the place; of the first mistake.
    pub fn title(&self) -> &str {
        self.0.faults.first().map_or("", |fault| &fault.title)
    }

    /// What to do about the first mistake.
    pub fn help(&self) -> Option<&str> {
        self.0.faults.first().and_then(|fault| fault.help.as_deref())
    }

    /// How many mistakes there are, at least one.
    pub fn count(&self) -> usize {
        self.0.faults.len()
    }

    /// Line and column of the first mistake, from 1, the column in characters; `None` where the file as a whole is at
    /// fault.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        self.place(self.0.faults.first()?)
    }

    fn place(&self, fault: &Fault) -> Option<(usize, usize)> {
        let place = fault.place.clone()?;
        Some(line_column(&self.0.source, clamped(&self.0.source, &place).start))
    }

    /// The messages with the lines they are about, as compilers show them; several lines, no line end after the last.
    pub fn render(&self, colour: bool) -> String {
        let faults = &self.0.faults;
        let mut parts: Vec<String> =
            faults.iter().take(MOST).map(|fault| self.render_one(fault, colour)).collect();
        match faults.len() {
            0 | 1 => {}
            count if count > MOST => {
                parts.push(format!("{count} mistakes, of which these are the first {MOST}"))
            }
            count => parts.push(format!("{count} mistakes")),
        }
        parts.join("\n\n")
    }

    fn render_one(&self, fault: &Fault, colour: bool) -> String {
        let Report { path, source, .. } = &*self.0;
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let path = path.to_string_lossy();
        let title = Level::ERROR.primary_title(fault.title.as_str());
        let mut group = match &fault.place {
            Some(place) => {
                let mark = AnnotationKind::Primary.span(clamped(source, place)).label(fault.label.as_str());
                let related = fault.related.iter().map(|(place, label)| {
                    AnnotationKind::Context.span(clamped(source, place)).label(label.as_str())
                });
                let snippet = Snippet::source(source.as_str()).path(path.as_ref());
                title.element(snippet.annotation(mark).annotations(related))
            }
            None => title.element(Level::NOTE.with_name("file").message(path)),
        };
        if let Some(expected) = &fault.expected {
            group = group.element(Level::NOTE.with_name("expected").message(expected.as_str()));
        }
        if let Some(help) = &fault.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        renderer.render(&[group])
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Report { path, faults, .. } = &*self.0;
        for (number, fault) in faults.iter().enumerate() {
            write!(f, "{}{}", if number == 0 { "" } else { "\n" }, path.display())?;
            if let Some((line, column)) = self.place(fault) {
                write!(f, ":{line}:{column}")?;
            }
            write!(f, ": {}", fault.title)?;
            if !fault.label.is_empty() {
                write!(f, ": {}", fault.label)?;
            }
            if let Some(expected) = &fault.expected {
                write!(f, "; expected {expected}")?;
            }
            if let Some(help) = &fault.help {
                write!(f, "; {help}")?;
            }
        }
        Ok(())
    }
}

impl fmt::Debug for SceneError {
    /// The rendered message: tests that unwrap a scene then show what a user would see.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{}", self.render(false))
    }
}

impl std::error::Error for SceneError {}

/// Line and column, from 1, of a byte offset; the column counts characters.
pub(super) fn line_column(source: &str, offset: usize) -> (usize, usize) {
    let before = &source[..clamped(source, &(offset..offset)).start];
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    // A byte order mark has no width.
    let line = before[line_start..].trim_start_matches('\u{FEFF}');
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}

/// The range moved onto character boundaries inside the source, so that no message can fail on its place.
fn clamped(source: &str, range: &Range<usize>) -> Range<usize> {
    let down = |mut at: usize| {
        at = at.min(source.len());
        while !source.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = down(range.start);
    start..down(range.end).max(start)
}
