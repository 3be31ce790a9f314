//! The page around the pictures: HTML to look at, Markdown to paste.

use super::document::{self, code, escape, plain};
use super::labels::capital;
use super::labels::is_long;
use super::picture::{Picture, PictureKind};
use super::pictures::DrawnPicture;
use super::{EXPLORE, MARKER, hover, tables};
use crate::store::{Attribute, Results};
use std::fmt::Write;
use std::path::Path;

/// Pictures larger than this stay outside the page, in bytes.
const MOST_INLINE: usize = 3_000_000;
/// Bytes of a text that are shown at most.
const MOST_TEXT: usize = 20_000;

/// What stands above the spectra.
const SPECTRA: &str = "Spectra";

/// The title of the page.
pub(super) fn heading(results: &Results, file: &Path) -> String {
    match results.title.trim() {
        "" => file.file_name().map_or_else(|| "Results".into(), |name| name.to_string_lossy().into_owned()),
        title => title.to_owned(),
    }
}

/// Long texts: name and content, cut where the whole would be a burden.
fn texts(results: &Results) -> Vec<(String, String)> {
    let long = results.attributes.iter().filter_map(|(name, value)| match value {
        Attribute::Text(text) if is_long(text) => Some((name, text)),
        _ => None,
    });
    let provenance = results.provenance.iter().map(|(name, text)| (name, text));
    let told = |(name, text): (&String, &String)| {
        let label = match name.as_str() {
            "scene" => "The scene as written".to_owned(),
            "scene_resolved" => "The scene with every value used".to_owned(),
            "plan" => "The plan in full (JSON)".to_owned(),
            "policy" => "The numbers of error control".to_owned(),
            other => capital(&other.replace('_', " ")),
        };
        (label, cut(text))
    };
    provenance.chain(long).map(told).collect()
}

/// The beginning of a text that is very long, and where the rest is.
fn cut(text: &str) -> String {
    if text.len() <= MOST_TEXT {
        return text.to_owned();
    }
    let end = (0..=MOST_TEXT).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    format!("{}\n... {} more bytes are in the results file", &text[..end], text.len() - end)
}

/// `index.html`: findings, pictures, tables, and how it was computed.
pub(super) fn html(
    results: &Results,
    file: &Path,
    (DrawnPicture { pictures, left_out }, findings, explore): (&DrawnPicture, &[String], bool),
) -> String {
    let mut page = document::open(&heading(results, file), MARKER);
    // Writing to a String cannot fail.
    let _ = writeln!(page, "<p>From <code>{}</code>.</p>", escape(&file.display().to_string()));
    if explore {
        let _ = writeln!(
            page,
            "<p><a href=\"{EXPLORE}\">{EXPLORE}</a> explores the results: sliders, maps, curves, brushes.</p>"
        );
    }
    for line in findings {
        let _ = writeln!(page, "<p class=\"finding\">{}</p>", escape(line));
    }
    if pictures.is_empty() {
        page.push_str(
            "<p>A single case has no pictures of its observables; the table below holds them.</p>\n",
        );
    }
    figures(&mut page, of_kind(pictures, PictureKind::Asked));
    if of_kind(pictures, PictureKind::Spectrum).next().is_some() {
        let _ = writeln!(page, "<h2>{SPECTRA}</h2>");
        figures(&mut page, of_kind(pictures, PictureKind::Spectrum));
    }
    for line in left_out {
        let _ = writeln!(page, "<p class=\"caption\">Not drawn: {}</p>", escape(line));
    }
    for table in tables::results(results) {
        let _ = writeln!(page, "<h2>{}</h2>", escape(&table.caption));
        page.push_str(&table.html());
    }
    page.push_str("<details><summary>How it was computed</summary>\n");
    for table in tables::computed(results) {
        let _ = writeln!(page, "<h2>{}</h2>", escape(&table.caption));
        page.push_str(&table.html());
    }
    figures(&mut page, of_kind(pictures, PictureKind::Computed));
    page.push_str("</details>\n");
    for (name, text) in texts(results) {
        let (name, text) = (escape(&name), escape(&text));
        let _ = writeln!(page, "<details><summary>{name}</summary><pre>{text}</pre></details>");
    }
    let _ = writeln!(page, "<script>{}</script>", hover::SCRIPT);
    page.push_str(document::CLOSE);
    page
}

