//! Maps over sample modulus and work of adhesion, with the borders that closed forms draw.

use super::super::super::scene_run::SceneRun;
use super::super::{LAWS, Picture};
use super::{RADII, reach};
use crate::contact::{DMT_BELOW, JKR_ABOVE};
use crate::engine::Finished;
use crate::report::{Heatmap, Panel, State, shown};
use crate::scene::{Axis, Params};
use crate::store::Coordinate;
use std::f64::consts::PI;
use std::sync::Arc;

/// The tip radius of the paper, m, for maps of the three laws beside each other.
const PAPER: f64 = 30e-9;

/// What the line of the fold is called.
const FOLD: &str = "left of it JKR never lets go";

/// What a map shows.
struct Kind {
    file: &'static str,
    title: &'static str,
    units: &'static str,
    name: &'static str,
    value: fn(&Finished) -> f64,
}

const KINDS: [Kind; 3] = [
    Kind {
        file: "ensemble_force.svg",
        title: "Largest force, tip radius 30 nm",
        units: "N",
        name: "largest force",
        // Where adhesion holds more than the drive presses, the sample only pulls.
        value: |one| if one.measured.force_max > 0.0 { one.measured.force_max } else { f64::NAN },
    },
    Kind {
        file: "ensemble_deformation.svg",
        title: "Largest deformation, tip radius 30 nm",
        units: "m",
        name: "largest deformation",
        value: |one| one.measured.indentation_max,
    },
    Kind {
        file: "ensemble_contact.svg",
        title: "Share of the period in contact, tip radius 30 nm",
        units: "1",
        name: "contact time",
        value: |one| one.measured.contact_time,
    },
];

pub(super) fn draw(runs: &[SceneRun]) -> Vec<Picture> {
    let mut pictures = Vec::new();
    for kind in &KINDS {
        let panels = runs.iter().zip(LAWS).map(|(ran, (law, name))| Panel {
            caption: name.into(),
            values: values(ran, PAPER, kind.value),
            lines: if law == "jkr" { vec![fold(ran, PAPER)] } else { Vec::new() },
            ..Panel::default()
        });
        pictures.push((kind.file.into(), picture(&runs[0], kind, panels.collect(), vec![FOLD.into()])));
    }
    let jkr = &runs[2];
    let radii = |kind: &Kind, lines: &dyn Fn(f64) -> Vec<Vec<(f64, f64)>>| -> Vec<Panel> {
        let panel = |&radius: &f64| Panel {
            caption: format!("JKR, R = {}", shown(radius, "m", 3)),
            values: values(jkr, radius, kind.value),
            lines: lines(radius),
            ..Panel::default()
        };
        RADII.iter().map(panel).collect()
    };
    let loss = Kind {
        file: "ensemble_loss.svg",
        title: "Loss per period under JKR, by tip radius",
        units: "J",
        name: "loss",
        // Without a release nothing is lost.
        value: |one| if one.measured.contacts > 0.0 { one.measured.dissipation } else { f64::NAN },
    };
    let panels = radii(&loss, &|radius| vec![fold(jkr, radius)]);
    pictures.push((loss.file.into(), picture(jkr, &loss, panels, vec![FOLD.into()])));
    let regimes = Kind {
        file: "ensemble_regimes.svg",
        title: "Where JKR lets go and where it belongs, by tip radius",
        ..KINDS[2]
    };
    let panels = radii(&regimes, &|radius| {
        vec![fold(jkr, radius), tabor(jkr, radius, JKR_ABOVE), tabor(jkr, radius, DMT_BELOW)]
    });
    let lines = vec![FOLD.into(), "Tabor's parameter 5 (left) and 0.1 (right)".into()];
    pictures.push((regimes.file.into(), picture(jkr, &regimes, panels, lines)));
    pictures
}

fn picture(ran: &SceneRun, kind: &Kind, panels: Vec<Panel>, lines: Vec<String>) -> String {
    let axes = &ran.scene.sweep.axes;
    let (x, y) = (coordinate(&axes[2]), coordinate(&axes[1]));
    Heatmap {
        title: kind.title.into(),
        units: kind.units,
        long_name: kind.name,
        x: &x,
        y: &y,
        columns: 3,
        panels,
        lines,
    }
    .draw()
}

fn coordinate(axis: &Axis) -> Coordinate {
    Coordinate {
        name: axis.name.clone(),
        units: axis.units.clone(),
        long_name: axis.long_name.clone(),
        scene_path: axis.path.clone(),
        values: Arc::clone(&axis.values),
        ..Coordinate::default()
    }
}

/// The first instance of the slice nearest to a tip radius, and how many it has.
fn slice(ran: &SceneRun, radius: f64) -> (usize, usize) {
    let axes = &ran.scene.sweep.axes;
    let plane = axes[1].values.len() * axes[2].values.len();
    let off = |i: usize| (axes[0].values[i] - radius).abs();
    let nearest = (0..axes[0].values.len()).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0);
    (nearest * plane, plane)
}

fn values(ran: &SceneRun, radius: f64, value: fn(&Finished) -> f64) -> Vec<(f64, State)> {
    let (first, count) = slice(ran, radius);
    let cell = |one: &Finished| {
        let value = value(one);
        (value, State::of(one.status as u8, value))
    };
    ran.outcome.results[first..][..count].iter().map(cell).collect()
}

/// Sample modulus (Pa) at which tip and sample have the combined modulus `modulus`; NaN where the tip alone
/// is softer than that.
fn sample_modulus(params: &Params, modulus: f64) -> f64 {
    let tip = &params.instrument.tip;
    let nu = params.sample.poisson_ratio;
    let compliance = 4.0 / (3.0 * modulus) - (1.0 - tip.poisson_ratio.powi(2)) / tip.youngs_modulus;
    if compliance > 0.0 { (1.0 - nu * nu) / compliance } else { f64::NAN }
}

/// Where the combined modulus takes a given value for each work of adhesion: (modulus, work).
fn line(ran: &SceneRun, modulus: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let works = &ran.scene.sweep.axes[1].values;
    let (low, high) = (works[0], works[works.len() - 1]);
    let work = |i: usize| low * (high / low).powf(i as f64 / 60.0);
    (0..=60).map(work).map(|work| (sample_modulus(&ran.scene.base, modulus(work)), work)).collect()
}

/// Where the fold lies as high as the tip comes: `3 a_s^2/R = reach`, `a_s^3 = pi w R^2/(6K)`.
fn fold(ran: &SceneRun, radius: f64) -> Vec<(f64, f64)> {
    let (first, _) = slice(ran, radius);
    let case = ran.plan.case(first as u32);
    let flexibility = ran.plan.driven(first as u32).kept.flexibility;
    let free = reach(ran, first) + 5.0 / 6.0 * PI * case.contact.work * radius * flexibility;
    line(ran, |work| {
        let reach = free - 5.0 / 6.0 * PI * work * radius * flexibility;
        PI * work * radius * radius / (6.0 * (radius * reach / 3.0).powf(1.5))
    })
}

/// Where Tabor's parameter is `mu`: `(3K/4)^2 = R w^2/(mu z0)^3`.
fn tabor(ran: &SceneRun, radius: f64, mu: f64) -> Vec<(f64, f64)> {
    let range = ran.scene.base.contact.decay_length;
    line(ran, |work| 4.0 / 3.0 * work * (radius / (mu * range).powi(3)).sqrt())
}
