//! The page.
use super::super::Numbers;
use crate::report::Document;

pub(super) fn placeholder(generator: &str) -> (String, String) {
    let document = Document { title: "being made".into(), ..Document::default() };
    ("index.html".into(), document.html(generator))
}

pub(super) fn document(_numbers: &Numbers, machine: &str) -> Document {
    let mut d = Document { title: "x".into(), ..Document::default() };
    d.paragraph("", machine);
    d
}
