//! Section 5: what the paper could not do.

use super::super::super::Numbers;
use super::super::LAWS;
use super::{percent, row};
use crate::report::Document;

pub(super) fn section(page: &mut Document, n: &Numbers) {
    page.heading("5. What the paper could not do: its three parameters at once");
    page.paragraph(
        "",
        format!(
            "{} instances under each law: sample modulus from 10 kPa to 10 GPa, work of adhesion from 1 to 100 mJ/m², \
             tip radius from 10 to 100 nm; drive and gap as in the paper, Q = 100 so that runs can settle, accuracy \
             1 %. White dots mark instances that did not settle; grey is no value: the sample only pulls, or nothing is \
             lost because the tip never lets go.",
            n.shown("ensemble.jkr.instances", 6)
        ),
    );
    page.table(
        "Of the instances that settled: smallest; median; largest. Loss under JKR: where the tip lets go.",
        summary(n),
    );
    maps(page);
    verdicts(page, n);
}

fn maps(page: &mut Document) {
    for (file, caption) in [
        (
            "ensemble_force.svg",
            "Largest force. Hertz does not know adhesion; DMT and JKR push only where the sample is stiff enough.",
        ),
        ("ensemble_deformation.svg", "Largest deformation: set by drive and gap until the sample stiffens."),
        ("ensemble_contact.svg", "Share of the period in contact."),
        ("ensemble_loss.svg", "Loss per period under JKR for three tip radii; Hertz and DMT lose nothing."),
        (
            "ensemble_regimes.svg",
            "Where JKR lets go, and where it belongs by Tabor's parameter, for three tip radii.",
        ),
    ] {
        page.figure(file, caption);
    }
}

/// Where JKR holds the tip for good, where each law is at home, and how exact the numbers are.
fn verdicts(page: &mut Document, n: &Numbers) {
    page.paragraph(
        "Where JKR never lets go.",
        format!(
            "In {} of the instances: soft, sticky, blunt. The border is where the fold is as high as the tip comes, \
             3a_s²/R = amplitude + gap less what the pull at the fold bends the lever by; it foretells {} of all \
             instances right. On the paper's own sample the fold is {} times as high as the tip comes.",
            percent(n.get("jkr.never"), 3),
            percent(n.get("jkr.foretold"), 4),
            n.shown("jkr.fold_over_reach", 2)
        ),
    );
    page.paragraph(
        "Which law.",
        format!(
            "By Tabor's parameter JKR fits {} of the grid, DMT {}, and {} lie between. The largest force under Hertz \
             is within 10 % of JKR's in {}, under DMT in {}. In {} the contact radius passes 0.3 of the tip's: there no \
             law of the three is at home.",
            percent(n.get("regime.jkr"), 3),
            percent(n.get("regime.dmt"), 3),
            percent(n.get("regime.between"), 3),
            percent(n.get("regime.hertz_near"), 3),
            percent(n.get("regime.dmt_near"), 3),
            percent(n.get("regime.strained"), 3)
        ),
    );
    page.paragraph(
        "How exact.",
        format!(
            "With one tap a period ({} of the instances) JKR's loss has the closed form 1.27494 πRw(π²w²R/K²)^(1/3): \
             median error {}, {} of them within 1 %. On stiff, hardly sticky samples the loss is a small difference of \
             what the sample stores and gives back: of that the error is at most {}. Hertz and DMT lose nothing; \
             what the table shows for them is error of the same kind.",
            percent(n.get("jkr.single_taps"), 3),
            percent(n.get("jkr.loss_error"), 1),
            percent(n.get("jkr.loss_close"), 3),
            percent(n.get("jkr.loss_error_stored"), 1)
        ),
    );
}

fn summary(n: &Numbers) -> Vec<Vec<String>> {
    let mut rows = vec![row(&["", "Hertz", "DMT", "JKR"])];
    let lines = [
        ("largest force", "force_max"),
        ("largest deformation", "depth"),
        ("share of the period in contact", "contact_time"),
        ("loss per period", "loss"),
    ];
    for (name, what) in lines {
        let mut cells = vec![name.to_owned()];
        for (law, _) in LAWS {
            let of = |which: &str| n.shown(&format!("ensemble.{law}.{what}.{which}"), 3);
            cells.push(format!("{}; {}; {}", of("least"), of("median"), of("most")));
        }
        rows.push(cells);
    }
    for (name, what) in [("did not settle", "not_steady"), ("without a result", "failed")] {
        let mut cells = vec![name.to_owned()];
        cells.extend(LAWS.map(|(law, _)| percent(n.get(&format!("ensemble.{law}.{what}")), 3)));
        rows.push(cells);
    }
    rows
}
