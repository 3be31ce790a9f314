//! Section 1: Table 1 and the choices it leaves.

use super::super::super::Numbers;
use super::{change, row};
use crate::report::{Document, shown};

pub(super) fn section(page: &mut Document, n: &Numbers) {
    page.heading("1. Table 1, what follows from it, and the choices it leaves");
    let mut rows = vec![row(&["quantity", "value"])];
    let prefixes = ["mass.", "rod.", "lever.", "coupled.", "tip.", "contact.", "dmt.", "jkr."];
    for number in n.iter().take_while(|number| !number.key.starts_with("choice.")) {
        if prefixes.iter().any(|prefix| number.key.starts_with(prefix)) {
            rows.push(vec![number.meaning.clone(), n.shown(&number.key, 7)]);
        }
    }
    page.table("Everything undamped, as in the paper; the tip rigid.", rows);
    page.table(
        "Where the printed text leaves a choice or cannot be followed: what the other reading would change.",
        choices(n),
    );
    page.paragraph(
        "Why these.",
        "The field: between electrodes at the rod's ends lies no free charge, so the electric displacement is uniform and not \
         the field. In (2) and (10) the deflection v counts from the moving base, so v(0) = 0 and (13) cannot hold \
         as printed. Figure 4 itself does not use (17b): its DMT and Hertz deformations agree. (18) is singular at \
         D = D0 unless D is negative outside contact.",
    );
}

/// One line for each choice: ours, theirs, a quantity under both.
fn choices(n: &Numbers) -> Vec<Vec<String>> {
    let (first, tip, beam) = ("first frequency", "amplitude of the free tip", "first frequency of the beam");
    let choices = [
        [
            "uniform displacement D, (9)",
            "uniform field E, (11)",
            first,
            "coupled.frequency_1",
            "choice.field.frequency",
        ],
        ["v(0) = 0, (2)", "v(0) = u(l_p), (13)", tip, "tip.amplitude", "choice.printed.tip"],
        ["30 kHz", "30 krad/s", tip, "tip.amplitude", "choice.radians.tip"],
        ["tip mass on its arm", "tip mass at the beam's end", beam, "choice.tip.on_arm", "choice.tip.at_end"],
        ["tip mass on its arm", "no tip mass", beam, "choice.tip.on_arm", "choice.tip.none"],
        ["rigid tip", "tip of silicon, 130 GPa", "K", "contact.modulus", "choice.tip.modulus"],
        [
            "a²/R, the text of 3.3",
            "JKR's deformation, (17b)",
            "DMT's force at 150 nm",
            "choice.profile.hertz",
            "choice.profile.printed",
        ],
        [
            "(1 + D/D0)²",
            "(1 - D/D0)², (18)",
            "DMT's force at D0/2 outside",
            "choice.attraction.ours",
            "choice.attraction.printed",
        ],
    ];
    let mut rows = vec![row(&["here", "other reading", "quantity", "here", "other", "change"])];
    for [ours, other, meaning, key, theirs] in choices {
        let (a, b) = (n.get(key), n.get(theirs));
        rows.push(vec![
            ours.into(),
            other.into(),
            meaning.into(),
            n.shown(key, 5),
            n.shown(theirs, 5),
            change(b, a, 3),
        ]);
    }
    rows.push(vec![
        "a²/R, the text of 3.3".into(),
        "JKR's deformation, (17b)".into(),
        "DMT's deformation where a²/R is 150 nm".into(),
        shown(150e-9, "m", 5),
        n.shown("choice.profile.depth", 5),
        change(n.get("choice.profile.depth"), 150e-9, 3),
    ]);
    rows
}
