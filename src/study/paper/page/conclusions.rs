//! Section 4: the paper's two conclusions, tested.

use super::super::super::Numbers;
use super::{percent, row};
use crate::report::{Document, shown};

pub(super) fn section(page: &mut Document, n: &Numbers) {
    page.heading("4. The two conclusions");
    coupling(page, n);
    when_coupling_matters(page, n);
    deformation(page, n);
}

/// Conclusion 1: what coupling does to the rod's top and to the tip.
fn coupling(page: &mut Document, n: &Numbers) {
    let mut rows = vec![row(&["", "coupled", "not coupled", "as printed"])];
    for (name, what) in [
        ("amplitude of the rod's top, free", "top"),
        ("acceleration of the rod's top, free", "acceleration"),
        ("amplitude of the tip, free", "tip"),
        ("largest deformation, figure 4, Hertz", "depth"),
    ] {
        let mut cells = vec![name.to_owned()];
        cells.extend(
            ["coupled", "prescribed", "printed"].map(|key| n.shown(&format!("coupling.{key}.{what}"), 6)),
        );
        rows.push(cells);
    }
    page.table("15 V at 30 kHz. Not coupled: the rod moves as if alone and drives the lever. As printed: (13) taken literally.", rows);
    page.paragraph(
        "Conclusion 1, first half, holds.",
        format!(
            "Base accelerations with and without coupling differ by {}.",
            percent(n.get("coupling.coupled.top_ratio") - 1.0, 2)
        ),
    );
    page.paragraph(
        "Conclusion 1, second half, does not hold.",
        format!(
            "The coupled tip's amplitude is {} times that of the uncoupled one, not much larger: the beam weighs {} of \
             the rod. As printed, the base motion counts twice, and the tip moves {} times as far; that is the whole \
             effect.",
            n.shown("coupling.coupled.tip_ratio", 7),
            n.shown("mass.lever_over_rod", 3),
            n.shown("coupling.printed.tip_ratio", 6)
        ),
    );
}

/// Drives and rods that need the two-way model.
fn when_coupling_matters(page: &mut Document, n: &Numbers) {
    page.figure(
        "coupling_response.svg",
        "Free tip over the drive's frequency across the resonances of rod and lever, the paper's rod and a light one.",
    );
    page.figure(
        "coupling_map.svg",
        "Difference between coupled and uncoupled tip motion, relative, phase included, largest within each cell. \
         Only the rod's mass changes: a thinner rod moves under a voltage as a thick one does. Q = 100.",
    );
    page.paragraph(
        "When coupling matters.",
        format!(
            "For the paper's rod never above {} between 10 and 400 kHz (at {}, its own first resonance), and {} at 30 kHz. \
             It passes 1 % at 30 kHz for a rod lighter than {} beam masses, and somewhere in the band for one \
             lighter than {}: near resonances of the rod first, then of the lever. There the two-way model is \
             needed; a rod of {} under a beam of {} can do without.",
            percent(n.get("apart.table1.largest"), 2),
            n.shown("apart.table1.frequency", 3),
            percent(n.get("apart.table1.drive"), 1),
            n.shown("apart.mass_drive_beams", 2),
            n.shown("apart.mass_anywhere_beams", 2),
            milligrams(n.get("mass.rod")),
            milligrams(n.get("mass.lever"))
        ),
    );
}

/// Conclusion 2: what the law does to the deformation.
fn deformation(page: &mut Document, n: &Numbers) {
    page.paragraph(
        "Conclusion 2, first half, holds; second half does not.",
        format!(
            "Equal tip travel means equal deformation. At the scaled drive the three laws' largest deformations are \
             {}, {} and {}. What differs is the force, {}, {} and {}, and the contact radius.",
            n.shown("scaled.hertz.depth", 5),
            n.shown("scaled.dmt.depth", 5),
            n.shown("scaled.jkr.depth", 5),
            n.shown("scaled.hertz.force_max", 4),
            n.shown("scaled.dmt.force_max", 4),
            shown(n.get("scaled.jkr.force_max"), "N", 4)
        ),
    );
}

fn milligrams(mass: f64) -> String {
    format!("{} mg", shown(mass * 1e6, "1", 2))
}
