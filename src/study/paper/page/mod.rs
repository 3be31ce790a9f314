//! The page: what holds, what does not, and why. Every number on it comes from [`Numbers`], and every
//! verdict from a comparison of them.

mod conclusions;
mod ensemble;
mod figures;
mod table1;

use super::super::Numbers;
use crate::report::{Document, shown};

/// Two motions closer than this, relative, are "almost the same".
const ALMOST: f64 = 0.01;
/// A response larger by this factor is "much larger".
const MUCH: f64 = 1.5;
/// A number read off the paper's text, "about", is met within this, relative.
const ABOUT: f64 = 0.1;

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
    page.table("", short(n));
    table1::section(&mut page, n);
    figures::section(&mut page, n);
    conclusions::section(&mut page, n);
    ensemble::section(&mut page, n);
    page
}

/// The paper's claims, each with its verdict.
fn short(n: &Numbers) -> Vec<Vec<String>> {
    let get = |key: &str| n.get(key);
    let apart =
        |what: &str| get(&format!("fig4.dmt.{what}_apart")).max(get(&format!("fig4.jkr.{what}_apart")));
    let same = apart("tip") / get("fig4.hertz.tip") < ALMOST && apart("top") / get("fig4.hertz.top") < ALMOST;
    let pairs =
        [("law.hertz.force_150", 1.8e-9), ("law.dmt.force_150", 1.5e-9), ("law.jkr.force_75", 0.4e-9)]
            .into_iter()
            .all(|(key, paper)| near(get(key), paper));
    vec![
        row(&["the paper", "here", "why"]),
        vec![
            "K = 1.8×10⁵ N/m²".into(),
            verdict(near(get("contact.modulus"), 1.8e5)),
            format!("{} with a rigid tip.", shown(get("contact.modulus"), "N/m^2", 5)),
        ],
        vec![
            "tip travel almost the same under the three laws".into(),
            verdict(same),
            format!(
                "At most {} apart on {}: adhesion pulls with at most {}, the lever has {}.",
                shown(apart("tip"), "m", 2),
                n.shown("fig4.hertz.tip", 3),
                n.shown("dmt.pull_off", 3),
                n.shown("lever.stiffness", 3)
            ),
        ],
        vec![
            "deformations quite different, JKR's half of the others'".into(),
            verdict(near(get("scaled.jkr.depth"), 0.5 * get("scaled.hertz.depth"))),
            "Deformation is travel less gap, and the travel is the same. Half comes out only if a²/R is taken for \
             the travel."
                .into(),
        ],
        vec![
            "forces of 1.8, 1.5 and 0.4 nN at 15 V".into(),
            verdict(near(get("fig4.hertz.force_max"), 1.8e-9)),
            format!(
                "At 15 V the tip goes {} deep and Hertz pushes with {}; it takes {} to go 150 nm deep.",
                n.shown("fig4.hertz.depth", 3),
                n.shown("fig4.hertz.force_max", 3),
                n.shown("scaled.voltage", 4)
            ),
        ],
        vec![
            "these forces belong to 150, 150 and 75 nm".into(),
            verdict(pairs),
            format!(
                "{}, {} and {} there: the paper's numbers agree with each other.",
                n.shown("law.hertz.force_150", 3),
                n.shown("law.dmt.force_150", 3),
                n.shown("law.jkr.force_75", 3)
            ),
        ],
        vec![
            "the rod's top moves as without the lever".into(),
            verdict((get("coupling.coupled.top_ratio") - 1.0).abs() < ALMOST),
            format!("The beam weighs {} of the rod.", n.shown("mass.lever_over_rod", 2)),
        ],
        vec![
            "the tip of the coupled system moves much farther".into(),
            verdict(get("coupling.coupled.tip_ratio") > MUCH),
            format!(
                "It moves {} times as far. (13) as printed counts the base motion twice: {} times.",
                n.shown("coupling.coupled.tip_ratio", 7),
                n.shown("coupling.printed.tip_ratio", 6)
            ),
        ],
    ]
}

fn near(value: f64, paper: f64) -> bool {
    (value / paper - 1.0).abs() <= ABOUT
}

fn verdict(holds: bool) -> String {
    (if holds { "holds" } else { "does not hold" }).to_owned()
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
