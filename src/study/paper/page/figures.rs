//! Sections 2 and 3: figures 3 and 4.

use super::super::super::Numbers;
use super::row;
use crate::report::{Document, shown};

pub(super) fn section(page: &mut Document, n: &Numbers) {
    figure_3(page, n);
    figure_4(page, n);
}

fn figure_3(page: &mut Document, n: &Numbers) {
    page.heading("2. Figure 3: force against deformation");
    page.figure(
        "figure_3.svg",
        "Force on the tip against deformation under the three laws; K, w and R of the paper.",
    );
    page.paragraph(
        "Holds.",
        "The figure's shapes: Hertz never pulls, DMT is Hertz less 2πRw, JKR has two branches.",
    );
    page.paragraph(
        "To be added.",
        format!(
            "A tip held by its lever does not follow JKR's whole curve: it jumps in at zero deformation, where the \
             force becomes {}, and lets go at the fold, {} above the surface, with {}. Once around loses {}, however \
             the tip is driven.",
            n.shown("jkr.jump_force", 4),
            shown(-n.get("jkr.fold_depth"), "m", 4),
            n.shown("jkr.fold_force", 4),
            n.shown("jkr.loss", 5)
        ),
    );
}

fn figure_4(page: &mut Document, n: &Numbers) {
    page.heading("3. Figure 4: the run");
    page.figure(
        "figure_4.svg",
        "Figure 4 (a) to (d) as printed: 15 V at 30 kHz from rest, undamped. The lines of the three laws lie on each \
         other in (a) to (c). Undamped from rest, the run never settles: its status is not_steady.",
    );
    page.figure("figure_4_scaled.svg", "The same with the drive at which a²/R reaches 150 nm under Hertz.");
    page.figure(
        "figure_4_readings.svg",
        "Figure 4 (c) and (d), both readings, at that drive: deformation as travel less gap (the law decides the \
         force), or a²/R as travel less gap (the law decides the deformation too).",
    );
    page.table(
        "The paper's numbers against ours, largest values of the run; the ratio is ours over the paper's.",
        table(n),
    );
    travel(page, n);
    half_deformation(page, n);
    page.paragraph(
        "Mind.",
        format!(
            "At 15 V the contact radius is {} of the tip radius under Hertz, at 150 nm {}: far outside the small \
             strains (0.3) that all three laws assume.",
            shown((n.get("fig4.hertz.depth") / 30e-9).sqrt(), "1", 2),
            shown((150e-9f64 / 30e-9).sqrt(), "1", 2)
        ),
    );
}

/// How far rod and tip go at 15 V, and with which forces.
fn travel(page: &mut Document, n: &Numbers) {
    page.paragraph(
        "Holds.",
        format!(
            "Travel of rod and tip hardly depends on the law: at 15 V DMT moves the tip by at most {} and JKR by {} \
             from where Hertz has it. At 150 nm Hertz and DMT push as the paper says.",
            n.shown("fig4.dmt.tip_apart", 2),
            n.shown("fig4.jkr.tip_apart", 2)
        ),
    );
    page.paragraph(
        "Does not hold.",
        format!(
            "The levels: with Table 1 and 15 V the tip travels {}, not 150 nm, and adhesion decides the force: DMT \
             goes down to {}, and JKR touches {} and never lets go, because its fold lies {} above the surface. \
             None of the choices above bridges the factor of {}; with (13) as printed the tip goes {} deep.",
            n.shown("fig4.hertz.tip", 3),
            n.shown("fig4.dmt.force_min", 3),
            times(n.get("fig4.jkr.touches")),
            shown(-n.get("jkr.fold_depth"), "m", 3),
            shown(n.get("scaled.voltage") / 15.0, "1", 3),
            n.shown("coupling.printed.depth", 3)
        ),
    );
}

/// Why JKR's deformation is no half of the others'.
fn half_deformation(page: &mut Document, n: &Numbers) {
    page.paragraph(
        "Does not hold.",
        format!(
            "Half the deformation under JKR at the same tip travel: deformation is travel less gap under every law. \
             The paper's 75 nm and 0.4 nN come from taking a from a²/R = travel less gap, as under Hertz, and then \
             the deformation from (16b): {} and {} at 150 nm. Taken the right way round, 75 nm go with {} and a = {}, \
             and 150 nm with {}.",
            n.shown("law.jkr.depth_read", 3),
            n.shown("law.jkr.force_read", 3),
            n.shown("law.jkr.force_75", 3),
            n.shown("law.jkr.radius_75", 3),
            n.shown("law.jkr.force_150", 3)
        ),
    );
}

fn times(count: f64) -> String {
    if count == 1.0 { "once".to_owned() } else { format!("{} times", shown(count, "1", 3)) }
}

/// Paper, ours at 15 V, ours at the scaled drive, ours in the paper's reading.
fn table(n: &Numbers) -> Vec<Vec<String>> {
    let soft = "15 V moves the tip a few nm; the pair is right at 150 nm.";
    let lines = [
        ("Hertz, deformation", 150e-9, "hertz.depth", "scaled.hertz.depth", "The drive is scaled to it."),
        ("DMT, deformation", 150e-9, "dmt.depth", "scaled.dmt.depth", "Same travel, same deformation."),
        (
            "JKR, deformation",
            75e-9,
            "jkr.depth",
            "reading.jkr.depth",
            "Half only in the paper's reading of a²/R.",
        ),
        ("Hertz, force", 1.8e-9, "hertz.force_max", "scaled.hertz.force_max", soft),
        (
            "DMT, force",
            1.5e-9,
            "dmt.force_max",
            "scaled.dmt.force_max",
            "At 15 V DMT only pulls; at 150 nm it is Hertz less 2πRw.",
        ),
        (
            "JKR, force",
            0.4e-9,
            "jkr.force_max",
            "reading.jkr.force_max",
            "At 15 V JKR only pulls; 0.4 nN belongs to the reading.",
        ),
    ];
    let mut rows = vec![row(&[
        "",
        "paper",
        "15 V",
        "ratio",
        "scaled drive",
        "ratio",
        "the paper's reading",
        "ratio",
        "why",
    ])];
    for (name, paper, key, read, why) in lines {
        let units = if name.ends_with("force") { "N" } else { "m" };
        let mut cells = vec![name.to_owned(), shown(paper, units, 3)];
        for key in [&format!("fig4.{key}"), &format!("scaled.{key}"), read] {
            cells.push(n.shown(key, 3));
            cells.push(shown(n.get(key) / paper, "1", 2));
        }
        cells.push(why.to_owned());
        rows.push(cells);
    }
    rows
}