fn of_kind(pictures: &[Picture], kind: PictureKind) -> impl Iterator<Item = &Picture> {
    pictures.iter().filter(move |picture| picture.kind == kind)
}

/// Pictures beside each other as far as the page has room, wide ones alone.
fn figures<'a>(page: &mut String, pictures: impl Iterator<Item = &'a Picture>) {
    page.push_str("<div class=\"pictures\">\n");
    pictures.for_each(|picture| page.push_str(&figure(picture)));
    page.push_str("</div>\n");
}

/// Whether a picture is too wide to stand beside another.
fn is_wide(svg: &str) -> bool {
    let width = svg.split_once("width=\"").and_then(|(_, rest)| rest.split_once('"'));
    width.and_then(|(width, _)| width.parse::<f64>().ok()).is_some_and(|width| width > 800.0)
}

/// A picture in the page, with what the pointer is told of it.
fn figure(picture: &Picture) -> String {
    let (name, note, file) = (escape(&picture.title), escape(&picture.note), escape(&picture.file()));
    let mut text = format!("<figure{}>\n", if is_wide(&picture.svg) { " class=\"alone\"" } else { "" });
    if picture.svg.len() <= MOST_INLINE {
        let _ = writeln!(text, "<div class=\"wide\">{}</div>", picture.svg);
        if let Some(json) = picture.hover.json() {
            let _ = writeln!(text, "<script type=\"application/json\">{json}</script>");
        }
    } else {
        let _ = writeln!(text, "<div class=\"wide\"><img src=\"{file}\" alt=\"{name}\"/></div>");
    }
    let csv = match &picture.csv {
        Some(_) => format!(", <a href=\"{0}.csv\">{0}.csv</a>", escape(&picture.name)),
        None => String::new(),
    };
    let _ = writeln!(
        text,
        "<figcaption>{name}. {note} <a href=\"{file}\">{file}</a>{csv}</figcaption>\n</figure>"
    );
    text
}

/// `report.md`, in the same order.
pub(super) fn markdown(
    results: &Results,
    file: &Path,
    (DrawnPicture { pictures, left_out }, findings): (&DrawnPicture, &[String]),
) -> String {
    let mut page = String::new();
    let _ = write!(page, "# {}\n\n", plain(&heading(results, file)));
    let _ = write!(page, "From {}.\n\n", code(&file.display().to_string()));
    for line in findings {
        let _ = write!(page, "{}\n\n", plain(line));
    }
    let show = |page: &mut String, kind: PictureKind| {
        for picture in of_kind(pictures, kind) {
            let title = plain(&picture.title);
            let _ = write!(page, "## {title}\n\n![{title}]({})\n\n", picture.file());
            if !picture.note.is_empty() {
                let _ = write!(page, "{}\n\n", plain(&picture.note));
            }
        }
    };
    show(&mut page, PictureKind::Asked);
    show(&mut page, PictureKind::Spectrum);
    for line in left_out {
        let _ = write!(page, "Not drawn: {}\n\n", plain(line));
    }
    for table in tables::results(results).into_iter().chain(tables::computed(results)) {
        let _ = write!(page, "## {}\n\n{}\n", table.caption, table.markdown());
    }
    show(&mut page, PictureKind::Computed);
    for (name, text) in texts(results) {
        // Indented text needs no fence that the text itself might hold.
        let _ = write!(page, "## {}\n\n", plain(&name));
        for line in text.lines() {
            let _ = writeln!(page, "    {line}");
        }
        page.push('\n');
    }
    page
}
