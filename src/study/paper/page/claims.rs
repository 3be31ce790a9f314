//! In short: the paper's claims, each with its verdict.

use super::super::super::Numbers;
use super::row;
use crate::report::shown;

/// Two motions closer than this, relative, are "almost the same".
const ALMOST: f64 = 0.01;
/// A response larger by this factor is "much larger".
const MUCH: f64 = 1.5;
/// A number read off the paper's text, "about", is met within this, relative.
const ABOUT: f64 = 0.1;

/// One line for each claim.
pub(super) fn table(n: &Numbers) -> Vec<Vec<String>> {
    let mut rows = vec![row(&["the paper", "here", "why"]), modulus(n), travel(n), deformations(n)];
    rows.extend(forces(n));
    rows.extend(coupling(n));
    rows
}

fn claim(paper: &str, holds: bool, why: String) -> Vec<String> {
    vec![paper.to_owned(), (if holds { "holds" } else { "does not hold" }).to_owned(), why]
}

fn modulus(n: &Numbers) -> Vec<String> {
    let modulus = n.get("contact.modulus");
    claim(
        "K = 1.8×10⁵ N/m²",
        near(modulus, 1.8e5),
        format!("{} with a rigid tip.", shown(modulus, "N/m^2", 5)),
    )
}

fn travel(n: &Numbers) -> Vec<String> {
    let apart =
        |what: &str| n.get(&format!("fig4.dmt.{what}_apart")).max(n.get(&format!("fig4.jkr.{what}_apart")));
    let same = |what: &str| apart(what) / n.get(&format!("fig4.hertz.{what}")) < ALMOST;
    claim(
        "tip travel almost the same under the three laws",
        same("tip") && same("top"),
        format!(
            "At most {} apart on {}: adhesion pulls with at most {}, the lever has {}.",
            shown(apart("tip"), "m", 2),
            n.shown("fig4.hertz.tip", 3),
            n.shown("dmt.pull_off", 3),
            n.shown("lever.stiffness", 3)
        ),
    )
}

fn deformations(n: &Numbers) -> Vec<String> {
    claim(
        "deformations quite different, JKR's half of the others'",
        near(n.get("scaled.jkr.depth"), 0.5 * n.get("scaled.hertz.depth")),
        "Deformation is travel less gap, and the travel is the same. Half comes out only if a²/R is taken for \
         the travel."
            .into(),
    )
}

/// The forces as levels at the paper's drive, and as pairs with the deformations.
fn forces(n: &Numbers) -> [Vec<String>; 2] {
    let pairs =
        [("law.hertz.force_150", 1.8e-9), ("law.dmt.force_150", 1.5e-9), ("law.jkr.force_75", 0.4e-9)]
            .into_iter()
            .all(|(key, paper)| near(n.get(key), paper));
    [
        claim(
            "forces of 1.8, 1.5 and 0.4 nN at 15 V",
            near(n.get("fig4.hertz.force_max"), 1.8e-9),
            format!(
                "At 15 V the tip goes {} deep and Hertz pushes with {}; it takes {} to go 150 nm deep.",
                n.shown("fig4.hertz.depth", 3),
                n.shown("fig4.hertz.force_max", 3),
                n.shown("scaled.voltage", 4)
            ),
        ),
        claim(
            "these forces belong to 150, 150 and 75 nm",
            pairs,
            format!(
                "{}, {} and {} there: the paper's numbers agree with each other.",
                n.shown("law.hertz.force_150", 3),
                n.shown("law.dmt.force_150", 3),
                n.shown("law.jkr.force_75", 3)
            ),
        ),
    ]
}

/// What coupling does to the rod's top, and to the tip.
fn coupling(n: &Numbers) -> [Vec<String>; 2] {
    [
        claim(
            "the rod's top moves as without the lever",
            (n.get("coupling.coupled.top_ratio") - 1.0).abs() < ALMOST,
            format!("The beam weighs {} of the rod.", n.shown("mass.lever_over_rod", 2)),
        ),
        claim(
            "the tip of the coupled system moves much farther",
            n.get("coupling.coupled.tip_ratio") > MUCH,
            format!(
                "It moves {} times as far. (13) as printed counts the base motion twice: {} times.",
                n.shown("coupling.coupled.tip_ratio", 7),
                n.shown("coupling.printed.tip_ratio", 6)
            ),
        ),
    ]
}

fn near(value: f64, paper: f64) -> bool {
    (value / paper - 1.0).abs() <= ABOUT
}
