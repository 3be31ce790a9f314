//! The page: what holds, what does not, and why. Every number on it comes from [`Numbers`], and every
//! verdict from a comparison of them.

mod claims;
mod conclusions;
mod ensemble_section;
mod figures;
mod table1_section;

use super::super::Numbers;
use crate::report::{Document, shown};

/// What stands in a folder before the study is done.
pub(super) fn placeholder(generator: &str) -> (String, String) {
    let mut document =
        Document { title: "The paper, reproduced and questioned".into(), ..Document::default() };
    document.paragraph("Not finished.", "The study was stopped before its page was written; make it again.");
    ("index.html".into(), document.html(generator))
}

/// The whole page; `machine` is its one line that differs from machine to machine.
pub(super) fn document(n: &Numbers, machine: &str) -> Document {
    let mut page = Document { title: "The paper, reproduced and questioned".into(), ..Document::default() };
    page.paragraph(
        "",
        "J.-L. Ha, R.-F. Fung and Y.-C. Chen, \"Dynamic Responses of an Atomic Force Microscope Interacting With \
         Samples\", J. Dyn. Syst. Meas. Control 127(4), 705-709 (2005), run again with afmsweep: a piezoelectric \
         rod driven at 30 kHz by 15 V carries a cantilever whose tip taps a soft, sticky sample 0.3 nm away. \
         Made by the command \"afmsweep study paper\", which writes this page, its pictures, numbers.csv (every number below, \
         with more digits) and the results files; its scenes are in scenes/.",
    );
    page.paragraph("", machine);
    page.heading("In short");
    page.table("", claims::table(n));
    table1_section::section(&mut page, n);
    figures::section(&mut page, n);
    conclusions::section(&mut page, n);
    ensemble_section::section(&mut page, n);
    page
}

fn row(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| (*cell).to_owned()).collect()
}

/// A share as a percentage.
fn percent(share: f64, digits: usize) -> String {
    format!("{} %", shown(100.0 * share, "1", digits))
}

/// What `value` is above `reference`, as a percentage with its sign.
fn change(value: f64, reference: f64, digits: usize) -> String {
    let change = value / reference - 1.0;
    format!("{}{}", if change > 0.0 { "+" } else { "" }, percent(change, digits))
}
