//! What is wrong with a scene file, where, and what to write instead.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why a scene cannot be used, with its place in the file.
///
/// `Display` gives one line (`file:line:column: what is wrong; expected ...; what to do`), for logs and
/// for wrapping; [`SceneError::render`] shows the lines of the file with the place marked.
#[derive(Clone)]
pub struct SceneError(Box<Report>);

#[derive(Clone, Debug)]
struct Report {
    path: PathBuf,
    source: String,
    fault: Box<Fault>,
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
        SceneError(Box::new(Report { path: path.to_path_buf(), source: source.to_string(), fault: self }))
    }
}

impl SceneError {
    /// The file at fault.
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// What is wrong, without the place.
    pub fn title(&self) -> &str {
        &self.0.fault.title
    }

    /// Line and column of the place, from 1, the column in characters; `None` where the file as a whole is at fault.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        let place = self.0.fault.place.clone()?;
        Some(line_column(&self.0.source, clamped(&self.0.source, &place).start))
    }

    /// The message with the lines it is about, as compilers show them; several lines, no line end after the last.
    pub fn render(&self, colour: bool) -> String {
        let Report { path, source, fault } = &*self.0;
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
        let Report { path, fault, .. } = &*self.0;
        write!(f, "{}", path.display())?;
        if let Some((line, column)) = self.line_column() {
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
