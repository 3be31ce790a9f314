//! Figure 3: force against deformation under the three laws.

use super::super::{Numbers, StudyError};
use super::Picture;
use super::printed_choices::{DEEP, jkr_at_radius};
use super::table1::contact;
use crate::contact::CurveBranch;
use crate::report::{Chart, ChartField, Look, Mark, Plot, shown};
use crate::scene::{LawChoice, Params};

/// Half the deformation of Hertz and DMT: what the paper reads for JKR, m.
const HALF: f64 = 75e-9;

pub(super) fn find(numbers: &mut Numbers, params: &Params) -> Result<Vec<Picture>, StudyError> {
    let laws = [("hertz", LawChoice::Hertz), ("dmt", LawChoice::Dmt), ("jkr", LawChoice::Jkr)];
    for (name, law) in laws {
        let force = contact(params, law).force(DEEP, true);
        numbers.add(format!("law.{name}.force_150"), format!("force at 150 nm, {name}"), force, "N");
    }
    let jkr = contact(params, LawChoice::Jkr);
    numbers.add("law.jkr.force_75", "force at 75 nm, jkr", jkr.force(HALF, true), "N");
    numbers.add("law.jkr.radius_75", "contact radius at 75 nm, jkr", jkr.contact_radius(HALF, true), "m");
    let (delta, force) = jkr_at_radius(&jkr, (jkr.radius * DEEP).sqrt());
    numbers.add("law.jkr.depth_read", "deformation at a²/R = 150 nm, jkr", delta, "m");
    numbers.add("law.jkr.force_read", "force at a²/R = 150 nm, jkr", force, "N");
    Ok(vec![("figure_3.svg".to_owned(), draw(params))])
}

fn draw(params: &Params) -> String {
    let curve = |law: LawChoice, branch: CurveBranch| -> Vec<(f64, f64)> {
        let curves = contact(params, law).curves_to(DEEP).curves;
        let found = curves.iter().find(|curve| curve.branch == branch);
        found.map_or_else(Vec::new, |curve| {
            let forces = curve.force_n.iter().map(|force| force.unwrap_or(f64::NAN));
            curve.indentation_m.iter().copied().zip(forces).collect()
        })
    };
    let jkr = contact(params, LawChoice::Jkr);
    let (fold, touch) = (jkr.law().release(), jkr.force(0.0, true));
    let release = jkr.force(fold, true);
    let jump = format!("touch: jumps to {}", shown(touch, "N", 3));
    let release_text = format!("fold: lets go at {}, {}", shown(fold, "m", 3), shown(release, "N", 3));
    let chart = Chart {
        title: "Figure 3: force against deformation".into(),
        x: ChartField { label: "deformation, negative for a gap".into(), units: "m".into(), log: false },
        series: vec![
            Look::line("Hertz", 2.0, false),
            Look::line("DMT", 2.0, false),
            Look::line("JKR, approach", 2.6, false),
            Look::line("JKR, retraction", 1.8, true),
        ],
        panels: vec![Plot {
            label: "force on the tip".into(),
            units: "N".into(),
            lines: vec![
                curve(LawChoice::Hertz, CurveBranch::Approach),
                curve(LawChoice::Dmt, CurveBranch::Approach),
                curve(LawChoice::Jkr, CurveBranch::Approach),
                curve(LawChoice::Jkr, CurveBranch::Retract),
            ],
            marks: vec![
                Mark { x: 0.0, y: touch, text: jump, offset: (60.0, -26.0) },
                Mark { x: fold, y: release, text: release_text, offset: (14.0, 110.0) },
            ],
            height: 360.0,
        }],
    };
    chart.draw()
}
