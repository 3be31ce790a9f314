//! Tables of the page that set numbers against each other.

use super::super::super::Numbers;
use super::percent;
use crate::report::shown;

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// What follows from Table 1.
pub(super) fn table_1(n: &Numbers) -> Vec<Vec<String>> {
    let prefixes = ["mass.", "rod.", "lever.", "coupled.", "tip.", "contact.", "dmt.", "jkr."];
    let first = n.iter().take_while(|number| !number.key.starts_with("choice."));
    let shown = first.filter(|number| prefixes.iter().any(|prefix| number.key.starts_with(prefix)));
    let rows = shown.map(|number| vec![number.meaning.clone(), n.shown(&number.key, 7)]);
    std::iter::once(row(["quantity", "value"])).chain(rows).collect()
}

/// One line for each choice: ours, theirs, a quantity under both.
pub(super) fn choices(n: &Numbers) -> Vec<Vec<String>> {
    let (first, tip, beam) = ("first frequency", "amplitude of the free tip", "first frequency of the beam");
    let field = ["uniform displacement D, (9)", "uniform field E, (11)", first];
    let arm = ["tip mass on its arm", "tip mass at the beam's end", beam];
    let depth = "DMT's deformation where a²/R is 150 nm";
    let choices = [
        (field, "coupled.frequency_1", "choice.field.frequency"),
        (["v(0) = 0, (2)", "v(0) = u(l_p), (13)", tip], "tip.amplitude", "choice.printed.tip"),
        (["30 kHz", "30 krad/s", tip], "tip.amplitude", "choice.radians.tip"),
        (arm, "choice.tip.on_arm", "choice.tip.at_end"),
        (["tip mass on its arm", "no tip mass", beam], "choice.tip.on_arm", "choice.tip.none"),
        (["rigid tip", "tip of silicon, 130 GPa", "K"], "contact.modulus", "choice.tip.modulus"),
        ([PROFILE[0], PROFILE[1], "DMT's force at 150 nm"], "choice.profile.hertz", "choice.profile.printed"),
        (
            ["(1 + D/D0)²", "(1 - D/D0)², (18)", "DMT's force at D0/2 outside"],
            "choice.attraction.ours",
            "choice.attraction.printed",
        ),
        ([PROFILE[0], PROFILE[1], depth], "", "choice.profile.depth"),
    ];
    let mut rows = vec![row(["here", "other reading", "quantity", "here", "other", "change"])];
    for (words, ours, theirs) in choices {
        let (here, told) = match ours {
            "" => (150e-9, shown(150e-9, "m", 5)),
            ours => (n.get(ours), n.shown(ours, 5)),
        };
        let change = n.get(theirs) / here - 1.0;
        let change = format!("{}{}", if change > 0.0 { "+" } else { "" }, percent(change, 3));
        rows.push([row(words), vec![told, n.shown(theirs, 5), change]].concat());
    }
    rows
}

/// The two readings of the deformation's profile.
const PROFILE: [&str; 2] = ["a²/R, the text of 3.3", "JKR's deformation, (17b)"];

/// Paper, ours at 15 V, ours at the scaled drive, ours in the paper's reading.
pub(super) fn figure_4(n: &Numbers) -> Vec<Vec<String>> {
    let soft = "15 V moves the tip a few nm; the pair is right at 150 nm.";
    let dmt = "At 15 V DMT only pulls; at 150 nm it is Hertz less 2πRw.";
    let jkr = "At 15 V JKR only pulls; 0.4 nN belongs to the reading.";
    let half = "Half only in the paper's reading of a²/R.";
    let lines = [
        ("Hertz, deformation", 150e-9, "hertz.depth", "scaled.hertz.depth", "The drive is scaled to it."),
        ("DMT, deformation", 150e-9, "dmt.depth", "scaled.dmt.depth", "Same travel, same deformation."),
        ("JKR, deformation", 75e-9, "jkr.depth", "reading.jkr.depth", half),
        ("Hertz, force", 1.8e-9, "hertz.force_max", "scaled.hertz.force_max", soft),
        ("DMT, force", 1.5e-9, "dmt.force_max", "scaled.dmt.force_max", dmt),
        ("JKR, force", 0.4e-9, "jkr.force_max", "reading.jkr.force_max", jkr),
    ];
    let head = ["", "paper", "15 V", "ratio", "scaled drive", "ratio", "the paper's reading", "ratio", "why"];
    let mut rows = vec![row(head)];
    for (name, paper, key, read, why) in lines {
        let units = if name.ends_with("force") { "N" } else { "m" };
        let mut cells = vec![name.to_owned(), shown(paper, units, 3)];
        for key in [&format!("fig4.{key}"), &format!("scaled.{key}"), read] {
            cells.extend([n.shown(key, 3), shown(n.get(key) / paper, "1", 2)]);
        }
        cells.push(why.to_owned());
        rows.push(cells);
    }
    rows
}
