//! The paper's claims, each with its verdict, and the numbers that only the page has.

use super::super::super::Numbers;

/// Two motions closer than this, relative, are "almost the same".
const ALMOST: f64 = 0.01;
/// A response larger by this factor is "much larger".
const MUCH: f64 = 1.5;
/// A number read off the paper's text, "about", is met within this, relative.
const ABOUT: f64 = 0.1;

/// Adds what follows from other numbers and stands on the page alone.
pub(super) fn derive(n: &mut Numbers) {
    let strain = |depth: f64| (depth / 30e-9).sqrt();
    for (key, value, units) in [
        ("modulus", n.get("contact.modulus"), "N/m^2"),
        ("tip_apart", apart(n, "tip"), "m"),
        ("fold_height", -n.get("jkr.fold_depth"), "m"),
        ("voltage_ratio", n.get("scaled.voltage") / 15.0, "1"),
        ("strain", strain(n.get("fig4.hertz.depth")), "1"),
        ("strain_150", strain(150e-9), "1"),
        ("top_change", n.get("coupling.coupled.top_ratio") - 1.0, "1"),
        ("rod_mg", n.get("mass.rod") * 1e6, "1"),
        ("lever_mg", n.get("mass.lever") * 1e6, "1"),
    ] {
        n.add(format!("page.{key}"), "", value, units);
    }
}

/// How far a motion under DMT or JKR is from that under Hertz at the most, m.
fn apart(n: &Numbers, what: &str) -> f64 {
    n.get(&format!("fig4.dmt.{what}_apart")).max(n.get(&format!("fig4.jkr.{what}_apart")))
}

/// Whether a claim holds, in words.
pub(super) fn verdict(n: &Numbers, claim: &str) -> &'static str {
    let near = |key: &str, paper: f64| (n.get(key) / paper - 1.0).abs() <= ABOUT;
    let same = |what: &str| apart(n, what) / n.get(&format!("fig4.hertz.{what}")) < ALMOST;
    let holds = match claim {
        "modulus" => near("contact.modulus", 1.8e5),
        "travel" => same("tip") && same("top"),
        "deformations" => near("scaled.jkr.depth", 0.5 * n.get("scaled.hertz.depth")),
        // The forces as levels at the paper's drive, and as pairs with the deformations.
        "forces" => near("fig4.hertz.force_max", 1.8e-9),
        "pairs" => {
            near("law.hertz.force_150", 1.8e-9)
                && near("law.dmt.force_150", 1.5e-9)
                && near("law.jkr.force_75", 0.4e-9)
        }
        // What coupling does to the rod's top, and to the tip.
        "top" => (n.get("coupling.coupled.top_ratio") - 1.0).abs() < ALMOST,
        "tip" => n.get("coupling.coupled.tip_ratio") > MUCH,
        _ => false,
    };
    if holds { "holds" } else { "does not hold" }
}
